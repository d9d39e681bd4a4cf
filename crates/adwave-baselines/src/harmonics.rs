//! Manifold harmonics: eigenfunctions of the Laplacian, and filtering in that basis.
//!
//! Source: `vallet2008`.
//!
//! ```text
//! S φ_k = λ_k M φ_k,   Φᵀ M Φ = I,   f̂_k = ⟨f, φ_k⟩_M,   f ≈ Σ_k f̂_k φ_k
//! ```
//! Strengths: a frequency response is exact and can be arbitrarily sharp, and a few coefficients represent a smooth
//! shape. Weaknesses: time and memory grow with the number of frequencies, and no function is local.

use crate::laplacian::LaplacianMatrices;
use crate::linalg::{EigenInfo, EigenParams, LinalgError, smallest_eigenpairs};
use adwave::Progress;
use adwave::shape::VertexMap;
use rayon::prelude::*;
use thiserror::Error;

/// Reason for which harmonics cannot be computed or applied.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum HarmonicsError {
    /// The eigenpairs could not be computed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A signal or a list of coefficients has the wrong length.
    #[error("expected {expected} values for {n_channels} channels, got {got}")]
    Length {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
        /// Number of channels.
        n_channels: usize,
    },
}

/// Treatment of the part of a signal above the last frequency.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remainder {
    /// Scales the part by the gain of the last frequency, as `vallet2008` does.
    #[default]
    LastGain,
    /// Keeps the part unchanged.
    Keep,
    /// Removes the part.
    Drop,
}

/// First eigenfunctions of a shape.
#[derive(Clone, Debug)]
pub struct Harmonics {
    /// Eigenvalues λ_k in ascending order, in 1 / squared model units; one eigenvalue is 0 for each component.
    pub values: Vec<f64>,
    /// Eigenfunctions φ_k, one after another, in the order of the Laplacian's rows; 0 at vertices without mass.
    pub functions: Vec<f64>,
    /// Diagonal of the mass matrix M.
    pub mass: Vec<f64>,
    /// Cost and accuracy of the eigenpairs.
    pub info: EigenInfo,
    vertex_map: VertexMap,
}

impl Harmonics {
    /// Computes the first `k` harmonics, or all of them if there are fewer. Cost: see [`smallest_eigenpairs`].
    ///
    /// Vertices without mass do not belong to the surface: harmonics are 0 there, and filters leave their values
    /// unchanged.
    ///
    /// # Errors
    /// [`HarmonicsError::Linalg`].
    ///
    /// ```
    /// use adwave::{Progress, shape::{Graph, Shape}};
    /// use adwave_baselines::harmonics::Harmonics;
    /// use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
    /// let edge = Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?);
    /// let laplacian = LaplacianMatrices::new(&edge, &LaplacianParams::default())?;
    /// let harmonics = Harmonics::new(&laplacian, 5, &Default::default(), Progress::none())?;
    /// assert!(harmonics.values[0] == 0.0 && (harmonics.values[1] - 2.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        laplacian: &LaplacianMatrices,
        k: usize,
        params: &EigenParams,
        progress: Progress<'_>,
    ) -> Result<Self, HarmonicsError> {
        let n = laplacian.n();
        let kept: Vec<u32> = (0..n as u32).filter(|&x| laplacian.mass[x as usize] > 0.0).collect();
        // In units of the mean mass the standard problem is well scaled in any model unit.
        let unit = kept.iter().map(|&x| laplacian.mass[x as usize]).sum::<f64>() / kept.len().max(1) as f64;
        let root: Vec<f64> = kept.iter().map(|&x| (laplacian.mass[x as usize] / unit).sqrt()).collect();
        let inverse: Vec<f64> = root.iter().map(|r| 1.0 / r).collect();
        let standard = laplacian.stiffness.submatrix(&kept).scale_symmetrically(&inverse);
        let pairs = smallest_eigenpairs(&standard, Some(&root), k, params, progress)?;
        let mut functions = vec![0.0; n * pairs.values.len()];
        let scale: Vec<f64> = inverse.iter().map(|r| r / unit.sqrt()).collect();
        functions.par_chunks_exact_mut(n.max(1)).enumerate().for_each(|(i, function)| {
            for ((&x, &value), &s) in kept.iter().zip(pairs.vector(i)).zip(&scale) {
                function[x as usize] = value * s;
            }
        });
        Ok(Self {
            values: pairs.values.iter().map(|v| v / unit).collect(),
            functions,
            mass: laplacian.mass.clone(),
            info: pairs.info,
            vertex_map: laplacian.vertex_map.clone(),
        })
    }

    /// Number of harmonics.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True if there are no harmonics.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Returns the eigenfunction φ_k in the order of the Laplacian's rows.
    pub fn function(&self, k: usize) -> &[f64] {
        &self.functions[k * self.mass.len()..][..self.mass.len()]
    }

    /// Maps values in the order of the Laplacian's rows to the vertices of the shape.
    pub fn scatter(&self, values: &[f64], n_channels: usize) -> Vec<f64> {
        self.vertex_map.scatter(values, n_channels)
    }

    /// Computes the coefficients `f̂ = Φᵀ M f`, harmonics × channels, of a signal in the order of the shape, n_vertices
    /// × n_channels. O(n·k).
    ///
    /// # Errors
    /// [`HarmonicsError::Length`].
    pub fn transform(&self, signal: &[f64], n_channels: usize) -> Result<Vec<f64>, HarmonicsError> {
        check(signal.len(), self.vertex_map.n_vertices(), n_channels)?;
        Ok(self.coefficients(&self.vertex_map.mean(signal, n_channels), n_channels))
    }

    fn coefficients(&self, mean: &[f64], n_channels: usize) -> Vec<f64> {
        let n = self.mass.len();
        let rows = self.functions.par_chunks_exact(n.max(1)).map(|function| {
            let mut sums = vec![0.0; n_channels];
            for ((&phi, &m), f) in function.iter().zip(&self.mass).zip(mean.chunks_exact(n_channels)) {
                for (sum, f) in sums.iter_mut().zip(f) {
                    *sum += phi * m * f;
                }
            }
            sums
        });
        rows.collect::<Vec<_>>().concat()
    }

    /// Computes `Σ_k f̂_k φ_k` in the order of the shape, n_vertices × n_channels. O(n·k).
    ///
    /// # Errors
    /// [`HarmonicsError::Length`].
    pub fn inverse(&self, coefficients: &[f64], n_channels: usize) -> Result<Vec<f64>, HarmonicsError> {
        check(coefficients.len(), self.len(), n_channels)?;
        Ok(self.vertex_map.scatter(&self.sum(coefficients, n_channels), n_channels))
    }

    fn sum(&self, coefficients: &[f64], n_channels: usize) -> Vec<f64> {
        const VERTICES: usize = 1024;
        let n = self.mass.len();
        let mut out = vec![0.0; n * n_channels];
        out.par_chunks_mut(VERTICES * n_channels).enumerate().for_each(|(piece, out)| {
            for (k, c) in coefficients.chunks_exact(n_channels).enumerate() {
                let function = &self.functions[k * n + piece * VERTICES..];
                for (out, phi) in out.chunks_exact_mut(n_channels).zip(function) {
                    for (out, c) in out.iter_mut().zip(c) {
                        *out += c * phi;
                    }
                }
            }
        });
        out
    }

    /// Scales each frequency `ω_k = √λ_k` (in 1 / model units) of the signal by `gain(ω_k)`; the result is in the order
    /// of the shape. O(n·k).
    ///
    /// # Errors
    /// [`HarmonicsError::Length`].
    pub fn filter(
        &self,
        signal: &[f64],
        n_channels: usize,
        gain: impl Fn(f64) -> f64,
        remainder: Remainder,
    ) -> Result<Vec<f64>, HarmonicsError> {
        check(signal.len(), self.vertex_map.n_vertices(), n_channels)?;
        let mean = self.vertex_map.mean(signal, n_channels);
        let mut coefficients = self.coefficients(&mean, n_channels);
        let frequency = |k: usize| self.values[k].max(0.0).sqrt();
        let rest = match remainder {
            Remainder::LastGain if !self.is_empty() => gain(frequency(self.len() - 1)),
            Remainder::LastGain | Remainder::Keep => 1.0,
            Remainder::Drop => 0.0,
        };
        for (k, c) in coefficients.chunks_exact_mut(n_channels.max(1)).enumerate() {
            let factor = gain(frequency(k)) - rest;
            for c in c.iter_mut() {
                *c *= factor;
            }
        }
        let mut out = self.sum(&coefficients, n_channels);
        for (x, (out, f)) in
            out.chunks_exact_mut(n_channels.max(1)).zip(mean.chunks_exact(n_channels.max(1))).enumerate()
        {
            let kept = if self.mass[x] > 0.0 { rest } else { 1.0 };
            for (out, f) in out.iter_mut().zip(f) {
                *out += kept * f;
            }
        }
        Ok(self.vertex_map.scatter(&out, n_channels))
    }
}

fn check(got: usize, rows: usize, n_channels: usize) -> Result<(), HarmonicsError> {
    let expected = rows * n_channels;
    if got != expected || n_channels == 0 {
        return Err(HarmonicsError::Length { expected, got, n_channels });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
