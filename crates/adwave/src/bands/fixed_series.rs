//! Polynomials of Φ₁ whose degree does not depend on the signal, so that part of a shape has the same bands as the
//! whole.

use super::chebyshev::{PassPlan, Polynomials};
use super::error::{check_buffer, check_signal};
use super::series::{Growth, Series, TruncationBound};
use super::transform::whole_steps_from_zero;
use super::{BandsError, BandsParams, Precision, Schedule, Transform};
use crate::Progress;
use crate::operator::RowOutput;
use crate::sparse::SignalView;

/// A band, or a weighted sum of bands, as a polynomial of Φ₁ whose degree depends on the levels and the accuracy
/// only.
///
/// [`Transform::wavelets_into`] truncates each series as soon as the norm of the band of this signal allows it.
/// Here the truncation is the same for all signals: the value at a vertex depends on the values within
/// [`reach`](Self::reach) rings around it and on no global quantity. The truncation error is at most
/// `accuracy·n^(−3/2)` of the largest value of the polynomial, n being the number of steps of the band. That is
/// about `accuracy` of the band for white noise on a surface, and less for smoother signals.
///
/// ```
/// use adwave::bands::{FixedSeries, Schedule};
/// let bands = FixedSeries::bands(&Schedule::dyadic(8)?, 1e-6)?;
/// assert_eq!(bands.iter().map(FixedSeries::reach).collect::<Vec<_>>(), [1, 2, 4, 8, 14, 22, 32, 47]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedSeries(Series);

impl FixedSeries {
    /// The series of all bands of `schedule`.
    ///
    /// # Errors
    /// [`BandsError`] if the accuracy is out of range or a level has a fractional number of steps.
    pub fn bands(schedule: &Schedule, accuracy: f64) -> Result<Vec<Self>, BandsError> {
        BandsParams::default().with_accuracy(accuracy).check()?;
        let steps = whole_steps_from_zero(schedule)?;
        let band = |pair: &[u64]| {
            let mut series = Series::band(pair[0], pair[1], Growth::Bounded);
            let budget = accuracy * series.total * (pair[1] as f64).powf(-1.5);
            series.coefficients.truncate(series.degree_within(budget, 0) + 1);
            Self::from_coefficients(series.coefficients)
        };
        Ok(steps.windows(2).map(band).collect())
    }

    /// The combination `Σ_j factors[j]·bands[j]`. Bands with factor 0 do not count towards the reach.
    ///
    /// # Panics
    /// Unless there is one factor per band.
    #[must_use]
    pub fn weighted(bands: &[Self], factors: &[f64]) -> Self {
        assert_eq!(bands.len(), factors.len(), "a factor for each band");
        let wanted = bands.iter().zip(factors).filter(|(_, factor)| **factor != 0.0);
        let (bands, factors): (Vec<Series>, Vec<f64>) = wanted.map(|(band, f)| (band.0.clone(), *f)).unzip();
        Self::from_coefficients(Series::combination(&bands, &factors, Growth::Bounded).coefficients)
    }

    /// The polynomial `Σ_k coefficients[k]·T_k(2Φ₁ − I)` of one's own, which is applied to `(I − Φ₁)f`.
    ///
    /// # Panics
    /// Without coefficients, or if one is not finite.
    #[must_use]
    pub fn polynomial(coefficients: Vec<f64>) -> Self {
        assert!(
            !coefficients.is_empty() && coefficients.iter().all(|a| a.is_finite()),
            "finite coefficients"
        );
        Self::from_coefficients(coefficients)
    }

    /// Number of rings around a vertex that its value depends on.
    pub fn reach(&self) -> usize {
        self.0.degree() + 1
    }

    /// Wraps coefficients without a tail, so that they are never truncated.
    fn from_coefficients(coefficients: Vec<f64>) -> Self {
        let tail = Vec::new();
        Self(Series { coefficients, tail, total: 0.0, rest: TruncationBound::default() }.without_tail())
    }
}

impl Transform {
    /// Computes `series[i](Φ₁)·(I − Φ₁)·signal` into `outs[i]`, each n_vertices × n_channels, row-major.
    ///
    /// The bits of a row depend only on the entries within [`FixedSeries::reach`] rings, provided these have the
    /// same order.
    ///
    /// # Errors
    /// [`BandsError`] if the signal or an output has the wrong length, a value is not finite, or the call is
    /// cancelled.
    pub fn apply_fixed_series_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        series: &[FixedSeries],
        outs: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<(), BandsError> {
        check_signal(signal, self.operator().n_rows(), n_channels)?;
        let len = outs.iter().map(|out| out.len()).sum();
        check_buffer(len, series.len() * signal.len())?;
        let series: Vec<Series> = series.iter().map(|s| s.0.clone()).collect();
        let passes = &mut PassPlan::default();
        let polynomials = Polynomials {
            series: &series,
            guard: &[],
            passes,
            output: RowOutput::Channels,
            precision: Precision::Double,
        };
        let prepared = self.evaluator(progress)?;
        prepared.evaluate(SignalView { values: signal, n_channels }, polynomials, 1.0, outs, progress)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::Diffusion;

    /// A path graph whose walk stays or moves to either side.
    fn path(n: usize) -> Diffusion {
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for x in 0..n as u32 {
            let sides: Vec<u32> =
                [x.wrapping_sub(1), x + 1].into_iter().filter(|y| (*y as usize) < n).collect();
            for &y in &sides {
                rows.push(x);
                columns.push(y);
                values.push(0.5 / sides.len() as f64);
            }
            rows.push(x);
            columns.push(x);
            values.push(0.5);
        }
        Diffusion::from_columns(n, &rows, &columns, &values).unwrap()
    }

    fn fixed(diffusion: Diffusion, signal: &[f64], series: &[FixedSeries]) -> Vec<Vec<f64>> {
        let transform = Transform::new(diffusion, &BandsParams::default()).unwrap();
        let mut outs = vec![vec![0.0; signal.len()]; series.len()];
        let mut slices: Vec<&mut [f64]> = outs.iter_mut().map(|out| &mut out[..]).collect();
        transform.apply_fixed_series_into(signal, 1, series, &mut slices, Progress::none()).unwrap();
        outs
    }

    #[test]
    fn a_part_with_rings_around_it_has_the_bits_of_the_whole_and_the_values_of_the_exact_bands() {
        let noise = |x: usize| f64::from((x as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
        let n = 6000;
        let signal: Vec<f64> = (0..n).map(noise).collect();
        let schedule = Schedule::dyadic(8).unwrap();
        let mut series = FixedSeries::bands(&schedule, 1e-6).unwrap();
        series.push(FixedSeries::weighted(&series, &[0.0, 0.5, -1.0, 0.0, 2.0, 1.0, 0.0, 0.0]));
        assert_eq!(series[8].reach(), series[5].reach());
        let whole = fixed(path(n), &signal, &series);
        let reach = series.iter().map(FixedSeries::reach).max().unwrap();
        let (first, last) = (2000, 2600);
        let part = first - reach..last + reach;
        let of_part = fixed(path(part.len()), &signal[part], &series);
        for (whole, part) in whole.iter().zip(&of_part) {
            assert_eq!(whole[first..last], part[reach..][..last - first]);
        }
        let transform = Transform::new(path(n), &BandsParams::default()).unwrap();
        let mut exact = vec![vec![0.0; n]; 8];
        let mut slices: Vec<&mut [f64]> = exact.iter_mut().map(|out| &mut out[..]).collect();
        transform.wavelets_into(&signal, 1, &schedule, &mut slices, Progress::none()).unwrap();
        for (exact, found) in exact.iter().zip(&whole) {
            let norm = exact.iter().map(|v| v * v).sum::<f64>().sqrt();
            let off = exact.iter().zip(found).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            assert!(off <= 1e-6 * norm, "{off:e} of {norm:e}");
        }
    }
}
