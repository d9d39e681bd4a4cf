//! Polynomials of Φ₁ for bands between fractional numbers of steps.
//!
//! With fractional a and b, `q(λ) = (λᵃ − λᵇ)/(1 − λ)` is not a polynomial: it has a branch point at λ = 0. It is
//! interpolated by p at the zeros of `t(λ) = T_m(y)`, `y = (2λ − 1 − ℓ)/(1 − ℓ)`, which lie in [ℓ, 1]. Folding the
//! contour of the remainder onto the cut at z = −s gives
//!
//! `q(λ) − p(λ) = −(t(λ)/π)·∫_0^∞ (sᵃ sin πa − sᵇ sin πb) / ((1 + s)(λ + s)·t(−s)) ds`,
//!
//! so that `|q − p| ≤ E·|t|` on [0, 1], where E is the integral at λ = 0 with absolute values. Since Φ₁ is
//! self-adjoint, `‖(q − p)(Φ₁)u‖ ≤ E·‖t(Φ₁)u‖` for every u. The polynomial t is applied together with p and its
//! norm is measured, so the bound needs no knowledge of the spectrum. The value ℓ is a guess; if the walk has
//! eigenvalues below ℓ in which u takes part, the measured norm shows it. For ℓ = 0 no measurement is needed, since
//! |t| ≤ 1, but E decreases only like `m^(−2a)`.
//!
//! From [`FEW_STEPS`] on, λⁿ is a polynomial as far as double precision can tell; see [`Series`].

use super::series::{Growth, Series, TruncationBound};
use crate::parallel;
use std::f64::consts::PI;

/// Number of steps up to which a band is interpolated. Beyond it, the infinite part of the series is about 4⁻³² of
/// the band.
pub(crate) const FEW_STEPS: f64 = 32.0;

/// Nodes of the trapezoidal rule in x = ln s. The integrands are analytic for |Im x| < π, so its error is rounding
/// only.
const FIRST_NODE: f64 = -60.0;
const LAST_NODE: f64 = 6.0;
const NODE_STEP: f64 = 0.125;

/// Factor that covers the error of the rule at the corners of the integrand of E, which contains absolute values.
const CORNERS: f64 = 1.01;

/// Fraction of the accuracy below which the error of ℓ = 0 must be for it to be chosen: most bands are not a
/// thousand times smaller than their steps times W_f(1).
const SURELY: f64 = 1e-3;

/// Interval and density of the interpolation points of q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InterpolationGrid {
    /// Lower end ℓ of the interval.
    lowest: f64,
    /// Degree m of t; the degree of p is m − 1.
    degree: usize,
}

/// Grids in the order in which they are tried. On each, t is about e⁴² times smaller on [ℓ, 1] than at 0, which
/// leaves rounding only. The walks of most meshes have no eigenvalue below 0.1; that of a bipartite graph has the
/// eigenvalue 0, for which only the last grid works.
pub(crate) const LADDER: [InterpolationGrid; 5] = [
    InterpolationGrid { lowest: 0.1, degree: 64 },
    InterpolationGrid { lowest: 1e-2, degree: 210 },
    InterpolationGrid { lowest: 1e-3, degree: 664 },
    InterpolationGrid { lowest: 1e-4, degree: 2100 },
    InterpolationGrid { lowest: 0.0, degree: 8192 },
];

impl InterpolationGrid {
    /// The exponent m·acosh|y| at λ below ℓ.
    fn exponent(&self, lambda: f64) -> f64 {
        2.0 * self.degree as f64 * ((self.lowest - lambda) / (1.0 - self.lowest)).sqrt().asinh()
    }

    /// The quotient |t(λ)|/|t(0)| at λ below ℓ, including λ = −s.
    fn relative(&self, lambda: f64) -> f64 {
        let (at, zero) = (self.exponent(lambda), self.exponent(0.0));
        (at - zero).exp() * (1.0 + (-2.0 * at).exp()) / (1.0 + (-2.0 * zero).exp())
    }

    /// The quotient t(λ)/|t(0)|, given λ and 1 − λ.
    fn guard_value(&self, lambda: f64, rest: f64) -> f64 {
        let sign = if self.degree.is_multiple_of(2) { 1.0 } else { -1.0 };
        if lambda < self.lowest {
            return sign * self.relative(lambda);
        }
        let angle = 2.0 * (rest / (1.0 - self.lowest)).min(1.0).sqrt().asin();
        (self.degree as f64 * angle).cos() / self.exponent(0.0).cosh()
    }

    /// The series of t/|t(0)|, which measures [`TruncationBound::guarded`].
    pub(crate) fn guard(&self) -> Vec<f64> {
        interpolant(self.degree + 1, |lambda, rest| self.guard_value(lambda, rest))
    }
}

/// A band between a < b steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StepRange {
    from: f64,
    to: f64,
}

impl StepRange {
    fn width(&self) -> f64 {
        self.to - self.from
    }

    /// The value `(λᵃ − λᵇ)/(1 − λ)`, given λ and 1 − λ, both positive.
    fn value(&self, lambda: f64, rest: f64) -> f64 {
        // ln λ is computed from the smaller of λ and 1 − λ, so that the quotient stays accurate at both ends.
        let log = if lambda > 0.5 { (-rest).ln_1p() } else { lambda.ln() };
        (self.from * log).exp() * -(self.width() * log).exp_m1() / rest
    }

    /// The jump `sᵃ sin πa − sᵇ sin πb`, and a bound of its size without a corner at its sign changes.
    fn jump(&self, log_s: f64) -> (f64, f64) {
        let (sine_a, sine_b) = (sin_pi(self.from), sin_pi(self.to));
        let (at_a, at_b) = (sine_a * (self.from * log_s).exp(), sine_b * (self.to * log_s).exp());
        if sine_a == 0.0 || sine_b == 0.0 || self.width() > 0.25 {
            return (at_a - at_b, at_a.abs() + at_b.abs());
        }
        // For close powers, sᵃ·((sin πa − sin πb) − sin πb·(s^(b−a) − 1)) avoids the difference of nearly equal
        // numbers.
        let middle = 0.5 * (self.from + self.to) + 0.5;
        let sines = -2.0 * sin_pi(middle) * sin_pi(0.5 * self.width());
        let (power, growth) = ((self.from * log_s).exp(), sine_b * (self.width() * log_s).exp_m1());
        (power * (sines - growth), power * (sines.abs() + growth.abs()))
    }
}

/// The sine sin πx for x ≥ 0, exactly 0 for whole x.
fn sin_pi(x: f64) -> f64 {
    let sine = (PI * x.fract()).sin();
    if x % 2.0 < 1.0 { sine } else { -sine }
}

/// Integrand of the remainder without the factor 1/(λ + s): pairs of s and weight, and |t(0)|·E.
struct InterpolationError {
    nodes: Vec<(f64, f64)>,
    size: f64,
}

impl InterpolationError {
    fn new(band: StepRange, rung: InterpolationGrid) -> Self {
        let n_nodes = ((LAST_NODE - FIRST_NODE) / NODE_STEP) as usize + 1;
        let mut size = 0.0;
        let mut nodes = Vec::with_capacity(n_nodes);
        for i in 0..n_nodes {
            let log = FIRST_NODE + i as f64 * NODE_STEP;
            let s = log.exp();
            let (jump, most) = band.jump(log);
            let scale = NODE_STEP / (PI * (1.0 + s) * rung.relative(-s));
            if i == 0 {
                // Sum over the omitted nodes: there s is small compared with all else, so it is a geometric series.
                let least = if sin_pi(band.from) == 0.0 { band.to } else { band.from };
                size += most * scale / (least * NODE_STEP).exp_m1();
            }
            size += most * scale;
            nodes.push((s, jump * scale * s));
        }
        Self { nodes, size: CORNERS * size }
    }

    /// The error q(λ) − p(λ) at λ below ℓ.
    fn value(&self, lambda: f64, rung: InterpolationGrid) -> f64 {
        let sum: f64 = self.nodes.iter().map(|(s, weight)| weight / (lambda + s)).sum();
        -rung.relative(lambda) * sum
    }
}

/// Series of the band between a < b steps: exact if both are whole, else with the accuracy of the grid `rung`.
pub(crate) fn band(a: f64, b: f64, rung: InterpolationGrid, accuracy: f64, growth: Growth) -> Series {
    if let (Some(a), Some(b)) = (to_whole(a), to_whole(b)) {
        return Series::band(a, b, growth);
    }
    let middle = FEW_STEPS.clamp(a, b);
    let mut parts = Vec::with_capacity(2);
    if a < middle {
        parts.push(match (to_whole(a), to_whole(middle)) {
            (Some(a), Some(b)) => Series::band(a, b, growth),
            _ => interpolate_power(StepRange { from: a, to: middle }, rung, accuracy, growth),
        });
    }
    if middle < b {
        parts.push(match (to_whole(middle), to_whole(b)) {
            (Some(a), Some(b)) => Series::band(a, b, growth),
            _ => Series::deep_band(middle, b, growth),
        });
    }
    if parts.len() == 1 { parts.remove(0) } else { Series::combination(&parts, &[1.0, 1.0], growth) }
}

fn to_whole(n: f64) -> Option<u64> {
    (n.fract() == 0.0).then_some(n as u64)
}

fn interpolate_power(band: StepRange, rung: InterpolationGrid, accuracy: f64, growth: Growth) -> Series {
    let plain = InterpolationGrid { lowest: 0.0, ..rung };
    let sure = InterpolationError::new(band, plain).size;
    // For vertices that are only left, p(Y) is a quotient of differences, `(p(y) − p(0))/y`. Then E·|t| becomes
    // E·(2|t| + 2) for |y| > ½, and E·(1.6m + 8) otherwise, where λ ≥ ¼ and |dt/dy| ≤ 1.6m.
    let (of_guard, of_start) = match growth {
        Growth::Bounded => (1.0, 0.0),
        Growth::Linear => (3.0, 1.6 * rung.degree as f64 + 10.0),
    };
    if sure <= SURELY * accuracy * band.width() || rung == plain {
        let coefficients = interpolant(rung.degree, |lambda, rest| band.value(lambda, rest));
        let rest = TruncationBound { always: sure * (of_guard + of_start), guarded: 0.0 };
        return Series::real(coefficients, rest, growth);
    }
    let remainder = InterpolationError::new(band, rung);
    // One node more than p needs, for the guard.
    let mut coefficients = interpolant(rung.degree + 1, |lambda, rest| {
        let below = if lambda < rung.lowest { remainder.value(lambda, rung) } else { 0.0 };
        band.value(lambda, rest) - below
    });
    coefficients.truncate(rung.degree);
    let at_zero = rung.exponent(0.0).cosh();
    let rest = TruncationBound {
        always: remainder.size / at_zero * (1.0 + of_start),
        guarded: remainder.size * of_guard,
    };
    Series::real(coefficients, rest, growth)
}

/// Number of coefficients that a thread sums at a time.
const COEFFICIENTS_AT_A_TIME: usize = 64;

/// Series in T_k(2λ − 1) of the polynomial of degree n − 1 with the values `value(λ, 1 − λ)` at the zeros of T_n(2λ
/// − 1). O(n²).
pub(super) fn interpolant(n: usize, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let cosines: Vec<f64> = (0..4 * n).map(|i| (0.5 * PI * i as f64 / n as f64).cos()).collect();
    let mut values: Vec<f64> = (0..n)
        .map(|i| {
            let half = 0.25 * PI * (2 * i + 1) as f64 / n as f64;
            // λ and 1 − λ without cancellation.
            value(half.cos().powi(2), half.sin().powi(2))
        })
        .collect();
    values.truncate(values.iter().rposition(|value| *value != 0.0).map_or(0, |last| last + 1));
    let coefficient = |k: usize| {
        let mut at = k;
        let mut sum = 0.0;
        for value in &values {
            sum += value * cosines[at];
            at = (at + 2 * k) % (4 * n);
        }
        sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
    };
    parallel::map_chunks(n, COEFFICIENTS_AT_A_TIME, |chunk| chunk.map(coefficient).collect::<Vec<_>>())
        .concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative rounding of sums over hundreds of cosines and of recurrences of that many steps.
    const ROUNDING: f64 = 2e-13;

    const ACCURACY: f64 = 1e-10;

    fn value(coefficients: &[f64], lambda: f64) -> f64 {
        let theta = (2.0 * lambda - 1.0).clamp(-1.0, 1.0).acos();
        coefficients.iter().zip(0..).map(|(a, k)| a * (f64::from(k) * theta).cos()).sum()
    }

    fn exact(a: f64, b: f64, lambda: f64) -> f64 {
        match lambda {
            0.0 => f64::from(u8::from(a == 0.0)),
            1.0 => b - a,
            _ => StepRange { from: a, to: b }.value(lambda, 1.0 - lambda),
        }
    }

    const BANDS: [(f64, f64); 11] = [
        (0.0, 1.0 / 64.0),
        (0.0, 0.5),
        (0.25, 0.3),
        (1.0, 1.19),
        (1.19, 1.41),
        (1.999, 2.001),
        (2.4, 3.0),
        (0.3, 6.5),
        (5.5, 32.0),
        (9.7, 200.3),
        (1000.25, 1000.75),
    ];

    #[test]
    fn what_is_missing_is_bounded_at_every_eigenvalue() {
        for rung in &LADDER[..3] {
            let guard = rung.guard();
            for (a, b) in BANDS {
                let series = band(a, b, *rung, ACCURACY, Growth::Bounded);
                // Denser towards 0, where the error is largest.
                for lambda in (0..=200).map(|i| f64::from(i) / 200.0).map(|x| x * x * x) {
                    let error = (value(&series.coefficients, lambda) - exact(a, b, lambda)).abs();
                    let measured = value(&guard, lambda).abs() + ROUNDING * series.rest.guarded.min(1.0);
                    let bound = series.rest.always + series.rest.guarded * measured;
                    let last = series.tail[series.tail.len() - 1];
                    assert!(
                        error <= bound + last + ROUNDING * series.total,
                        "{a}..{b} at {lambda} by {rung:?}: {error:e} beyond {bound:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_bound_is_not_much_more_than_what_is_missing() {
        for (a, b) in [(0.0, 0.5), (1.0, 1.19), (1.19, 1.41), (0.3, 6.5)] {
            let rung = LADDER[0];
            let series = band(a, b, rung, ACCURACY, Growth::Bounded);
            assert!(series.rest.guarded > 0.0, "{a}..{b} is not for ℓ = 0");
            let error = (value(&series.coefficients, 0.0) - exact(a, b, 0.0)).abs();
            // If a and b are close, parts of the integral cancel whose sizes enter the bound.
            assert!(
                series.rest.guarded < 5.0 * error,
                "{a}..{b}: {error:e}, bound {:e}",
                series.rest.guarded
            );
        }
    }

    #[test]
    fn the_guard_is_a_peak_at_0() {
        for rung in &LADDER[..4] {
            let guard = rung.guard();
            assert!((value(&guard, 0.0).abs() - 1.0).abs() < ROUNDING);
            for i in 0..=50 {
                let lambda = rung.lowest + (1.0 - rung.lowest) * f64::from(i) / 50.0;
                assert!(value(&guard, lambda).abs() < ROUNDING, "{lambda}: {}", value(&guard, lambda));
            }
        }
    }

    #[test]
    fn whole_steps_beside_others_give_the_same_polynomial() {
        // The sum λ + … + λ⁶ by its own series, and as the difference of two fractional bands.
        let exact = Series::band(1, 7, Growth::Bounded).coefficients;
        for rung in &LADDER[..2] {
            let parts = [(1.0, 3.5), (3.5, 7.0)].map(|(a, b)| band(a, b, *rung, ACCURACY, Growth::Bounded));
            let sum = Series::combination(&parts, &[1.0, 1.0], Growth::Bounded);
            for i in 0..=40 {
                let lambda = 0.1 + 0.9 * f64::from(i) / 40.0;
                let off = (value(&sum.coefficients, lambda) - value(&exact, lambda)).abs();
                assert!(off <= ACCURACY * SURELY * 7.0, "{lambda}: {off:e}");
            }
        }
    }

    #[test]
    fn the_last_rung_needs_no_guard() {
        let rung = LADDER[LADDER.len() - 1];
        let series = band(1.0, 1.41, rung, ACCURACY, Growth::Bounded);
        assert_eq!(series.rest.guarded, 0.0);
        assert!(series.rest.always < 1e-8 && series.rest.always > 0.0, "{:?}", series.rest);
        for lambda in [0.0, 1e-9, 1e-6, 1e-3, 0.3, 1.0] {
            let off = (value(&series.coefficients, lambda) - exact(1.0, 1.41, lambda)).abs();
            assert!(off <= series.rest.always + ROUNDING, "{lambda}: {off:e}");
        }
    }
}
