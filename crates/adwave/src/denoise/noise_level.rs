//! Estimate of the noise level of a surface.

use super::surface::NoisySurface;
use super::{FAR, SEED};
use crate::parallel;
use crate::vector::{add_scaled, dot, unit};
use crate::{Cancelled, Progress};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// Number of lazy steps that smooth a surface to obtain the normals along which noise is measured.
const STEPS_BEFORE: usize = 4;

/// Number of successive differences from the mean of the neighbors.
const ORDERS: usize = 3;

/// Quantile of absolute differences that measures the noise of the noisiest places.
const HIGH: f64 = 0.95;

/// Number of means over a point and its neighbors for the noise at a place.
const LOCAL_STEPS: usize = 6;

/// Largest noise at a place, relative to the typical one: more is shape.
const MOST_LOCAL: f64 = 3.0;

/// Number of means over a point and its neighbors for noise that differs from place to place.
const STEPS_BY_PLACE: usize = 12;

/// Mean absolute value of a standard normal variable.
const MEAN_OF_ABSOLUTE: f64 = 0.797_884_560_802_865_4;

/// Standard deviations of the noise along the normals that different quantiles of the differences suggest; they agree
/// for noise that is the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NoiseLevels {
    /// Standard deviation by the median.
    pub(super) typical: f64,
    /// Standard deviation by the 95 % quantile.
    pub(super) high: f64,
}

/// Standard deviations of the noise along the normals, independent between points, in the units of `points`.
/// O(points).
///
/// Each is the smallest of three estimates: quantiles of the absolute deviations of `n·(p − mean of its neighbors)`, of
/// the difference of that from the mean of its neighbors, and of the difference of this, each divided by its value for
/// noise of variance 1. Curvature adds to them, to the later ones less. Detail that the points barely resolve
/// counts as noise; noise that neighbors share does not. The result is 0 if no point has neighbors.
pub(super) fn noise_levels(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<NoiseLevels, Cancelled> {
    let mut heights = surface.heights_over_neighbors(points, progress)?;
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let white: Vec<f64> = points.iter().map(|_| StandardNormal.sample(&mut random)).collect();
    let mut white = surface.difference(&white, progress)?;
    let has_neighbors = |x: usize| !surface.ring.row(x).is_empty();
    let mut least = [f64::INFINITY; 2];
    for order in 0..ORDERS {
        if order > 0 {
            heights = surface.difference(&heights, progress)?;
            white = surface.difference(&white, progress)?;
        }
        let deviations = |values: &[f64]| {
            let mut known: Vec<f64> =
                (0..values.len()).filter(|&x| has_neighbors(x)).map(|x| values[x]).collect();
            let center = median(&mut known);
            for v in &mut known {
                *v = (*v - center).abs();
            }
            [median(&mut known), quantile(&mut known, HIGH)]
        };
        let (found, of_white) = (deviations(&heights), deviations(&white));
        for ((least, found), of_white) in least.iter_mut().zip(found).zip(of_white) {
            if of_white > 0.0 {
                *least = least.min(found / of_white);
            }
        }
    }
    let [typical, high] = least.map(|level| if level.is_finite() { level } else { 0.0 });
    Ok(NoiseLevels { typical, high })
}

impl NoisySurface {
    /// Distance that each point moves at most: three times the noise there.
    pub(super) fn most_moved(
        &self,
        points: &[[f64; 3]],
        noise: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let local = self.local_noise(points, noise, progress)?;
        Ok(local.into_iter().map(|level| FAR * level).collect())
    }

    /// Heights of the points over the means of their neighbors, along the normals of the smoothed surface.
    fn heights_over_neighbors(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let smooth = self.smoothed(points, STEPS_BEFORE, progress)?;
        let normals = point_normals(self, &smooth, progress)?;
        parallel::try_collect(points.len(), progress, |x| -dot(&normals[x], &self.umbrella(points, x)))
    }

    /// Standard deviation of the noise along the normals at each point, at least `noise` and at most [`MOST_LOCAL`]
    /// times that: means over some rings of the absolute heights over the neighbors, which are `√(1 + 1/n)·√(2/π)` for
    /// white noise of variance 1 and n neighbors. O(points).
    fn local_noise(
        &self,
        points: &[[f64; 3]],
        noise: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let mut levels = self.heights_over_neighbors(points, progress)?;
        for (x, level) in levels.iter_mut().enumerate() {
            let n_neighbors = self.ring.row(x).len().max(1) as f64;
            *level = level.abs() / ((1.0 + 1.0 / n_neighbors).sqrt() * MEAN_OF_ABSOLUTE);
        }
        for _ in 0..LOCAL_STEPS {
            levels = self.means(&levels, progress)?;
        }
        Ok(levels.into_iter().map(|level| level.max(noise).min(MOST_LOCAL * noise)).collect())
    }

    /// Standard deviation of the noise along the normals at each point: means over some rings of the absolute
    /// differences of third order, to which shape adds least. Also the ratio of its 90 % to its 10 % quantile, divided
    /// by that ratio for white noise which is the same everywhere. O(points).
    pub(super) fn noise_by_place(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, f64), Cancelled> {
        let mut heights = self.heights_over_neighbors(points, progress)?;
        let mut random = Pcg64Mcg::seed_from_u64(SEED);
        let white: Vec<f64> = points.iter().map(|_| StandardNormal.sample(&mut random)).collect();
        let mut white = self.difference(&white, progress)?;
        for _ in 1..ORDERS {
            heights = self.difference(&heights, progress)?;
            white = self.difference(&white, progress)?;
        }
        let local = |values: &[f64]| {
            let mut levels: Vec<f64> = values.iter().map(|v| v.abs()).collect();
            for _ in 0..STEPS_BY_PLACE {
                levels = self.means(&levels, progress)?;
            }
            let mut sorted = levels.clone();
            let [low, middle, high] = [0.1, 0.5, 0.9].map(|share| quantile(&mut sorted, share));
            Ok::<_, Cancelled>((levels, middle, if low > 0.0 { high / low } else { 1.0 }))
        };
        let (mut levels, _, spread) = local(&heights)?;
        let (_, of_white, spread_of_white) = local(&white)?;
        if of_white > 0.0 {
            for level in &mut levels {
                *level /= of_white;
            }
        }
        Ok((levels, spread / spread_of_white))
    }

    /// Means over each point and its neighbors.
    pub(super) fn means(&self, values: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        parallel::try_collect(values.len(), progress, |x| {
            let near = self.ring.row(x);
            let sum: f64 = near.iter().map(|&y| values[y as usize]).sum();
            (values[x] + sum) / (near.len() + 1) as f64
        })
    }

    /// Values minus the mean over their neighbors.
    fn difference(&self, values: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        parallel::try_collect(values.len(), progress, |x| {
            let near = self.ring.row(x);
            let sum: f64 = near.iter().map(|&y| values[y as usize]).sum();
            values[x] - sum / near.len().max(1) as f64
        })
    }
}

/// Unit normals of the points.
pub(super) fn point_normals(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let normals = surface.normals(points, progress)?;
    let areas = surface.areas(points, progress)?;
    parallel::try_collect(points.len(), progress, |x| {
        let sum = surface
            .at_vertex
            .row(x)
            .iter()
            .fold([0.0; 3], |sum, &t| add_scaled(&sum, areas[t as usize], &normals[t as usize]));
        unit(&sum).unwrap_or_default()
    })
}

/// Upper median; 0 for no values.
pub(super) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// Value that a share of the values is below; 0 for no values.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((share * values.len() as f64) as usize).min(values.len() - 1);
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
