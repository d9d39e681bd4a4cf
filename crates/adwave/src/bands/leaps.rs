//! Bands by an operator that takes any number of steps at once ([`Leap`]).
//!
//! `S_f(j)` is one leap of n_j − n_{j−1} steps from `S_f(j−1)`, and `W_f(j) = S_f(j−1) − S_f(j)` (eq. 11). The operator
//! bounds the error of each leap relative to its input, whose norm no later leap increases. A constant part does not
//! change, so the signal is taken without its mean. If the error bound of a band is too large for its norm, all leaps
//! are repeated with a finer accuracy. A fine band of a smooth signal is a small difference of large values, whose
//! rounding alone may be too large; then the caller takes the series, which start from `(I − Φ₁)f`.

use super::chebyshev::EvaluationInfo;
use super::{BandsError, FINEST_ACCURACY, Schedule, Transform};
use crate::operator::{Invariant, Leap, RowWeights};
use crate::pages::zeros;
use crate::sparse::SignalView;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Accuracy of a leap relative to the requested accuracy of the bands, or to what a band that missed it needs.
const MARGIN: f64 = 0.1;

/// Most times that all leaps are taken, each time with the accuracy that the one before shows to be needed.
const MOST_ATTEMPTS: usize = 4;

/// Rounding of a difference of two signals relative to the larger one.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Transform {
    /// Leaps from level to level, and again with finer leaps until every band keeps to the accuracy. S_f(j), counted from 0,
    /// is in the vector j modulo their number. `each(level, S_f(j − 1), S_f(j))` returns the norms of the band and of
    /// S_f(j), or ends the leaps, and may change S_f(j − 1).
    fn leap_bands(
        &self,
        leap: &dyn Leap,
        signal: SignalView<'_>,
        schedule: &Schedule,
        vectors: &mut [&mut [f64]],
        progress: Progress<'_>,
        mut each: impl FnMut(usize, &mut [f64], &[f64]) -> Result<[f64; 2], Cancelled>,
    ) -> Result<EvaluationInfo, BandsError> {
        let (operator, accuracy) = (self.operator(), self.params().accuracy);
        let n_channels = signal.n_channels;
        let measure = RowNorm { n_channels, weights: operator.weights() };
        let steps = schedule.steps_from_zero();
        let mut missed: Option<(usize, f64)> = None;
        let mut asked = (MARGIN * accuracy).max(FINEST_ACCURACY);
        for _ in 0..MOST_ATTEMPTS {
            let (mut error, mut worst) = (0.0, 0.0_f64);
            let before_that = missed.take();
            let (mut n_leaps, mut largest_bound) = (0, 0.0_f64);
            let means = match operator.invariant() {
                Invariant::Constants => measure.means(signal.values),
                Invariant::Nothing => vec![0.0; n_channels],
            };
            let mut size = measure.subtract(signal.values, &means, vectors[0]);
            for (level, pair) in steps.windows(2).enumerate() {
                progress.step(level as u64, schedule.n_levels() as u64)?;
                let [now, next] = [level, level + 1].map(|j| j % vectors.len());
                let [now, next] = vectors.get_disjoint_mut([now, next]).expect("two vectors or more");
                let before = error;
                let bound =
                    leap.take_steps(pair[1] - pair[0], now, n_channels, asked, next, progress.quiet())?;
                n_leaps += 1;
                largest_bound = largest_bound.max(bound);
                error = before + bound * size;
                let [band, coarser] = each(level, now, next)?;
                let off = before + error + ROUNDING * size;
                let relative = if off > 0.0 && band > 0.0 { off / band } else { 0.0 };
                if relative > accuracy {
                    missed.get_or_insert((level + 1, relative));
                }
                worst = worst.max(relative);
                size = coarser;
            }
            if missed.is_none() {
                let info = EvaluationInfo { products: n_leaps, terms: n_leaps, ..EvaluationInfo::default() };
                return Ok(EvaluationInfo { error_bound: worst, ..info });
            }
            // Leaps that are as accurate as they can be.
            if asked.min(largest_bound) <= FINEST_ACCURACY || missed == before_that {
                break;
            }
            // What the leaps reached, not what was asked: they may be far more accurate.
            asked = (MARGIN * largest_bound * accuracy / worst).clamp(FINEST_ACCURACY, asked);
        }
        let (level, reached) = missed.expect("a band missed the accuracy");
        Err(BandsError::Missed { level, accuracy, reached })
    }

    /// Bands of all levels by leaps, which go through the vectors of the bands and one more, `spare` if it is given.
    pub(super) fn wavelets_by_leaps(
        &self,
        leap: &dyn Leap,
        signal: SignalView<'_>,
        schedule: &Schedule,
        wavelets: &mut [&mut [f64]],
        spare: Option<&mut [f64]>,
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        let measure = RowNorm { n_channels: signal.n_channels, weights: self.operator().weights() };
        let mut own = Vec::new();
        let last = spare.unwrap_or_else(|| {
            own = zeros(signal.values.len());
            &mut own
        });
        let mut vectors: Vec<&mut [f64]> = wavelets.iter_mut().map(|wavelet| &mut **wavelet).collect();
        vectors.push(last);
        self.leap_bands(leap, signal, schedule, &mut vectors, progress, |_, finer, coarser| {
            Ok(measure.subtract_coarser(finer, coarser))
        })
    }

    /// Calls `visit(level, W_f(j))` with the bands of all levels, counted from 0, which share two vectors. If the leaps are
    /// repeated, they come again from the first one.
    pub(super) fn visit_bands_by_leaps(
        &self,
        leap: &dyn Leap,
        signal: SignalView<'_>,
        schedule: &Schedule,
        progress: Progress<'_>,
        mut visit: impl FnMut(usize, &mut [f64]) -> Result<(), Cancelled>,
    ) -> Result<EvaluationInfo, BandsError> {
        let measure = RowNorm { n_channels: signal.n_channels, weights: self.operator().weights() };
        let (mut now, mut next) = (zeros(signal.values.len()), zeros(signal.values.len()));
        let vectors: &mut [&mut [f64]] = &mut [&mut now, &mut next];
        self.leap_bands(leap, signal, schedule, vectors, progress, |level, finer, coarser| {
            let norms = measure.subtract_coarser(finer, coarser);
            visit(level, finer)?;
            Ok(norms)
        })
    }

    /// `Σ_j factors[j−1]·W_f(j)` by leaps.
    pub(super) fn weighted_by_leaps(
        &self,
        leap: &dyn Leap,
        signal: SignalView<'_>,
        weights: super::transform::LevelFactors<'_>,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        let super::transform::LevelFactors { schedule, factors } = weights;
        let measure = RowNorm { n_channels: signal.n_channels, weights: self.operator().weights() };
        if let [factor] = *factors {
            // The only band takes the place of the signal that it is the first leap from.
            let vectors: &mut [&mut [f64]] = &mut [out, &mut zeros(signal.values.len())];
            return self.leap_bands(leap, signal, schedule, vectors, progress, |_, finer, coarser| {
                Ok(measure.visit_band(finer, &[], coarser, |sum, _, coarser| {
                    let band = *sum - coarser;
                    *sum = factor * band;
                    band
                }))
            });
        }
        let (mut now, mut next) = (zeros(signal.values.len()), zeros(signal.values.len()));
        let vectors: &mut [&mut [f64]] = &mut [&mut now, &mut next];
        self.leap_bands(leap, signal, schedule, vectors, progress, |level, finer, coarser| {
            let (factor, is_first) = (factors[level], level == 0);
            Ok(measure.visit_band(out, finer, coarser, |sum, finer, coarser| {
                let band = finer - coarser;
                *sum = if is_first { factor * band } else { *sum + factor * band };
                band
            }))
        })
    }
}

/// Norms of signals with a weight for each row.
#[derive(Clone, Copy)]
struct RowNorm<'a> {
    n_channels: usize,
    weights: RowWeights<'a>,
}

impl RowNorm<'_> {
    /// The weighted mean of each channel.
    fn means(self, signal: &[f64]) -> Vec<f64> {
        let (d, n) = (self.n_channels, signal.len() / self.n_channels);
        let (total, even) = match self.weights {
            RowWeights::Uniform => (1.0, Some(1.0 / n as f64)),
            RowWeights::Each(weights) => (parallel::sum(n, |x| weights[x]), None),
        };
        let weight = |x: usize| even.unwrap_or_else(|| self.weights.weight(x, n));
        if d == 1 {
            if let Some(even) = even {
                let chunk = |rows: Range<usize>| sum(&signal[rows], |value| value);
                let parts = parallel::map_chunks(n, super::bands::VERTICES_AT_A_TIME, chunk);
                return vec![even * parts.into_iter().sum::<f64>()];
            }
            return vec![parallel::sum(n, |x| weight(x) * signal[x]) / total];
        }
        // All channels at once: one by one, each would read the whole signal.
        let sums = parallel::sums(n, d, |x, sums| {
            let weight = weight(x);
            sums.iter_mut().zip(&signal[x * d..][..d]).for_each(|(sum, value)| *sum += weight * value);
        });
        sums.into_iter().map(|sum| sum / total).collect()
    }

    /// Puts the signal less a number for each channel into `out`, and returns the norm of the result.
    fn subtract(self, signal: &[f64], means: &[f64], out: &mut [f64]) -> f64 {
        let (d, n) = (self.n_channels, signal.len() / self.n_channels);
        let chunk = |first: usize, rows: &mut [f64]| {
            let given = &signal[first * d..][..rows.len()];
            for (row, given) in rows.chunks_exact_mut(d).zip(given.chunks_exact(d)) {
                for ((centered, value), mean) in row.iter_mut().zip(given).zip(means) {
                    *centered = value - mean;
                }
            }
            match self.weights {
                RowWeights::Uniform => sum(rows, square) / n as f64,
                RowWeights::Each(weights) => (rows.chunks_exact(d).zip(&weights[first..]))
                    .map(|(row, weight)| weight * sum(row, square))
                    .sum(),
            }
        };
        let parts: Vec<f64> = parallel::map_rows(out, d, super::bands::VERTICES_AT_A_TIME, chunk);
        parts.into_iter().sum::<f64>().sqrt()
    }

    /// Turns S_f(j − 1), `finer`, into W_f(j), and returns the norms of the band and of S_f(j), `coarser`.
    fn subtract_coarser(self, finer: &mut [f64], coarser: &[f64]) -> [f64; 2] {
        self.visit_band(finer, &[], coarser, |band, _, coarser| {
            *band -= coarser; // W_f(j) = S_f(j−1) − S_f(j) (eq. 11)
            *band
        })
    }

    /// Calls `put(out, finer, coarser)` for each value, which returns that of the band, and returns the norms of the band
    /// and of `coarser`, in one pass over memory. `finer` is empty if `put` finds its values in `out`.
    fn visit_band(
        self,
        out: &mut [f64],
        finer: &[f64],
        coarser: &[f64],
        put: impl Fn(&mut f64, f64, f64) -> f64 + Sync + Send,
    ) -> [f64; 2] {
        let (d, n) = (self.n_channels, (coarser.len() / self.n_channels) as f64);
        // Values that nobody looks at.
        let finer = if finer.is_empty() { coarser } else { finer };
        let chunk = |first: usize, out: &mut [f64]| {
            let (finer, coarser) = (&finer[first * d..][..out.len()], &coarser[first * d..][..out.len()]);
            match self.weights {
                RowWeights::Uniform => put_band(out, finer, coarser, &put).map(|sum| sum / n),
                RowWeights::Each(weights) => {
                    let rows =
                        out.chunks_exact_mut(d).zip(finer.chunks_exact(d)).zip(coarser.chunks_exact(d));
                    rows.zip(&weights[first..]).fold([0.0; 2], |sums, (((out, finer), coarser), weight)| {
                        let row = put_band(out, finer, coarser, &put);
                        [0, 1].map(|i| sums[i] + weight * row[i])
                    })
                }
            }
        };
        let parts = parallel::map_rows(out, d, super::bands::VERTICES_AT_A_TIME, chunk);
        [0, 1].map(|i| parts.iter().map(|part| part[i]).sum::<f64>().sqrt())
    }
}

/// Values whose terms are summed at once.
const TOGETHER: usize = 8;

/// Sum of a term of each value.
fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let (chunks, last) = values.as_chunks::<TOGETHER>();
    let mut sums = [0.0; TOGETHER];
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += term(*value));
    }
    sums.iter().sum::<f64>() + last.iter().map(|value| term(*value)).sum::<f64>()
}

fn square(value: f64) -> f64 {
    value * value
}

/// Calls `put(out, finer, coarser)` for each value, which returns that of the band, and returns the sums of squares of the
/// band and of `coarser`.
fn put_band(
    out: &mut [f64],
    finer: &[f64],
    coarser: &[f64],
    put: &impl Fn(&mut f64, f64, f64) -> f64,
) -> [f64; 2] {
    let (outs, last_out) = out.as_chunks_mut::<TOGETHER>();
    let (finers, last_finer) = finer.as_chunks::<TOGETHER>();
    let (coarsers, last_coarser) = coarser.as_chunks::<TOGETHER>();
    let (mut bands, mut rests) = ([0.0; TOGETHER], [0.0; TOGETHER]);
    for ((out, finer), coarser) in outs.iter_mut().zip(finers).zip(coarsers) {
        for lane in 0..TOGETHER {
            let band = put(&mut out[lane], finer[lane], coarser[lane]);
            bands[lane] += band * band;
            rests[lane] += coarser[lane] * coarser[lane];
        }
    }
    for ((out, finer), coarser) in last_out.iter_mut().zip(last_finer).zip(last_coarser) {
        let band = put(out, *finer, *coarser);
        bands[0] += band * band;
        rests[0] += coarser * coarser;
    }
    [bands.iter().sum(), rests.iter().sum()]
}
