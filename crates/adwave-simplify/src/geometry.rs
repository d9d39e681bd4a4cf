//! Vectors, and the nearest point of a triangle.

pub(crate) type Point = [f64; 3];

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(u: Point, v: Point) -> Point {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(crate) fn length(v: Point) -> f64 {
    dot(v, v).sqrt()
}

/// Point `a + t (b − a)`.
pub(crate) fn interpolate(a: Point, b: Point, t: f64) -> Point {
    std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
}

/// Vector `(b − a) × (c − a)`, whose length is twice the area.
pub(crate) fn doubled_normal([a, b, c]: [Point; 3]) -> Point {
    cross(minus(b, a), minus(c, a))
}

pub(crate) fn doubled_area(triangle: [Point; 3]) -> f64 {
    length(doubled_normal(triangle))
}

/// Mean of points.
pub(crate) fn center(points: &[Point]) -> Point {
    std::array::from_fn(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64)
}

/// Barycentric coordinates of the point of a triangle nearest to `p`, by the seven regions of Ericson, "Real-Time
/// Collision Detection", 5.1.5.
pub(crate) fn nearest_weights(p: Point, &[a, b, c]: &[Point; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (minus(b, a), minus(c, a), minus(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = minus(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = share(d1, -d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = minus(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = share(d2, -d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = share(d4 - d3, d5 - d6);
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    if sum.is_nan() || sum <= 0.0 {
        return [1.0, 0.0, 0.0]; // no area: any point of the triangle gives an upper bound
    }
    [va / sum, vb / sum, vc / sum]
}

/// Ratio `x / (x + y)`; 0 if the sum is 0.
fn share(x: f64, y: f64) -> f64 {
    if x + y > 0.0 { x / (x + y) } else { 0.0 }
}

/// Squared distance of a point from a triangle, computed at a point that is the nearest one up to rounding.
pub(crate) fn squared_distance(p: Point, triangle: &[Point; 3]) -> f64 {
    let weights = nearest_weights(p, triangle);
    let [a, b, c] = triangle;
    let to: Point = std::array::from_fn(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k] - p[k]);
    dot(to, to)
}
