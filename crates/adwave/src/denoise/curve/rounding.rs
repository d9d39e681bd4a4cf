//! Rounded coordinates of a curve.
//!
//! Heights in steps of a meter are equal over many vertices, so that neighbors predict each other exactly; that does not
//! prove that they are exact. Rounding changes a coordinate by up to half a step, evenly spread.

use super::chains::Chain;

/// Standard deviation of the changes by rounding to steps of 1, 1/√12.
const ROUNDED: f64 = 0.288_675_134_594_812_9;

/// Deviation of a difference of two coordinates from a multiple of the step, in steps, up to which it is one.
const TOLERANCE: f64 = 0.01;

/// Smallest number of changes from which rounding is distinguished from lines between the points of a lattice.
const FEWEST: usize = 6;

/// Largest share of the changes of a rounded coordinate that continue in the same direction at the next edge, where it
/// changes slowly.
const CONTINUED: f64 = 0.25;

/// Smallest share of the vertices at which a rounded coordinate bends, where it changes fast.
const BENDS: f64 = 0.2;

/// Smallest share of these bends that are not larger than a step.
const SMALL_BENDS: f64 = 0.75;

/// Step to which the coordinates along each axis are rounded; 0 where none is found, or where a coordinate changes as on
/// lines between the points of a lattice, which are exact.
pub(super) fn rounding_steps(chains: &[Chain], points: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let step = lattice_step(points.iter().map(|p| p[axis]).collect());
        if step > 0.0 && is_rounded(chains, points, axis, step) { step } else { 0.0 }
    })
}

/// Noise that rounding to a step adds.
pub(super) fn rounding_noise(step: f64) -> f64 {
    ROUNDED * step
}

/// Smallest difference of values, if all others are its multiples; else 0.
fn lattice_step(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let gaps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let step = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |gap: &f64| (gap / step - (gap / step).round()).abs() <= TOLERANCE;
    if !gaps.is_empty() && gaps.iter().all(is_multiple) { step } else { 0.0 }
}

/// True if the coordinate along an axis changes by single steps between equal values, or bends by a step at many
/// vertices.
fn is_rounded(chains: &[Chain], points: &[[f64; 3]], axis: usize, step: f64) -> bool {
    let (mut n_changes, mut n_continued) = (0_usize, 0_usize);
    let (mut n_vertices, mut n_bends, mut n_small) = (0_usize, 0_usize, 0_usize);
    for chain in chains {
        let values: Vec<f64> = chain.vertices.iter().map(|&x| points[x as usize][axis]).collect();
        let changes: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
        let steps = |change: f64| (change / step).round().abs();
        n_changes += changes.iter().filter(|d| steps(**d) > 0.0).count();
        n_continued += changes.windows(2).filter(|w| w[0] * w[1] > 0.0).count();
        n_vertices += changes.len().saturating_sub(1);
        n_bends += changes.windows(2).filter(|w| steps(w[1] - w[0]) > 0.0).count();
        n_small += changes.windows(2).filter(|w| steps(w[1] - w[0]) == 1.0).count();
    }
    let is_slow = n_continued as f64 <= CONTINUED * n_changes as f64;
    let is_jagged =
        n_bends as f64 >= BENDS * n_vertices as f64 && n_small as f64 >= SMALL_BENDS * n_bends as f64;
    n_changes >= FEWEST && (is_slow || is_jagged)
}
