//! Symmetric positive tensors of three dimensions, such as those of diffusion: their logarithms are six scalars.
//!
//! Log-Euclidean: `D′ = exp(S(log D))` for any diffusion S of scalars. The result is positive definite, since an
//! exponential is, and `log det D = tr log D` diffuses as a scalar, so that tensors don't swell where their directions
//! differ (`arsigny2006`).

use crate::parallel;
use crate::{Cancelled, Progress, named_values};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Number of tensors that a thread processes at a time.
const TENSORS_AT_A_TIME: usize = 1 << 11;

/// Order of the six components of a symmetric tensor in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TensorOrder {
    /// By rows of the upper triangle: xx, xy, xz, yy, yz, zz.
    #[default]
    Upper,
    /// By rows of the lower triangle: xx, xy, yy, xz, yz, zz.
    Lower,
    /// The diagonal first: xx, yy, zz, xy, xz, yz.
    Diagonal,
}

named_values!(TensorOrder, "order of tensors", {
    Upper => "upper" | "fsl", "xx, xy, xz, yy, yz, zz: FSL";
    Lower => "lower" | "nifti", "xx, xy, yy, xz, yz, zz: NIfTI symmetric matrices, ANTs, DIPY";
    Diagonal => "diagonal" | "mrtrix", "xx, yy, zz, xy, xz, yz: MRtrix";
});

impl TensorOrder {
    /// Position in this order of each component of the order [`Upper`](Self::Upper).
    pub fn positions(self) -> [usize; 6] {
        match self {
            Self::Upper => [0, 1, 2, 3, 4, 5],
            Self::Lower => [0, 1, 3, 2, 4, 5],
            Self::Diagonal => [0, 3, 4, 1, 5, 2],
        }
    }

    /// Components in the order [`Upper`](Self::Upper) of tensors in this order, n × 6.
    pub fn to_upper(self, tensors: &[f64]) -> Vec<f64> {
        let positions = self.positions();
        tensors.chunks_exact(6).flat_map(|tensor| positions.map(|at| tensor[at])).collect()
    }

    /// Components in this order of tensors in the order [`Upper`](Self::Upper), n × 6.
    pub fn reorder_upper(self, tensors: &[f64]) -> Vec<f64> {
        let positions = self.positions();
        let mut out = vec![0.0; tensors.len()];
        for (out, tensor) in out.chunks_exact_mut(6).zip(tensors.chunks_exact(6)) {
            for (&at, value) in positions.iter().zip(tensor) {
                out[at] = *value;
            }
        }
        out
    }
}

/// Logarithms of tensors.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorLogarithms {
    /// Components xx, xy, xz, yy, yz, zz of each logarithm, n × 6; NaN where there is none.
    pub logarithms: Vec<f64>,
    /// Number of tensors that are finite, not all 0, and not positive definite.
    pub n_not_positive: usize,
}

/// Matrix logarithms of symmetric tensors (n × 6: xx, xy, xz, yy, yz, zz). A tensor that is not finite, or whose smallest
/// eigenvalue is not above 0, has none; tensors of zeros, as outside of a brain, are not counted. O(n).
///
/// ```
/// use adwave::directions::{exp_tensors, log_tensors};
/// use adwave::Progress;
/// let tensors = [4.0, 0.0, 0.0, 1.0, 0.0, 1.0, /* not positive */ 1.0, 2.0, 0.0, 1.0, 0.0, 1.0];
/// let found = log_tensors(&tensors, Progress::none())?;
/// assert!((found.logarithms[0] - 4.0_f64.ln()).abs() < 1e-15 && found.logarithms[6].is_nan());
/// assert_eq!(found.n_not_positive, 1);
/// let back = exp_tensors(&found.logarithms, Progress::none())?;
/// assert!((back[0] - 4.0).abs() < 1e-14 && (back[3] - 1.0).abs() < 1e-14);
/// # Ok::<(), adwave::Cancelled>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless there are six values for each tensor.
pub fn log_tensors(tensors: &[f64], progress: Progress<'_>) -> Result<TensorLogarithms, Cancelled> {
    let mut logarithms = tensors.to_vec();
    let counts = parallel::try_map_rows(
        logarithms.as_chunks_mut::<6>().0,
        1,
        TENSORS_AT_A_TIME,
        progress,
        |_, rows| rows.iter_mut().map(|tensor| usize::from(!take_logarithm(tensor))).sum::<usize>(),
    )?;
    assert!(tensors.len().is_multiple_of(6), "six values for each tensor");
    Ok(TensorLogarithms { logarithms, n_not_positive: counts.into_iter().sum() })
}

/// Matrix exponentials of symmetric tensors (n × 6: xx, xy, xz, yy, yz, zz); NaN stays NaN. O(n).
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless there are six values for each tensor.
pub fn exp_tensors(logarithms: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
    assert!(logarithms.len().is_multiple_of(6), "six values for each tensor");
    let mut tensors = logarithms.to_vec();
    parallel::try_visit_rows(tensors.as_chunks_mut::<6>().0, 1, TENSORS_AT_A_TIME, progress, |_, rows| {
        for tensor in rows.iter_mut().filter(|tensor| tensor.iter().all(|t| t.is_finite())) {
            map_eigenvalues(tensor, |_| true, f64::exp);
        }
    })?;
    Ok(tensors)
}

/// Replaces a tensor by its logarithm, or by NaN if it has none. False if it is finite, not 0, and not positive.
fn take_logarithm(tensor: &mut [f64; 6]) -> bool {
    let is_finite = tensor.iter().all(|t| t.is_finite());
    let is_zero = tensor.iter().all(|t| *t == 0.0);
    if is_finite && !is_zero && map_eigenvalues(tensor, |v| v > 0.0, f64::ln) {
        return true;
    }
    *tensor = [f64::NAN; 6];
    !is_finite || is_zero
}

/// Applies a function to the eigenvalues of a tensor if `allowed` holds for all of them.
fn map_eigenvalues(tensor: &mut [f64; 6], allowed: fn(f64) -> bool, value: fn(f64) -> f64) -> bool {
    let largest = tensor.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    let scale = if largest > 0.0 { largest } else { 1.0 };
    let [xx, xy, xz, yy, yz, zz] = tensor.map(|t| t / scale);
    let eigen = SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
    let values: Vector3<f64> = eigen.eigenvalues * scale;
    if !values.iter().all(|v| allowed(*v)) {
        return false;
    }
    let vectors = eigen.eigenvectors;
    let mapped = vectors * Matrix3::from_diagonal(&values.map(value)) * vectors.transpose();
    *tensor = [mapped.m11, mapped.m12, mapped.m13, mapped.m22, mapped.m23, mapped.m33];
    true
}
