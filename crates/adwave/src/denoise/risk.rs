//! Mixture of estimates with the least risk, as estimated from the noisy data.

use crate::Progress;
use crate::{Cancelled, parallel};
use std::ops::Range;

/// Maximal number of steps of the search for the best mixture.
const MAX_STEPS: usize = 20_000;

/// Risk of mixtures `Σ_k w_k F_k` of estimates of a vector field m from noisy data y = m + e:
/// `‖Σ_k w_k F_k − m‖² = w·Gw − 2b·w + ‖m‖²`, averaged over the sites by area.
///
/// G holds `⟨F_k, F_l⟩`. By Stein's identity b holds `⟨F_k, m⟩ = ⟨F_k, y⟩ − cov(F_k, e)`, where the covariance
/// follows from the change of F_k and y when noise of known size is added (`ramani2008`).
#[derive(Clone, Debug)]
pub(super) struct Risk {
    gram: Vec<Vec<f64>>,
    toward: Vec<f64>,
}

impl Risk {
    /// Builds the risk from the estimates of the data (the data themselves first; any number of channels per site),
    /// one or more repetitions of the estimates for data with added noise of `step` times the standard deviation of
    /// the noise, and the weight of each site. `strength` multiplies the standard deviation. O(sites × channels ×
    /// estimates²).
    pub(super) fn new(
        estimates: &[Vec<f64>],
        shaken: &[Vec<Vec<f64>>],
        areas: &[f64],
        step: f64,
        strength: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = areas.len();
        let total = parallel::try_sum(n, progress, |x| areas[x])?;
        let total = if total > 0.0 { total } else { 1.0 };
        let mean = |term: &(dyn Fn(usize) -> f64 + Sync)| {
            parallel::try_sum(n, progress, |x| areas[x] * term(x)).map(|sum| sum / total)
        };
        let data = &estimates[0];
        let d = data.len() / n.max(1);
        let dot = |a: &[f64], b: &[f64], x: usize| -> f64 {
            a[x * d..][..d].iter().zip(&b[x * d..][..d]).map(|(a, b)| a * b).sum()
        };
        let amplification = (strength / step).powi(2) / shaken.len() as f64;
        let mut gram = vec![vec![0.0; estimates.len()]; estimates.len()];
        let mut toward = Vec::with_capacity(estimates.len());
        for (k, f) in estimates.iter().enumerate() {
            let covariance = |x: usize| {
                let of = |g: &Vec<Vec<f64>>, c: usize| (g[k][c] - f[c]) * (g[0][c] - data[c]);
                let once = |g| (x * d..(x + 1) * d).map(|c| of(g, c)).sum::<f64>();
                amplification * shaken.iter().map(once).sum::<f64>()
            };
            toward.push(mean(&|x| dot(f, data, x) - covariance(x))?);
            for l in 0..=k {
                gram[k][l] = mean(&|x| dot(f, &estimates[l], x))?;
                gram[l][k] = gram[k][l];
            }
        }
        Ok(Self { gram, toward })
    }

    /// The risk with the products `⟨F_k, F_l⟩` and `⟨F_k, m⟩`.
    pub(super) fn from_products(gram: Vec<Vec<f64>>, toward: Vec<f64>) -> Self {
        Self { gram, toward }
    }

    /// Weights of the mixture of least risk: ≥ 0, with sum 1. Each step is exact along the two most promising
    /// estimates; at most [`MAX_STEPS`] steps.
    pub(super) fn best_weights(&self) -> Vec<f64> {
        self.best_among(self.toward.len())
    }

    /// Weights of the best mixture of the first n estimates; the others have weight 0.
    pub(super) fn best_among(&self, n: usize) -> Vec<f64> {
        self.search(std::slice::from_ref(&(0..n)))
    }

    /// Weights of the best mixture of estimates in blocks of n; the weights of each block have sum 1.
    pub(super) fn best_in_blocks(&self, n: usize) -> Vec<f64> {
        let blocks: Vec<Range<usize>> = (0..self.toward.len()).step_by(n).map(|at| at..at + n).collect();
        self.search(&blocks)
    }

    fn search(&self, blocks: &[Range<usize>]) -> Vec<f64> {
        let mut weights = vec![0.0; self.toward.len()];
        for block in blocks {
            weights[block.start] = 1.0;
        }
        let least_gain = 1e-12 * self.gram[0][0];
        let slope =
            |k: usize| blocks.iter().map(|block| self.gram[k][block.start]).sum::<f64>() - self.toward[k];
        let mut slopes: Vec<f64> = (0..weights.len()).map(slope).collect();
        for _ in 0..MAX_STEPS {
            let steepest = |a: &usize, b: &usize| slopes[*a].total_cmp(&slopes[*b]);
            let exchange = |block: &Range<usize>| {
                let to = block.clone().min_by(steepest)?;
                let from = block.clone().filter(|&k| weights[k] > 0.0).max_by(steepest)?;
                Some((slopes[from] - slopes[to], from, to))
            };
            let exchanges = blocks.iter().filter_map(exchange);
            let Some((gain, from, to)) = exchanges.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            let bend = self.gram[to][to] + self.gram[from][from] - 2.0 * self.gram[to][from];
            if gain.is_nan() || gain <= least_gain {
                break;
            }
            let step = if bend > 0.0 { (gain / bend).min(weights[from]) } else { weights[from] };
            weights[to] += step;
            weights[from] = if step == weights[from] { 0.0 } else { weights[from] - step };
            for (k, slope) in slopes.iter_mut().enumerate() {
                *slope += step * (self.gram[k][to] - self.gram[k][from]);
            }
        }
        weights
    }

    /// Estimated reduction of the risk from one mixture to another, and the standard error of that difference for
    /// noise of standard deviation `noise` at each of `n_sites`: `2σ·‖Σ_k (v_k − w_k)·F_k‖/√n`.
    pub(super) fn gain(&self, of: &[f64], over: &[f64], noise: f64, n_sites: usize) -> (f64, f64) {
        let apart: Vec<f64> = of.iter().zip(over).map(|(v, w)| v - w).collect();
        let square = self.inner(&apart, &apart).max(0.0);
        (self.known_risk(over) - self.known_risk(of), 2.0 * noise * (square / n_sites.max(1) as f64).sqrt())
    }

    /// The product `v·Gw`.
    fn inner(&self, v: &[f64], w: &[f64]) -> f64 {
        let row = |gram: &Vec<f64>| gram.iter().zip(w).map(|(g, w)| g * w).sum::<f64>();
        self.gram.iter().zip(v).map(|(gram, v)| v * row(gram)).sum()
    }

    /// The risk of a mixture without the term `‖m‖²`: `w·Gw − 2b·w`.
    pub(super) fn known_risk(&self, weights: &[f64]) -> f64 {
        let toward: f64 = weights.iter().zip(&self.toward).map(|(w, b)| w * b).sum();
        self.inner(weights, weights) - 2.0 * toward
    }

    /// Estimated mean square errors of the data and of a mixture.
    pub(super) fn risks_before_and_after(&self, weights: &[f64]) -> [f64; 2] {
        // The mean square of the data minus that of the noise is ‖m‖².
        let truth = self.toward[0];
        let after = self.known_risk(weights);
        [(self.gram[0][0] - truth).max(0.0), (truth + after).max(0.0)]
    }
}
