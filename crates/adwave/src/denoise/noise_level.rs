//! How large the noise of a surface is.

use super::surface::{Kind, Surface};
use crate::parallel;
use crate::vector::{add_scaled, dot, unit};
use crate::{Cancelled, Progress};

/// Lazy steps by which a surface is smoothed for the normals along which noise is measured.
const STEPS_BEFORE: usize = 4;

/// The standard deviation of a normal variable is its median absolute deviation over this.
const MEDIAN_DEVIATION: f64 = 0.674_489_750_196_081_7;

/// The standard deviation of noise along the normals, independent from point to point, in the units of `points`: from the median
/// absolute deviation of `n·(p − mean of its neighbours)`, which noise of variance σ² gives the variance `σ²·(1 + 1/k)` at a point of
/// k neighbours. O(points).
///
/// Curvature counts as noise where the points do not resolve it, and noise that neighbours share does not. 0 without points
/// that have neighbours.
pub(super) fn noise_level(
    surface: &Surface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let smooth = surface.smoothed(points, STEPS_BEFORE, progress)?;
    let normals = point_normals(surface, &smooth, progress)?;
    let heights = parallel::try_collect(points.len(), progress, |x| {
        let n_near = surface.ring.of(x).len();
        if n_near == 0 {
            return f64::NAN;
        }
        dot(&normals[x], &surface.umbrella(points, x)) / (1.0 + 1.0 / n_near as f64).sqrt()
    })?;
    let mut heights: Vec<f64> = heights.into_iter().filter(|h| h.is_finite()).collect();
    let centre = median(&mut heights);
    for h in &mut heights {
        *h = (*h - centre).abs();
    }
    Ok(median(&mut heights) / MEDIAN_DEVIATION)
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
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
