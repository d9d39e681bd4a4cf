//! Functions of the Laplacian: filters and filter banks that are given by their gain at each eigenvalue, such as those
//! of `hammond2011`, `leonardi2013` and `perraudin2014`.

use super::Decomposer;
use crate::bands::{BandsError, FixedSeries, check_signal};
use crate::operator::Semigroup;
use crate::{Progress, parallel};

/// A function of the Laplacian as a polynomial: `g(L)f = g(0)·f + q(Φ₁)(I − Φ₁)f`.
///
/// With `y = 2φ − 1` for the eigenvalues φ of Φ₁ and `λ = s·(1 − φ)` ([`Decomposer::spectral_range`]),
/// `q = (g(λ) − g(0))/(1 − φ)`, so that constants are multiplied by g(0) exactly.
#[derive(Clone, Debug)]
pub struct SpectralSeries {
    /// The gain g(0) of constants.
    pub at_zero: f64,
    /// The gain at the largest eigenvalue, for what differs between vertices at one position.
    pub at_most: f64,
    /// The polynomial q, from its coefficients in `T_k(y)` ([`FixedSeries::polynomial`]).
    pub series: FixedSeries,
}

impl Decomposer {
    /// Largest λ that the Laplacian can have: 2 for a walk, where `L = 2(I − Φ₁) = I − Q` is its normalized
    /// Laplacian, which is similar to the symmetric one, `I − D^(−½)WD^(−½)`. For heat, `L = −Δ` in one over the square
    /// of the unit of lengths.
    pub fn spectral_range(&self) -> f64 {
        match self.operator().semigroup() {
            // The mean square of a step in both directions of the surface is four times the time of heat.
            Semigroup::Heat { rate, .. } => 4.0 * rate / self.operator().step_length().powi(2),
            _ => 2.0,
        }
    }

    /// Applies functions of the Laplacian to a signal (n_vertices × n_channels); the results lie one after the other.
    /// Costs the products of the greatest degree.
    ///
    /// # Errors
    /// [`BandsError`] if the signal has the wrong length or a value that is not finite, the walk is not reversible, or
    /// the call is cancelled.
    ///
    /// ```
    /// use adwave::bands::FixedSeries;
    /// use adwave::SpectralSeries;
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::{Decomposer, Progress};
    /// // On two nodes λ is 0 or 2. The gain 1 − λ/2 = 1 − 2(1 − φ)/2 has q = −1.
    /// let pair = Decomposer::new(&Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?));
    /// let mean = SpectralSeries { at_zero: 1.0, at_most: 0.0, series: FixedSeries::polynomial(vec![-1.0]) };
    /// let found = pair.apply_spectral(&[1.0, 3.0], 1, &[mean], Progress::none())?;
    /// assert!((found[0] - 2.0).abs() < 1e-15 && (found[1] - 2.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn apply_spectral(
        &self,
        signal: &[f64],
        n_channels: usize,
        functions: &[SpectralSeries],
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, BandsError> {
        check_signal(signal, self.n_vertices(), n_channels)?;
        if !self.operator().is_reversible() {
            return Err(BandsError::NotReversible);
        }
        let map = self.vertex_map();
        let mean = map.mean(signal, n_channels);
        let series: Vec<FixedSeries> = functions.iter().map(|function| function.series.clone()).collect();
        let mut found = vec![vec![0.0; mean.len()]; series.len()];
        let mut outs: Vec<&mut [f64]> = found.iter_mut().map(Vec::as_mut_slice).collect();
        self.transform().apply_fixed_series_into(&mean, n_channels, &series, &mut outs, progress)?;
        let mean_at = map.scatter(&mean, n_channels);
        let mut result = Vec::with_capacity(functions.len() * signal.len());
        for (SpectralSeries { at_zero, at_most, .. }, found) in functions.iter().zip(found) {
            let mut sum = map.scatter(&found, n_channels);
            parallel::visit_rows(&mut sum, 1, 1 << 12, |first, rows| {
                let given = signal[first..].iter().zip(&mean_at[first..]);
                for (sum, (f, mean)) in rows.iter_mut().zip(given) {
                    *sum += at_zero * mean + at_most * (f - mean);
                }
            });
            result.extend(sum);
        }
        Ok(result)
    }
}
