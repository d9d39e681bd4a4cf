//! Heat and wave kernel signatures: descriptors of a vertex from the spectrum.
//!
//! Source: `sun2009`, `aubry2011`. Both are invariant under bending. They describe the surroundings of a vertex;
//! unlike bands they cannot be edited.

use crate::harmonics::Harmonics;
use rayon::prelude::*;

/// Number 4 ln 10: at the shortest time the last harmonic has the weight 1e-4.
const FOUR_LN_10: f64 = 4.0 * std::f64::consts::LN_10;

/// Signatures of all vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    /// Times t (squared model units) of the heat kernel, or energies ln λ of the wave kernel.
    pub scales: Vec<f64>,
    /// Values of the signature, n_vertices × scales, row-major, in the order of the shape.
    pub values: Vec<f64>,
}

/// First and last nonzero eigenvalue; `None` if there are fewer than two.
fn range(harmonics: &Harmonics) -> Option<(f64, f64)> {
    let last = *harmonics.values.last()?;
    let first = *harmonics.values.iter().find(|&&v| v > 1e-9 * last)?;
    (first < last).then_some((first, last))
}

/// Computes times from `4 ln 10 / λ_last` to `4 ln 10 / λ_1`, in squared model units, equally spaced in the logarithm,
/// as in `sun2009`. Empty if there are fewer than two nonzero eigenvalues.
pub fn heat_times(harmonics: &Harmonics, n_times: usize) -> Vec<f64> {
    let Some((first, last)) = range(harmonics) else { return Vec::new() };
    let (from, to) = ((FOUR_LN_10 / last).ln(), (FOUR_LN_10 / first).ln());
    (0..n_times).map(|i| (from + (to - from) * i as f64 / (n_times.max(2) - 1) as f64).exp()).collect()
}

/// Computes `HKS(x, t) = Σ_k e^(−λ_k t) φ_k(x)²`, in 1 / squared model units: the fraction of heat that stays at x.
/// O(n·k·times).
///
/// ```
/// use adwave::{Progress, shape::{Graph, Shape}};
/// use adwave_baselines::{harmonics::Harmonics, signature::heat_kernel_signature};
/// use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
/// let edge = Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?);
/// let laplacian = LaplacianMatrices::new(&edge, &LaplacianParams::default())?;
/// let harmonics = Harmonics::new(&laplacian, 2, &Default::default(), Progress::none())?;
/// let signature = heat_kernel_signature(&harmonics, &[1.0]);
/// assert!((signature.values[0] - 0.5 * (1.0 + f64::exp(-2.0))).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn heat_kernel_signature(harmonics: &Harmonics, times: &[f64]) -> Signature {
    weighted_squares(harmonics, times, |lambda, t| (-lambda * t).exp(), |_| 1.0)
}

/// Computes `WKS(x, e) = Σ_k φ_k(x)² exp(−(e − ln λ_k)²/2σ²) / Σ_k exp(−(e − ln λ_k)²/2σ²)` at `n_energies` energies
/// from `ln λ_1 + 2σ` to `ln λ_last − 2σ`, both included, where `σ` is seven times their spacing. O(n·k·energies).
pub fn wave_kernel_signature(harmonics: &Harmonics, n_energies: usize) -> Signature {
    const SIGMA: f64 = 7.0;
    let Some((first, last)) = range(harmonics) else {
        return Signature { scales: Vec::new(), values: Vec::new() };
    };
    let step = (last.ln() - first.ln()) / (n_energies.saturating_sub(1) as f64 + 4.0 * SIGMA);
    let sigma = SIGMA * step;
    let energies: Vec<f64> = (0..n_energies).map(|i| first.ln() + 2.0 * sigma + step * i as f64).collect();
    let weight = |lambda: f64, e: f64| {
        if lambda < first { 0.0 } else { (-(e - lambda.ln()).powi(2) / (2.0 * sigma * sigma)).exp() }
    };
    let total = |e: f64| harmonics.values.iter().map(|&lambda| weight(lambda, e)).sum::<f64>();
    weighted_squares(harmonics, &energies, weight, |e| 1.0 / total(e))
}

fn weighted_squares(
    harmonics: &Harmonics,
    scales: &[f64],
    weight: impl Fn(f64, f64) -> f64,
    factor: impl Fn(f64) -> f64,
) -> Signature {
    let n = harmonics.mass.len();
    let weights: Vec<Vec<f64>> = harmonics
        .values
        .iter()
        .map(|&lambda| scales.iter().map(|&s| weight(lambda, s) * factor(s)).collect())
        .collect();
    let mut values = vec![0.0; n * scales.len()];
    if scales.is_empty() {
        return Signature { scales: Vec::new(), values };
    }
    values.par_chunks_exact_mut(scales.len()).enumerate().for_each(|(x, row)| {
        for (k, weights) in weights.iter().enumerate() {
            let square = harmonics.functions[k * n + x].powi(2);
            for (value, w) in row.iter_mut().zip(weights) {
                *value += w * square;
            }
        }
    });
    Signature { scales: scales.to_vec(), values: harmonics.scatter(&values, scales.len()) }
}
