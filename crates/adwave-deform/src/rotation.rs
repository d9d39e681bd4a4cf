//! Rotations as unit quaternions, and matrices of three rows.

use adwave::vector::{Vector, cross};

/// A matrix by rows.
pub(crate) type Matrix = [[f64; 3]; 3];

/// The identity matrix.
pub(crate) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The quaternion `w, x, y, z` of no rotation.
pub(crate) const NO_TURN: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Cap on the sweeps of Jacobi's method; four or five are usual.
const MAX_SWEEPS: usize = 30;

/// Product `a·b`.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// Transpose of `a`.
pub(crate) fn transpose(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

/// Product `a·v`.
#[inline]
pub(crate) fn image(a: &Matrix, v: &Vector) -> Vector {
    [0, 1, 2].map(|i| a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2])
}

/// Determinant of `a`.
pub(crate) fn determinant(a: &Matrix) -> f64 {
    let c = cross(&a[1], &a[2]);
    a[0][0] * c[0] + a[0][1] * c[1] + a[0][2] * c[2]
}

/// Adds `s·u·vᵀ`.
#[inline]
pub(crate) fn add_outer(sum: &mut Matrix, s: f64, u: &Vector, v: &Vector) {
    for (row, c) in sum.iter_mut().zip(u) {
        for (entry, d) in row.iter_mut().zip(v) {
            *entry += s * c * d;
        }
    }
}

/// Rotation matrix of a unit quaternion.
pub(crate) fn to_matrix(q: &[f64; 4]) -> Matrix {
    let [w, x, y, z] = *q;
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Change `(R − I)·v` that a rotation makes: exactly 0 for no rotation.
#[inline]
pub(crate) fn turn_change(q: &[f64; 4], v: &Vector) -> Vector {
    let axis = [q[1], q[2], q[3]];
    let t = cross(&axis, v);
    let s = cross(&axis, &t);
    [0, 1, 2].map(|c| 2.0 * (q[0] * t[c] + s[c]))
}

/// Product `a·b` of quaternions: the rotation b, then a.
pub(crate) fn compose(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Quaternion of length 1 along `q`; no rotation if `q` has no direction.
#[inline]
pub(crate) fn normalized(q: &[f64; 4]) -> [f64; 4] {
    let squared = q.iter().map(|c| c * c).sum::<f64>();
    if squared == 1.0 {
        return *q;
    }
    if !(squared > 1e-200 && squared.is_finite()) {
        return NO_TURN;
    }
    let scale = 1.0 / squared.sqrt();
    q.map(|c| c * scale)
}

/// Rotation by a vector: its length is the angle in radians.
pub(crate) fn exponential(v: &Vector) -> [f64; 4] {
    let angle = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    // sin(angle/2)/angle, whose limit at 0 is a half.
    let s = if angle < 1e-8 { 0.5 } else { (0.5 * angle).sin() / angle };
    normalized(&[(0.5 * angle).cos(), s * v[0], s * v[1], s * v[2]])
}

/// Vector of the rotation by a unit quaternion, whose length is the angle in radians, at most π.
pub(crate) fn logarithm(q: &[f64; 4]) -> Vector {
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    let axis = [1, 2, 3].map(|c| sign * q[c]);
    let sine = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
    // angle/sin(angle/2), whose limit at 0 is 2.
    let factor = if sine < 1e-8 { 2.0 } else { 2.0 * sine.atan2(sign * q[0]) / sine };
    axis.map(|c| factor * c)
}

/// Rotation R with the largest `⟨R, m⟩`, that is the rotation nearest to `m` (`horn1987`). A matrix that prefers no
/// rotation gives none.
#[expect(clippy::needless_range_loop, reason = "rows and columns of one matrix")]
pub(crate) fn nearest_rotation(m: &Matrix) -> [f64; 4] {
    let scale = m.iter().flatten().fold(0.0_f64, |largest, c| largest.max(c.abs()));
    if !(scale > 0.0 && scale.is_finite()) {
        return NO_TURN;
    }
    let m = m.map(|row| row.map(|c| c / scale));
    let (xx, yy, zz) = (m[0][0], m[1][1], m[2][2]);
    let mut a = [
        [xx + yy + zz, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
        [0.0, xx - yy - zz, m[0][1] + m[1][0], m[2][0] + m[0][2]],
        [0.0, 0.0, yy - xx - zz, m[1][2] + m[2][1]],
        [0.0, 0.0, 0.0, zz - xx - yy],
    ];
    for i in 0..4 {
        for j in 0..i {
            a[i][j] = a[j][i];
        }
    }
    let (values, vectors) = symmetric_eigen(a);
    let best = (1..4).fold(0, |best, k| if values[k] > values[best] { k } else { best });
    let q = [0, 1, 2, 3].map(|i| vectors[i][best]);
    normalized(&if q[0] < 0.0 { q.map(|c| -c) } else { q })
}

/// Eigenvalues of a symmetric matrix and its eigenvectors as columns, by Jacobi's rotations.
#[expect(clippy::needless_range_loop, reason = "rows and columns of one matrix")]
pub(crate) fn symmetric_eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut vectors = [[0.0; N]; N];
    for (i, row) in vectors.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    for _ in 0..MAX_SWEEPS {
        let (mut off, mut on) = (0.0, 0.0);
        for (i, row) in a.iter().enumerate() {
            for (j, c) in row.iter().enumerate() {
                *(if i == j { &mut on } else { &mut off }) += c * c;
            }
        }
        if off <= 1e-32 * on || off == 0.0 {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..N {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                for row in &mut vectors {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    let mut values = [0.0; N];
    for (i, value) in values.iter_mut().enumerate() {
        *value = a[i][i];
    }
    (values, vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_rotation_of_a_rotation_is_it() {
        for v in [[0.0, 0.0, 0.0], [0.3, -0.2, 0.9], [3.1, 0.0, 0.0], [-1.0, 2.0, -0.5]] {
            let r = to_matrix(&exponential(&v));
            let found = to_matrix(&nearest_rotation(&r));
            for (a, b) in r.as_flattened().iter().zip(found.as_flattened()) {
                assert!((a - b).abs() < 1e-14, "{v:?}: {a} {b}");
            }
            assert!((determinant(&r) - 1.0).abs() < 1e-14);
            let again = to_matrix(&exponential(&logarithm(&exponential(&v))));
            for (a, b) in r.as_flattened().iter().zip(again.as_flattened()) {
                assert!((a - b).abs() < 1e-14, "{v:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn the_change_of_a_turn_is_that_of_its_matrix() {
        let (q, v) = (exponential(&[0.4, 1.1, -0.6]), [0.2, -3.0, 0.7]);
        let turned = image(&to_matrix(&q), &v);
        let change = turn_change(&q, &v);
        for c in 0..3 {
            assert!((turned[c] - v[c] - change[c]).abs() < 1e-14);
        }
        assert_eq!(turn_change(&NO_TURN, &v), [0.0; 3]);
        let twice = image(&to_matrix(&compose(&q, &q)), &v);
        let in_turn = image(&to_matrix(&q), &turned);
        assert!((0..3).all(|c| (twice[c] - in_turn[c]).abs() < 1e-14));
        assert_eq!(product(&IDENTITY, &transpose(&to_matrix(&q))), transpose(&to_matrix(&q)));
    }

    #[test]
    fn eigenvectors_satisfy_their_equation() {
        let a = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 1.0]];
        let (values, vectors) = symmetric_eigen(a);
        for k in 0..3 {
            let v = [0, 1, 2].map(|i| vectors[i][k]);
            let w = image(&a, &v);
            assert!((0..3).all(|i| (w[i] - values[k] * v[i]).abs() < 1e-13));
        }
    }
}
