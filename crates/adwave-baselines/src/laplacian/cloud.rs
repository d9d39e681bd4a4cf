//! The Laplacian of a point cloud by the heat kernel.

use super::super::vector::{dot, minus};
use adwave::operator::LocalOperator;

/// `Δ|x − p|² = 4` in a plane.
const PLANE: f64 = 4.0;

/// Weights `c·A(x)A(y)exp(−‖x−y‖²/4t)` between neighbours, and masses A (Belkin, Sun & Wang, "Constructing Laplace operator
/// from point clouds in R^d", 2009; the paper's reference 34).
///
/// There c is 1/4πt² and all points are neighbours. With the nearest alone the kernel is cut off, so c is chosen such that
/// `Δ|x|² = 4` holds in the mean over the cloud, as in a plane.
pub(super) fn heat_kernel(points: &[[f64; 3]], operator: &LocalOperator) -> (Vec<(u32, u32, f64)>, Vec<f64>) {
    let mass = operator.areas.clone();
    let four_t = 4.0 * operator.time();
    let total: f64 = mass.iter().sum();
    // Masses in units of their mean: products of two could underflow.
    let mean = total / mass.len().max(1) as f64;
    let unit = if mean > 0.0 { mean } else { 1.0 };
    let mut weights = Vec::new();
    let mut moment = 0.0;
    for x in 0..points.len() {
        for &y in operator.neighbours.of(x).iter().filter(|&&y| y as usize > x) {
            let d = minus(&points[x], &points[y as usize]);
            let squared = if four_t > 0.0 { dot(&d, &d) / four_t } else { 0.0 };
            let weight = mass[x] / unit * (mass[y as usize] / unit) * (-squared).exp();
            weights.push((x as u32, y, weight));
            moment += 2.0 * weight * squared;
        }
    }
    let c = if moment > 0.0 && four_t > 0.0 { PLANE * (total / four_t) / moment } else { 1.0 };
    weights.iter_mut().for_each(|e| e.2 *= c);
    (weights, mass)
}
