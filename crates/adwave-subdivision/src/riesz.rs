//! Measurement of the stability of a wavelet basis.

use crate::{LiftedWavelets, SubdivisionError};
use adwave::Progress;

/// Largest number of vertices, for which two dense matrices take 128 MB each.
const MAX_VERTICES: usize = 4096;

/// Relative change of a bound at which the power iteration ends.
const ACCURACY: f64 = 1e-9;

/// Largest number of steps of the power iteration.
const MAX_STEPS: usize = 5000;

/// Bounds of a Riesz basis: `lower·Σ c_i² ≤ ‖Σ c_i ψ_i/‖ψ_i‖‖² ≤ upper·Σ c_i²`, in the norm Σ m·f².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RieszBounds {
    /// Largest lower bound.
    pub lower: f64,
    /// Smallest upper bound.
    pub upper: f64,
}

impl RieszBounds {
    /// Condition of the basis, `upper/lower`; 1 for an orthogonal basis.
    pub fn condition(&self) -> f64 {
        self.upper / self.lower
    }
}

impl LiftedWavelets {
    /// Computes the Riesz bounds of the wavelets and the coarsest scaling functions, by power iteration with dense
    /// matrices. O(n²) memory.
    ///
    /// # Errors
    /// [`SubdivisionError::WrongNumber`] for more than 4096 vertices, and on cancellation.
    pub fn riesz_bounds(&self, progress: Progress<'_>) -> Result<RieszBounds, SubdivisionError> {
        let n = self.n_vertices();
        if n > MAX_VERTICES {
            let what = "vertices or fewer, for dense matrices,";
            return Err(SubdivisionError::WrongNumber { what, n_given: n, expected: MAX_VERTICES });
        }
        let roots: Vec<f64> = self.masses().iter().map(|m| m.sqrt()).collect();
        // Columns of M^½·S·N⁻¹ and of its inverse N·A·M^−½, with N the norms of the columns of M^½·S.
        let (mut synthesis, mut analysis) = (vec![0.0; n * n], vec![0.0; n * n]);
        let mut norms = vec![0.0; n];
        let mut unit = vec![0.0; n];
        for i in 0..n {
            progress.check()?;
            unit[i] = 1.0;
            let function = self.synthesize(&unit, 1, progress)?;
            let coefficients = self.analyze(&unit, 1, progress)?.values;
            unit[i] = 0.0;
            let column = &mut synthesis[i * n..(i + 1) * n];
            for (entry, (value, root)) in column.iter_mut().zip(function.iter().zip(&roots)) {
                *entry = value * root;
            }
            norms[i] = column.iter().map(|x| x * x).sum::<f64>().sqrt();
            for entry in column {
                *entry /= norms[i];
            }
            for (entry, value) in analysis[i * n..(i + 1) * n].iter_mut().zip(coefficients) {
                *entry = value / roots[i];
            }
        }
        for column in analysis.chunks_exact_mut(n) {
            column.iter_mut().zip(&norms).for_each(|(entry, norm)| *entry *= norm);
        }
        let upper = greatest_square(&synthesis, n, progress)?;
        let lower = 1.0 / greatest_square(&analysis, n, progress)?;
        Ok(RieszBounds { lower, upper })
    }
}

/// Square of the largest singular value of a matrix given by its columns.
fn greatest_square(columns: &[f64], n: usize, progress: Progress<'_>) -> Result<f64, SubdivisionError> {
    // A start that is orthogonal to no vector of a symmetric shape.
    let mut x: Vec<f64> = (0..n).map(|i| 1.0 + 0.5 * (1.7 * i as f64).sin()).collect();
    let mut last = 0.0;
    for _ in 0..MAX_STEPS {
        progress.check()?;
        let length = x.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut product = vec![0.0; n];
        for (column, v) in columns.chunks_exact(n).zip(&x) {
            product.iter_mut().zip(column).for_each(|(p, c)| *p += c * v / length);
        }
        x = columns
            .chunks_exact(n)
            .map(|column| column.iter().zip(&product).map(|(c, p)| c * p).sum())
            .collect();
        let square: f64 = product.iter().map(|p| p * p).sum();
        if (square - last).abs() <= ACCURACY * square {
            return Ok(square);
        }
        last = square;
    }
    Ok(last)
}
