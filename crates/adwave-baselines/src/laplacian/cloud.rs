//! Laplacian of a point cloud from the heat kernel.

use adwave::operator::LocalOperator;
use adwave::vector::{dot, subtract};

/// Laplacian `Δ|x − p|²` of the squared distance in a plane.
const PLANE: f64 = 4.0;

/// Computes the weights `c·A(x)A(y)exp(−‖x−y‖²/4t)` between neighbors, and the masses A (`belkin2009`).
///
/// In the paper c is 1/4πt² and all points are neighbors. With only the nearest neighbors the kernel is cut off, so c
/// is chosen such that `Δ|x − p|² = 4` holds at the median point p, as in a plane. An isolated point has the mass 1.
pub(super) fn heat_kernel(points: &[[f64; 3]], operator: &LocalOperator) -> (Vec<(u32, u32, f64)>, Vec<f64>) {
    let mut mass = operator.areas().to_vec();
    let four_t = 4.0 * operator.time();
    // Masses in units of their mean: products of two could underflow.
    let mut unit = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    if unit <= 0.0 {
        mass.fill(1.0);
        unit = 1.0;
    }
    let mut weights = Vec::new();
    let mut moment = vec![0.0; points.len()];
    for x in 0..points.len() {
        for &y in operator.neighbors().row(x).iter().filter(|&&y| y as usize > x) {
            let d = subtract(&points[x], &points[y as usize]);
            let squared = if four_t > 0.0 { dot(&d, &d) / four_t } else { 0.0 };
            let weight = mass[x] / unit * (mass[y as usize] / unit) * (-squared).exp();
            weights.push((x as u32, y, weight));
            moment[x] += weight * squared;
            moment[y as usize] += weight * squared;
        }
    }
    let mut ratios: Vec<f64> = moment
        .iter()
        .zip(&mass)
        .filter(|&(&m, &a)| m > 0.0 && a > 0.0)
        .map(|(m, a)| m / (a / four_t))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let c = ratios.get(ratios.len() / 2).map_or(1.0, |median| PLANE / median);
    for e in &mut weights {
        e.2 *= c;
    }
    (weights, mass)
}
