//! The rigid motion that brings one shape closest to another.

use crate::{Closest, Motion, Surface};
use adwave::vector::{cross, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// How a fit is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignParams {
    /// Points of the moving shape that are used at most, evenly taken from its order.
    pub most_points: usize,
    /// Rounds at most.
    pub most_rounds: usize,
    /// Whether the size may change too.
    pub scaled: bool,
}

impl Default for AlignParams {
    fn default() -> Self {
        Self { most_points: 20_000, most_rounds: 100, scaled: false }
    }
}

/// How a fit came out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignInfo {
    /// Rounds that were taken.
    pub rounds: usize,
    /// Median distance of the points that have a closest point off the border, in model units; NaN when none has.
    pub median: f64,
    /// Share of the points that have one, in [0, 1].
    pub overlap: f64,
}

/// Tukey's constant: 95 % of the efficiency of least squares on normal errors.
const TUKEY: f64 = 4.685;
/// From the median of absolute values of normal errors to their standard deviation.
const MAD: f64 = 1.4826;
/// Residuals, as a share of the size of the shape, that are rounding.
const ROUNDING: f64 = 1e-9;
/// A round that moves less than this part of what is left changes nothing any more.
const STILL: f64 = 0.01;

/// The rigid motion of `points` (with [`AlignParams::scaled`] the similarity) that brings them closest to `surface`, begun at `start`: in each
/// round the closest points, then the small motion with the least `Σ w·(n·(p − c))²`, n the normal at the closest point c, and w Tukey's weights, so that what differs between
/// the shapes does not tilt the fit. Points whose closest lies on a border have none. O(rounds × points × log n).
///
/// A part of the motion that no point speaks for (the turn of a sphere) stays as it was.
///
/// Source: `chen1992`.
///
/// # Errors
/// [`Cancelled`].
pub fn align(
    points: &[[f64; 3]],
    surface: &Surface,
    start: Motion,
    params: &AlignParams,
    progress: Progress<'_>,
) -> Result<(Motion, AlignInfo), Cancelled> {
    let step = points.len().div_ceil(params.most_points.max(1)).max(1);
    let used: Vec<[f64; 3]> = points.iter().step_by(step).copied().collect();
    let size = size(&used);
    let mut motion = start;
    let mut rounds = 0;
    while rounds < params.most_rounds {
        progress.check()?;
        rounds += 1;
        let moved: Vec<[f64; 3]> = used.iter().map(|p| motion.apply(p)).collect();
        let Some(Round { small, moves, residual }) = round(&moved, surface, size, params.scaled) else {
            break;
        };
        motion = motion.then(&small);
        if moves < (ROUNDING * size).max(STILL * residual) {
            break;
        }
    }
    let moved: Vec<[f64; 3]> = used.iter().map(|p| motion.apply(p)).collect();
    let mut distances: Vec<f64> =
        inner(&moved, surface).map(|(p, c)| norm(&subtract(&p, &c.point))).collect();
    let overlap = distances.len() as f64 / used.len().max(1) as f64;
    Ok((motion, AlignInfo { rounds, median: median(&mut distances), overlap }))
}

/// Half the extent of the points.
fn size(points: &[[f64; 3]]) -> f64 {
    adwave::shape::diagonal(points) / 2.0
}

/// The points that have a closest point off the border, with it.
fn inner<'a>(
    moved: &'a [[f64; 3]],
    surface: &'a Surface,
) -> impl Iterator<Item = ([f64; 3], Closest)> + use<'a> {
    let found: Vec<Closest> = moved.par_iter().map(|p| surface.closest(p)).collect();
    moved.iter().copied().zip(found).filter(|(_, closest)| !closest.is_border && closest.normal != [0.0; 3])
}

/// What one round found.
struct Round {
    small: Motion,
    /// How far it moves a point at the rim.
    moves: f64,
    /// Median distance from the tangent planes before.
    residual: f64,
}

/// One round.
fn round(moved: &[[f64; 3]], surface: &Surface, size: f64, scaled: bool) -> Option<Round> {
    let found: Vec<([f64; 3], Closest)> = inner(moved, surface).collect();
    if found.len() < 6 || size <= 0.0 {
        return None;
    }
    let center = {
        let sum = found.iter().fold([0.0; 3], |sum, (p, _)| std::array::from_fn(|k| sum[k] + p[k]));
        sum.map(|c| c / found.len() as f64)
    };
    let residual = |(p, c): &([f64; 3], Closest)| dot(&subtract(p, &c.point), &c.normal);
    let mut absolute: Vec<f64> = found.iter().map(|pair| residual(pair).abs()).collect();
    let typical = median(&mut absolute);
    let width = (TUKEY * MAD * typical).max(ROUNDING * size);
    let (mut a, mut b) = (SMatrix::<f64, 7, 7>::zeros(), SVector::<f64, 7>::zeros());
    for pair in &found {
        let r = residual(pair);
        let share = 1.0 - (r / width).powi(2);
        if share <= 0.0 {
            continue;
        }
        // Turns and growth in units of the size, so that the unknowns are lengths alike.
        let arm = subtract(&pair.0, &center).map(|c| c / size);
        let (turn, n) = (cross(&arm, &pair.1.normal), pair.1.normal);
        let growth = if scaled { dot(&arm, &n) } else { 0.0 };
        let row = SVector::from([turn[0], turn[1], turn[2], n[0], n[1], n[2], growth]);
        let weight = share * share;
        a += weight * row * row.transpose();
        b -= weight * r * row;
    }
    // What no point speaks for stays: eigenvalues far below the largest are left out.
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
    let moves = size * norm(&turn) + norm(&shift) + x[6].abs();
    let small = about.then(&Motion::new([0.0; 3], translation));
    moves.is_finite().then_some(Round { small, moves, residual: typical })
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
