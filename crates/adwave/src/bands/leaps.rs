//! Bands by an operator that takes any number of steps at once ([`Leap`]).
//!
//! `S_f(j)` is one leap of n_j − n_{j−1} steps from `S_f(j−1)`, and `W_f(j) = S_f(j−1) − S_f(j)` (eq. 11). The operator
//! bounds the error of each leap relative to its input, whose norm no later leap increases. A constant part does not
//! change, so the signal is taken without its mean. If the error bound of a band is too large for its norm, all leaps
//! are repeated with a finer accuracy. A fine band of a smooth signal is a small difference of large values, whose
//! rounding alone may be too large; then the caller takes the series, which start from `(I − Φ₁)f`.

use super::chebyshev::EvaluationInfo;
use super::transform::add;
use super::{BandsError, FINEST_ACCURACY, Schedule, Transform};
use crate::operator::{Invariant, Leap, RowWeights};
use crate::pages::zeros;
use crate::{Progress, parallel};

/// Accuracy of a leap relative to the requested accuracy of the bands, or to what a band that missed it needs.
const MARGIN: f64 = 0.1;

/// Most times that all leaps are taken, each time with the accuracy that the one before shows to be needed.
const MOST_ATTEMPTS: usize = 4;

/// Rounding of a difference of two signals relative to the larger one.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Transform {
    /// Calls `each(level, W_f(level))` for each level, counted from 0, and again with finer leaps until every band
    /// keeps to the accuracy.
    pub(super) fn leap_bands(
        &self,
        leap: &dyn Leap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
        mut each: impl FnMut(usize, &[f64]),
    ) -> Result<EvaluationInfo, BandsError> {
        let operator = self.operator();
        let (n, weights, accuracy) = (operator.n_rows(), operator.weights(), self.params().accuracy);
        let centered = || match operator.invariant() {
            Invariant::Constants => without_mean(signal, n_channels, n, weights),
            Invariant::Nothing => signal.to_vec(),
        };
        let norm = |values: &[f64]| {
            let square = |row: &[f64]| row.iter().map(|v| v * v).sum::<f64>();
            match weights {
                RowWeights::Uniform => (sum_of_squares(values) / n as f64).sqrt(),
                RowWeights::Each(weights) => {
                    parallel::sum(n, |x| weights[x] * square(&values[x * n_channels..][..n_channels])).sqrt()
                }
            }
        };
        let steps = schedule.steps_from_zero();
        let mut missed: Option<(usize, f64)> = None;
        let mut asked = (MARGIN * accuracy).max(FINEST_ACCURACY);
        for _ in 0..MOST_ATTEMPTS {
            let (mut now, mut next, mut error, mut worst) = (centered(), zeros(signal.len()), 0.0, 0.0_f64);
            let before_that = missed.take();
            let (mut n_leaps, mut largest_bound) = (0, 0.0_f64);
            for (level, pair) in steps.windows(2).enumerate() {
                progress.step(level as u64, schedule.n_levels() as u64)?;
                let (size, before) = (norm(&now), error);
                let bound =
                    leap.take_steps(pair[1] - pair[0], &now, n_channels, asked, &mut next, progress.quiet())?;
                n_leaps += 1;
                largest_bound = largest_bound.max(bound);
                error = before + bound * size;
                parallel::visit_rows(&mut now, 1, super::bands::VERTICES_AT_A_TIME, |first, rows| {
                    rows.iter_mut().zip(&next[first..]).for_each(|(now, next)| *now -= next);
                });
                let band = norm(&now);
                let off = before + error + ROUNDING * size;
                let relative = if off > 0.0 && band > 0.0 { off / band } else { 0.0 };
                if relative > accuracy {
                    missed.get_or_insert((level + 1, relative));
                }
                worst = worst.max(relative);
                each(level, &now);
                std::mem::swap(&mut now, &mut next);
            }
            if missed.is_none() {
                let info = EvaluationInfo { products: n_leaps, terms: n_leaps, ..EvaluationInfo::default() };
                return Ok(EvaluationInfo { error_bound: worst, ..info });
            }
            // Leaps that are as accurate as they can be.
            if asked <= FINEST_ACCURACY || missed == before_that {
                break;
            }
            // What the leaps reached, not what was asked: they may be far more accurate.
            asked = (MARGIN * largest_bound * accuracy / worst).clamp(FINEST_ACCURACY, asked);
        }
        let (level, reached) = missed.expect("a band missed the accuracy");
        Err(BandsError::Missed { level, accuracy, reached })
    }

    /// Bands of all levels by leaps.
    pub(super) fn wavelets_by_leaps(
        &self,
        leap: &dyn Leap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        wavelets: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        self.leap_bands(leap, signal, n_channels, schedule, progress, |level, band| {
            wavelets[level].copy_from_slice(band);
        })
    }

    /// `Σ_j factors[j−1]·W_f(j)` by leaps.
    pub(super) fn weighted_by_leaps(
        &self,
        leap: &dyn Leap,
        signal: &[f64],
        n_channels: usize,
        weights: super::transform::LevelFactors<'_>,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        let super::transform::LevelFactors { schedule, factors } = weights;
        self.leap_bands(leap, signal, n_channels, schedule, progress, |level, band| {
            if level == 0 {
                out.fill(0.0); // a repetition begins again
            }
            add(factors[level], band, out, n_channels);
        })
    }
}

/// The signal less the weighted mean of each channel.
fn without_mean(signal: &[f64], n_channels: usize, n: usize, weights: RowWeights<'_>) -> Vec<f64> {
    let total = parallel::sum(n, |x| weights.weight(x, n));
    let means: Vec<f64> = (0..n_channels)
        .map(|c| parallel::sum(n, |x| weights.weight(x, n) * signal[x * n_channels + c]) / total)
        .collect();
    let mut centered: Vec<f64> = zeros(signal.len());
    parallel::visit_rows(&mut centered, n_channels, super::bands::VERTICES_AT_A_TIME, |first, rows| {
        let given = signal[first * n_channels..].chunks_exact(n_channels);
        for (row, given) in rows.chunks_exact_mut(n_channels).zip(given) {
            for ((centered, value), mean) in row.iter_mut().zip(given).zip(&means) {
                *centered = value - mean;
            }
        }
    });
    centered
}

/// Sum of squares, of several values at once.
fn sum_of_squares(values: &[f64]) -> f64 {
    const TOGETHER: usize = 8;
    const AT_A_TIME: usize = 1 << 13;
    let chunk = |range: std::ops::Range<usize>| {
        let (whole, rest) = values[range].as_chunks::<TOGETHER>();
        let mut sums = [0.0; TOGETHER];
        for values in whole {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value * value;
            }
        }
        sums.iter().sum::<f64>() + rest.iter().map(|v| v * v).sum::<f64>()
    };
    parallel::map_chunks(values.len(), AT_A_TIME, chunk).into_iter().sum()
}
