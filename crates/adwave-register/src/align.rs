//! Alignment: the motion that brings one shape closest to another.

use crate::{ClosestPoint, ClosestPointSearch, Motion};
use adwave::vector::{cross, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// Options of an alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AlignParams {
    /// Largest number of points of the moving shape, sampled evenly in their order.
    pub max_points: usize,
    /// Largest number of rounds.
    pub max_rounds: usize,
    /// True to fit a similarity, with a change of size, instead of a rigid motion. The scale stays within a factor of
    /// [`MAX_GROWTH`] of the scale of the start.
    pub scaled: bool,
    /// Distance from the surface, in model units, up to which points take part in the first round. It shrinks from
    /// round to round until the median distance decides; with 0 the median distance decides from the first round. It
    /// should be the distance between the shapes at the start, so that small parts that differ, such as the bumps of a
    /// ball, do not turn the shape.
    pub reach: f64,
}

impl AlignParams {
    /// Sets [`scaled`](Self::scaled).
    #[must_use]
    pub fn with_scaled(self, scaled: bool) -> Self {
        Self { scaled, ..self }
    }
}

impl Default for AlignParams {
    fn default() -> Self {
        Self { max_points: 20_000, max_rounds: 100, scaled: false, reach: 0.0 }
    }
}

/// Diagnostics of an alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignInfo {
    /// Number of rounds.
    pub rounds: usize,
    /// Median distance of the points whose closest point is not on a border, in model units; NaN if there is none.
    pub median: f64,
    /// Share of the sampled points whose closest point is not on a border, in [0, 1].
    pub overlap: f64,
}

/// Tukey's constant, for which the fit has 95 % of the efficiency of least squares on normal errors.
const TUKEY: f64 = 4.685;
/// Ratio of standard deviation to median absolute deviation of normal errors.
const MAD: f64 = 1.4826;
/// Residual caused by rounding, relative to the size of the shape.
const ROUNDING: f64 = 1e-9;
/// Largest change of the scale of a similarity, as a factor.
pub const MAX_GROWTH: f64 = 1.5;
/// Factor by which the reach shrinks in a round.
const SHRINKING: f64 = 0.7;
/// Factor by which the reach shrinks after a round that moved little.
const FAST_SHRINKING: f64 = 0.2;
/// Movement of a round, relative to the residual, below which the iteration ends.
const MIN_PROGRESS: f64 = 0.01;

/// Finds the rigid motion of `points` that brings them closest to `surface`; with [`AlignParams::scaled`] a similarity.
///
/// The iteration begins at `start`. Each round finds the closest points c with normals n, then the small motion that
/// minimizes `Σ w·(n·(p − c))²`. The weights w are Tukey's, so that differences between the shapes do not tilt the fit.
/// Points whose closest point lies on a border are ignored. Components of the motion that the points do not determine,
/// such as the rotation of a sphere, stay unchanged. O(rounds × points × log n).
///
/// Source: `chen1992`.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub fn align(
    points: &[[f64; 3]],
    surface: &ClosestPointSearch,
    start: Motion,
    params: &AlignParams,
    progress: Progress<'_>,
) -> Result<(Motion, AlignInfo), Cancelled> {
    let step = points.len().div_ceil(params.max_points.max(1)).max(1);
    let used: Vec<[f64; 3]> = points.iter().step_by(step).copied().collect();
    // The unit of rotation and growth is the size of the moved shape: with the size of a shape a thousand times as
    // large or as small, either these components or the translation would seem undetermined.
    let size = start.scale() * half_extent(&used);
    let mut motion = start;
    let (mut rounds, mut reach) = (0, params.reach);
    while rounds < params.max_rounds {
        progress.check()?;
        rounds += 1;
        let moved: Vec<[f64; 3]> = used.iter().map(|p| motion.apply(p)).collect();
        let Some(Round { motion: small, movement, residual }) =
            align_round(&moved, surface, size, reach, params.scaled)
        else {
            break;
        };
        let growth = motion.scale() * small.scale() / start.scale();
        if !(1.0 / MAX_GROWTH..=MAX_GROWTH).contains(&growth) {
            break;
        }
        motion = motion.then(&small);
        if movement < (ROUNDING * size).max(MIN_PROGRESS * residual) && reach <= TUKEY * MAD * residual {
            break;
        }
        reach *= if movement < MIN_PROGRESS * reach { FAST_SHRINKING } else { SHRINKING };
    }
    let moved: Vec<[f64; 3]> = used.iter().map(|p| motion.apply(p)).collect();
    let mut distances: Vec<f64> =
        interior_pairs(&moved, surface).map(|(p, c)| norm(&subtract(&p, &c.point))).collect();
    let overlap = distances.len() as f64 / used.len().max(1) as f64;
    Ok((motion, AlignInfo { rounds, median: median(&mut distances), overlap }))
}

/// Half the diagonal of the bounding box of some points.
fn half_extent(points: &[[f64; 3]]) -> f64 {
    adwave::shape::diagonal(points) / 2.0
}

/// Pairs points with their closest points, and leaves out those whose closest point is on a border or has no normal.
fn interior_pairs<'a>(
    moved: &'a [[f64; 3]],
    surface: &'a ClosestPointSearch,
) -> impl Iterator<Item = ([f64; 3], ClosestPoint)> + use<'a> {
    let closest: Vec<ClosestPoint> = moved.par_iter().map(|p| surface.closest(p)).collect();
    moved.iter().copied().zip(closest).filter(|(_, closest)| !closest.is_border && closest.normal != [0.0; 3])
}

/// Result of one round.
struct Round {
    motion: Motion,
    /// Movement of a point at the rim, in model units.
    movement: f64,
    /// Median distance from the tangent planes before the round, in model units.
    residual: f64,
}

/// Performs one round; `None` if fewer than six points have a closest point, or if the shape has no extent.
fn align_round(
    moved: &[[f64; 3]],
    surface: &ClosestPointSearch,
    size: f64,
    reach: f64,
    scaled: bool,
) -> Option<Round> {
    let pairs: Vec<([f64; 3], ClosestPoint)> = interior_pairs(moved, surface).collect();
    if pairs.len() < 6 || size <= 0.0 {
        return None;
    }
    let center = {
        let sum = pairs.iter().fold([0.0; 3], |sum, (p, _)| std::array::from_fn(|k| sum[k] + p[k]));
        sum.map(|c| c / pairs.len() as f64)
    };
    let residual = |(p, c): &([f64; 3], ClosestPoint)| dot(&subtract(p, &c.point), &c.normal);
    let mut absolute: Vec<f64> = pairs.iter().map(|pair| residual(pair).abs()).collect();
    let typical = median(&mut absolute);
    let width = (TUKEY * MAD * typical).max(reach).max(ROUNDING * size);
    let (mut a, mut b) = (SMatrix::<f64, 7, 7>::zeros(), SVector::<f64, 7>::zeros());
    for pair in &pairs {
        let r = residual(pair);
        let share = 1.0 - (r / width).powi(2);
        if share <= 0.0 {
            continue;
        }
        // Rotation and growth are scaled by the size, so that all unknowns are lengths.
        let arm = subtract(&pair.0, &center).map(|c| c / size);
        let (turn, n) = (cross(&arm, &pair.1.normal), pair.1.normal);
        let growth = if scaled { dot(&arm, &n) } else { 0.0 };
        let row = SVector::from([turn[0], turn[1], turn[2], n[0], n[1], n[2], growth]);
        let weight = share * share;
        a += weight * row * row.transpose();
        b -= weight * r * row;
    }
    // Undetermined components have eigenvalues far below the largest and are left out.
    let eigen = a.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut x = SVector::<f64, 7>::zeros();
    for k in 0..7 {
        if eigen.eigenvalues[k] > 1e-6 * largest {
            let v = eigen.eigenvectors.column(k);
            x += v * (v.dot(&b) / eigen.eigenvalues[k]);
        }
    }
    let (turn, shift) = ([x[0], x[1], x[2]].map(|c| c / size), [x[3], x[4], x[5]]);
    let about = Motion::new(turn, [0.0; 3]).scaled_by(1.0 + x[6] / size);
    let back = about.apply(&center);
    let translation = std::array::from_fn(|k| center[k] - back[k] + shift[k]);
    let movement = size * norm(&turn) + norm(&shift) + x[6].abs();
    let motion = about.then(&Motion::new([0.0; 3], translation));
    movement.is_finite().then_some(Round { motion, movement, residual: typical })
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
