//! Chebyshev series of the bands of a plain walk, which need not stay where it is.
//!
//! With Q = 2Φ₁ − I, `Qᵗ = Σ_k 2^(1−t)·C(t, (t−k)/2)·T_k(Q)` over the k of the parity of t, halved at k = 0: the
//! distribution of a symmetric walk of t steps. A band between a < b steps is `W = (Qᵃ − Qᵇ)f = q(Q)u` with
//! `u = (I − Φ₁)f = ½(I − Q)f` and `q = 2Σ_{i=a}^{b−1} Qⁱ`. All coefficients of q are positive and sum to 2(b − a). As
//! for lazy walks, q is also four times the double tails of the distribution, because
//! `(1 − y)T_k = −½(T_{k+1} − 2T_k + T_{k−1})`.
//!
//! Source for the coefficients: `carne1985`.

use super::series::{Growth, NEGLIGIBLE, Series, double_tails};

/// Number of steps up to which a band is summed power by power, because the tails of nearly equal powers cancel.
const SUMMED_DIRECTLY: u64 = 64;

/// The series of the band between `a < b` steps. O(√b) terms.
pub(crate) fn band(a: u64, b: u64, growth: Growth) -> Series {
    let mut q: Vec<f64> = Vec::new();
    if b - a <= SUMMED_DIRECTLY {
        for t in a..b {
            let law = plain_law(t);
            q.resize(q.len().max(law.len()), 0.0);
            for (q, p) in q.iter_mut().zip(law) {
                *q += 2.0 * p;
            }
        }
    } else {
        q = double_tails(&plain_law(b));
        for (q, less) in q.iter_mut().zip(double_tails(&plain_law(a))) {
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

/// Probabilities `C(t, (t−k)/2)/2ᵗ` for k = 0, 1, … until they are negligible or k > t; 0 where k and t differ in
/// parity.
fn plain_law(t: u64) -> Vec<f64> {
    let first = (t % 2) as usize;
    let mut law = vec![0.0; first + 1];
    law[first] = 1.0;
    let (mut p, mut k) = (1.0, first as u64);
    while k < t {
        p *= (t - k) as f64 / (t + k + 2) as f64;
        if p < NEGLIGIBLE {
            break;
        }
        k += 2;
        law.extend([0.0, p]);
    }
    let one_side: f64 = law[1..].iter().rev().sum();
    let total = law[0] + 2.0 * one_side;
    for p in &mut law {
        *p /= total;
    }
    law
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative rounding of sums over thousands of terms.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn the_law_is_that_of_the_binomials() {
        assert_eq!(plain_law(0), [1.0]);
        assert_eq!(plain_law(1), [0.0, 0.5]);
        assert_eq!(plain_law(2), [0.5, 0.0, 0.25]);
        assert_eq!(plain_law(4), [0.375, 0.0, 0.25, 0.0, 0.0625]);
    }

    #[test]
    fn the_series_is_the_geometric_sum() {
        for (a, b) in [(0, 1), (1, 2), (3, 7), (0, 65), (10, 200), (128, 256), (101, 1000)] {
            let series = band(a, b, Growth::Bounded);
            let total: f64 = series.coefficients.iter().rev().sum();
            assert!((total - 2.0 * (b - a) as f64).abs() <= ROUNDING * b as f64, "{a}..{b}: {total}");
            for i in 0..=100 {
                let y = f64::from(i) / 50.0 - 1.0;
                let angle = y.acos();
                let found: f64 =
                    series.coefficients.iter().zip(0..).map(|(c, k)| c * (f64::from(k) * angle).cos()).sum();
                let exact: f64 = (a..b).map(|t| 2.0 * y.powi(t as i32)).sum();
                assert!((found - exact).abs() <= ROUNDING * b as f64, "{a}..{b} at {y}: {found} for {exact}");
            }
        }
    }
}
