//! Denoising of a signal on any shape.

use super::noise_level::median;
use super::noise_model::{NoiseModel, Stabilizer};
use super::risk::Risk;
use super::scaling::{scaling_functions, shared_transform, transform, with_accuracy};
use super::{DenoiseError, DenoiseParams, SEED, SHAKE};
use crate::bands::{Schedule, Transform};
use crate::local_fit::{FitDomain, LinearTransform, LocalFit};
use crate::operator::Diffusion;
use crate::shape::{Adjacency, VertexMap};
use crate::{Cancelled, Decomposer, Progress, parallel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;
use std::sync::Arc;

/// Steps of the shape's own walk that smooth a signal: two per doubling, whole numbers so that any walk can take
/// them.
const PLAIN_STEPS: [f64; 18] = [
    1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 16.0, 23.0, 32.0, 45.0, 64.0, 91.0, 128.0, 181.0, 256.0, 362.0, 512.0,
];

/// First level of [`PLAIN_STEPS`], from 0, that also smooths a signal without regard to its slopes. At borders a local
/// linear fit over many steps leaves more noise than a mean, and a signal without slopes does not need it.
const FIRST_MEAN_LEVEL: usize = 7;

/// Noise relative to the largest value below which the difference from a linear fit is rounding.
const ROUNDING: f64 = 1e-13;

/// Number of levels by guided walks: 1, 2, 4, … 128 steps.
const LED_LEVELS: usize = 8;

/// Number of leading entries of [`PLAIN_STEPS`] that smooth the signal for its first guide.
const FIRST_GUIDE_LEVELS: usize = 2;

/// Numbers of levels (16 and 32 steps) by which the first guide smooths the signal for the second, and the second
/// for the third.
const GUIDE_LEVELS: [usize; 2] = [5, 6];

/// Change of a signal between neighbors at which steps are damped, in square roots of its median squared
/// difference.
const REACH: f64 = 2.5;

/// Number of probes with added noise for at most [`FEW_VALUES`] values; larger signals get one.
const PROBES: usize = 4;

/// Number of values up to which [`PROBES`] probes are used.
const FEW_VALUES: usize = 100_000;

/// Number of standard errors by which the promise of a mixture with guided walks must exceed that of the best one
/// without.
const LEAST_GAIN: f64 = 2.0;

/// Number of channels that guide a walk together; in signals with more channels each guides alone.
const CHANNELS_TOGETHER: usize = 3;

/// Largest relative error of a band, far below the remaining noise.
pub(super) const ACCURACY: f64 = 1e-5;

/// Largest number of successive differences from which the noise is estimated.
const NOISE_ORDERS: usize = 5;

/// Standard error of a median absolute deviation relative to it, times the root of the number of values.
const LEVEL_ERROR: f64 = 1.17;

/// Difference of a row from the mean of the rows at its place, in standard deviations of the noise of a row, beyond
/// which it is a jump of the signal.
const JUMP: f64 = 4.0;

/// Assumed noise of one group of channels, and the operations applied.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SignalNoise {
    /// Indices of the channels, from 0.
    pub channels: Vec<usize>,
    /// Dependence of the noise on the values.
    pub model: NoiseModel,
    /// Standard deviation of the noise, estimated or given: in the unit of the signal; with Poisson noise that of a
    /// value of 1, whose square is the variance per unit of value; with multiplicative noise relative to the value.
    pub noise: f64,
    /// Share of the variance of the noise that is left in the result, in 0..=1.
    pub remaining: f64,
    /// Weight of the unchanged signal in the result.
    pub kept: f64,
    /// Numbers of steps of the walk that is independent of the signal, about two per doubling.
    pub plain_steps: Vec<f64>,
    /// Weight of each of `plain_steps`.
    pub plain_weights: Vec<f64>,
    /// Weights of the walks that favor vertices of similar values, after 1, 2, 4, … 128 steps, for each of two
    /// guides.
    pub step_weights: Vec<f64>,
    /// Expected mean square error, summed over the channels, before and after; unless the noise is Gaussian, that of
    /// the values `2·√f` or `ln f`, whose noise is the same everywhere.
    pub risk: [f64; 2],
    /// Number of places with several rows that differ by noise; they get the same values.
    #[serde(skip_serializing_if = "is_zero")]
    pub repeated: usize,
    /// Number of places with several rows that differ by more than 4 times the noise of a row; the rows keep their
    /// differences.
    #[serde(skip_serializing_if = "is_zero")]
    pub jumps: usize,
    /// Standard deviation of the noise of a single row if places have several; 0 otherwise.
    #[serde(skip_serializing_if = "is_nothing")]
    pub noise_of_rows: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_nothing(value: &f64) -> bool {
    *value == 0.0
}

/// A denoised signal.
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedSignal {
    /// New values, n_vertices × n_channels, in the order of the shape; masked vertices keep theirs.
    pub values: Vec<f64>,
    /// Assumed noise and operations, per group of channels.
    pub info: Vec<SignalNoise>,
}

/// Removes noise from a signal (n_vertices × n_channels, row-major, in the order of the shape) on a mesh, cloud or
/// graph. O(entries × channels).
///
/// The result is a mixture of the signal, of its scaling coefficients after 1, 2, 3, 4, 6, 8, 11, 16, … 512 steps of
/// the shape's own walk, and of those after 1, 2, 4, … 128 steps of walks that favor neighbors of similar values, so
/// that jumps stay. The weights are ≥ 0, sum to 1 and minimize the mean square error by Stein's estimate for Gaussian
/// noise that is independent between vertices, with the standard deviation estimated from the signal (or given, in its
/// unit). Guided walks are used only if they promise an improvement of more than two standard errors. Noise of another
/// [`NoiseModel`] is first made the same everywhere, by `2·√(f + 3a/8)` for a variance of a·f and by ln f; the inverse
/// returns means without bias. With [`LocalFit::Linear`], the default, scaling coefficients are about a local linear
/// fit, so that slopes are neither noise nor bias. From 16 steps on, the scaling coefficients about the local mean are
/// parts of the mixture too. Three channels, or the first three of four (a color with alpha), are treated together;
/// otherwise each channel is treated separately.
///
/// Directions ([`Directions`](crate::directions::Directions)) are two channels that are treated together: what arrives
/// from a neighbor is turned on its way, and the noise is that of each of the two numbers.
///
/// Rows at equal positions that differ by noise are repeated measurements: their mean is denoised, and all get its
/// value. Rows that differ by more than 4 times the noise are two sides of a jump, and keep their differences.
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
/// [`DenoiseError`] for a signal of the wrong length or with a value that is not finite, a parameter out of its
/// range, or if the call is cancelled.
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
    let map = decomposer.vertex_map();
    let is_known = |x: usize| masked.is_none_or(|masked| !masked[x]);
    let known = |v: usize| is_known(map.welded(v));
    if let Some(at) = (0..signal.len()).find(|&i| !signal[i].is_finite() && known(i / n_channels)) {
        return Err(DenoiseError::NotFinite { vertex: at / n_channels, value: signal[at] });
    }
    let model = params.noise_model;
    if let Some(at) =
        (0..signal.len()).find(|&i| !Stabilizer::is_possible(model, signal[i]) && known(i / n_channels))
    {
        return Err(DenoiseError::ImpossibleValue { model, vertex: at / n_channels, value: signal[at] });
    }
    let filled: Vec<f64> = signal.iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect();
    let welded = map.try_mean(&filled, n_channels, progress)?;
    let walk = with_accuracy(decomposer.transform(), ACCURACY)?;
    walk.check_signal(&welded, n_channels)?;
    let at_place = decomposer.operator().channels_at_place();
    if at_place > 1 && model != NoiseModel::Gaussian {
        return Err(DenoiseError::Directions);
    }
    let groups = channel_groups(n_channels, at_place);
    let (mut values, mut info) = (signal.to_vec(), Vec::new());
    for (k, channels) in groups.iter().enumerate() {
        progress.step(k as u64, groups.len() as u64)?;
        let data: Vec<f64> =
            welded.chunks_exact(n_channels).flat_map(|row| channels.iter().map(|&c| row[c])).collect();
        let group_of = |data: &[f64]| {
            let n_together = channels.len();
            let domains =
                (0..n_together).map(|c| decomposer.fit_domain(&channel(data, c, n_together))).collect();
            let is_linear = decomposer.applied_local_fit(params.local_fit) == LocalFit::Linear;
            let domains = Some(domains).filter(|_| is_linear);
            ChannelGroup { decomposer, d: n_together, is_known: &is_known, domains }
        };
        let scale = Stabilizer::new(&data, params, |data| group_of(data).level(data, &walk, progress))?;
        let stable = scale.transformed(&data);
        let (found, mut report) =
            group_of(&stable).denoised(&stable, &walk, &params.with_noise(scale.noise), progress)?;
        let is_changed = report.kept < 1.0;
        let rows = RowsAtPlaces::new(map, &filled, &welded, n_channels, channels);
        let is_jump = rows.jumps(&scale, report.noise, &mut report, &is_known);
        for (v, row) in values.chunks_exact_mut(n_channels).enumerate().filter(|_| is_changed) {
            let x = map.welded(v);
            for (at, &c) in channels.iter().enumerate().filter(|_| is_known(x)) {
                let restored = scale.restored(found[x * channels.len() + at], report.remaining);
                if is_jump.as_ref().is_none_or(|is_jump| is_jump[x]) {
                    row[c] += restored - welded[x * n_channels + c];
                } else {
                    row[c] = restored;
                }
            }
        }
        report.channels.clone_from(channels);
        info.push(report);
    }
    progress.step(groups.len() as u64, groups.len() as u64)?;
    Ok(DenoisedSignal { values, info })
}

/// Channels that are denoised together: those that belong together at a place, the first three of three or four, else each
/// alone.
fn channel_groups(n_channels: usize, at_place: usize) -> Vec<Vec<usize>> {
    if at_place == 1 && matches!(n_channels, 3 | 4) {
        let rest = (CHANNELS_TOGETHER..n_channels).map(|c| vec![c]);
        return std::iter::once((0..CHANNELS_TOGETHER).collect()).chain(rest).collect();
    }
    (0..n_channels).step_by(at_place).map(|c| (c..c + at_place).collect()).collect()
}

/// Rows of a signal at equal positions, for one group of channels.
struct RowsAtPlaces<'a> {
    map: &'a VertexMap,
    /// All rows, and the mean of those at each place.
    rows: &'a [f64],
    means: &'a [f64],
    n_channels: usize,
    channels: &'a [usize],
}

impl<'a> RowsAtPlaces<'a> {
    fn new(
        map: &'a VertexMap,
        rows: &'a [f64],
        means: &'a [f64],
        n_channels: usize,
        channels: &'a [usize],
    ) -> Self {
        Self { map, rows, means, n_channels, channels }
    }

    /// Flags the welded vertices whose rows differ by a jump, that is by more than [`JUMP`] times the noise of a row;
    /// `None` if no rows differ. Other rows differ by noise, which is added to the error before in `report`. `noise` is
    /// that of the means.
    fn jumps(
        &self,
        scale: &Stabilizer,
        noise: f64,
        report: &mut SignalNoise,
        is_known: &dyn Fn(usize) -> bool,
    ) -> Option<Vec<bool>> {
        let n_places = self.map.n_welded();
        if n_places == self.map.n_vertices() || noise == 0.0 {
            return None;
        }
        let value = |rows: &[f64], v: usize, c: usize| rows[v * self.n_channels + c];
        let (mut squares, mut counts) = (vec![0.0; n_places], vec![0_u32; n_places]);
        for v in 0..self.map.n_vertices() {
            let x = self.map.welded(v);
            counts[x] += 1;
            let (row, mean): (Vec<f64>, Vec<f64>) =
                self.channels.iter().map(|&c| (value(self.rows, v, c), value(self.means, x, c))).unzip();
            let apart = |(a, b): (f64, f64)| (a - b) * (a - b);
            let apart = scale.transformed(&row).into_iter().zip(scale.transformed(&mean)).map(apart);
            squares[x] += apart.sum::<f64>();
        }
        let several = |x: &usize| counts[*x] > 1 && squares[*x] > 0.0 && is_known(*x);
        if !(0..n_places).any(|x| several(&x)) {
            return None;
        }
        let mut sorted = counts.clone();
        let typical = *sorted.select_nth_unstable(n_places / 2).1;
        // The noise of a mean of k rows is that of a row by √k.
        let limit = JUMP * JUMP * noise * noise * f64::from(typical) * self.channels.len() as f64;
        let is_jump: Vec<bool> =
            (0..n_places).map(|x| squares[x] > limit * f64::from(counts[x].saturating_sub(1))).collect();
        report.jumps = (0..n_places).filter(several).filter(|&x| is_jump[x]).count();
        report.repeated = (0..n_places).filter(several).filter(|&x| !is_jump[x]).count();
        report.noise_of_rows = noise * f64::from(typical).sqrt();
        let removed: f64 = (0..n_places).filter(|&x| !is_jump[x] && is_known(x)).map(|x| squares[x]).sum();
        report.risk[0] += removed / self.map.n_vertices() as f64;
        Some(is_jump)
    }
}

/// Channels that are denoised together.
pub(super) struct ChannelGroup<'a> {
    pub(super) decomposer: &'a Decomposer,
    /// Number of channels.
    pub(super) d: usize,
    /// Returns true if a welded vertex has a value.
    pub(super) is_known: &'a (dyn Fn(usize) -> bool + Sync),
    /// Domain over which each channel is fitted, if smoothing is about a local linear fit.
    pub(super) domains: Option<Vec<FitDomain>>,
}

/// Channel `c` of `data`, n × d.
pub(super) fn channel(data: &[f64], c: usize, d: usize) -> Vec<f64> {
    data[c.min(data.len())..].iter().step_by(d).copied().collect()
}

/// The diffusion of the domain, prepared for a group of channels.
struct ShapeWalk<'a> {
    transform: &'a Transform,
    /// Fit of each channel; empty if smoothing is about the local mean.
    fits: Vec<LinearTransform<'a>>,
}

/// A walk that favors neighbors with similar values of the signal.
struct LedWalk {
    transform: Transform,
    /// Its rows; `None` for directions, which are smoothed about a mean.
    rows: Option<Arc<Diffusion>>,
}

impl<'a> ChannelGroup<'a> {
    /// Standard deviation of the noise of `data`.
    pub(super) fn level(
        &self,
        data: &[f64],
        walk: &Transform,
        progress: Progress<'_>,
    ) -> Result<f64, DenoiseError> {
        let fits = self.fits(walk, progress)?;
        if self.decomposer.operator().channels_at_place() > 1 {
            self.noise_of_directions(data, walk, progress)
        } else if fits.is_empty() {
            self.noise_level(data, progress)
        } else {
            self.noise_about_fits(data, &fits, progress)
        }
    }

    /// Mixture of least risk for noise of the standard deviation that `params` must give.
    fn denoised(
        &self,
        data: &[f64],
        walk: &Transform,
        params: &DenoiseParams,
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, SignalNoise), DenoiseError> {
        let walk = ShapeWalk { fits: self.fits(walk, progress)?, transform: walk };
        let noise = params.noise.unwrap_or(0.0);
        let model = params.noise_model;
        let mut info = SignalNoise { model, noise, kept: 1.0, remaining: 1.0, ..SignalNoise::default() };
        if noise * params.strength == 0.0 {
            return Ok((data.to_vec(), info));
        }
        let candidates = self.candidates(data, &walk, progress)?;
        // All vertices have the same weight, as their noise is the same; those without a value have weight 0.
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
            self.candidates(&data, &walk, progress)
        });
        let shaken = shaken.collect::<Result<Vec<_>, DenoiseError>>()?;
        let risk = Risk::new(&candidates, &shaken, &counts, SHAKE, params.strength, progress)?;
        // With many guided walks, some promise an improvement by chance.
        let n_known = counts.iter().filter(|c| **c > 0.0).count();
        let n_means = if walk.fits.is_empty() { 0 } else { PLAIN_STEPS.len() - FIRST_MEAN_LEVEL };
        let n_plain = 1 + PLAIN_STEPS.len() + n_means;
        let (plain, led) = (risk.best_among(n_plain), risk.best_weights());
        let (gain, error) = risk.gain(&led, &plain, noise, n_known);
        let weights = if gain > LEAST_GAIN * error { led } else { plain };
        info.risk = risk.risks_before_and_after(&weights);
        info.kept = weights[0];
        info.plain_steps = PLAIN_STEPS.to_vec();
        info.plain_weights = weights[1..=PLAIN_STEPS.len()].to_vec();
        let means = &weights[1 + PLAIN_STEPS.len()..n_plain];
        info.plain_weights[PLAIN_STEPS.len() - n_means..].iter_mut().zip(means).for_each(|(w, m)| *w += m);
        info.step_weights = weights[n_plain..].to_vec();
        let mix = |candidates: &[Vec<f64>]| {
            parallel::try_collect(data.len(), progress, |i| {
                weights.iter().zip(candidates).map(|(w, candidate)| w * candidate[i]).sum()
            })
        };
        let mixture = mix(&candidates)?;
        if model != NoiseModel::Gaussian {
            // The response to noise of known size tells the share of it that is left. Medians pass over the vertices
            // near steps, where steps of the walk change with the noise.
            let response = mix(&shaken[0])?;
            let apart = |a: &[f64], b: &[f64]| -> f64 {
                let known = (0..a.len()).filter(|i| (self.is_known)(i / self.d));
                let mut sizes: Vec<f64> = known.map(|i| (a[i] - b[i]).abs()).collect();
                median(&mut sizes)
            };
            let added = apart(&shaken[0][0], &candidates[0]);
            let share = (apart(&response, &mixture) / added).powi(2);
            info.remaining = if added > 0.0 { share.min(1.0) } else { 1.0 };
        }
        Ok((mixture, info))
    }

    /// Fit of each channel on a walk; none if smoothing is about the local mean.
    pub(super) fn fits<'t>(
        &self,
        walk: &'t Transform,
        progress: Progress<'_>,
    ) -> Result<Vec<LinearTransform<'t>>, DenoiseError>
    where
        'a: 't,
    {
        let mut fits: Vec<LinearTransform<'t>> = Vec::new();
        for &domain in self.domains.iter().flatten() {
            let fit = match fits.last().filter(|fit| fit.domain() == domain) {
                Some(fit) => fit.clone(),
                None => self.decomposer.linear_transform(walk, domain, progress)?,
            };
            fits.push(fit);
        }
        Ok(fits)
    }

    /// Scaling coefficients of the data by a walk, and those about the local mean from level `first_mean` on if the
    /// others are about a linear fit.
    pub(super) fn scaling(
        &self,
        walk: &Transform,
        fits: &[LinearTransform<'_>],
        data: &[f64],
        schedule: &Schedule,
        first_mean: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<f64>>, DenoiseError> {
        if fits.is_empty() {
            return scaling_functions(walk, data, self.d, schedule, progress);
        }
        let mut joined: Vec<Vec<f64>> = Vec::new();
        for (c, fit) in fits.iter().enumerate() {
            let found = fit.scaling(&channel(data, c, self.d), schedule, first_mean, progress.quiet())?;
            let found = [found.levels, found.plain].concat();
            if self.d == 1 {
                return Ok(found);
            }
            joined.resize_with(found.len(), || vec![0.0; data.len()]);
            for (level, found) in joined.iter_mut().zip(found) {
                level.iter_mut().skip(c).step_by(self.d).zip(found).for_each(|(value, s)| *value = s);
            }
        }
        Ok(joined)
    }

    /// The data, then their scaling coefficients by the shape's walk and by walks with two guides.
    fn candidates(
        &self,
        data: &[f64],
        walk: &ShapeWalk<'_>,
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let led = |by: &[f64]| -> Result<LedWalk, DenoiseError> {
            if let Some(operator) = self.decomposer.operator().weighed_by_guide(by, REACH, progress)? {
                return Ok(LedWalk { transform: shared_transform(operator, ACCURACY)?, rows: None });
            }
            let guide: Vec<[f64; 3]> = by
                .chunks_exact(self.d)
                .map(|row| std::array::from_fn(|c| row.get(c).copied().unwrap_or_default()))
                .collect();
            // The lengths of steps are not needed.
            let rows = self.decomposer.step_rows(progress)?;
            let rows = rows.weigh_by_guide(&guide, REACH, |_, _| 0.0, progress)?;
            let rows = Arc::new(rows);
            Ok(LedWalk { transform: transform(Arc::clone(&rows), ACCURACY)?, rows: Some(rows) })
        };
        let scaling_by = |led: &LedWalk, n_levels: usize| {
            let schedule = Schedule::dyadic(n_levels).expect("a few levels");
            let fits = match &led.rows {
                Some(rows) => {
                    distinct_fits(&walk.fits, |fit| fit.with_transform(&led.transform, rows, progress))?
                }
                None => Vec::new(),
            };
            self.scaling(&led.transform, &fits, data, &schedule, n_levels, progress)
        };
        let plain_schedule = Schedule::real(PLAIN_STEPS.to_vec()).expect("increasing numbers");
        let plain =
            self.scaling(walk.transform, &walk.fits, data, &plain_schedule, FIRST_MEAN_LEVEL, progress)?;
        let first = led(&plain[FIRST_GUIDE_LEVELS - 1])?;
        let second = led(&last(scaling_by(&first, GUIDE_LEVELS[0])?))?;
        let by_second = scaling_by(&second, LED_LEVELS)?;
        let third = led(&by_second[GUIDE_LEVELS[1] - 1])?;
        let by_third = scaling_by(&third, LED_LEVELS)?;
        Ok([vec![data.to_vec()], plain, by_second, by_third].concat())
    }

    /// Standard deviation of the noise, from the differences between values and the linear fits to their neighbors.
    fn noise_about_fits(
        &self,
        data: &[f64],
        fits: &[LinearTransform<'_>],
        progress: Progress<'_>,
    ) -> Result<f64, DenoiseError> {
        let neighbors = self.decomposer.step_rows(progress)?.neighbors();
        let mut channels = Vec::new();
        for (c, fit) in fits.iter().enumerate() {
            let field = channel(data, c, self.d);
            let white = white_noise(field.len(), c);
            channels.push([fit.residuals(&field, progress)?, fit.residuals(&white, progress)?]);
        }
        let differ = |field: &[f64]| self.differences(field, neighbors, progress);
        Ok(self.level_of_residuals(data, channels, neighbors, differ)?)
    }

    /// Standard deviation of the noise of each of the two numbers of a direction, from the differences between
    /// directions and those that arrive in a step.
    fn noise_of_directions(
        &self,
        data: &[f64],
        walk: &Transform,
        progress: Progress<'_>,
    ) -> Result<f64, DenoiseError> {
        let differ = |field: &[f64]| -> Result<Vec<f64>, Cancelled> {
            let mut out = vec![0.0; field.len()];
            walk.operator().difference(field, self.d, &mut out, progress)?;
            Ok(out)
        };
        let fields = vec![[differ(data)?, differ(&white_noise(data.len(), 0))?]];
        let neighbors = self.decomposer.try_neighbors(progress)?;
        Ok(self.level_of_residuals(data, fields, neighbors, differ)?)
    }

    /// Standard deviation of the noise, from the differences between values and the means of their neighbors.
    fn noise_level(&self, data: &[f64], progress: Progress<'_>) -> Result<f64, DenoiseError> {
        let neighbors = self.decomposer.try_neighbors(progress)?;
        let differ = |field: &[f64]| self.differences(field, neighbors, progress);
        let mut channels = Vec::new();
        for c in 0..self.d {
            let field = channel(data, c, self.d);
            let white = white_noise(field.len(), c);
            channels.push([differ(&field)?, differ(&white)?]);
        }
        Ok(self.level_of_residuals(data, channels, neighbors, differ)?)
    }

    /// Standard deviation of the noise from the residuals of each field and those of noise of variance 1: the ratio
    /// of their median absolute deviations. Both are replaced by their differences from the mean of the neighbors as
    /// long as this lowers the ratio: detail of the signal decays from each to the next, white noise does not. A field
    /// has one number for each vertex, or those that belong together.
    fn level_of_residuals(
        &self,
        data: &[f64],
        mut fields: Vec<[Vec<f64>; 2]>,
        neighbors: &Adjacency,
        differ: impl Fn(&[f64]) -> Result<Vec<f64>, Cancelled>,
    ) -> Result<f64, Cancelled> {
        let width = fields[0][0].len() * self.d / data.len().max(1);
        let mut least: Option<f64> = None;
        for order in 0..NOISE_ORDERS {
            if order > 0 {
                for field in fields.as_flattened_mut() {
                    *field = differ(field)?;
                }
            }
            let typical = |which: usize| {
                let fields = fields.iter().map(|fields| &fields[which]);
                let mut known: Vec<f64> = fields
                    .flat_map(|field| (0..field.len()).map(move |i| (i / width, field[i])))
                    .filter(|(x, _)| !neighbors.row(*x).is_empty() && (self.is_known)(*x))
                    .map(|(_, v)| v.abs())
                    .collect();
                (median(&mut known), known.len())
            };
            let ((found, n), (of_white, _)) = (typical(0), typical(1));
            if of_white <= 0.0 {
                break;
            }
            let level = found / of_white;
            // The least of several estimates would be too small by chance.
            let error = LEVEL_ERROR / (n as f64).sqrt();
            least = match least {
                Some(least) if level > (1.0 - error) * least => break,
                _ => Some(level),
            };
        }
        let largest = data.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        Ok(least.filter(|level| *level > ROUNDING * largest).unwrap_or(0.0))
    }

    /// Values minus the means of their known neighbors; 0 without any.
    fn differences(
        &self,
        field: &[f64],
        neighbors: &Adjacency,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        parallel::try_collect(field.len(), progress, |x| {
            let (mut sum, mut n) = (0.0, 0.0);
            for &y in neighbors.row(x).iter().filter(|y| (self.is_known)(**y as usize)) {
                sum += field[y as usize];
                n += 1.0;
            }
            if n > 0.0 && (self.is_known)(x) { field[x] - sum / n } else { 0.0 }
        })
    }
}

/// Noise of variance 1 for a channel.
fn white_noise(n: usize, channel: usize) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(SEED + channel as u64);
    (0..n).map(|_| StandardNormal.sample(&mut random)).collect()
}

/// Fits made from others, one for each; consecutive fits over the same domain share one.
fn distinct_fits<'t>(
    of: &[LinearTransform<'_>],
    make: impl Fn(&LinearTransform<'_>) -> Result<LinearTransform<'t>, Cancelled>,
) -> Result<Vec<LinearTransform<'t>>, Cancelled> {
    let mut fits: Vec<LinearTransform<'t>> = Vec::new();
    for old in of {
        let fit = match fits.last().filter(|fit| fit.domain() == old.domain()) {
            Some(fit) => fit.clone(),
            None => make(old)?,
        };
        fits.push(fit);
    }
    Ok(fits)
}

fn last(mut levels: Vec<Vec<f64>>) -> Vec<f64> {
    levels.pop().expect("a level")
}
