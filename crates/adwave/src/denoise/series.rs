//! Denoising of a series of frames in space and time together.

use super::risk::Risk;
use super::scaling::with_accuracy;
use super::signal::{ACCURACY, ChannelGroup, channel};
use super::{DenoiseError, DenoiseParams, NoiseModel, SEED};
use crate::bands::{Schedule, Transform};
use crate::time::{TimeAxis, TimeError};
use crate::{Decomposer, Progress, parallel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

/// Steps in space of the estimates.
const STEPS: [f64; 6] = [1.0, 2.0, 5.0, 12.0, 30.0, 75.0];

/// First of [`STEPS`], from 0, that also smooths without regard to slopes: over many steps a local linear fit keeps more
/// noise than a mean.
const FIRST_MEAN: usize = 2;

/// Largest width in time relative to the length of the series; what is slower stays together.
const SLOWEST: f64 = 0.25;

/// Width in time relative to the length of the series at which nothing but the mean over all frames is left.
const MEAN: f64 = 8.0;

/// Frames in which the noise is measured.
const NOISE_FRAMES: usize = 9;

/// Random fields that measure how much noise an estimate keeps: on the domain, and along time.
const PROBES: [usize; 2] = [4, 256];

/// Values from which the mixture is chosen; the places are spread evenly.
const VALUES: usize = 400_000;

/// Fewest places from which the mixture is chosen.
const FEWEST_PLACES: usize = 64;

/// Values of the result that are computed together.
const VALUES_TOGETHER: usize = 1 << 20;

/// Assumed noise of a series, and the mixture that replaced it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SeriesNoise {
    /// Standard deviation of the noise of a value, estimated or given.
    pub noise: f64,
    /// Widths σ of the bands along time, in its unit. Two bands follow: what changes more slowly, and the mean over all
    /// frames.
    pub widths: Vec<f64>,
    /// Numbers of steps in space of the estimates.
    pub steps: Vec<f64>,
    /// Numbers of steps of further estimates, which are means, if those of `steps` are about a local linear fit.
    pub mean_steps: Vec<f64>,
    /// For each band along time: its weight as it is, after each of `steps` and of `mean_steps`, and left out.
    pub weights: Vec<Vec<f64>>,
    /// Expected mean square error of a value, before and after.
    pub risk: [f64; 2],
}

/// A series after [`denoise_series`].
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedSeries {
    /// New values, places × frames × components; masked vertices keep theirs.
    pub values: Vec<f64>,
    /// Assumed noise and operations.
    pub info: SeriesNoise,
}

/// Removes noise from a series of frames (n_vertices × frames × n_components, the last index fastest, in the order of the
/// shape) on anything that has bands. O(entries × values).
///
/// The series is split into bands along time, of 1, 2, 4, … frames up to a quarter of its length, what is slower, and the
/// mean over all frames. Each band is replaced by a mixture of itself, of what 1, 2, 5, 12, 30 and 75 steps in space make
/// of it, and of nothing, with weights ≥ 0 of sum 1. The steps are about a local linear fit, and from 5 steps on also about
/// a mean; `params` may ask for means alone. All weights together minimize the mean square error by Stein's estimate for
/// Gaussian noise that is independent between places and frames. So what is steady keeps its detail in space, and what
/// moves is averaged over what moves alike. The noise is estimated from the differences of frames from the mean of the
/// frames before and after, unless it is given.
///
/// ```
/// use adwave::denoise::{DenoiseParams, denoise_series};
/// use adwave::grid::Grid;
/// use adwave::time::TimeAxis;
/// use adwave::{Decomposer, Progress};
/// let grid = Grid::new(&[20, 20], &[1.0, 1.0])?;
/// let decomposer = Decomposer::from_domain(grid.clone(), grid.heat())?;
/// // A wave that runs over the places, with noise.
/// let mut state = 1_u32;
/// let mut random = || {
///     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
///     f64::from(state) / f64::from(u32::MAX) - 0.5
/// };
/// let wave = |x: usize, t: usize| (0.2 * (x % 20) as f64 + 0.1 * t as f64).cos() * (0.2 * (x / 20) as f64).sin();
/// let truth: Vec<f64> = (0..400 * 60).map(|i| wave(i / 60, i % 60)).collect();
/// let noisy: Vec<f64> = truth.iter().map(|m| m + random()).collect();
/// let (axis, params) = (TimeAxis::new(60, 1.0)?, DenoiseParams::default());
/// let clean = denoise_series(&decomposer, &axis, &noisy, 1, &params, Progress::none())?;
/// let error = |f: &[f64]| f.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
/// assert!(error(&clean.values) < 0.05 * error(&noisy));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DenoiseError`] for a series of the wrong length or with a value that is not finite at a vertex that is not masked, a
/// parameter out of its range, noise that depends on the values, or if the call is cancelled.
pub fn denoise_series(
    decomposer: &Decomposer,
    axis: &TimeAxis,
    series: &[f64],
    n_components: usize,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<DenoisedSeries, DenoiseError> {
    params.check()?;
    if params.noise_model != NoiseModel::Gaussian {
        return Err(DenoiseError::NotInTime { model: params.noise_model });
    }
    if decomposer.operator().channels_at_place() > 1 {
        return Err(DenoiseError::Directions);
    }
    let (n_frames, map) = (axis.n_frames(), decomposer.vertex_map());
    let row = n_frames * n_components;
    let expected = decomposer.n_vertices() * row;
    if row == 0 || series.len() != expected {
        return Err(DenoiseError::SignalLength { found: series.len(), expected });
    }
    let masked = decomposer.mask_flags();
    let is_known = |x: usize| masked.is_none_or(|masked| !masked[x]);
    let is_wrong = |i: &usize| !series[*i].is_finite() && is_known(map.welded(*i / row));
    if let Some(at) = (0..series.len()).find(is_wrong) {
        return Err(DenoiseError::NotFinite { vertex: at / row, value: series[at] });
    }
    let filled: Vec<f64> = series.iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect();
    let welded = map.try_mean(&filled, row, progress)?;
    let parts = SeriesParts {
        decomposer,
        axis,
        n_components,
        is_known: &is_known,
        is_linear: decomposer.applied_local_fit(params.local_fit) == crate::local_fit::LocalFit::Linear,
        walk: with_accuracy(decomposer.transform(), ACCURACY)?,
        widths: widths(axis),
    };
    let noise = match params.noise {
        Some(noise) => vec![noise; n_components],
        None => parts.noise(&welded, progress)?,
    };
    let variance = noise.iter().map(|noise| noise * noise).sum::<f64>() / n_components as f64;
    let mut info = SeriesNoise { noise: variance.sqrt(), steps: STEPS.to_vec(), ..SeriesNoise::default() };
    if variance * params.strength == 0.0 {
        return Ok(DenoisedSeries { values: series.to_vec(), info });
    }
    let levels = parts.levels(&welded, progress)?;
    let assumed = variance * params.strength * params.strength;
    let (weights, risk) = parts.best_weights(&welded, &levels, assumed, progress)?;
    let found = parts.mixture(&welded, &levels, &weights, progress)?;
    let mut values = series.to_vec();
    parallel::try_visit_rows(&mut values, row, 1 << 6, progress, |first, rows| {
        for (v, row_values) in rows.chunks_exact_mut(row).enumerate() {
            let x = map.welded(first + v);
            let at = x * row..(x + 1) * row;
            for ((value, new), old) in row_values.iter_mut().zip(&found[at.clone()]).zip(&welded[at]) {
                if is_known(x) {
                    *value += new - old;
                }
            }
        }
    })?;
    if parts.is_linear {
        info.mean_steps = STEPS[FIRST_MEAN..].to_vec();
    }
    info.widths = parts.widths[..parts.widths.len() - 1].to_vec();
    (info.weights, info.risk) = (weights, risk);
    Ok(DenoisedSeries { values, info })
}

/// Widths in time of the bands: 1, 2, 4, … frames, and one that leaves the mean alone.
fn widths(axis: &TimeAxis) -> Vec<f64> {
    let (step, n) = (axis.step(), axis.n_frames() as f64);
    let frames = std::iter::successors(Some(1.0), |frames| Some(2.0 * frames));
    frames.take_while(|frames| *frames <= SLOWEST * n).chain([MEAN * n]).map(|f| f * step).collect()
}

/// A series with all that its estimates need.
struct SeriesParts<'a> {
    decomposer: &'a Decomposer,
    axis: &'a TimeAxis,
    n_components: usize,
    is_known: &'a (dyn Fn(usize) -> bool + Sync),
    is_linear: bool,
    walk: Transform,
    /// Widths σ of the bands along time.
    widths: Vec<f64>,
}

impl SeriesParts<'_> {
    fn row(&self) -> usize {
        self.axis.n_frames() * self.n_components
    }

    /// One channel on the domain.
    fn group(&self, field: &[f64]) -> ChannelGroup<'_> {
        let domains = self.is_linear.then(|| vec![self.decomposer.fit_domain(field)]);
        ChannelGroup { decomposer: self.decomposer, d: 1, is_known: self.is_known, domains }
    }

    /// Standard deviation of the noise of each component, from some frames together, which are compared with as many fields
    /// of noise of variance 1: one for all would give its own error to every frame.
    fn noise(&self, series: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, DenoiseError> {
        let (n_frames, d, row) = (self.axis.n_frames(), self.n_components, self.row());
        let between = n_frames.saturating_sub(2).max(1);
        let n_measured = NOISE_FRAMES.min(between);
        let mut noise = Vec::with_capacity(d);
        for c in 0..d {
            let differences = parallel::try_collect(series.len() / row * n_measured, progress, |i| {
                let (x, k) = (i / n_measured, i % n_measured);
                let at = (2 * k + 1) * between / (2 * n_measured);
                let value = |t: usize| series[x * row + t * d + c];
                // The difference has the variance of the noise.
                match n_frames {
                    2 => (value(1) - value(0)) / 2.0_f64.sqrt(),
                    _ => (value(at + 1) - 0.5 * (value(at) + value(at + 2))) / 1.5_f64.sqrt(),
                }
            })?;
            let domain = |k: usize| self.decomposer.fit_domain(&channel(&differences, k, n_measured));
            let domains = self.is_linear.then(|| (0..n_measured).map(domain).collect());
            let (decomposer, is_known) = (self.decomposer, self.is_known);
            let frames = ChannelGroup { decomposer, d: n_measured, is_known, domains };
            noise.push(frames.level(&differences, &self.walk, progress.quiet())?);
        }
        Ok(noise)
    }

    /// The series after each of [`STEPS`], and by means after the last of them.
    fn levels(&self, series: &[f64], progress: Progress<'_>) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let schedule = Schedule::real(STEPS.to_vec()).expect("increasing numbers");
        if !self.is_linear {
            let walk = &self.walk;
            return super::scaling::scaling_functions(walk, series, self.row(), &schedule, progress);
        }
        let row = self.row();
        let mut levels: Vec<Vec<f64>> = Vec::new();
        for c in 0..row {
            progress.step(c as u64, row as u64)?;
            let field = channel(series, c, row);
            let found = self.smoothed(&field, &schedule, progress.quiet())?;
            levels.resize_with(found.len(), || vec![0.0; series.len()]);
            for (level, found) in levels.iter_mut().zip(found) {
                level.iter_mut().skip(c).step_by(row).zip(found).for_each(|(value, s)| *value = s);
            }
        }
        progress.step(row as u64, row as u64)?;
        Ok(levels)
    }

    /// A field of one channel after the steps of a schedule, and by means after the last of them.
    fn smoothed(
        &self,
        field: &[f64],
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let group = self.group(field);
        let fits = group.fits(&self.walk, progress)?;
        group.scaling(&self.walk, &fits, field, schedule, FIRST_MEAN, progress)
    }

    /// Shares of the variance of noise that the estimates keep in common with it: of each level in space, 1 for none, and
    /// of each band along time.
    fn shares(&self, n_places: usize, progress: Progress<'_>) -> Result<[Vec<f64>; 2], DenoiseError> {
        let [n_fields, n_rows] = PROBES;
        let mut random = Pcg64Mcg::seed_from_u64(SEED);
        let mut normal =
            |n: usize| -> Vec<f64> { (0..n).map(|_| StandardNormal.sample(&mut random)).collect() };
        let schedule = Schedule::real(STEPS.to_vec()).expect("increasing numbers");
        let (mut in_space, mut square) = (Vec::new(), 0.0);
        for _ in 0..n_fields {
            let mut field = normal(n_places);
            for (x, value) in field.iter_mut().enumerate() {
                if !(self.is_known)(x) {
                    *value = 0.0;
                }
            }
            square += field.iter().map(|v| v * v).sum::<f64>();
            let levels = self.smoothed(&field, &schedule, progress.quiet())?;
            in_space.resize(levels.len(), 0.0);
            for (share, level) in in_space.iter_mut().zip(&levels) {
                *share += field.iter().zip(level).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        let in_space = std::iter::once(1.0).chain(in_space.iter().map(|share| share / square)).collect();
        let rows = normal(n_rows * self.axis.n_frames());
        let square: f64 = rows.iter().map(|v| v * v).sum();
        let bands = self.axis.bands(&rows, 1, &self.widths, progress.quiet()).map_err(failed)?;
        let along = |band: &Vec<f64>| rows.iter().zip(band).map(|(a, b)| a * b).sum::<f64>() / square;
        Ok([in_space, bands.iter().map(along).collect()])
    }

    /// For each band along time the weights of its estimates, those of least risk for noise of this variance, and the
    /// risk of a value before and after.
    fn best_weights(
        &self,
        series: &[f64],
        levels: &[Vec<f64>],
        variance: f64,
        progress: Progress<'_>,
    ) -> Result<(Vec<Vec<f64>>, [f64; 2]), DenoiseError> {
        let row = self.row();
        let n_places = series.len() / row;
        let known: Vec<usize> = (0..n_places).filter(|x| (self.is_known)(*x)).collect();
        let n_taken = known.len().min((VALUES / row).max(FEWEST_PLACES));
        let places: Vec<usize> = (0..n_taken).map(|k| known[k * known.len() / n_taken]).collect();
        let taken = |level: &[f64]| -> Vec<f64> {
            places.iter().flat_map(|x| &level[x * row..(x + 1) * row]).copied().collect()
        };
        let data = taken(series);
        // Estimates by level in space, then by band.
        let mut by_level = vec![self.bands(&data, progress)?];
        for level in levels {
            by_level.push(self.bands(&taken(level), progress)?);
        }
        let [in_space, in_time] = self.shares(n_places, progress)?;
        // A band as it is, its levels, and nothing.
        let n_choices = levels.len() + 2;
        let n_estimates = in_time.len() * n_choices;
        let estimate = |k: usize| by_level.get(k % n_choices).map(|bands| &bands[k / n_choices][..]);
        let dot = |a: &[f64], b: &[f64]| {
            parallel::try_sum(a.len(), progress, |i| a[i] * b[i]).map(|sum| sum / data.len().max(1) as f64)
        };
        let mut gram = vec![vec![0.0; n_estimates]; n_estimates];
        let mut toward = vec![0.0; n_estimates];
        for k in 0..n_estimates {
            let Some(f) = estimate(k) else { continue };
            let kept = variance * in_space[k % n_choices] * in_time[k / n_choices];
            toward[k] = dot(f, &data)? - kept;
            for (l, g) in (0..=k).filter_map(|l| Some((l, estimate(l)?))) {
                gram[k][l] = dot(f, g)?;
                gram[l][k] = gram[k][l];
            }
        }
        let truth = (dot(&data, &data)? - variance).max(0.0);
        let risk = Risk::from_products(gram, toward);
        let weights = risk.best_in_blocks(n_choices);
        let after = (truth + risk.known_risk(&weights)).max(0.0);
        Ok((weights.chunks(n_choices).map(<[f64]>::to_vec).collect(), [variance, after]))
    }

    fn bands(&self, rows: &[f64], progress: Progress<'_>) -> Result<Vec<Vec<f64>>, DenoiseError> {
        self.axis.bands(rows, self.n_components, &self.widths, progress.quiet()).map_err(failed)
    }

    /// The sum of all estimates by their weights.
    fn mixture(
        &self,
        series: &[f64],
        levels: &[Vec<f64>],
        weights: &[Vec<f64>],
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, DenoiseError> {
        let row = self.row();
        let together = (VALUES_TOGETHER / row).max(1) * row;
        let mut sum = vec![0.0; series.len()];
        let levels = std::iter::once(series).chain(levels.iter().map(Vec::as_slice));
        for (j, level) in levels.enumerate().filter(|(j, _)| weights.iter().any(|band| band[*j] > 0.0)) {
            for (out, rows) in sum.chunks_mut(together).zip(level.chunks(together)) {
                let bands = self.bands(rows, progress)?;
                for (band, weights) in bands.iter().zip(weights).filter(|(_, weights)| weights[j] > 0.0) {
                    out.iter_mut().zip(band).for_each(|(out, value)| *out += weights[j] * value);
                }
            }
        }
        Ok(sum)
    }
}

/// The axis and its widths fit each other; what is left is a call that was cancelled.
fn failed(error: TimeError) -> DenoiseError {
    match error {
        TimeError::Cancelled(cancelled) => cancelled.into(),
        other => unreachable!("{other}"),
    }
}
