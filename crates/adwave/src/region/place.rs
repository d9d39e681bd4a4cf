//! Location of a shape that is nearest to a point.

use super::front::Corners;
use crate::shape::distance;
use crate::vector::{add_scaled, dot, subtract};

/// Location on a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePlace {
    /// Position of the location.
    pub(super) point: [f64; 3],
    /// The welded vertex nearest to the point that it was looked up for.
    pub(super) vertex: usize,
    /// The triangle that it lies in.
    pub(super) corners: Option<[u32; 3]>,
    /// Distance from the point that it was looked up for.
    pub(super) distance: f64,
}

impl SurfacePlace {
    /// The nearest location on the triangles around the nearest `vertex` and around its neighbors.
    pub(super) fn nearest_on_mesh(
        p: &[f64; 3],
        vertex: usize,
        corners: &Corners,
        points: &[[f64; 3]],
    ) -> Self {
        let at_vertex = points[vertex];
        let mut best = Self { point: at_vertex, vertex, corners: None, distance: distance(p, &at_vertex) };
        if best.distance == 0.0 {
            return best;
        }
        let own = corners.pairs_of(vertex as u32);
        let others =
            own.iter().flatten().flat_map(|&v| corners.pairs_of(v).iter().map(move |pair| (v, pair)));
        for (v, &[q, r]) in own.iter().map(|pair| (vertex as u32, pair)).chain(others) {
            let triangle = [v, q, r];
            let point = nearest_on_triangle(p, triangle.map(|v| &points[v as usize]));
            let away = distance(p, &point);
            if away < best.distance {
                best = Self { point, vertex, corners: Some(triangle), distance: away };
            }
        }
        best
    }

    /// The point itself if it lies among the points of a cloud or curve, no farther from the nearest `vertex` than its
    /// `reach`; else the vertex.
    pub(super) fn nearest_among_points(p: &[f64; 3], vertex: usize, reach: f64, points: &[[f64; 3]]) -> Self {
        let away = distance(p, &points[vertex]);
        let (point, distance) = if away <= reach { (*p, 0.0) } else { (points[vertex], away) };
        Self { point, vertex, corners: None, distance }
    }
}

/// Nearest point of a triangle, which may have no area.
fn nearest_on_triangle(p: &[f64; 3], [a, b, c]: [&[f64; 3]; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (subtract(b, a), subtract(c, a), subtract(p, a));
    let (bb, bc, cc) = (dot(&ab, &ab), dot(&ab, &ac), dot(&ac, &ac));
    let (pb, pc) = (dot(&ap, &ab), dot(&ap, &ac));
    let det = bb * cc - bc * bc;
    if det > 0.0 {
        let (s, t) = ((cc * pb - bc * pc) / det, (bb * pc - bc * pb) / det);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return add_scaled(&add_scaled(a, s, &ab), t, &ac);
        }
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| nearest_on_side(p, a, b));
    let [first, second, third] = sides;
    let nearer = |q: [f64; 3], r: [f64; 3]| if distance(p, &r) < distance(p, &q) { r } else { q };
    nearer(nearer(first, second), third)
}

/// Nearest point of the segment from `a` to `b`.
pub(super) fn nearest_on_side(p: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    let way = subtract(b, a);
    let squared = dot(&way, &way);
    let t = dot(&subtract(p, a), &way) / squared;
    add_scaled(a, if squared > 0.0 { t.clamp(0.0, 1.0) } else { 0.0 }, &way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_a_triangle_is_no_farther_than_any_other() {
        let mut state = 3_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        for _ in 0..200 {
            let [p, a, b, c] = std::array::from_fn(|_| std::array::from_fn::<f64, 3, _>(|_| random()));
            let near = nearest_on_triangle(&p, [&a, &b, &c]);
            let least = distance(&p, &near);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (s, t) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let other = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
                    assert!(least <= distance(&p, &other) + 1e-12);
                }
            }
        }
        let flat = nearest_on_triangle(&[0.3, 1.0, 0.0], [&[0.0; 3], &[1.0, 0.0, 0.0], &[0.5, 0.0, 0.0]]);
        assert!((flat[0] - 0.3).abs() < 1e-12 && flat[1] == 0.0);
    }
}
