//! Transforms of nodes: 4 × 4 matrices with the last row (0, 0, 0, 1).

use super::json::Json;

/// Rows 0 to 2 of a matrix of homogeneous coordinates.
pub(crate) type AffineMatrix = [[f64; 4]; 3];

pub(crate) const IDENTITY: AffineMatrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Product a · b.
pub(crate) fn product(a: &AffineMatrix, b: &AffineMatrix) -> AffineMatrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let sum = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
            if j == 3 { sum + a[i][3] } else { sum }
        })
    })
}

/// Local transform of a node relative to its parent: `matrix`, or translation · rotation · scale.
pub(crate) fn node_transform(node: &Json) -> Option<AffineMatrix> {
    if let Some(columns) = node.numbers::<16>("matrix") {
        return Some(std::array::from_fn(|i| std::array::from_fn(|j| columns[4 * j + i])));
    }
    let given = ["translation", "rotation", "scale", "matrix"].iter().any(|key| node.get(key).is_some());
    if !given {
        return None;
    }
    let [tx, ty, tz] = node.numbers("translation").unwrap_or([0.0; 3]);
    let [x, y, z, w] = node.numbers("rotation").unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let [sx, sy, sz] = node.numbers("scale").unwrap_or([1.0; 3]);
    Some([
        [(1.0 - 2.0 * (y * y + z * z)) * sx, 2.0 * (x * y - z * w) * sy, 2.0 * (x * z + y * w) * sz, tx],
        [2.0 * (x * y + z * w) * sx, (1.0 - 2.0 * (x * x + z * z)) * sy, 2.0 * (y * z - x * w) * sz, ty],
        [2.0 * (x * z - y * w) * sx, 2.0 * (y * z + x * w) * sy, (1.0 - 2.0 * (x * x + y * y)) * sz, tz],
    ])
}

/// Transforms a point.
pub(crate) fn point(m: &AffineMatrix, p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3])
}

fn cofactors(m: &AffineMatrix) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| minor(i, j)))
}

/// Determinant of the linear part; negative for a reflection.
pub(crate) fn determinant(m: &AffineMatrix) -> f64 {
    let c = cofactors(m);
    (0..3).map(|j| m[0][j] * c[0][j]).sum()
}

/// Transforms a normal by the inverse transpose of the linear part and scales it to length 1.
pub(crate) fn normal(m: &AffineMatrix, n: [f64; 3]) -> [f64; 3] {
    let sign = if determinant(m) < 0.0 { -1.0 } else { 1.0 };
    let turned: [f64; 3] = cofactors(m).map(|row| sign * (row[0] * n[0] + row[1] * n[1] + row[2] * n[2]));
    let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { turned.map(|x| x / length) } else { n }
}

/// Transforms a direction on the surface by the linear part and scales it to length 1.
pub(crate) fn direction(m: &AffineMatrix, d: [f64; 3]) -> [f64; 3] {
    let turned: [f64; 3] = std::array::from_fn(|i| m[i][0] * d[0] + m[i][1] * d[1] + m[i][2] * d[2]);
    let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { turned.map(|x| x / length) } else { d }
}

/// True if the matrix is more than a translation.
pub(crate) fn turns(m: &AffineMatrix) -> bool {
    (0..3).any(|i| (0..3).any(|j| m[i][j] != IDENTITY[i][j]))
}

/// Inverse of `m`, or `None` if `m` is singular.
pub(crate) fn inverse(m: &AffineMatrix) -> Option<AffineMatrix> {
    let (c, d) = (cofactors(m), determinant(m));
    let inverse: AffineMatrix = std::array::from_fn(|i| {
        let row: [f64; 3] = std::array::from_fn(|j| c[j][i] / d);
        let shift = -(row[0] * m[0][3] + row[1] * m[1][3] + row[2] * m[2][3]);
        [row[0], row[1], row[2], shift]
    });
    inverse.as_flattened().iter().all(|x| x.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_turns_scales_and_shifts_in_that_order() {
        // A quarter turn about z, a scaling by 2, and a translation by 5 along z.
        let node = Json::parse(br#"{"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2],"translation":[0,0,5]}"#);
        let m = node_transform(&node.unwrap()).unwrap();
        let p = point(&m, [1.0, 0.0, 0.0]);
        assert!(p.iter().zip([0.0, 2.0, 5.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{p:?}");
        let back = point(&inverse(&m).unwrap(), p);
        assert!(back.iter().zip([1.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        assert!((determinant(&m) - 8.0).abs() < 1e-12);
        let once = product(&m, &IDENTITY);
        assert_eq!(once, m);
    }

    #[test]
    fn normals_of_a_mirrored_and_stretched_plane_stay_normal() {
        let m = [[-3.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        // The plane x = y with the tangent (1, 1, 0) and the normal (1, -1, 0).
        let (t, n) = (point(&m, [1.0, 1.0, 0.0]), normal(&m, [1.0, -1.0, 0.0]));
        assert!((0..3).map(|k| t[k] * n[k]).sum::<f64>().abs() < 1e-12);
    }
}
