//! The walk prepared once, for the bands of many signals.

use super::chebyshev::{Outcome, Prepared};
use super::real_series::{self, LADDER, Rung};
use super::series::{Growth, Series};
use super::{Bands, BandsError, BandsInfo, BandsParams, Engine, Schedule};
use crate::operator::Diffusion;
use crate::shape::VertexMap;
use crate::sparse::{apply, difference, zeros};
use crate::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::Arc;

/// A walk made ready to split signals into bands, in the order of the analysis (the order of the diffusion's rows).
///
/// ```
/// use adwave::bands::{BandsParams, Schedule, Transform};
/// use adwave::{Progress, operator::Diffusion};
/// let walk = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.5, 0.5])?;
/// let transform = Transform::new(&walk, &BandsParams::default())?;
/// let (mut first, mut second) = ([0.0; 2], [0.0; 2]);
/// let schedule = Schedule::dyadic(2)?;
/// transform.wavelets_into(&[1.0, 3.0], 1, &schedule, &mut [&mut first, &mut second], Progress::none())?;
/// assert_eq!((first, second), ([-1.0, 1.0], [0.0, 0.0])); // one step already takes the mean
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Transform<'a> {
    diffusion: &'a Diffusion,
    params: BandsParams,
    engine: Engine,
    /// What the Chebyshev recurrence needs; none where powers are used.
    prepared: Option<Prepared>,
}

impl<'a> Transform<'a> {
    /// Prepares `diffusion`. O(entries).
    ///
    /// # Errors
    /// [`BandsError::Accuracy`] when the accuracy cannot be promised.
    pub fn new(diffusion: &'a Diffusion, params: &BandsParams) -> Result<Self, BandsError> {
        params.check()?;
        let engine = if diffusion.is_reversible() && params.engine != Engine::Powers {
            Engine::Chebyshev
        } else {
            Engine::Powers
        };
        let prepared = (engine == Engine::Chebyshev)
            .then(|| Prepared::new(Arc::new(diffusion.clone()), Progress::none()))
            .transpose()?;
        Ok(Self { diffusion, params: *params, engine, prepared })
    }

    /// The walk.
    pub fn diffusion(&self) -> &'a Diffusion {
        self.diffusion
    }

    /// `W_f(j) = (Φ₁^{n_{j−1}} − Φ₁^{n_j}) f`, j = 1 … J, into `wavelets[j − 1]`; all n_vertices × n_channels, row-major.
    ///
    /// Each within [`BandsParams::accuracy`] of its own norm. Constants give exact zeros.
    ///
    /// # Errors
    /// [`BandsError`] when the signal has the wrong length or a value that is not finite, when steps that are not whole are
    /// asked of a walk that is not reversible or miss the accuracy, or when cancelled.
    ///
    /// # Panics
    /// Unless there is one output of the signal's length a level.
    pub fn wavelets_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        wavelets: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        super::decompose::check_signal(signal, self.diffusion.n_vertices(), n_channels)?;
        assert_eq!(wavelets.len(), schedule.n_levels(), "one output a level");
        assert!(wavelets.iter().all(|w| w.len() == signal.len()), "outputs as long as the signal");
        let steps = schedule.steps_from_zero();
        let outcome = if let Some(prepared) = &self.prepared {
            let series = |level: usize, rung| self.band(&steps[level..level + 2], rung, prepared.growth);
            self.climb(prepared, signal, n_channels, series, wavelets, progress)?
        } else {
            let steps = whole(schedule)?;
            for wavelet in &mut *wavelets {
                wavelet.fill(0.0);
            }
            self.sum_powers(signal, n_channels, &steps, progress, |level, now| {
                add(1.0, now, wavelets[level]);
            })?
        };
        Ok(self.info(&outcome, n_channels))
    }

    /// `Σ_j factors[j−1]·W_f(j)` into `out`, n_vertices × n_channels, by a single polynomial of Φ₁. A filter with one gain a
    /// band is `f + Σ_j (gain_j − 1)·W_f(j)` (eq. 18).
    ///
    /// Within [`BandsParams::accuracy`] of its own norm.
    ///
    /// # Errors
    /// As for [`wavelets_into`](Self::wavelets_into).
    ///
    /// # Panics
    /// Unless there is one finite factor a level and `out` is as long as the signal.
    pub fn weighted_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        factors: &[f64],
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        super::decompose::check_signal(signal, self.diffusion.n_vertices(), n_channels)?;
        assert_eq!(factors.len(), schedule.n_levels(), "one factor a level");
        assert!(factors.iter().all(|g| g.is_finite()), "finite factors");
        assert_eq!(out.len(), signal.len(), "an output as long as the signal");
        let steps = schedule.steps_from_zero();
        let outcome = if let Some(prepared) = &self.prepared {
            let series = |_, rung| {
                let bands: Vec<Series> =
                    steps.par_windows(2).map(|pair| self.band(pair, rung, prepared.growth)).collect();
                Series::combination(&bands, factors, prepared.growth)
            };
            self.climb(prepared, signal, n_channels, series, &mut [out], progress).map_err(|error| {
                match error {
                    BandsError::Missed { level, accuracy, reached } => BandsError::Missed {
                        level: schedule.first_real().unwrap_or(level),
                        accuracy,
                        reached,
                    },
                    other => other,
                }
            })?
        } else {
            let steps = whole(schedule)?;
            out.fill(0.0);
            self.sum_powers(signal, n_channels, &steps, progress, |level, now| {
                add(factors[level], now, out);
            })?
        };
        Ok(self.info(&outcome, n_channels))
    }

    /// All bands of a signal in the order of the shape; see [`decompose`](super::decompose())
    ///
    /// # Errors
    /// As for [`wavelets_into`](Self::wavelets_into).
    pub fn decompose(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Bands, BandsError> {
        let (n_vertices, n_levels) = (vertex_map.n_vertices(), schedule.n_levels());
        super::decompose::check_signal(signal, n_vertices, n_channels)?;
        let mean = vertex_map.mean(signal, n_channels);
        let mut scaling: Vec<Vec<f64>> = (0..=n_levels).map(|_| zeros(signal.len())).collect();
        scaling[0].par_iter_mut().zip(signal).with_min_len(1 << 14).for_each(|(s, f)| *s = *f);
        // The wavelets come in the order of the analysis into what will hold the scaling coefficients.
        let mut outs: Vec<&mut [f64]> = scaling[1..].iter_mut().map(|s| &mut s[..mean.len()]).collect();
        let info = self.wavelets_into(&mean, n_channels, schedule, &mut outs, progress)?;
        let is_welded = vertex_map.n_welded() < n_vertices;
        let mut wavelet = Vec::with_capacity(n_levels);
        for level in 1..=n_levels {
            let (finer, rest) = scaling.split_at_mut(level);
            let (fine, coarse) = (&finer[level - 1], &mut rest[0]);
            let mut band = zeros(signal.len());
            band.par_chunks_exact_mut(n_channels).with_min_len(1 << 12).enumerate().for_each(|(x, band)| {
                band.copy_from_slice(&coarse[vertex_map.welded(x) * n_channels..][..n_channels]);
            });
            if level == 1 && is_welded {
                finish_welded(vertex_map, &mean, signal, n_channels, coarse, &mut band);
            } else {
                coarse
                    .par_iter_mut()
                    .zip(fine)
                    .zip(&band)
                    .with_min_len(1 << 14)
                    .for_each(|((s, fine), w)| *s = fine - w);
            }
            wavelet.push(band);
        }
        Ok(Bands {
            n_vertices,
            n_channels,
            steps: schedule.steps_from_zero(),
            sigma: schedule.sigma(self.diffusion.step_length()),
            scaling,
            wavelet,
            info,
        })
    }

    /// The series of the band between two numbers of steps.
    fn band(&self, pair: &[f64], rung: Rung, growth: Growth) -> Series {
        real_series::band(pair[0], pair[1], rung, self.params.accuracy, growth)
    }

    /// `series(i, rung)(Φ₁)·(I − Φ₁)·signal` into `outs[i]`, by the first rung of the ladder that is good enough for each.
    /// Series of whole steps are the same on every rung, and done with the first.
    fn climb(
        &self,
        prepared: &Prepared,
        signal: &[f64],
        n_channels: usize,
        series: impl Fn(usize, Rung) -> Series + Sync,
        outs: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<Outcome, BandsError> {
        let accuracy = self.params.accuracy;
        let mut sum = Outcome::default();
        let mut missed: Vec<(usize, f64)> = (0..outs.len()).map(|i| (i, f64::INFINITY)).collect();
        for rung in LADDER {
            // The last rungs cost O(m²) a band, before any product that would ask whether to go on.
            let made = |&(i, _): &(usize, f64)| {
                if progress.is_cancelled() { Err(Cancelled) } else { Ok(series(i, rung)) }
            };
            let these: Vec<Series> = missed.par_iter().map(made).collect::<Result<_, _>>()?;
            let is_guarded = these.iter().any(|s| s.rest.guarded > 0.0);
            let guard = if is_guarded { rung.guard() } else { Vec::new() };
            let mut wanted = missed.iter().map(|&(i, _)| i).peekable();
            let mut outs: Vec<&mut [f64]> = outs
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| wanted.next_if_eq(i).is_some())
                .map(|(_, out)| &mut **out)
                .collect();
            let outcome =
                prepared.evaluate(signal, n_channels, (&these, &guard), accuracy, &mut outs, progress)?;
            sum.degree = sum.degree.max(outcome.degree);
            sum.products += outcome.products;
            sum.terms += outcome.terms;
            sum.error_bound = sum.error_bound.max(outcome.error_bound);
            missed = outcome.missed.into_iter().map(|(at, reached)| (missed[at].0, reached)).collect();
            if missed.is_empty() {
                return Ok(sum);
            }
        }
        let (at, reached) = missed[0];
        Err(BandsError::Missed { level: at + 1, accuracy, reached })
    }

    /// Calls `each(level, Φ₁ⁱu)` for i = 0 … n_J − 1, level counted from 0. As `W_f(j)` is a sum of these, it has the
    /// relative accuracy of u, which a difference of two S_f would not have.
    fn sum_powers(
        &self,
        signal: &[f64],
        n_channels: usize,
        steps: &[u64],
        progress: Progress<'_>,
        mut each: impl FnMut(usize, &[f64]),
    ) -> Result<Outcome, Cancelled> {
        let total = steps[steps.len() - 1];
        let mut now = vec![0.0; signal.len()];
        let mut next = vec![0.0; signal.len()];
        difference(self.diffusion, self.diffusion.stationary(), signal, n_channels, 0, &mut now, progress)?;
        for (level, range) in steps.windows(2).enumerate() {
            for i in range[0]..range[1] {
                progress.step(i, total)?;
                if i > 0 {
                    apply(self.diffusion, &now, &mut next, n_channels);
                    std::mem::swap(&mut now, &mut next);
                }
                each(level, &now);
            }
        }
        progress.step(total, total)?;
        Ok(Outcome { degree: total - 1, products: total, terms: total, ..Outcome::default() })
    }

    fn info(&self, outcome: &Outcome, n_channels: usize) -> BandsInfo {
        let &Outcome { degree, products, terms, error_bound, .. } = outcome;
        BandsInfo {
            engine: self.engine,
            degree,
            products,
            terms,
            error_bound,
            bytes: self.working_bytes(n_channels),
        }
    }

    /// Bytes that a transform of `diffusion` will take at most, beyond the signal, its bands and the diffusion.
    pub fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        let n = diffusion.n_vertices() as u64;
        if diffusion.is_reversible() {
            Prepared::forecast_bytes(diffusion, n_channels)
        } else {
            2 * 8 * n * n_channels as u64
        }
    }

    /// Bytes that a call takes beyond the signal and its bands, what is prepared here and the diffusion included.
    pub fn working_bytes(&self, n_channels: usize) -> u64 {
        let n = self.diffusion.n_vertices() as u64;
        match &self.prepared {
            Some(prepared) => prepared.working_bytes(n_channels),
            None => self.diffusion.bytes() + 2 * 8 * n * n_channels as u64,
        }
    }
}

/// The steps of a schedule from 0, for a walk that takes one after the other.
fn whole(schedule: &Schedule) -> Result<Vec<u64>, BandsError> {
    let Some(steps) = schedule.whole_steps() else {
        let level = schedule.first_real().expect("a level that is not whole");
        let steps = schedule.steps()[level - 1];
        return Err(BandsError::NotWhole { level, steps });
    };
    Ok(std::iter::once(0).chain(steps).collect())
}

fn add(factor: f64, now: &[f64], out: &mut [f64]) {
    out.par_iter_mut().zip(now).with_min_len(1 << 14).for_each(|(out, v)| *out += factor * v);
}

/// S_f(1) and W_f(1) where vertices are welded: S_f(1) is one value for all of them, and what tells them apart is in
/// W_f(1).
fn finish_welded(
    vertex_map: &VertexMap,
    mean: &[f64],
    signal: &[f64],
    n_channels: usize,
    scaling: &mut [f64],
    wavelet: &mut [f64],
) {
    scaling
        .par_chunks_exact_mut(n_channels)
        .zip(wavelet.par_chunks_exact_mut(n_channels))
        .zip(signal.par_chunks_exact(n_channels))
        .with_min_len(1 << 12)
        .enumerate()
        .for_each(|(x, ((scaling, wavelet), signal))| {
            let mean = &mean[vertex_map.welded(x) * n_channels..][..n_channels];
            for (((s, w), f), m) in scaling.iter_mut().zip(wavelet).zip(signal).zip(mean) {
                *s = m - *w;
                *w += f - m;
            }
        });
}
