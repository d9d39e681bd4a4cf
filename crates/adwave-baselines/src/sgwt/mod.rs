//! Spectral graph wavelets: kernels of the graph Laplacian, evaluated by polynomials or exactly.
//!
//! Source: `hammond2011`.
//!
//! ```text
//! c_i = g_i(L) f,   A‖f‖² ≤ Σ_i ‖c_i‖² ≤ B‖f‖²,   f = (Σ_i g_i(L)²)⁻¹ Σ_i g_i(L) c_i
//! ```
//! Strengths: the kernel can be chosen freely, a tight frame preserves energies, and any weighted graph is accepted.
//! Weaknesses: λ_max scales all kernels, so that scales depend on the meshing; the inverse is an iteration unless the
//! frame is tight; a sharp kernel needs a high degree and is not local.

mod chebyshev;
mod exact;
mod kernels;

pub(crate) use chebyshev::apply as apply_polynomials;
pub use chebyshev::{Polynomial, fit};
pub use exact::ExactFrame;
pub use kernels::{KernelFamily, Kernels};

use crate::linalg::{CgInfo, LinalgError, SymmetricMatrix, conjugate_gradients, symmetric_eigen};
use adwave::Progress;
use adwave::operator::Diffusion;
use thiserror::Error;

/// Reason for which a frame cannot be built or applied.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SgwtError {
    /// A linear algebra step failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The number of kernels is out of range.
    #[error("the number of kernels must be in {least}..={most}, got {got}")]
    Kernels {
        /// Number of kernels requested.
        got: usize,
        /// Smallest number of kernels.
        least: usize,
        /// Largest number of kernels.
        most: usize,
    },
    /// The requested accuracy cannot be reached.
    #[error(
        "kernel {kernel} must be approximated to {accuracy:e}, but a polynomial of degree {degree} reaches \
        only {error:e}; allow a larger error or choose smoother kernels"
    )]
    Accuracy {
        /// Index of the kernel.
        kernel: usize,
        /// Largest degree tried.
        degree: usize,
        /// Error at that degree.
        error: f64,
        /// Requested accuracy.
        accuracy: f64,
    },
    /// A signal or a list of coefficients has the wrong length.
    #[error("expected {expected} values, got {got}")]
    Length {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// The operator is not reversible.
    #[error("the diffusion operator is not reversible, so it has no symmetric form")]
    NotReversible,
    /// All kernels vanish somewhere in the spectrum.
    #[error("the kernels do not form a frame: their lower frame bound is {0:e}")]
    NoFrame(f64),
    /// The graph is too large for the exact method.
    #[error("the exact method is limited to {most} vertices, got {n}; use polynomials")]
    TooLarge {
        /// Number of vertices.
        n: usize,
        /// Largest number of vertices.
        most: usize,
    },
}

/// Kernels of a Laplacian, as polynomials of a given accuracy.
#[derive(Clone, Debug)]
pub struct Frame {
    laplacian: SymmetricMatrix,
    /// Kernels of the frame.
    pub kernels: Kernels,
    /// Polynomials `p_i ≈ g_i`, one per kernel.
    pub polynomials: Vec<Polynomial>,
    /// Frame bounds A and B: bounds of `Σ p_i(λ)²` for λ in [0, λ_max], computed from the kernels and the errors of the
    /// polynomials.
    pub bounds: (f64, f64),
}

/// Number of points of [0, λ_max] at which the bounds are evaluated.
const POINTS: usize = 20_000;

impl Frame {
    /// Builds the frame of `kernels` on a positive semi-definite `laplacian`. Each kernel is approximated within
    /// `accuracy` on [0, λ_max], so that coefficients have an error of at most `accuracy·‖f‖`.
    ///
    /// # Errors
    /// [`SgwtError::Accuracy`], [`SgwtError::NoFrame`].
    ///
    /// ```
    /// use adwave::Progress;
    /// use adwave_baselines::linalg::SymmetricMatrix;
    /// use adwave_baselines::sgwt::{Frame, KernelFamily, Kernels, largest_eigenvalue};
    /// let path = SymmetricMatrix::from_halves(2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0)])?;
    /// let kernels = Kernels::new(KernelFamily::Itersine, 4, largest_eigenvalue(&path))?;
    /// let frame = Frame::new(path, kernels, 1e-8)?;
    /// let c = frame.analyze(&[3.0, -1.0], Progress::none())?;
    /// let energy: f64 = c.iter().flatten().map(|v| v * v).sum();
    /// assert!((energy - 10.0).abs() < 1e-6); // a tight frame with A = B = 1
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(laplacian: SymmetricMatrix, kernels: Kernels, accuracy: f64) -> Result<Self, SgwtError> {
        let polynomials = fit(&kernels, accuracy)?;
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for i in 0..=POINTS {
            let lambda = kernels.lambda_max * i as f64 / POINTS as f64;
            let (mut least, mut most) = (0.0, 0.0);
            for (k, p) in polynomials.iter().enumerate() {
                let g = kernels.value(k, lambda).abs();
                least += (g - p.error).max(0.0).powi(2);
                most += (g + p.error).powi(2);
            }
            (low, high) = (low.min(least), high.max(most));
        }
        if !(low > 0.0 && high.is_finite()) {
            return Err(SgwtError::NoFrame(low));
        }
        Ok(Self { laplacian, kernels, polynomials, bounds: (low, high) })
    }

    /// Computes `c_i = p_i(L) f`, one list per kernel. All kernels share one recurrence.
    ///
    /// # Errors
    /// [`SgwtError::Length`]; [`SgwtError::Linalg`] if cancelled.
    pub fn analyze(&self, signal: &[f64], progress: Progress<'_>) -> Result<Vec<Vec<f64>>, SgwtError> {
        check(self.laplacian.n(), signal.len())?;
        Ok(chebyshev::apply(&self.laplacian, &self.polynomials, signal, progress)
            .map_err(LinalgError::from)?)
    }

    /// Computes `Σ_i p_i(L) c_i`, the adjoint of the analysis.
    ///
    /// # Errors
    /// [`SgwtError::Length`]; [`SgwtError::Linalg`] if cancelled.
    pub fn adjoint(&self, coefficients: &[Vec<f64>], progress: Progress<'_>) -> Result<Vec<f64>, SgwtError> {
        check(self.polynomials.len(), coefficients.len())?;
        for c in coefficients {
            check(self.laplacian.n(), c.len())?;
        }
        Ok(chebyshev::apply_adjoint(&self.laplacian, &self.polynomials, coefficients, progress)
            .map_err(LinalgError::from)?)
    }

    /// Reconstructs the signal whose coefficients are nearest to the given ones, by about `½√(B/A)·ln(2/tolerance)`
    /// iterations of conjugate gradients on `Σ p_i(L)²`.
    ///
    /// # Errors
    /// [`SgwtError`] for wrong lengths, if the iteration does not converge, and on cancellation.
    pub fn inverse(
        &self,
        coefficients: &[Vec<f64>],
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, CgInfo), SgwtError> {
        let right = self.adjoint(coefficients, progress)?;
        let condition = (self.bounds.1 / self.bounds.0).sqrt();
        let cap = 50 + (condition * (2.0 / tolerance.max(1e-15)).ln()).min(1e5) as usize;
        let apply = |x: &[f64], y: &mut [f64]| {
            // The solver checks for cancellation between its steps, so a step itself runs without a progress handle.
            let square = self
                .analyze(x, Progress::none())
                .and_then(|c| self.adjoint(&c, Progress::none()))
                .expect("the lengths are right, and the step cannot be cancelled");
            y.copy_from_slice(&square);
        };
        Ok(conjugate_gradients(apply, &right, tolerance, cap, progress)?)
    }
}

fn check(expected: usize, got: usize) -> Result<(), SgwtError> {
    if expected == got { Ok(()) } else { Err(SgwtError::Length { expected, got }) }
}

/// Computes `Π^½ (I − Q) Π^(−½)` of a reversible `walk`, where Q is its non-lazy part: symmetric, with its spectrum in
/// [0, 2]. Also returns `√(nπ)`, by which a signal is multiplied before and divided after. O(entries).
///
/// # Errors
/// [`SgwtError::NotReversible`].
pub fn normalized_laplacian(walk: &Diffusion) -> Result<(SymmetricMatrix, Vec<f64>), SgwtError> {
    if !walk.is_reversible() {
        return Err(SgwtError::NotReversible);
    }
    let n = walk.n_vertices();
    let root: Vec<f64> = walk.stationary().iter().map(|p| (p.max(1e-30) * n as f64).sqrt()).collect();
    let mut entries = Vec::new();
    for x in 0..n {
        let (columns, weights) = walk.row(x);
        entries.push((x as u32, x as u32, 2.0 * weights.iter().sum::<f64>()));
        let above = columns.iter().zip(weights).filter(|e| *e.0 as usize > x);
        entries.extend(above.map(|(&y, &w)| (x as u32, y, -2.0 * root[x] * w / root[y as usize])));
    }
    Ok((SymmetricMatrix::from_halves(n, &entries)?, root))
}

/// Upper bound of the largest eigenvalue, within about 1 %: the smaller of Gershgorin's bound and 1.01 times the sum of
/// the largest Ritz value of 60 Lanczos steps and its residual. The latter is not a proof, but Lanczos finds the top of
/// a spectrum first, and the 1 % leaves room for an error.
pub fn largest_eigenvalue(matrix: &SymmetricMatrix) -> f64 {
    const STEPS: usize = 60;
    const ROOM: f64 = 1.01;
    let n = matrix.n();
    let row_sums = (0..n).map(|x| matrix.row(x).1.iter().map(|a| a.abs()).sum::<f64>());
    let gershgorin = row_sums.fold(0.0, f64::max);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Multiples of the golden ratio have a component in every direction.
    let mut w: Vec<f64> = (0..n).map(|i| ((i as f64 + 1.0) * 0.618_033_988_749_895).fract() - 0.5).collect();
    let (mut basis, mut diagonal, mut off): (Vec<Vec<f64>>, Vec<f64>, Vec<f64>) = Default::default();
    for _ in 0..STEPS.min(n) {
        let length = dot(&w, &w).sqrt();
        if length <= 1e-12 * gershgorin {
            break;
        }
        off.push(length);
        let v: Vec<f64> = w.iter().map(|w| w / length).collect();
        w = matrix.product(&v);
        diagonal.push(dot(&v, &w));
        basis.push(v);
        for v in basis.iter().chain(&basis) {
            let part = dot(v, &w);
            for (w, v) in w.iter_mut().zip(v) {
                *w -= part * v;
            }
        }
    }
    let m = diagonal.len();
    let mut t = vec![0.0; m * m];
    for i in 0..m {
        t[i * m + i] = diagonal[i];
        if i > 0 {
            t[(i - 1) * m + i] = off[i];
            t[i * m + i - 1] = off[i];
        }
    }
    let Ok((values, vectors)) = symmetric_eigen(&t, m) else { return gershgorin };
    let Some(&top) = values.last() else { return gershgorin };
    let residual = dot(&w, &w).sqrt() * vectors[m * m - 1].abs();
    gershgorin.min(ROOM * (top + residual))
}

#[cfg(test)]
mod tests;
