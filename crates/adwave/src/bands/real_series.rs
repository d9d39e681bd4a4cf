//! Chebyshev series of bands between numbers of steps that are not whole.
//!
//! `λⁿ` of a real n has a branch point at λ = 0, so its series on [0, 1] does not end, and falls only like `k^(−2n−1)` once
//! k > n. For n ≥ 32 that part is below all rounding (`4⁻ⁿ`) and [`Series`] serves. Below, a band
//! `q(λ) = (λᵃ − λᵇ)/(1 − λ)` is expanded on `[ℓ, 1]` in `y = (2λ − 1 − ℓ)/(1 − ℓ)`, where it is analytic:
//!
//! * For k ≥ b, folding the contour of the coefficients' integral onto the cut λ = −s gives
//!   `a_k = (2/π)(−1)^(k+1) ∫_{θ₀}^∞ (sᵃ sin πa − sᵇ sin πb)/(1 + s)·e^(−kθ) dθ`, `s = ((1−ℓ)cosh θ − (1+ℓ))/2`,
//!   `cosh θ₀ = (1+ℓ)/(1−ℓ)`: the coefficients fall like `e^(−kθ₀)`. The integral keeps their relative accuracy.
//! * What is cut off after the term d is not bounded by `Σ|a_k|` if the walk has eigenvalues λ < ℓ, where
//!   `|T_k(y)| = cosh kθ`. But `cosh kθ ≤ e^((k−d)θ₀)·cosh dθ` there, so that for any u
//!   `‖Σ_{k>d} a_k T_k(Y)u‖ ≤ ρ_d·(‖u‖ + ‖T_d(Y)u‖)`, `ρ_d = Σ_{k>d} |a_k| e^((k−d)θ₀)`.
//!   The last norm is measured on the way. So no knowledge of the spectrum is needed: ℓ is a guess, and where it is wrong the
//!   measured norm grows and says so.

use super::series::Growth;
use std::f64::consts::PI;

/// Nodes of the trapezoidal rule in x, where θ = θ₀ + eˣ: from e⁻⁴⁰ to e⁴, sixteen for each factor of e. The integrands are
/// analytic in a strip of width π, so that the rule errs by rounding only.
const NODES: usize = 44 * 16;
const FIRST_NODE: f64 = -40.0;
const NODE_STEP: f64 = 1.0 / 16.0;

/// Up to which number of steps a band is expanded here; beyond, λⁿ is as good as a polynomial.
pub(crate) const FEW_STEPS: f64 = 32.0;

/// The interval [ℓ, 1] of an expansion, and how many terms it may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    /// ℓ, in [0, 1).
    pub(crate) lowest: f64,
    /// θ₀.
    theta: f64,
    /// Sampling points for the first coefficients.
    n_samples: usize,
    /// The most terms.
    pub(crate) cap: usize,
}

impl Interval {
    /// [0.1, 1]: the walks of most meshes have no eigenvalue below; 256 terms cost less than most schedules' last level.
    pub(crate) fn usual() -> Self {
        let lowest = 0.1_f64;
        let theta = ((1.0 + lowest) / (1.0 - lowest)).acosh();
        Self { lowest, theta, n_samples: 512, cap: 256 }
    }

    /// [0, 1], for signals with much of what a bipartite graph's walk turns round at every step.
    pub(crate) fn whole() -> Self {
        Self { lowest: 0.0, theta: 0.0, n_samples: 1 << 13, cap: 1 << 13 }
    }

    fn cut(self, theta: f64) -> f64 {
        // Without cancellation near θ₀: cosh θ − cosh θ₀ = 2 sinh((θ+θ₀)/2)·sinh((θ−θ₀)/2).
        let half = |t: f64| (0.5 * t).sinh();
        (1.0 - self.lowest) * half(theta + self.theta) * half(theta - self.theta)
    }
}

/// `q(λ) = Σ_i f_i (λ^{a_i} − λ^{b_i})/(1 − λ)` on an interval: its coefficients and bounds of what a cut costs.
#[derive(Clone, Debug)]
pub(crate) struct RealSeries {
    /// a_0 … a_cap.
    pub(crate) coefficients: Vec<f64>,
    /// ρ_d.
    pub(crate) rest: Vec<f64>,
    /// `Σ|f_i|(b_i − a_i)`.
    pub(crate) total: f64,
}

/// A part of a band: a < b steps, and the factor before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) factor: f64,
}

impl Part {
    /// `(λᵃ − λᵇ)/(1 − λ)`, given 1 − λ as well, both at least 0.
    fn value(&self, lambda: f64, rest: f64) -> f64 {
        if rest == 0.0 {
            return self.to - self.from;
        }
        // ln λ from the smaller of λ and 1 − λ, so that the quotient keeps its accuracy at both ends.
        let log = if lambda > 0.5 { (-rest).ln_1p() } else { lambda.ln() };
        let from = if self.from == 0.0 { 1.0 } else { (self.from * log).exp() };
        from * -((self.to - self.from) * log).exp_m1() / rest
    }

    /// `sᵃ sin πa` and `sᵇ sin πb`, over 1 + s.
    fn jump(&self, s: f64) -> [f64; 2] {
        [self.from, self.to].map(|n| {
            let sine = sin_pi(n);
            if sine == 0.0 { 0.0 } else { sine * s.powf(n) / (1.0 + s) }
        })
    }
}

/// sin πn, exactly 0 for whole n.
fn sin_pi(n: f64) -> f64 {
    let sine = (PI * n.fract()).sin();
    if n % 2.0 < 1.0 { sine } else { -sine }
}

impl RealSeries {
    /// The series of a sum of parts. O(terms × nodes).
    pub(crate) fn new(parts: &[Part], interval: Interval, growth: Growth) -> Self {
        let last = parts.iter().map(|part| part.to).fold(0.0, f64::max);
        // The contour may be folded once k is beyond the growth of q at infinity.
        let folded_from = (last.ceil() as usize + 1).min(interval.cap);
        let mut coefficients = sampled(parts, interval, folded_from);
        let (mut jumps, mut sizes, mut decay) =
            (Vec::with_capacity(NODES), Vec::with_capacity(NODES), Vec::with_capacity(NODES));
        for node in 0..NODES {
            let t = (FIRST_NODE + node as f64 * NODE_STEP).exp();
            let s = interval.cut(interval.theta + t);
            let weight = 2.0 / PI * t * NODE_STEP;
            let (mut jump, mut size) = (0.0, 0.0);
            for part in parts {
                let [from, to] = part.jump(s);
                jump += part.factor * (from - to);
                size += part.factor.abs() * (from.abs() + to.abs());
            }
            // At the far nodes s overflows, where the exponential has long vanished.
            let at = |v: f64| if v.is_finite() { weight * v } else { 0.0 };
            jumps.push(at(jump) * (-(folded_from as f64) * t).exp());
            sizes.push(at(size) * (-(folded_from as f64) * t).exp() / -(-t).exp_m1());
            decay.push((-t).exp());
        }
        // What the rule leaves out below its first node, where s is a power of τ.
        let first = FIRST_NODE.exp();
        let smallest = if interval.theta > 0.0 { 1.0 } else { 2.0 };
        let below: f64 = parts
            .iter()
            .map(|part| {
                let jump = part.jump(interval.cut(interval.theta + first));
                let of = |n: f64, v: f64| if v == 0.0 { 0.0 } else { v.abs() / (smallest * n) };
                part.factor.abs() * 2.0 / PI * (of(part.from, jump[0]) + of(part.to, jump[1]))
            })
            .sum();
        let mut rest = vec![f64::INFINITY; folded_from.saturating_sub(1)];
        for k in folded_from..=interval.cap + 1 {
            let scale = (-(k as f64) * interval.theta).exp();
            // Σ_{m ≥ k} of the coefficients, weighted from the term k − 1 on.
            let sum: f64 = sizes.iter().sum::<f64>() + below;
            rest.push(sum * scale * interval.theta.exp() * interval.slack(k, growth));
            if k <= interval.cap {
                let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
                coefficients.push(sign * scale * jumps.iter().sum::<f64>());
            }
            for ((jump, size), decay) in jumps.iter_mut().zip(&mut sizes).zip(&decay) {
                *jump *= decay;
                *size *= decay;
            }
        }
        let total = parts.iter().map(|part| part.factor.abs() * (part.to - part.from)).sum();
        Self { coefficients, rest, total }
    }
}

impl Interval {
    /// How much more than ρ_{k−1}(‖u‖ + ‖T u‖) the cut before the term k may cost.
    ///
    /// Where some vertices are only left and never entered (`Y = [Y_R 0; B 0]` up to a shift), `p(Y)` is
    /// `B·(p(y) − p(y₀))/(y − y₀)` of Y_R there: `|T_k(y) − T_k(y₀)| ≤ 3k|y − y₀|` within the interval, as y₀ lies well inside,
    /// and at most `2.5|T_k|` times that distance below it.
    fn slack(self, k: usize, growth: Growth) -> f64 {
        // The first coefficients of a slow series come from samples, which fold the far ones into them.
        let folding = if self.lowest == 0.0 { 2.0 } else { 1.0 };
        match growth {
            Growth::Bounded => folding,
            // The weights 3m of the terms m ≥ k, which fall like e^(−mθ₀), sum to that of a few more than k.
            Growth::Linear if self.lowest > 0.0 => 4.0 + 3.0 * (k as f64 + 1.0 / self.theta.exp_m1()),
            Growth::Linear => f64::INFINITY,
        }
    }
}

/// The first `n` coefficients by the discrete cosine transform.
fn sampled(parts: &[Part], interval: Interval, n: usize) -> Vec<f64> {
    let n_samples = interval.n_samples;
    let angle = |i: usize| PI * (i as f64 + 0.5) / n_samples as f64;
    let values: Vec<f64> = (0..n_samples)
        .map(|i| {
            let square = |v: f64| v * v;
            // 1 − λ and λ without cancellation: y = cos φ.
            let rest = (1.0 - interval.lowest) * square((0.5 * angle(i)).sin());
            let lambda = interval.lowest + (1.0 - interval.lowest) * square((0.5 * angle(i)).cos());
            parts.iter().map(|part| part.factor * part.value(lambda, rest)).sum()
        })
        .collect();
    (0..n)
        .map(|k| {
            let sum: f64 = values.iter().enumerate().map(|(i, v)| v * (k as f64 * angle(i)).cos()).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n_samples as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative rounding of a few hundred cosines and a quadrature that errs by rounding.
    const ROUNDING: f64 = 1e-13;

    fn part(from: f64, to: f64) -> Part {
        Part { from, to, factor: 1.0 }
    }

    fn chebyshev(k: usize, y: f64) -> f64 {
        if y < -1.0 {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sign * (k as f64 * (-y).acosh()).cosh()
        } else {
            (k as f64 * y.clamp(-1.0, 1.0).acos()).cos()
        }
    }

    #[test]
    fn both_ways_to_the_coefficients_agree_where_both_hold() {
        for (a, b) in [(0.0, 0.5), (0.0, 1.5), (1.0, 2.0_f64.sqrt()), (2.6, 5.3), (7.2, 7.3)] {
            let interval = Interval::usual();
            let series = RealSeries::new(&[part(a, b)], interval, Growth::Bounded);
            let sampled = sampled(&[part(a, b)], interval, 40);
            for (k, s) in sampled.iter().enumerate() {
                let off = (series.coefficients[k] - s).abs();
                assert!(off <= ROUNDING * (b - a), "{a}..{b}, term {k}: {} and {s}", series.coefficients[k]);
            }
        }
    }

    #[test]
    fn the_coefficients_on_the_whole_interval_are_those_of_the_closed_form() {
        // c_{k+1}/c_k = (n − k)/(n + k + 1), twice the first for k ≥ 1; and q·(1 − λ) = 1 − λⁿ in the series of q.
        let n = 3.4;
        let q = RealSeries::new(&[part(0.0, n)], Interval::whole(), Growth::Bounded).coefficients;
        let power = |k: usize| {
            let before = if k == 0 { q[1] } else { q[k - 1] };
            let before = if k == 1 { 2.0 * before } else { before };
            -(0.5 * q[k] - 0.25 * (before + q[k + 1]) * if k == 0 { 0.5 } else { 1.0 })
        };
        for k in 1..30 {
            let expected = (n - k as f64) / (n + k as f64 + 1.0);
            let found = power(k + 1) / power(k);
            assert!((found / expected - 1.0).abs() < 1e-6, "{k}: {found} for {expected}");
        }
    }

    #[test]
    fn what_is_cut_off_is_bounded_within_the_interval_and_below_it() {
        for interval in [Interval::usual(), Interval::whole()] {
            for (a, b) in [(0.0, 0.5), (1.0, 1.4), (2.4, 3.4), (0.3, 6.0)] {
                let part = part(a, b);
                let series = RealSeries::new(&[part], interval, Growth::Bounded);
                for degree in [12, 30, 60] {
                    for i in 0..=60 {
                        let lambda = f64::from(i) / 60.0;
                        let y = (2.0 * lambda - 1.0 - interval.lowest) / (1.0 - interval.lowest);
                        let sum: f64 = (0..=degree).map(|k| series.coefficients[k] * chebyshev(k, y)).sum();
                        let error = (sum - part.value(lambda, 1.0 - lambda)).abs();
                        let bound = series.rest[degree] * (1.0 + chebyshev(degree, y).abs());
                        // Rounding grows with the terms, which grow below the interval.
                        let rounding = ROUNDING * (1.0 + b) * (1.0 + chebyshev(degree, y).abs() * 1e-3);
                        assert!(error <= bound + rounding, "{a}..{b} at {lambda}: {error} beyond {bound}");
                        if i == 0 && interval.lowest > 0.0 && degree == 30 {
                            assert!(bound < 1e4 * error, "{a}..{b}: {error}, a loose bound {bound}");
                        }
                    }
                }
            }
        }
    }
}
