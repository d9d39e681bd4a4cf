//! Denoising of clouds: each point moves onto a surface fitted to its neighbors, as far as an estimate of the risk
//! allows.
//!
//! Heights of the neighbors over their plane are fitted by planes and quadrics of two sizes, with weights that fall
//! with the distance and with the residual. The first residuals are relative to the height of the point itself, so that
//! a second sheet nearby has no part in the fit. For a fit that moves points by `d` with noise σ and leverage h,
//! `d² + 2σ²h − σ²` is an unbiased estimate of its squared error (`stein1981`). The mean of this estimate over the
//! neighbors decides the share of each fit, and the share of leaving the point where it is.
//!
//! Noise larger than about half the distance of the points needs wider fits: see [`patches`]. Points in lines need
//! neighbors from several of them: see [`rows`].

mod fit;
mod lanes;
mod noise;
mod patches;
mod rows;

use super::noise_level::median;
use super::params::{CloudDenoising, Outliers, StrongNoise};
use super::{Creases, DenoiseParams};
use crate::vector::{Vector, add_scaled, dot, norm, subtract};
use crate::{Cancelled, Progress, parallel};
use fit::{FitFrame, HeightFit, Heights, RobustReach};
use noise::{FIT_SIZES, Residuals, distance, fit_residuals, noise_by_place, quantile};
use patches::Patches;
pub(in crate::denoise) use patches::noise_at_places;
pub(in crate::denoise) use rows::{NearestRows, rows_across_lines};

/// Number of nearest neighbors that fits use.
pub(super) const NEIGHBORS: usize = 48;

/// Number of neighbors of the smaller fits.
const FEW_NEIGHBORS: usize = 24;

/// Number of rings of neighbors that determine the result of a point. Patches need most: five to the center of a patch,
/// five to the others around it, and six to their points and the rows of these. The other fits need nine: one for the
/// fit, one for the risks, six for the noise there (residuals, their quantiles, a mean and three rounds of smoothing),
/// and one for the neighbors of the fits in these.
pub(super) const REACH: usize = 17;

/// Width of the weights of a fit, in distances to its last neighbor.
const WIDTH: f64 = 0.6;

/// Distances in height at which robust weights fall, in standard deviations of the noise.
const START_REACH: f64 = 2.0;
const FIT_REACH: f64 = 2.0;

/// Neighbors over which risks are averaged.
const RISK_NEIGHBORS: usize = 24;

/// Weight of the leverage in the risk; 2 is unbiased for fits that do not depend on the heights, and the robust weights
/// do.
const LEVERAGE: f64 = 3.0;

/// Risk in units of σ² at which the share of a fit is 1/e.
const TEMPERATURE: f64 = 0.3;

/// Farthest motion in standard deviations of the noise.
const FARTHEST: f64 = 3.0;

/// Longest motion, in those, that is shortened to it; points of longer ones belong to no surface and stay.
const SHORTENED: f64 = 1.5;

/// Size of a neighborhood in standard deviations of the noise below which its own axes are noise.
const LEAST_SIZE: f64 = 8.0;

/// Smallest residual of an outlier in standard deviations of the noise, and its smallest distance to its 8th neighbor
/// relative to the median of this distance among its neighbors.
const OUTLIER_RESIDUAL: f64 = 5.0;
const OUTLIER_DISTANCE: f64 = 1.8;

/// Noise from which points fill a volume: relative to the distance to the 32nd neighbor, and to the noise of the whole
/// cloud.
const VOLUME_NOISE: f64 = 0.15;
const VOLUME_RATIO: f64 = 2.5;

/// Ratio of the smallest to the largest variance of a neighborhood from which it may be a volume too: surfaces with
/// noise as large as their points are apart stay below.
const VOLUME_ISOTROPY: f64 = 0.2;

/// Ratio of the second to the largest variance of a neighborhood below which it is a line.
const LINE_RATIO: f64 = 0.05;

/// Ratio of the standard deviation of white noise on a flat surface to the one that the fits assume: the quantile by
/// which the noise is smoothed is below the median, and random deviations are taken for two sheets. Cautious fits do
/// less harm at edges.
const CAUTION: f64 = 1.13;

/// Share of the points whose noise counts no more than that of the last of the others: corners of shapes look like noise.
const NOISIEST: f64 = 0.9;

/// Interval of the true noise relative to the noise found in 9 of 10 of the generated smooth clouds and clouds with edges,
/// with noise of 0.05 to 3 spacings.
const TRUE_OF_WEAK: [f64; 2] = [0.6, 1.8];
const TRUE_OF_STRONG: [f64; 2] = [0.8, 1.4];

/// Length in units of the cloud below which squares could vanish; it counts as 0.
const NOTHING: f64 = 1e-100;

/// Number of fits.
const N_FITS: usize = 5;

/// Index of the fit of patches, which are wider than the neighbors, and the factor of its share: patches are tested
/// against the noise by all of their points, and not by the risk of a few alone.
const WIDE: usize = 4;
const WIDE_FAVOR: f64 = 128.0;

/// Noise of a cloud at each point, and the residuals from which it was estimated.
pub(super) struct CloudNoise {
    /// Standard deviation that the fits assume at each point: the noise divided by [`CAUTION`].
    pub(super) by_point: Vec<f64>,
    residuals: Vec<Residuals>,
    /// Wide fits.
    patches: Patches,
    /// True if points of patches move by these alone.
    is_strong: bool,
    /// Median of the noise, which places with much noise hardly affect.
    pub(super) typical: f64,
    /// Root mean square of the noise over the points, as it is reported.
    pub(super) overall: f64,
    /// Interval around it that holds the true one in nine of ten clouds.
    interval: [f64; 2],
}

impl CloudNoise {
    /// Estimates the noise, unless it is given; `strong` is what [`noise_at_places`] found in the whole cloud.
    pub(super) fn new(
        points: &[Vector],
        near: &NearestRows,
        given: Option<f64>,
        strong: Option<&StrongNoise>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let residuals = fit_residuals(points, near, progress)?;
        let mut by_point = match given {
            Some(noise) => vec![noise / CAUTION; points.len()],
            None => noise_by_place(points, near, &residuals, progress)?,
        };
        let patches = Patches::new(points, near, strong, &by_point, progress)?;
        if let Some(strong) = strong {
            for (level, &noise) in by_point.iter_mut().zip(&patches.noise) {
                *level = if noise > 0.0 { noise / CAUTION } else { level.max(strong.at_least / CAUTION) };
            }
        }
        let mut known: Vec<f64> =
            (0..points.len()).filter(|&x| !near.row(x).is_empty()).map(|x| by_point[x]).collect();
        let typical = CAUTION * median(&mut known);
        let most = quantile(&mut known, NOISIEST);
        let square: f64 = known.iter().map(|level| level.min(most).powi(2)).sum();
        let overall = CAUTION * (square / known.len().max(1) as f64).sqrt();
        let factors = match (given, strong) {
            (Some(_), _) => [1.0; 2],
            (None, Some(_)) => TRUE_OF_STRONG,
            (None, None) => TRUE_OF_WEAK,
        };
        let interval = factors.map(|factor| factor * overall);
        Ok(Self { typical, overall, interval, by_point, residuals, patches, is_strong: strong.is_some() })
    }

    /// Standard deviation of the noise at each point, times `unit`.
    pub(super) fn noise_at_points(&self, unit: f64) -> Vec<f64> {
        self.by_point.iter().map(|level| CAUTION * level * unit).collect()
    }
}

/// New positions of a cloud, its outliers, and information about the fits.
pub(super) struct CloudResult {
    pub(super) points: Vec<Vector>,
    /// Declared outliers.
    pub(super) outliers: Vec<u32>,
    pub(super) info: CloudDenoising,
    /// Mean share of leaving points as they are.
    pub(super) kept: f64,
}

/// Fits of a point: the motion and the leverage of each; a leverage of infinity where there is no fit.
#[derive(Clone, Copy)]
struct PointFits {
    motions: [Vector; N_FITS],
    leverages: [f64; N_FITS],
}

impl Default for PointFits {
    fn default() -> Self {
        Self { motions: [[0.0; 3]; N_FITS], leverages: [f64::INFINITY; N_FITS] }
    }
}

/// Treatment of a point.
#[derive(Clone, Copy, Default, PartialEq)]
enum PointState {
    /// The point moves by the mixture of its fits.
    #[default]
    Moved,
    /// The point stays: no surface is found, or the error of the surface would be out of range.
    Left,
    /// The point is an outlier.
    Outlier,
}

/// Motion of a point, its state, and the share of leaving it in place.
type PointOutcome = (Vector, PointState, f64);

/// Moves the points of a cloud onto its surface. `typical` is the noise of the whole cloud. O(points).
pub(super) fn denoise_points(
    points: &[Vector],
    near: &NearestRows,
    noise: &CloudNoise,
    typical: f64,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<CloudResult, Cancelled> {
    let is_patched = |x: usize| noise.is_strong && noise.patches.noise[x] > 0.0;
    let mut is_needed = vec![!noise.is_strong; points.len()];
    for x in (0..points.len()).filter(|&x| noise.is_strong && !is_patched(x)) {
        is_needed[x] = true;
        near.row(x).iter().for_each(|&y| is_needed[y as usize] = true);
    }
    let fits = parallel::try_collect(points.len(), progress, |x| {
        if !is_needed[x] {
            return PointFits::default();
        }
        let mut fits = point_fits(
            points,
            near,
            x,
            params.strength * noise.by_point[x],
            typical * params.strength,
            params.creases,
        );
        if !noise.is_strong && fits.leverages.iter().any(|h| h.is_finite()) {
            (fits.motions[WIDE], fits.leverages[WIDE]) =
                (noise.patches.motions[x], noise.patches.leverages[x]);
        }
        fits
    })?;
    let outcomes: Vec<PointOutcome> = parallel::try_collect(points.len(), progress, |x| {
        if is_outlier(points, near, noise, x) {
            let motion = match params.outliers {
                Outliers::Pull => pulled(points, near, x),
                Outliers::Keep | Outliers::Drop => [0.0; 3],
            };
            return (motion, PointState::Outlier, 1.0);
        }
        if is_patched(x) {
            let motion = noise.patches.motions[x].map(|c| c * params.strength.min(1.0));
            return (motion, PointState::Moved, 0.0);
        }
        mixed_motion(near, &fits, noise, params.strength, x)
    })?;
    let moved: Vec<Vector> = points.iter().zip(&outcomes).map(|(p, (d, ..))| add_scaled(p, 1.0, d)).collect();
    let in_state = |state| outcomes.iter().filter(move |o| o.1 == state).count();
    let outliers = (0..).zip(&outcomes).filter(|(_, o)| o.1 == PointState::Outlier).map(|(x, _)| x).collect();
    let nearest = |points: &[Vector]| {
        parallel::try_sum(points.len(), progress, |x| {
            let near = near.row(x).iter().map(|&y| distance(&points[x], &points[y as usize]));
            near.reduce(f64::min).unwrap_or(0.0)
        })
        .map(|sum| sum / points.len().max(1) as f64)
    };
    let mut levels = noise.by_point.clone();
    // Points that lie on each other have no noise but rounding.
    let rounding = f64::EPSILON * points.as_flattened().iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let mut noise_at = |share| CAUTION * quantile(&mut levels, share);
    let info = CloudDenoising {
        noise_range: [0.05, 0.95].map(|share| Some(noise_at(share)).filter(|n| *n > rounding).unwrap_or(0.0)),
        noise_interval: noise.interval,
        n_outliers: in_state(PointState::Outlier),
        n_left: in_state(PointState::Left),
        nearest_distance: [nearest(points)?, nearest(&moved)?],
        rounding: rounding_step(points),
        outliers: params.outliers,
        strong: None,
        residual_ratio: None,
        flat_share: None,
        neighbors: NEIGHBORS,
    };
    let kept = outcomes.iter().map(|o| o.2).sum::<f64>() / outcomes.len().max(1) as f64;
    Ok(CloudResult { points: moved, outliers, info, kept })
}

/// All fits of a point.
fn point_fits(
    points: &[Vector],
    near: &NearestRows,
    x: usize,
    noise: f64,
    typical: f64,
    creases: Creases,
) -> PointFits {
    let mut out = PointFits::default();
    let row = near.row(x);
    let radius = near.radius(points, x, NEIGHBORS);
    if row.len() < FIT_SIZES[0] || radius < NOTHING || noise < NOTHING {
        return out;
    }
    let frame = FitFrame::new(points, x, row, WIDTH * radius);
    let is_line = frame.variances[1] < LINE_RATIO * frame.variances[2];
    let share = noise / near.radius(points, x, FIT_SIZES[2]);
    let is_thick = share > VOLUME_NOISE || frame.variances[0] > VOLUME_ISOTROPY * frame.variances[2];
    if is_line || (is_thick && CAUTION * noise > VOLUME_RATIO * typical) {
        return out;
    }
    let reach = RobustReach { start: START_REACH * noise, fit: FIT_REACH * noise };
    let mut add = |first: usize, fits: [Option<HeightFit>; 2], frame: &FitFrame| {
        for (k, fit) in (first..).zip(fits) {
            if let Some(fit) = fit {
                (out.motions[k], out.leverages[k]) = (fit.motion(frame), fit.variance.min(1.0));
            }
        }
    };
    if creases != Creases::Keep {
        let heights = Heights::new(points, x, row, &frame, radius);
        add(0, heights.robust_fits(WIDTH, reach), &frame);
    }
    if creases != Creases::None {
        let row = &row[..row.len().min(FEW_NEIGHBORS)];
        let radius = near.radius(points, x, FEW_NEIGHBORS);
        if radius >= NOTHING {
            let is_large = LEAST_SIZE * noise < radius;
            let frame = if is_large { FitFrame::new(points, x, row, WIDTH * radius) } else { frame };
            let heights = Heights::new(points, x, row, &frame, radius);
            add(2, heights.robust_fits(WIDTH, reach), &frame);
        }
    }
    out
}

/// True for a point that is far from the surface of its neighbors and farther from them than they are from each other.
fn is_outlier(points: &[Vector], near: &NearestRows, noise: &CloudNoise, x: usize) -> bool {
    let (residuals, level) = (noise.residuals[x], noise.by_point[x]);
    if level < NOTHING || !residuals.iter().all(|r| *r > OUTLIER_RESIDUAL * level) {
        return false;
    }
    let own = near.radius(points, x, FIT_SIZES[0]);
    let mut others: Vec<f64> =
        near.row(x).iter().map(|&y| near.radius(points, y as usize, FIT_SIZES[0])).collect();
    own > OUTLIER_DISTANCE * median(&mut others)
}

/// Motion of an outlier onto the plane of its neighbors.
fn pulled(points: &[Vector], near: &NearestRows, x: usize) -> Vector {
    let row = near.row(x);
    let radius = near.radius(points, x, NEIGHBORS);
    // The neighbors as one of them sees them, so that the outlier itself does not turn the plane.
    let Some(&first) = row.first() else { return [0.0; 3] };
    let own = near.row(first as usize);
    let frame = FitFrame::new(points, first as usize, own, WIDTH * radius.max(NOTHING));
    let mut heights: Vec<f64> = row
        .iter()
        .take(FIT_SIZES[0])
        .map(|&y| dot(&frame.axes[0], &subtract(&points[y as usize], &points[x])))
        .collect();
    frame.axes[0].map(|c| c * median(&mut heights))
}

/// Mixture of the fits of a point by their risks around it.
fn mixed_motion(
    near: &NearestRows,
    fits: &[PointFits],
    noise: &CloudNoise,
    strength: f64,
    x: usize,
) -> PointOutcome {
    let level = strength * noise.by_point[x];
    if level < NOTHING {
        return ([0.0; 3], PointState::Moved, 1.0);
    }
    if fits[x].leverages.iter().all(|h| h.is_infinite()) {
        return ([0.0; 3], PointState::Left, 1.0);
    }
    let row = near.row(x);
    let around = &row[..row.len().min(RISK_NEIGHBORS)];
    let risk = |k: usize| {
        let one = |y: usize| {
            let level = strength * noise.by_point[y];
            let PointFits { motions, leverages } = &fits[y];
            if level < NOTHING || leverages[k].is_infinite() {
                return FARTHEST * FARTHEST;
            }
            let square = dot(&motions[k], &motions[k]) / (level * level);
            square.min(FARTHEST * FARTHEST) + LEVERAGE * leverages[k] - 1.0
        };
        let sum: f64 = around.iter().map(|&y| one(y as usize)).sum::<f64>() + one(x);
        (sum / (around.len() + 1) as f64).max(0.0)
    };
    let risks: [f64; N_FITS] = std::array::from_fn(risk);
    // Staying has the risk σ².
    let least = risks.iter().copied().fold(1.0, f64::min);
    let share = |risk: f64| (-(risk - least) / TEMPERATURE).exp();
    let stay = share(1.0);
    let (mut total, mut motion) = (stay, [0.0; 3]);
    for (k, &risk) in risks.iter().enumerate() {
        if fits[x].leverages[k].is_finite() {
            let share = share(risk) * if k == WIDE { WIDE_FAVOR } else { 1.0 };
            total += share;
            motion = add_scaled(&motion, share, &fits[x].motions[k]);
        }
    }
    let motion = motion.map(|c| c / total);
    // Strictly below the limit, whatever the sum of position and motion rounds to.
    let limit = FARTHEST * (1.0 - 1e-9) * noise.by_point[x] * strength.min(1.0);
    let length = norm(&motion);
    if length <= SHORTENED * limit {
        (motion.map(|c| c * (limit / length.max(limit))), PointState::Moved, stay / total)
    } else {
        ([0.0; 3], PointState::Left, 1.0)
    }
}

/// Number of coordinates from which their rounding is found.
const ROUNDING_SAMPLE: usize = 20_000;

/// Step to which coordinates are rounded, the smallest of the axes; 0 if most of them differ along an axis, as the
/// heights over a regular grid do. Axes along which all are equal do not count.
fn rounding_step(points: &[Vector]) -> f64 {
    let stride = points.len().div_ceil(ROUNDING_SAMPLE).max(1);
    let step = |axis: usize| {
        let mut values: Vec<f64> = points.iter().step_by(stride).map(|p| p[axis]).collect();
        let n = values.len();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        match values.len() {
            0 | 1 => None,
            distinct if 4 * distinct > n => Some(0.0),
            _ => Some(values.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min)),
        }
    };
    (0..3).filter_map(step).reduce(f64::min).unwrap_or_default()
}
