//! Conjugate gradients for symmetric positive (semi-)definite operators.

use super::LinalgError;
use adwave::Progress;

/// Cost and accuracy of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CgInfo {
    /// Number of iterations.
    pub iterations: usize,
    /// Relative residual `‖b − A x‖ / ‖b‖` according to the recurrence.
    pub residual: f64,
}

/// Solves `A x = b` to `‖b − A x‖ ≤ tolerance·‖b‖` for a symmetric positive semi-definite `A`, where `apply(x, y)`
/// computes `y = A x`.
///
/// The iteration starts at 0, so that the part of `b` in the null space of A does not enter `x`. It does not converge
/// if `b` lies outside the range of A by more than the tolerance.
///
/// # Errors
/// [`LinalgError::CgNotConverged`] after `max_iterations`, [`LinalgError::Cancelled`].
///
/// ```
/// use adwave::Progress;
/// use adwave_baselines::linalg::conjugate_gradients;
/// let apply = |x: &[f64], y: &mut [f64]| { y[0] = 2.0 * x[0] + x[1]; y[1] = x[0] + 2.0 * x[1]; };
/// let (x, info) = conjugate_gradients(apply, &[4.0, 5.0], 1e-12, 10, Progress::none())?;
/// assert!((x[0] - 1.0).abs() < 1e-12 && info.iterations <= 2);
/// # Ok::<(), adwave_baselines::linalg::LinalgError>(())
/// ```
pub fn conjugate_gradients(
    mut apply: impl FnMut(&[f64], &mut [f64]),
    b: &[f64],
    tolerance: f64,
    max_iterations: usize,
    progress: Progress<'_>,
) -> Result<(Vec<f64>, CgInfo), LinalgError> {
    let scale = dot(b, b).sqrt();
    let mut x = vec![0.0; b.len()];
    if scale == 0.0 {
        return Ok((x, CgInfo { iterations: 0, residual: 0.0 }));
    }
    let (mut r, mut p, mut ap) = (b.to_vec(), b.to_vec(), vec![0.0; b.len()]);
    let mut rr = dot(&r, &r);
    let mut residual = 1.0;
    for iteration in 0..max_iterations {
        if residual <= tolerance {
            return Ok((x, CgInfo { iterations: iteration, residual }));
        }
        progress.step(iteration as u64, max_iterations as u64)?;
        apply(&p, &mut ap);
        let curvature = dot(&p, &ap);
        if !(curvature.is_finite() && curvature > 0.0) {
            return Err(LinalgError::CgNotConverged { iterations: iteration, residual });
        }
        let step = rr / curvature;
        for (x, p) in x.iter_mut().zip(&p) {
            *x += step * p;
        }
        for (r, ap) in r.iter_mut().zip(&ap) {
            *r -= step * ap;
        }
        let next = dot(&r, &r);
        for (p, r) in p.iter_mut().zip(&r) {
            *p = r + next / rr * *p;
        }
        rr = next;
        residual = rr.sqrt() / scale;
    }
    if residual <= tolerance {
        return Ok((x, CgInfo { iterations: max_iterations, residual }));
    }
    Err(LinalgError::CgNotConverged { iterations: max_iterations, residual })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
