//! Where a node puts its mesh: matrices of 4 × 4 that end in (0, 0, 0, 1).

use super::json::Json;

/// Rows 0 to 2 of a matrix of homogeneous coordinates.
pub(crate) type Matrix = [[f64; 4]; 3];

pub(crate) const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// a · b.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let sum = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
            if j == 3 { sum + a[i][3] } else { sum }
        })
    })
}

/// Of a node, from its parent's place to its own: `matrix`, or translation · rotation · scale.
pub(crate) fn of_node(node: &Json) -> Option<Matrix> {
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

/// Where a point goes.
pub(crate) fn point(m: &Matrix, p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3])
}

fn cofactors(m: &Matrix) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| minor(i, j)))
}

/// The determinant of the linear part; negative where it mirrors.
pub(crate) fn determinant(m: &Matrix) -> f64 {
    let c = cofactors(m);
    (0..3).map(|j| m[0][j] * c[0][j]).sum()
}

/// The direction of a normal: the linear part's inverse, transposed, applied to it, at length 1.
pub(crate) fn normal(m: &Matrix, n: [f64; 3]) -> [f64; 3] {
    let sign = if determinant(m) < 0.0 { -1.0 } else { 1.0 };
    let turned: [f64; 3] = cofactors(m).map(|row| sign * (row[0] * n[0] + row[1] * n[1] + row[2] * n[2]));
    let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { turned.map(|x| x / length) } else { n }
}

/// Whether it does more than shift.
pub(crate) fn turns(m: &Matrix) -> bool {
    (0..3).any(|i| (0..3).any(|j| m[i][j] != IDENTITY[i][j]))
}

/// The matrix that undoes `m`, or `None` where `m` flattens.
pub(crate) fn inverse(m: &Matrix) -> Option<Matrix> {
    let (c, d) = (cofactors(m), determinant(m));
    let inverse: Matrix = std::array::from_fn(|i| {
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
        // A quarter turn about z, twice as large, five up.
        let node = Json::parse(br#"{"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2],"translation":[0,0,5]}"#);
        let m = of_node(&node.unwrap()).unwrap();
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
        // The plane x = y, of which (1, 1, 0) is a tangent and (1, -1, 0) the normal.
        let (t, n) = (point(&m, [1.0, 1.0, 0.0]), normal(&m, [1.0, -1.0, 0.0]));
        assert!((0..3).map(|k| t[k] * n[k]).sum::<f64>().abs() < 1e-12);
    }
}
