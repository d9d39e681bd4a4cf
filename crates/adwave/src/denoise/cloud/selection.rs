//! Choice among the fits of a point by their estimated errors there and around it.

use super::{N_FITS, N_ROBUST, NOTHING, NearestRows, PointFits, PointOutcome, PointState};
use crate::vector::{Vector, add_scaled, dot, norm};

/// Number of nearest neighbors whose motions are averaged: their noise cancels, and what the fits have in common, the
/// bias, stays.
const SHARED_NEIGHBORS: usize = 8;

/// Number of nearest neighbors over which errors are averaged, once for the errors at a place and twice for those around
/// it.
pub(super) const RISK_NEIGHBORS: usize = 24;

/// Largest squared length of a motion, in units of σ².
const MOST_ENERGY: f64 = 36.0;

/// Factor of the leverage of the robust fits: their weights depend on the noise too.
const ROBUST_LEVERAGE: f64 = 1.5;

/// Deviation of the mean squared length of the motions from its expectation that random noise causes, in units of σ²,
/// at a place and around it.
const ENERGY_MARGIN_HERE: f64 = 0.5;
const ENERGY_MARGIN_AROUND: f64 = 0.2;

/// Differences between the risk at a place and the risk around it that random noise causes: a larger risk at the place
/// counts from the first, a smaller one from the second.
const MORE_HERE: f64 = 0.1;
const LESS_HERE: f64 = 0.05;

/// Risk in units of σ² at which the share of a fit is 1/e.
const TEMPERATURE: f64 = 0.03;

/// Factor of the farthest motion up to which a longer one is shortened: Gaussian noise is hardly ever larger.
const TAIL: f64 = 1.5;

/// Errors of the fits at a point, or their means over points, in units of σ². The leverage is infinite without a fit.
#[derive(Clone, Copy)]
pub(super) struct FitErrors {
    /// Squared length of the motion; for white noise and without bias 1 − leverage.
    energy: [f32; N_FITS],
    /// Squared length of the mean motion of the nearest points, less its expectation for white noise.
    bias: [f32; N_FITS],
    leverage: [f32; N_FITS],
}

impl Default for FitErrors {
    fn default() -> Self {
        Self { energy: [0.0; N_FITS], bias: [0.0; N_FITS], leverage: [f32::INFINITY; N_FITS] }
    }
}

impl FitErrors {
    /// Errors at point `x`, where the noise is `level`.
    pub(super) fn new(near: &NearestRows, fits: &[PointFits], level: f64, x: usize) -> Self {
        let mut out = Self::default();
        if level < NOTHING {
            return out;
        }
        let row = near.row(x);
        let square = |d: &Vector| dot(d, d) / (level * level);
        for k in (0..N_FITS).filter(|&k| fits[x].leverages[k].is_finite()) {
            let (own, leverage) = (&fits[x].motions[k], fits[x].leverages[k]);
            let (mut n, mut sum) = (1.0, *own);
            for fit in row.iter().take(SHARED_NEIGHBORS).map(|&y| &fits[y as usize]) {
                if fit.leverages[k].is_finite() {
                    n += 1.0;
                    sum = add_scaled(&sum, 1.0, &fit.motions[k]);
                }
            }
            out.energy[k] = square(own).min(MOST_ENERGY) as f32;
            out.bias[k] = (square(&sum) / (n * n) - (1.0 - leverage) / n).min(MOST_ENERGY) as f32;
            out.leverage[k] = leverage as f32;
        }
        out
    }

    /// Mean over a point and its nearest neighbors, for each fit over those that have it.
    pub(super) fn mean(near: &NearestRows, errors: &[Self], x: usize) -> Self {
        let mut out = Self::default();
        let (mut sums, mut counts) = ([[0.0_f32; 3]; N_FITS], [0.0_f32; N_FITS]);
        for y in near.row(x).iter().take(RISK_NEIGHBORS).map(|&y| y as usize).chain([x]) {
            let Self { energy, bias, leverage } = &errors[y];
            for k in 0..N_FITS {
                if leverage[k].is_finite() {
                    counts[k] += 1.0;
                    for (sum, value) in sums[k].iter_mut().zip([energy[k], bias[k], leverage[k]]) {
                        *sum += value;
                    }
                }
            }
        }
        for k in (0..N_FITS).filter(|&k| counts[k] > 0.0) {
            [out.energy[k], out.bias[k], out.leverage[k]] = sums[k].map(|sum| sum / counts[k]);
        }
        out
    }

    /// Risk of fit `k` in units of σ²: its variance, its bias, and what the energy of the motions lacks or has too much.
    /// A fit that follows the noise moves points too little.
    fn risk(&self, k: usize, energy_margin: f64) -> f64 {
        let [energy, bias, leverage] = [self.energy[k], self.bias[k], self.leverage[k]].map(f64::from);
        let factor = if k < N_ROBUST { ROBUST_LEVERAGE } else { 1.0 };
        let off = (energy + leverage - 1.0).abs();
        factor * leverage + bias.max(0.0) + (off - energy_margin).max(0.0)
    }
}

/// Noise at a point.
#[derive(Clone, Copy)]
pub(super) struct PointNoise {
    /// Standard deviation that the fits assume, times the strength.
    pub(super) level: f64,
    /// True if it is too large for the robust fits.
    pub(super) is_strong: bool,
    /// Farthest motion.
    pub(super) most: f64,
}

/// Mixture of the fits of a point by their risks.
pub(super) fn mixed_motion(
    fits: &PointFits,
    here: &FitErrors,
    around: &FitErrors,
    noise: PointNoise,
) -> PointOutcome {
    if noise.level < NOTHING {
        return ([0.0; 3], PointState::Moved, 1.0);
    }
    if fits.leverages.iter().all(|h| h.is_infinite()) {
        return ([0.0; 3], PointState::Left, 1.0);
    }
    let risks: [f64; N_FITS] = std::array::from_fn(|k| {
        // The neighbors of a point with a large error have similar errors, so their motions say little about bias.
        if noise.is_strong && k >= N_ROBUST {
            return fits.leverages[k] + fits.biases[k - N_ROBUST].max(0.0);
        }
        let here = here.risk(k, ENERGY_MARGIN_HERE);
        around.risk(k, ENERGY_MARGIN_AROUND).max(here - MORE_HERE).min(here + LESS_HERE)
    });
    // Staying has the risk σ².
    let least = risks.iter().copied().fold(1.0, f64::min);
    let share = |risk: f64| (-(risk - least) / TEMPERATURE).exp();
    let stay = share(1.0);
    let (mut total, mut motion) = (stay, [0.0; 3]);
    for (k, &risk) in risks.iter().enumerate() {
        if fits.leverages[k].is_finite() {
            total += share(risk);
            motion = add_scaled(&motion, share(risk), &fits.motions[k]);
        }
    }
    let motion = motion.map(|c| c / total);
    // Strictly below the limit, whatever the sum of position and motion rounds to.
    let (length, most) = (norm(&motion), (1.0 - 1e-9) * noise.most);
    if length <= most {
        (motion, PointState::Moved, stay / total)
    } else if length <= TAIL * most {
        (motion.map(|c| c * most / length), PointState::Moved, stay / total)
    } else {
        ([0.0; 3], PointState::Left, 1.0)
    }
}
