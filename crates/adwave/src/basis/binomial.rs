//! Powers of a lazy random walk as Chebyshev sums.

/// Coefficients of `((1+y)/2)ⁿ = Σ_k c_k T_k(y)` up to the degree beyond which they sum to less than `tail`,
/// divided by their sum.
///
/// `c_0 = C(2n,n)/4ⁿ`, `c_k = 2·C(2n,n−k)/4ⁿ` are positive and sum to 1, so the error of a truncated sum is at most
/// the omitted part wherever |T_k| ≤ 1. The degree is about `√(n·ln(2/tail))`, and at most n. O(degree).
///
/// Source: `varopoulos1985`, `carne1985`.
pub(super) fn chebyshev_of_power(n: u64, tail: f64) -> Vec<f64> {
    let n = n as f64;
    // Up to a common factor, c_{k+1}/c_k = (n−k)/(n+k+1), which never overflows, unlike the binomials.
    let mut coefficients = vec![0.5];
    let mut sum = 0.5;
    let mut k = 0.0;
    let mut term = 1.0;
    while k < n {
        let ratio = (n - k) / (n + k + 1.0);
        term *= ratio;
        k += 1.0;
        coefficients.push(term);
        sum += term;
        // The ratios decrease, so the remainder is less than a geometric series.
        if term * ratio / (1.0 - ratio) < tail * sum {
            break;
        }
    }
    for c in &mut coefficients {
        *c /= sum;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a sum of some hundred terms.
    const ROUNDING: f64 = 1e-14;

    fn power(coefficients: &[f64], y: f64) -> f64 {
        coefficients.iter().enumerate().map(|(k, c)| c * (k as f64 * y.acos()).cos()).sum()
    }

    #[test]
    fn complete_sums_are_powers() {
        for n in [0_u64, 1, 2, 7, 30] {
            let c = chebyshev_of_power(n, 0.0);
            assert_eq!(c.len() as u64, n + 1);
            for y in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let exact = f64::midpoint(1.0, y).powi(n as i32);
                assert!((power(&c, y) - exact).abs() < ROUNDING, "n = {n}, y = {y}");
            }
        }
    }

    #[test]
    fn cut_sums_err_by_the_tail_at_most() {
        for tail in [1e-3, 1e-6, 1e-10] {
            let n = 4096;
            let c = chebyshev_of_power(n, tail);
            assert!((c.len() as f64) < 1.1 * (n as f64 * (2.0 / tail).ln()).sqrt());
            for step in 0..=200 {
                let y = f64::from(step) / 100.0 - 1.0;
                // Dividing by the sum changes every value by as much again.
                let error = (power(&c, y) - f64::midpoint(1.0, y).powf(n as f64)).abs();
                assert!(error < 2.0 * tail + ROUNDING, "tail {tail}, y = {y}: {error}");
            }
        }
    }
}
