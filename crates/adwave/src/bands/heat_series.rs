//! Chebyshev series of the bands of heat diffusion.
//!
//! With `x = 1 − λ` and times a < b, counted in steps of Φ₁, a band is `W = q(Φ₁)u`, `u = (I − Φ₁)f`,
//! `q = (e^(−ax) − e^(−bx))/x = ∫_a^b e^(−sx) ds`. In `y = 2λ − 1`, `e^(−sx) = e^(−z)(I_0(z) + 2Σ_k I_k(z)T_k(y))`
//! with z = s/2 and the modified Bessel functions I_k (`abramowitz1964`, 9.6.34). The numbers `e^(−z)I_k(z)` are
//! the probabilities of a symmetric walk with steps at random times, so all coefficients of q are positive and sum
//! to b − a, as for whole steps.
//!
//! With dispersion d the exponent is `x + dx²`, and `q = (e^(−a(x+dx²)) − e^(−b(x+dx²)))/x` is interpolated.

use super::real_series::interpolant;
use super::series::{Growth, NEGLIGIBLE, Series, double_tails};

/// Relative distance of two times below which the band is integrated numerically, because differences would cancel.
const CLOSE: f64 = 0.25;

/// Number of Gauss–Legendre points, enough for errors at the level of rounding.
const N_NODES: usize = 16;

/// Margin in the logarithm below [`NEGLIGIBLE`] at which the recurrence of Bessel quotients starts, so that its
/// wrong start has no effect.
const MARGIN: f64 = 25.0;

/// Terms of a series with dispersion beyond those that the time without it takes.
const MORE_TERMS: usize = 32;

/// Quotient of the end and the start of a part of a long band with dispersion.
const CUT: f64 = 64.0;

/// Exponent at which heat counts as gone, far below rounding.
const VANISHED: f64 = 60.0;

/// Rounding of the coefficients of a series with dispersion, relative to their sum; the last terms are no more.
const ROUNDED_SUM: f64 = 2e-15;

/// The series of the band between the times `a < b`. O(√b) terms; with dispersion O(b) operations.
pub(crate) fn band(a: f64, b: f64, dispersion: f64, growth: Growth) -> Series {
    if dispersion > 0.0 {
        return dispersed_band(a, b, dispersion, growth);
    }
    let mut q: Vec<f64> = Vec::new();
    if b - a < CLOSE * a {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        for (node, weight) in gauss_legendre(N_NODES) {
            let law = heat_law(middle + half * node);
            q.resize(q.len().max(law.len()), 0.0);
            for (q, p) in q.iter_mut().zip(law) {
                *q += half * weight * p;
            }
        }
    } else {
        // Dividing by x sums the tails of the distribution twice.
        q = double_tails(&heat_law(b));
        for (q, less) in q.iter_mut().zip(double_tails(&heat_law(a))) {
            *q -= less;
        }
        for q in &mut q {
            *q *= 4.0;
        }
    }
    for q in q.iter_mut().skip(1) {
        *q *= 2.0;
    }
    Series::new(q, growth)
}

/// [`band`] with dispersion, by interpolation at as many points as leave rounding alone. A long band is cut at
/// 1/[`CUT`] of its end: of what follows a cut, only few points near x = 0 differ from 0.
fn dispersed_band(a: f64, b: f64, dispersion: f64, growth: Growth) -> Series {
    let mut q: Vec<f64> = Vec::new();
    let mut end = b;
    while end > a {
        let start = if end > CUT { a.max(end / CUT) } else { a };
        let value = |_, x: f64| {
            let exponent = x + dispersion * x * x;
            let before = start * exponent;
            if before > VANISHED { 0.0 } else { (-before).exp() * -(-(end - start) * exponent).exp_m1() / x }
        };
        let part = interpolant(heat_law(end * (1.0 + dispersion)).len() + MORE_TERMS, value);
        q.resize(q.len().max(part.len()), 0.0);
        for (q, part) in q.iter_mut().zip(part) {
            *q += part;
        }
        end = start;
    }
    let least = ROUNDED_SUM * q.iter().map(|q| q.abs()).sum::<f64>();
    let mut omitted = 0.0;
    while q.last().is_some_and(|last| omitted + last.abs() <= least) {
        omitted += q.pop().map_or(0.0, f64::abs);
    }
    Series::new(q, growth)
}

/// The values `e^(−z)I_k(z)`, z = s/2, for k = 0, 1, … until they are negligible. The relative error is a few
/// roundings.
fn heat_law(s: f64) -> Vec<f64> {
    let z = 0.5 * s;
    if z == 0.0 {
        return vec![1.0];
    }
    // I_k/I_{k−1} < z/(k − ½ + √((k − ½)² + z²)) bounds the number of values.
    let bound = |k: f64| z / (k - 0.5 + (k - 0.5).hypot(z));
    let (mut log, mut last) = (0.0, 0_usize);
    while log > NEGLIGIBLE.ln() - MARGIN {
        last += 1;
        log += bound(last as f64).ln();
    }
    // With I_{k−1}/I_k = 1 + rise_k, the recurrence I_{k−1} − I_{k+1} = (2k/z)·I_k is run downwards, where errors
    // decay. Near k = 0 the quotients are close to 1, and their distance from 1 determines the accuracy.
    let mut rises = vec![0.0; last + 1];
    let mut above = 1.0 - bound(last as f64 + 1.0);
    for k in (1..=last).rev() {
        let rise = 2.0 * k as f64 / z - above;
        rises[k] = rise;
        above = rise / (1.0 + rise);
    }
    let mut law = vec![1.0];
    let mut p = 1.0;
    for rise in &rises[1..] {
        p /= 1.0 + rise;
        if p < NEGLIGIBLE {
            break;
        }
        law.push(p);
    }
    let one_side: f64 = law[1..].iter().rev().sum();
    let total = 1.0 + 2.0 * one_side;
    for p in &mut law {
        *p /= total;
    }
    law
}

/// Nodes and weights of the `n`-point Gauss–Legendre rule on [−1, 1].
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        // Newton's method from a start that is accurate to a few digits.
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut now) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * now - before) / (x * x - 1.0);
            x -= now / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(series: &Series, lambda: f64) -> f64 {
        let theta = (2.0 * lambda - 1.0).clamp(-1.0, 1.0).acos();
        series.coefficients.iter().zip(0..).map(|(a, k)| a * (f64::from(k) * theta).cos()).sum()
    }

    fn exact(a: f64, b: f64, lambda: f64) -> f64 {
        let x = 1.0 - lambda;
        if x == 0.0 { b - a } else { (-a * x).exp() * -(-(b - a) * x).exp_m1() / x }
    }

    #[test]
    fn the_law_is_that_of_bessel_functions() {
        // e^(−1)·I_0(1), e^(−1)·I_1(1), e^(−1)·I_5(1), from tables.
        let law = heat_law(2.0);
        for (k, table) in [(0, 0.465_759_607_593_640_45), (1, 0.207_910_415_349_708_45)] {
            assert!((law[k] / table - 1.0).abs() < 1e-14, "{k}: {}", law[k]);
        }
        assert!((law[5] / 9.987_2e-5 - 1.0).abs() < 1e-4, "{}", law[5]);
        for s in [1e-12, 1e-3, 0.7, 40.0, 1e4, 1e8, 1e11] {
            let law = heat_law(s);
            // The variance of the walk is z.
            let variance: f64 =
                2.0 * law.iter().enumerate().rev().map(|(k, p)| (k as f64).powi(2) * p).sum::<f64>();
            assert!((variance / (0.5 * s) - 1.0).abs() < 1e-11, "{s}: {variance}");
        }
    }

    #[test]
    fn the_series_is_the_integral() {
        let bands = [
            (0.0, 1e-3),
            (0.0, 0.5),
            (0.5, 0.6),
            (1.0, 2.0),
            (3.0, 3.5),
            (10.0, 12.4999),
            (10.0, 12.5001),
            (100.0, 100.001),
            (100.0, 200.0),
            (1e4, 2e4),
            (1e4, 1.1e4),
        ];
        for (a, b) in bands {
            let series = band(a, b, 0.0, Growth::Bounded);
            assert!(series.coefficients.iter().all(|&c| c >= 0.0), "{a}..{b}");
            for i in 0..=60 {
                let lambda = 1.0 - (f64::from(i) / 60.0).powi(3);
                let (found, exact) = (value(&series, lambda), exact(a, b, lambda));
                assert!((found - exact).abs() <= 1e-12 * (b - a), "{a}..{b} at {lambda}: {found} {exact}");
            }
        }
    }

    #[test]
    fn the_series_with_dispersion_is_the_quotient() {
        let bands = [
            (0.0, 1e-3),
            (0.0, 0.5),
            (1.0, 2.0),
            (10.0, 10.001),
            (0.0, 70.0),
            (0.0, 1e4),
            (1e4, 1.1e4),
            (0.0, 1e7),
        ];
        for (a, b) in bands {
            for d in [1e-3, 0.4, 0.5, 3.0] {
                let series = band(a, b, d, Growth::Bounded);
                for i in 0..=60 {
                    let x = (f64::from(i) / 60.0).powi(3);
                    let decay = x * (1.0 + d * x);
                    let exact =
                        if x == 0.0 { b - a } else { (-a * decay).exp() * -(-(b - a) * decay).exp_m1() / x };
                    let found = value(&series, 1.0 - x);
                    // acos and multiples of it lose digits near x = 0.
                    assert!(
                        (found - exact).abs() <= 3e-12 * (b - a),
                        "{a}..{b}, {d} at {x}: {found} {exact}"
                    );
                }
                let plain = band(a, b, 0.0, Growth::Bounded).degree();
                assert!(
                    series.degree() <= 2 * plain + MORE_TERMS,
                    "{a}..{b}, {d}: {} for {plain}",
                    series.degree()
                );
            }
        }
    }
}
