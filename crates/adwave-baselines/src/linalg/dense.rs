//! Dense symmetric eigenproblems.

use super::LinalgError;
use faer::{MatRef, Side};

/// Computes the eigenvalues in ascending order and the orthonormal eigenvectors, column-major, of a dense symmetric `n`
/// × `n` matrix, column-major. O(n³).
///
/// # Errors
/// [`LinalgError::DenseEigen`].
pub(crate) fn symmetric_eigen(matrix: &[f64], n: usize) -> Result<(Vec<f64>, Vec<f64>), LinalgError> {
    if n == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    // faer does not terminate on NaN.
    if matrix.iter().any(|a| !a.is_finite()) {
        return Err(LinalgError::DenseEigen { n });
    }
    let eigen = MatRef::from_column_major_slice(matrix, n, n)
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| LinalgError::DenseEigen { n })?;
    let values = (0..n).map(|i| eigen.S()[i]).collect();
    let vectors = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| eigen.U()[(i, j)]).collect();
    Ok((values, vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_graph_has_its_cosines() {
        for n in [1_usize, 2, 7, 50, 64, 130] {
            let mut laplacian = vec![0.0; n * n];
            for i in 1..n {
                laplacian[i * n + i] += 1.0;
                laplacian[(i - 1) * n + i - 1] += 1.0;
                laplacian[i * n + i - 1] = -1.0;
                laplacian[(i - 1) * n + i] = -1.0;
            }
            let (values, _) = symmetric_eigen(&laplacian, n).unwrap();
            for (k, &value) in values.iter().enumerate() {
                let exact = 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / n as f64).cos();
                assert!((value - exact).abs() < 1e-13 * n as f64, "n = {n}, k = {k}: {value} {exact}");
            }
        }
    }

    #[test]
    fn nan_is_an_error() {
        assert_eq!(symmetric_eigen(&[f64::NAN], 1), Err(LinalgError::DenseEigen { n: 1 }));
    }
}
