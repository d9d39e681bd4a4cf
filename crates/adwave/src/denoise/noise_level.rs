//! How large the noise of a surface is.

use super::SEED;
use super::surface::{Kind, Surface};
use crate::parallel;
use crate::vector::{add_scaled, dot, unit};
use crate::{Cancelled, Progress};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// Lazy steps by which a surface is smoothed for the normals along which noise is measured.
const STEPS_BEFORE: usize = 4;

/// Differences with the mean of the neighbors that are taken, one after the other.
const ORDERS: usize = 3;

/// The standard deviation of noise along the normals, independent from point to point, in the units of `points`. O(points).
///
/// From the median absolute deviation of `n·(p − mean of its neighbors)`, of the difference of that with the mean of its neighbors,
/// and of the difference of this, each over what it is for noise of variance 1; the least of the three, since curvature adds to them,
/// to the later less. Detail that the points hardly resolve counts as noise, and noise that neighbors share does not.
/// 0 without points that have neighbors.
pub(super) fn noise_level(
    surface: &Surface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let smooth = surface.smoothed(points, STEPS_BEFORE, progress)?;
    let normals = point_normals(surface, &smooth, progress)?;
    let mut heights =
        parallel::try_collect(points.len(), progress, |x| -dot(&normals[x], &surface.umbrella(points, x)))?;
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let white: Vec<f64> = points.iter().map(|_| StandardNormal.sample(&mut random)).collect();
    let mut white = surface.difference(&white, progress)?;
    let has_neighbors = |x: usize| !surface.ring.of(x).is_empty();
    let mut least = f64::INFINITY;
    for order in 0..ORDERS {
        if order > 0 {
            heights = surface.difference(&heights, progress)?;
            white = surface.difference(&white, progress)?;
        }
        let deviation = |values: &[f64]| {
            let mut known: Vec<f64> =
                (0..values.len()).filter(|&x| has_neighbors(x)).map(|x| values[x]).collect();
            let center = median(&mut known);
            for v in &mut known {
                *v = (*v - center).abs();
            }
            median(&mut known)
        };
        let of_white = deviation(&white);
        if of_white > 0.0 {
            least = least.min(deviation(&heights) / of_white);
        }
    }
    Ok(if least.is_finite() { least } else { 0.0 })
}

impl Surface {
    /// Values less the mean of their neighbors'.
    fn difference(&self, values: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        parallel::try_collect(values.len(), progress, |x| {
            let near = self.ring.of(x);
            let sum: f64 = near.iter().map(|&y| values[y as usize]).sum();
            values[x] - sum / near.len().max(1) as f64
        })
    }
}

/// Unit normals of the points.
fn point_normals(
    surface: &Surface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let normals = surface.normals(points, progress)?;
    let Kind::Mesh { at_vertex, .. } = &surface.kind else { return Ok(normals) };
    let areas = surface.areas(points, progress)?;
    parallel::try_collect(points.len(), progress, |x| {
        let sum = at_vertex
            .of(x)
            .iter()
            .fold([0.0; 3], |sum, &t| add_scaled(&sum, areas[t as usize], &normals[t as usize]));
        unit(&sum).unwrap_or_default()
    })
}

/// The upper median; 0 of nothing.
pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
