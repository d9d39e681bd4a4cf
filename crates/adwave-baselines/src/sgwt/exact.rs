//! Spectral graph wavelets computed from all eigenpairs, on small graphs.

use super::{Kernels, SgwtError, check};
use crate::linalg::{SymmetricMatrix, symmetric_eigen};

/// Largest number of vertices, for which the eigenvectors take 128 MB.
const MAX_VERTICES: usize = 4000;

/// Kernels of a Laplacian with its full spectrum.
#[derive(Clone, Debug)]
pub struct ExactFrame {
    n: usize,
    /// Kernels of the frame.
    pub kernels: Kernels,
    /// Eigenvalues in ascending order.
    pub spectrum: Vec<f64>,
    vectors: Vec<f64>,
    /// Frame bounds A and B: smallest and largest `Σ g_i(λ)²` over the eigenvalues.
    pub bounds: (f64, f64),
}

impl ExactFrame {
    /// Builds the frame of `kernels` on `laplacian`. O(n³).
    ///
    /// # Errors
    /// [`SgwtError::TooLarge`], [`SgwtError::NoFrame`], [`SgwtError::Linalg`].
    pub fn new(laplacian: &SymmetricMatrix, kernels: Kernels) -> Result<Self, SgwtError> {
        let n = laplacian.n();
        if n > MAX_VERTICES {
            return Err(SgwtError::TooLarge { n, most: MAX_VERTICES });
        }
        let (spectrum, vectors) = symmetric_eigen(&laplacian.to_dense(), n)?;
        let sums =
            spectrum.iter().map(|&l| (0..kernels.len()).map(|i| kernels.value(i, l).powi(2)).sum::<f64>());
        let (low, high) = sums.fold((f64::INFINITY, 0.0_f64), |(low, high), s| (low.min(s), high.max(s)));
        if low <= 0.0 {
            return Err(SgwtError::NoFrame(low));
        }
        Ok(Self { n, kernels, spectrum, vectors, bounds: (low, high) })
    }

    fn vector(&self, k: usize) -> &[f64] {
        &self.vectors[k * self.n..][..self.n]
    }

    fn spectral(&self, x: &[f64]) -> Vec<f64> {
        (0..self.n).map(|k| self.vector(k).iter().zip(x).map(|(u, x)| u * x).sum()).collect()
    }

    fn spatial(&self, hat: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.n];
        for (k, h) in hat.iter().enumerate() {
            x.iter_mut().zip(self.vector(k)).for_each(|(x, u)| *x += h * u);
        }
        x
    }

    /// Computes `c_i = g_i(L) f`, one list per kernel. O(n²) each.
    ///
    /// # Errors
    /// [`SgwtError::Length`].
    pub fn analyze(&self, signal: &[f64]) -> Result<Vec<Vec<f64>>, SgwtError> {
        check(self.n, signal.len())?;
        let hat = self.spectral(signal);
        Ok((0..self.kernels.len())
            .map(|i| {
                let scaled: Vec<f64> =
                    hat.iter().zip(&self.spectrum).map(|(h, &l)| h * self.kernels.value(i, l)).collect();
                self.spatial(&scaled)
            })
            .collect())
    }

    /// Reconstructs the signal whose coefficients are nearest to the given ones.
    ///
    /// # Errors
    /// [`SgwtError::Length`].
    pub fn inverse(&self, coefficients: &[Vec<f64>]) -> Result<Vec<f64>, SgwtError> {
        check(self.kernels.len(), coefficients.len())?;
        let mut hat = vec![0.0; self.n];
        for (i, c) in coefficients.iter().enumerate() {
            check(self.n, c.len())?;
            for ((h, s), &l) in hat.iter_mut().zip(self.spectral(c)).zip(&self.spectrum) {
                *h += s * self.kernels.value(i, l);
            }
        }
        for (h, &l) in hat.iter_mut().zip(&self.spectrum) {
            *h /= (0..self.kernels.len()).map(|i| self.kernels.value(i, l).powi(2)).sum::<f64>();
        }
        Ok(self.spatial(&hat))
    }
}
