//! Features of the values of an image or a volume, independent of its noise.
//!
//! Independent noise is known on every level from the kernel of heat, so that the finest levels tell its size around each
//! place. A feature exceeds by many times what that noise can cause, and all places around it by a part of its height: an
//! edge, whose band is as large along it as at its extrema, is none. Levels are compared by contrast, the response less
//! the median over a ring: a wide hill raises the responses of all of them, the more the coarser they are, and its ring
//! with them.

use super::best::select_spread_by;
use super::refine::{TangentNeighborhood, edge_ratio, parabola_peak};
use super::response::ResponseLevel;
use super::surface::without_side_lobes;
use super::{Feature, FeatureError, FeatureParams, Refinement};
use crate::bands::Wavelets;
use crate::grid::{Grid, MAX_AXES, NoiseMeasure, NoisePatches};
use crate::{Decomposer, Progress, parallel};
use std::borrow::Cow;

/// Least response and contrast of a feature, in standard deviations due to noise.
const SIGNIFICANT: f64 = 8.0;

/// Least difference between a feature and the largest response around it, in standard deviations due to noise.
const SIGNIFICANT_DROP: f64 = 5.5;

/// Radius at which a feature is compared with its surroundings, in σ_j.
const AROUND: f64 = 1.25;

/// Radius of the middle of the ring over which contrast is measured, and half of its width, in σ_j.
const RING: [f64; 2] = [2.0, 0.5];

/// Distance between the places of a ring along each axis, in σ_j, if they are closer; more of them tell no more.
const SPACING: f64 = 0.25;

/// Least difference from the largest response around, relative to the feature, and its increase for places as far apart
/// as σ_j: places are squares, so that the edge of a shape rises and falls along it. It falls with the square of σ_j.
const DROP: [f64; 2] = [0.25, 0.5];

/// Distance from a border in σ_j up to which there are no features: a border reflects the values, so that a slope has a
/// crease there.
const BORDER: f64 = 1.0;

/// Number of the finest dyadic levels by which noise is measured: neighbors that share it up to 2 places apart make it
/// seem smaller on finer ones.
const NOISE_LEVELS: usize = 4;

/// Width, in the finest spacing, up to which a level measures noise: that of the last of those levels.
const WIDEST_OF_NOISE: f64 = 2.9;

/// Number of levels from one that measures noise to the one that tells its background, for one, two and three axes. The
/// further one has less of the noise that neighbors share, and more of what is no background, above all in a volume:
/// there a coarser level has less noise.
const TO_BACKGROUND: [usize; MAX_AXES] = [2, 2, 1];

/// Standard deviation of values that are rounded, in steps.
const ROUNDED: f64 = 0.289;

/// Width σ_j of the level on which a Gaussian blob has its largest contrast, in standard deviations of the blob, for one,
/// two and three axes. With u = σ²/2 its response at the distance r is `g(u/2) − g(u)` with
/// `g(v) = (1 + v)^(−d/2) e^(−r²/(2 + 2v))`.
const WIDTH_OF_BLOB: [f64; MAX_AXES] = [1.903, 1.587, 1.357];

/// Relative difference of responses that are equal.
const TIE: f64 = 1e-9;

/// Number of places that a thread processes at a time.
const PLACES_AT_A_TIME: usize = 1 << 12;

/// Finds the significant features of the values of a grid; see [`features`](super::features).
pub(super) fn grid_features(
    decomposer: &Decomposer,
    grid: &Grid,
    wavelets: &Wavelets,
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<Vec<Feature>, FeatureError> {
    let n_levels = wavelets.n_levels();
    let levels: Vec<_> = (1..=n_levels).map(|j| wavelets.level_norms(j)).collect();
    let largest =
        levels.iter().map(|level| parallel::max(level.len(), 0.0, |x| level[x].abs())).fold(0.0, f64::max);
    let border_sigmas = params.border_sigmas.unwrap_or(BORDER);
    let from_border = decomposer.distance_from_border(border_sigmas * wavelets.sigma[n_levels], progress)?;
    let search = SpotSearch {
        grid,
        masked: decomposer.mask_flags(),
        noise: noise(grid, &levels, &wavelets.sigma, decomposer.domain().spacings()[0]),
        least: wavelets.info.error_bound.max(f64::EPSILON) * largest / SIGNIFICANT,
        params,
    };
    let mut found = Vec::new();
    for j in 2..n_levels {
        progress.step(j as u64 - 2, n_levels as u64 - 2)?;
        let sigma = [wavelets.sigma[j - 1], wavelets.sigma[j], wavelets.sigma[j + 1]];
        let level = ThreeLevels {
            levels: [&levels[j - 2], &levels[j - 1], &levels[j]],
            sigma,
            of_noise: deviation_of_noise(grid, &[(1.0, sigma[0]), (-1.0, sigma[1])]),
            around: grid.shell(AROUND * sigma[1], 0.0, 0.0),
            rings: sigma.map(|sigma| grid.shell(RING[0] * sigma, RING[1] * sigma, SPACING * sigma)),
        };
        let reach = border_sigmas * wavelets.sigma[j];
        let here = level.levels[1];
        let candidates = parallel::try_map_chunks(
            here.len(),
            PLACES_AT_A_TIME,
            progress,
            || (),
            |(), range| {
                let inside = range.filter(|&x| from_border[x] > reach);
                inside.filter_map(|x| search.candidate(x, &level, decomposer)).collect::<Vec<Feature>>()
            },
        )?;
        found.extend(candidates.into_iter().flatten().map(|feature| Feature { level: j, ..feature }));
    }
    let places: Vec<[f64; 3]> = found.iter().map(|feature| grid.position(feature.vertex)).collect();
    let mut features = without_side_lobes(&found, &places, progress.quiet())?;
    features.sort_by(|a, b| {
        a.level.cmp(&b.level).then(b.strength.total_cmp(&a.strength)).then(a.vertex.cmp(&b.vertex))
    });
    if let Some(best) = params.best {
        features = select_spread_by(&features, best, |feature| feature.response.abs());
    }
    Ok(features)
}

/// Noise by the finest levels, each less so much of a coarser one that where values bend evenly nothing is left: there a
/// response is proportional to the difference of the squared widths of its level. `sigma` are the widths of the levels
/// after that of the signal, and `finest` is the finest spacing, all in model units.
fn noise(grid: &Grid, levels: &[Cow<'_, [f64]>], sigma: &[f64], finest: f64) -> NoisePatches {
    let n_levels = levels.len();
    let to_background = TO_BACKGROUND[grid.n_long_axes().clamp(1, MAX_AXES) - 1];
    let difference = |k: usize| sigma[k].powi(2) - sigma[k - 1].powi(2);
    let measure = |k: usize| {
        let coarser = (k + to_background).min(n_levels);
        let share = difference(k) / difference(coarser);
        let heats =
            [(1.0, sigma[k - 1]), (-1.0, sigma[k]), (-share, sigma[coarser - 1]), (share, sigma[coarser])];
        let deviation = deviation_of_noise(grid, &heats);
        NoiseMeasure { level: &levels[k - 1], background: &levels[coarser - 1], share, deviation }
    };
    let n_measured = sigma[1..].iter().take_while(|sigma| **sigma <= WIDEST_OF_NOISE * finest).count();
    let measures: Vec<NoiseMeasure<'_>> =
        (1..=n_measured.clamp(1, NOISE_LEVELS.min(n_levels - 1))).map(measure).collect();
    grid.noise(&measures)
}

/// Standard deviation of independent noise of variance 1 in a sum of heats, each with its factor and its width σ: the
/// square root of `Σ_p Σ_q c_p c_q K(σ_p² + σ_q²)` with K(σ²) the share of a unit that heat of width σ leaves at its place.
fn deviation_of_noise(grid: &Grid, heats: &[(f64, f64)]) -> f64 {
    let pairs = heats.iter().flat_map(|p| heats.iter().map(move |q| (p, q)));
    let variance: f64 = pairs.map(|((c, a), (d, b))| c * d * grid.own_share(a * a + b * b)).sum();
    variance.max(0.0).sqrt()
}

/// A level with those beside it.
struct ThreeLevels<'a> {
    /// Responses of the level before, of this one and of the next.
    levels: [&'a [f64]; 3],
    /// Widths of these levels in model units.
    sigma: [f64; 3],
    /// Standard deviation of noise of variance 1.
    of_noise: f64,
    /// Steps to the places with which a feature is compared.
    around: Vec<[isize; MAX_AXES]>,
    /// Steps to the places of the ring of each level.
    rings: [Vec<[isize; MAX_AXES]>; 3],
}

struct SpotSearch<'a> {
    grid: &'a Grid,
    /// Places that are left out.
    masked: Option<&'a [bool]>,
    noise: NoisePatches,
    /// Error of the bands, in units of the response.
    least: f64,
    params: &'a FeatureParams,
}

impl SpotSearch<'_> {
    /// The neighbors of a place along the axes.
    fn neighbors(&self, x: usize) -> impl Iterator<Item = usize> + '_ {
        self.grid.sides(x).filter(|&y| self.masked.is_none_or(|masked| !masked[y]))
    }

    /// The feature at a place, if it is significant.
    fn candidate(&self, x: usize, level: &ThreeLevels<'_>, decomposer: &Decomposer) -> Option<Feature> {
        let here = level.levels[1];
        let response = here[x];
        // Most places fall below the least deviation of all, or are no peaks.
        if response.is_nan() || response.abs() <= SIGNIFICANT * self.least {
            return None;
        }
        let sign = response.signum();
        let height = response.abs();
        let tie = TIE * height;
        let is_below = |y: usize| {
            let difference = height - sign * here[y];
            y == x || difference > tie || (difference >= -tie && x < y)
        };
        let is_peak =
            self.neighbors(x).all(is_below) && self.neighbors(x).all(|y| self.neighbors(y).all(is_below));
        let deviation = self.deviation(x, level);
        if !is_peak || height <= SIGNIFICANT * deviation {
            return None;
        }
        let around = level.around.iter().filter_map(|step| self.grid.place_at(x, step));
        let largest =
            around.map(|y| sign * here[y]).filter(|r| !r.is_nan()).fold(f64::NEG_INFINITY, f64::max);
        let spacings = (self.grid.coarsest() / level.sigma[1]).min(1.0);
        let least = (DROP[0] + DROP[1] * spacings * spacings) * height;
        if height - largest <= least.max(SIGNIFICANT_DROP * deviation) {
            return None;
        }
        let contrast = self.contrast(x, level, 1)?;
        let contrasts =
            [self.contrast(x, level, 0)?, contrast, self.contrast(x, level, 2)?].map(|c| sign * c);
        let [finer, height, coarser] = contrasts;
        if height <= SIGNIFICANT * deviation || finer >= height - tie || coarser > height + tie {
            return None;
        }
        let n_axes = self.grid.n_long_axes().clamp(1, MAX_AXES);
        let mut feature = Feature {
            vertex: x,
            position: Some(self.grid.position(x)),
            level: 0,
            sigma: parabola_peak(level.sigma, contrasts) / WIDTH_OF_BLOB[n_axes - 1],
            response: contrast,
            strength: height / deviation,
            channel: None,
        };
        if let Some(most) = self.params.max_edge_ratio {
            let mut neighbors: Vec<u32> = self.neighbors(x).map(|y| y as u32).collect();
            neighbors.sort_unstable();
            neighbors.dedup();
            let local = TangentNeighborhood::new(decomposer, &neighbors, x);
            if edge_ratio(&local, &ResponseLevel::plain(here)).is_none_or(|ratio| ratio > most) {
                return None;
            }
        }
        if self.params.refinement == Refinement::Quadratic {
            feature.position = Some(self.grid.position_at(self.refined(x, here)));
        }
        Some(feature)
    }

    /// The response at a place less the median over the ring around it, on one of three levels; `None` if the ring has no
    /// values.
    fn contrast(&self, x: usize, three: &ThreeLevels<'_>, which: usize) -> Option<f64> {
        let level = three.levels[which];
        let places = three.rings[which].iter().filter_map(|step| self.grid.place_at(x, step));
        let mut around: Vec<f64> = places.map(|y| level[y]).filter(|r| !r.is_nan()).collect();
        let middle = around.len() / 2;
        (!around.is_empty()).then(|| level[x] - *around.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Standard deviation of the response at a place due to noise, to rounded values and to the error of the bands. Noise
    /// of half a step spreads the error of rounding evenly over all widths; without it, that error is the same at
    /// neighbors.
    fn deviation(&self, x: usize, level: &ThreeLevels<'_>) -> f64 {
        let noise = self.noise.deviation_at(x);
        let step = self.params.value_step.unwrap_or(0.0);
        let rounded = if noise < 0.5 * step { ROUNDED * step } else { 0.0 };
        (noise * level.of_noise).max(rounded).max(self.least)
    }

    /// The place of the maximum of a parabola along each axis, in places.
    fn refined(&self, x: usize, here: &[f64]) -> [f64; MAX_AXES] {
        let at = self.grid.coordinates(x);
        std::array::from_fn(|axis| {
            let side = |step: isize| {
                let mut steps = [0; MAX_AXES];
                steps[axis] = step;
                self.grid.place_at(x, &steps).map_or(f64::NAN, |y| here[y])
            };
            let (before, after) = (side(-1), side(1));
            let shift = 0.5 * (before - after) / (before - 2.0 * here[x] + after);
            at[axis] + if shift.is_finite() { shift.clamp(-0.5, 0.5) } else { 0.0 }
        })
    }
}

/// Step to which values are rounded: the smallest difference that they have often, and 0 for values that are not finite.
///
/// The first percent of the differences between successive values of up to 100,000 of them in ascending order. For values
/// with fractions it is far below their noise.
///
/// ```
/// use adwave::features::value_step;
/// let counts: Vec<f64> = (0..1000).map(|i| 2.0 * f64::from(i * 7919 % 50)).collect();
/// assert_eq!(value_step(&counts), 2.0);
/// ```
pub fn value_step(values: &[f64]) -> f64 {
    const MOST: usize = 100_000;
    let stride = values.len().div_ceil(MOST).max(1);
    let mut sorted: Vec<f64> = values.iter().copied().step_by(stride).filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut gaps: Vec<f64> =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > 0.0).collect();
    if gaps.is_empty() {
        return 0.0;
    }
    let first = gaps.len() / 100;
    *gaps.select_nth_unstable_by(first, f64::total_cmp).1
}
