//! Mixture of the estimates of the vertices of a chain, by their estimated risk.
//!
//! Candidates are the estimates from windows that end at corners, and polynomials in windows of fixed sizes. The risk
//! of each is that of Stein for Gaussian noise, `Σ_a ((q_a − p_a)²/σ_a² + 2c − 1)`, for an estimate q of the
//! position p with weight c of the vertex itself, averaged over the vertices near by. Weights fall exponentially with
//! it, as in mixtures of least squares (`leung2006`).

use super::track::{AxisGroup, Estimate, Track};
use std::ops::Range;

/// Numbers of vertices that windows of fixed size reach to either side.
const REACHES: [usize; 14] = [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 90, 128];

/// Degrees of the polynomials in windows of fixed size.
const DEGREES: [usize; 3] = [1, 3, 5];

/// Number of vertices to either side over which a risk is averaged, with weights that fall linearly.
const NEAR: usize = 90;

/// Fall of the logarithm of a weight for a risk of one variance of the noise.
const SHARPNESS: f64 = 16.0;

/// Factor of the weight of the vertex itself in estimates whose windows depend on the noise: a Monte Carlo estimate
/// of their divergence is 1.1 to 1.7 times the sum of these weights.
const ADAPTIVE: f64 = 1.4;

/// Number of vertices that are estimated together.
pub(super) const BLOCK: usize = 1024;

/// Estimates for all candidates at some vertices.
struct Candidates {
    by_candidate: Vec<Vec<Option<Estimate>>>,
    /// Place of the first of the vertices that are asked for.
    first: usize,
    vertices: Vec<usize>,
}

/// Estimates of the positions of `vertices` of a track, at most [`BLOCK`]. Only the axes of the groups change.
pub(super) fn blended(track: &Track, vertices: Range<usize>, groups: &[AxisGroup]) -> Vec<Estimate> {
    let near = if track.is_closed { NEAR.min((track.n_vertices() - 1) / 2) } else { NEAR };
    let before = (1..=near as isize).rev().filter_map(|k| track.neighbor(vertices.start, -k));
    let after = (1..=near as isize).filter_map(|k| track.neighbor(vertices.end - 1, k));
    let all: Vec<usize> = before.chain(vertices.clone()).chain(after).collect();
    let mut by_candidate = vec![Vec::new()];
    for degree in DEGREES {
        for reach in REACHES.into_iter().filter(|reach| 2 * reach > degree) {
            by_candidate.push(track.centered(&all, reach, degree));
        }
    }
    let first = if track.is_closed { near } else { vertices.start.min(near) };
    let mut candidates = Candidates { by_candidate, first, vertices: all };
    let start = |i: usize| Estimate { point: track.point(i), variance: 0.0, own: 0.0 };
    let mut blended: Vec<Estimate> = vertices.map(start).collect();
    for group in groups {
        candidates.by_candidate[0] =
            candidates.vertices.iter().map(|&i| Some(track.estimate(i, group))).collect();
        candidates.blend(track, group, near, &mut blended);
    }
    blended
}

impl Candidates {
    /// Sets the coordinates of a group to the mixture of the candidates, and adds its variance.
    fn blend(&self, track: &Track, group: &AxisGroup, near: usize, blended: &mut [Estimate]) {
        let risks: Vec<Vec<Option<f64>>> = (0..self.by_candidate.len())
            .map(|c| (0..self.vertices.len()).map(|k| self.risk(track, group, c, k)).collect())
            .collect();
        for (k, result) in (self.first..).zip(blended) {
            let risk = |(c, risks): (usize, &Vec<Option<f64>>)| {
                self.by_candidate[c][k].map(|estimate| (mean_near(risks, k, near), estimate))
            };
            let known: Vec<(f64, Estimate)> = risks.iter().enumerate().filter_map(risk).collect();
            let least = known.iter().map(|(risk, _)| *risk).fold(f64::INFINITY, f64::min);
            let (mut sum, mut variance, mut total) = ([0.0; 3], 0.0, 0.0);
            for (risk, estimate) in &known {
                let share = (SHARPNESS * (least - risk)).exp();
                sum = std::array::from_fn(|a| sum[a] + share * (estimate.point[a] - result.point[a]));
                variance += share * estimate.variance;
                total += share;
            }
            for axis in (0..3).filter(|&axis| group.precisions[axis] > 0.0) {
                result.point[axis] += sum[axis] / total;
            }
            result.variance = result.variance.max(variance / total);
        }
    }

    /// Stein's estimate of the risk of candidate `c` at place `k`, in variances of the noise.
    fn risk(&self, track: &Track, group: &AxisGroup, c: usize, k: usize) -> Option<f64> {
        let estimate = self.by_candidate[c][k]?;
        let own = if c == 0 { (ADAPTIVE * estimate.own).min(1.0) } else { estimate.own };
        let point = track.point(self.vertices[k]);
        let of_axis = |axis: usize| {
            let apart = (estimate.point[axis] - point[axis]) * group.precisions[axis];
            if group.precisions[axis] > 0.0 { apart * apart + 2.0 * own - 1.0 } else { 0.0 }
        };
        Some((0..3).map(of_axis).sum())
    }
}

/// Mean of the values around place `k`, with weights that fall linearly to 0 beyond `near` places.
fn mean_near(values: &[Option<f64>], k: usize, near: usize) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    let first = k.saturating_sub(near);
    for (j, value) in values.iter().enumerate().take(k + near + 1).skip(first) {
        if let Some(value) = value {
            let weight = (near + 1 - j.abs_diff(k)) as f64;
            sum += weight * value;
            total += weight;
        }
    }
    sum / total
}
