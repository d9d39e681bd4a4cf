//! Noise taken off a signal on any shape.

use super::noise_level::median;
use super::risk::Risk;
use super::scaling::{scaling_functions, transform};
use super::{DenoiseError, DenoiseParams, SEED, SHAKE};
use crate::bands::{Schedule, Transform};
use crate::operator::Diffusion;
use crate::{Decomposer, Progress, parallel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

/// Steps of the shape's own walk by which a signal is smoothed: two to each doubling, whole so that any walk can take them.
const PLAIN_STEPS: [f64; 18] = [
    1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 16.0, 23.0, 32.0, 45.0, 64.0, 91.0, 128.0, 181.0, 256.0, 362.0, 512.0,
];

/// Levels that it is split into by walks that are led: 1, 2, 4, … 128 steps.
const LED_LEVELS: usize = 8;

/// How many of [`PLAIN_STEPS`] smooth it for its first guide.
const FIRST_GUIDE_LEVELS: usize = 2;

/// Levels, so that 16 and 32 steps, by which it is smoothed by the first guide for the second, and by the second for the third.
const GUIDE_LEVELS: [usize; 2] = [5, 6];

/// How far a signal may change from one vertex to the next, in root medians of its squared differences there.
const REACH: f64 = 2.5;

/// Times that noise is added to see how estimates follow it, up to [`FEW_VALUES`] values; once to more.
const PROBES: usize = 4;

/// See [`PROBES`].
const FEW_VALUES: usize = 100_000;

/// Standard errors of its promise by which a mixture with led walks must beat the best without.
const LEAST_GAIN: f64 = 2.0;

/// Channels that lead a walk together; those of signals that have more lead one each.
const CHANNELS_TOGETHER: usize = 3;

/// Largest relative error of a band: far below what is left of the noise.
const ACCURACY: f64 = 1e-5;

/// The standard deviation of a normal variable is its median absolute deviation over this.
const MEDIAN_DEVIATION: f64 = 0.674_489_750_196_081_7;

/// What was assumed of the noise of one group of channels, and what was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SignalNoise {
    /// The channels, from 0.
    pub channels: Vec<usize>,
    /// Standard deviation of the noise, in the unit of the signal: as estimated or given.
    pub noise: f64,
    /// How much of the result is the signal as it was.
    pub kept: f64,
    /// Steps of the walk that knows nothing of the signal, about two numbers to each doubling.
    pub plain_steps: Vec<f64>,
    /// How much comes from each of these.
    pub plain_weights: Vec<f64>,
    /// How much comes from walks that keep to vertices of like values, after 1, 2, 4, … 128 steps, for each of two guides.
    pub step_weights: Vec<f64>,
    /// The expected mean square of the error, summed over the channels, before and after.
    pub risk: [f64; 2],
}

/// A denoised signal.
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedSignal {
    /// New values, n_vertices × n_channels, in the order of the shape; masked vertices keep theirs.
    pub values: Vec<f64>,
    /// What was assumed and done, for each group of channels.
    pub info: Vec<SignalNoise>,
}

/// Takes noise off a signal (n_vertices × n_channels, row-major, in the order of the shape) on a mesh, cloud or graph.
/// O(entries × channels).
///
/// The result is a mixture of the signal, of its scaling functions after 1, 2, 3, 4, 6, 8, 11, 16, … 512 steps of the shape's own walk, and of those after
/// 1, 2, 4, … 128 steps of walks that keep to neighbors of like values, so that steps stay. The weights, ≥ 0 and of sum 1, have the least mean square
/// error (without the led walks, unless these promise more than two standard errors) by Stein's estimate for Gaussian noise, independent from vertex to vertex, whose standard deviation is estimated from the signal
/// (or given, in its unit). Three channels, and the first three of four, are taken together (a color, with what lies over it);
/// otherwise each is by itself.
///
/// ```
/// use adwave::denoise::{DenoiseParams, denoise_signal};
/// use adwave::{Decomposer, Progress, shape::{Graph, Shape}};
/// let edges: Vec<_> = (0..399).map(|i| (i, i + 1, 1.0)).collect();
/// let decomposer = Decomposer::new(&Shape::Graph(Graph::new(400, &edges)?));
/// let step = |i: i32| if i < 200 { 0.0 } else { 1.0 };
/// let mut state = 1_u32;
/// let mut random = || {
///     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
///     f64::from(state) / f64::from(u32::MAX) - 0.5
/// };
/// let noisy: Vec<f64> = (0..400).map(|i| step(i) + 0.4 * random()).collect();
/// let result = denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none())?;
/// let square = |f: &[f64]| f.iter().zip(0..).map(|(v, i)| (v - step(i)).powi(2)).sum::<f64>();
/// assert!(square(&result.values) < 0.2 * square(&noisy));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DenoiseError`] for a signal that does not fit or is not finite, a parameter out of its range, or when cancelled.
pub fn denoise_signal(
    decomposer: &Decomposer,
    signal: &[f64],
    n_channels: usize,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<DenoisedSignal, DenoiseError> {
    params.check()?;
    let n = decomposer.n_vertices();
    if n_channels == 0 || signal.len() != n * n_channels {
        let (found, expected) = (signal.len(), n * n_channels);
        return Err(DenoiseError::SignalLength { found, expected });
    }
    let masked = decomposer.mask_flags();
    let map = decomposer.geometry().vertex_map();
    let is_known = |x: usize| masked.is_none_or(|masked| !masked[x]);
    let known = |v: usize| is_known(map.welded(v));
    if let Some(at) = (0..signal.len()).find(|&i| !signal[i].is_finite() && known(i / n_channels)) {
        return Err(DenoiseError::NotFinite { vertex: at / n_channels, value: signal[at] });
    }
    let filled: Vec<f64> = signal.iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect();
    let welded = map.try_mean(&filled, n_channels, progress)?;
    let together = if matches!(n_channels, 3 | 4) { CHANNELS_TOGETHER } else { 1 };
    let mut groups: Vec<Vec<usize>> = vec![(0..together).collect()];
    groups.extend((together..n_channels).map(|c| vec![c]));
    let (mut values, mut info) = (signal.to_vec(), Vec::new());
    for (k, channels) in groups.iter().enumerate() {
        progress.step(k as u64, groups.len() as u64)?;
        let data: Vec<f64> =
            welded.chunks_exact(n_channels).flat_map(|row| channels.iter().map(|&c| row[c])).collect();
        let group = Group { decomposer, d: channels.len(), is_known: &is_known };
        let (found, mut report) = group.denoised(&data, params, progress)?;
        for (v, row) in values.chunks_exact_mut(n_channels).enumerate() {
            let x = map.welded(v);
            for (at, &c) in channels.iter().enumerate().filter(|_| is_known(x)) {
                row[c] += found[x * channels.len() + at] - welded[x * n_channels + c];
            }
        }
        report.channels.clone_from(channels);
        info.push(report);
    }
    progress.step(groups.len() as u64, groups.len() as u64)?;
    Ok(DenoisedSignal { values, info })
}

/// Channels that are denoised together.
struct Group<'a> {
    decomposer: &'a Decomposer,
    /// How many.
    d: usize,
    /// Whether a welded vertex has a value.
    is_known: &'a (dyn Fn(usize) -> bool + Sync),
}

impl Group<'_> {
    fn denoised(
        &self,
        data: &[f64],
        params: &DenoiseParams,
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, SignalNoise), DenoiseError> {
        let noise = match params.noise {
            Some(noise) => noise,
            None => self.noise_level(data, progress)?,
        };
        let mut info = SignalNoise { noise, kept: 1.0, ..SignalNoise::default() };
        if noise * params.strength == 0.0 {
            return Ok((data.to_vec(), info));
        }
        let candidates = self.candidates(data, progress)?;
        // Each vertex counts alike, as its noise does; those that are not known do not.
        let counts = parallel::try_collect(data.len() / self.d, progress, |x| {
            f64::from(u8::from((self.is_known)(x)))
        })?;
        let n_times = if data.len() <= FEW_VALUES { PROBES } else { 1 };
        let mut random = Pcg64Mcg::seed_from_u64(SEED);
        let shaken = (0..n_times).map(|_| {
            let mut shaken = |v: &f64| -> f64 {
                let deviate: f64 = StandardNormal.sample(&mut random);
                v + SHAKE * noise * deviate
            };
            let data: Vec<f64> = data.iter().map(&mut shaken).collect();
            self.candidates(&data, progress)
        });
        let shaken = shaken.collect::<Result<Vec<_>, DenoiseError>>()?;
        let risk = Risk::new(&candidates, &shaken, &counts, SHAKE, params.strength, progress)?;
        // The many led walks promise something by chance, too.
        let n_known = counts.iter().filter(|c| **c > 0.0).count();
        let (plain, led) = (risk.best_among(1 + PLAIN_STEPS.len()), risk.best_weights());
        let (gain, error) = risk.gain(&led, &plain, noise, n_known);
        let weights = if gain > LEAST_GAIN * error { led } else { plain };
        info.risk = risk.before_and_after(&weights);
        info.kept = weights[0];
        info.plain_steps = PLAIN_STEPS.to_vec();
        info.plain_weights = weights[1..=PLAIN_STEPS.len()].to_vec();
        info.step_weights = weights[1 + PLAIN_STEPS.len()..].to_vec();
        let mixture = parallel::try_collect(data.len(), progress, |i| {
            weights.iter().zip(&candidates).map(|(w, candidate)| w * candidate[i]).sum()
        })?;
        Ok((mixture, info))
    }

    /// The data, then their scaling functions by the shape's walk and by walks that two guides lead.
    fn candidates(&self, data: &[f64], progress: Progress<'_>) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let walk = self.decomposer.diffusion();
        let scaling =
            |walk: &Transform, schedule: &Schedule| scaling_functions(walk, data, self.d, schedule, progress);
        let led = |by: &[f64]| -> Result<Transform, DenoiseError> {
            let guide: Vec<[f64; 3]> = by
                .chunks_exact(self.d)
                .map(|row| std::array::from_fn(|c| row.get(c).copied().unwrap_or_default()))
                .collect();
            // Lengths of steps are not asked for.
            transform(walk.guided(&guide, REACH, |_, _| 0.0, progress)?, ACCURACY)
        };
        let plain_schedule = Schedule::real(PLAIN_STEPS.to_vec()).expect("increasing numbers");
        let plain = scaling(&transform(Diffusion::clone(walk), ACCURACY)?, &plain_schedule)?;
        let dyadic = |n| Schedule::dyadic(n).expect("a few levels");
        let led_levels = dyadic(LED_LEVELS);
        let first = led(&plain[FIRST_GUIDE_LEVELS - 1])?;
        let second = led(&last(scaling(&first, &dyadic(GUIDE_LEVELS[0]))?))?;
        let by_second = scaling(&second, &led_levels)?;
        let third = led(&by_second[GUIDE_LEVELS[1] - 1])?;
        let by_third = scaling(&third, &led_levels)?;
        Ok([vec![data.to_vec()], plain, by_second, by_third].concat())
    }

    /// The standard deviation of noise, from the median absolute deviation of the difference between a value and the mean of its
    /// neighbors', which noise of variance σ² gives the variance `σ²·(1 + 1/k)` at a vertex of k neighbors.
    fn noise_level(&self, data: &[f64], progress: Progress<'_>) -> Result<f64, DenoiseError> {
        let (neighbors, d) = (self.decomposer.neighbors(), self.d);
        let mut deviations = parallel::try_collect(data.len(), progress, |i| {
            let (x, c) = (i / d, i % d);
            let near = neighbors.of(x);
            if near.is_empty() || !(self.is_known)(x) {
                return f64::NAN;
            }
            let k = near.len() as f64;
            let mean = near.iter().map(|&y| data[y as usize * d + c]).sum::<f64>() / k;
            (data[i] - mean).abs() / (1.0 + 1.0 / k).sqrt()
        })?;
        deviations.retain(|v| v.is_finite());
        Ok(median(&mut deviations) / MEDIAN_DEVIATION)
    }
}

fn last(mut levels: Vec<Vec<f64>>) -> Vec<f64> {
    levels.pop().expect("a level")
}
