//! Bounds of the rounding errors of powers of a walk, in double and single precision.
//!
//! Lanes are rounded with the relative error ε: 0 in double and 2⁻²⁴ in single precision. A row of m entries is summed
//! in double precision, with u = 2⁻⁵³ and `γ_m = mu/(1 − mu)` (`higham2002`, chapter 3), and rounded once. No entry of
//! P is negative, so that the errors of t steps are bounded value by value: `|computed − Pᵗx| ≤ g(t)·Pᵗ|x|`,
//! `g(t) = (1 + ε)·((1 + ε)(1 + γ_m))ᵗ − 1`, which is (t + 1)·6e-8 in single precision, whatever the degrees. For
//! values of at least 0 this is a relative error of each.
//!
//! Let N be a norm that P does not increase: the largest size if rows are normalized, the sum of the sizes for columns,
//! the root of the sum of the squares for the symmetric walk. Then a band `W_j` has the error
//! `b_j = g(n_{j−1}) + g(n_j)` relative to `N(x)`, and as `N(W_j x) ≤ 2N(x)`, the path of the bands j and k has the
//! error `2b_j + (2 + b_j)·b_k`. In single precision and with normalized rows, the middle of the range of each channel
//! is subtracted first, which changes no band; the error is then relative to half of the range.

use crate::WalkPowers;
use adwave::bands::Precision;

/// Largest error at which [`Precision::Auto`] takes single precision.
const AUTO_ACCURACY: f64 = 1e-10;

/// Largest excess of a row sum over 1, see `WalkMatrix::from_probabilities`.
const ROW_SUM_EXCESS: f64 = 1e-9;

/// Factor that covers underflow, the arithmetic of the bound and the subtraction of the middle.
const MARGIN: f64 = 1.0 + 1e-6;

/// Number format of a result, and a bound of its rounding errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkAccuracy {
    /// Single or double.
    pub precision: Precision,
    /// Largest relative error; each function names its norm.
    pub error_bound: f64,
}

impl WalkAccuracy {
    /// Accuracy of the requested format. [`Precision::Auto`] takes single precision if its error is at most 1e-10.
    pub(crate) fn choose(wanted: Precision, bound: impl Fn(Precision) -> f64) -> Self {
        let precision = match wanted {
            Precision::Auto if bound(Precision::Single) <= AUTO_ACCURACY => Precision::Single,
            Precision::Single => Precision::Single,
            _ => Precision::Double,
        };
        Self { precision, error_bound: bound(precision) }
    }
}

impl WalkPowers {
    /// The bound g of the error of some steps, relative to the same steps of the absolute values.
    pub(crate) fn power_bound(&self, precision: Precision, steps: u32) -> f64 {
        const UNIT: f64 = f64::EPSILON / 2.0;
        let most = (0..self.n_nodes()).map(|x| self.walk().rows().row(x).0.len()).max().unwrap_or(0) as f64;
        let rounding = if precision == Precision::Single { f64::from(f32::EPSILON) / 2.0 } else { 0.0 };
        let per_step = rounding.ln_1p() + (most * UNIT / (1.0 - most * UNIT)).ln_1p();
        MARGIN * (rounding.ln_1p() + f64::from(steps) * per_step).exp_m1()
    }

    /// The bound of the errors of bands between scales, and with `with_second` of the bands of their absolute values.
    pub(crate) fn bands_bound(&self, precision: Precision, scales: &[u32], with_second: bool) -> f64 {
        let powers: Vec<f64> = scales.iter().map(|&steps| self.power_bound(precision, steps)).collect();
        let growth = scales.last().map_or(1.0, |&steps| (f64::from(steps) * ROW_SUM_EXCESS.ln_1p()).exp());
        let start = self.power_bound(precision, 0);
        let bands = powers
            .iter()
            .scan(start, |before, &power| Some(growth * (std::mem::replace(before, power) + power)));
        let bands: Vec<f64> = bands.collect();
        let largest = |bands: &[f64]| bands.iter().copied().fold(0.0, f64::max);
        match bands.split_last() {
            // Bands that are coarser are less accurate, so that the last two give the largest error.
            Some((&last, before)) if with_second && !before.is_empty() => {
                let before = largest(before);
                last.max(2.0 * growth * before + (2.0 * growth + before) * last)
            }
            _ => largest(&bands),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::powers::tests::powers;

    #[test]
    fn bounds_are_those_of_the_formulas() {
        let powers = powers(50, 0.5);
        let epsilon = f64::from(f32::EPSILON) / 2.0;
        for steps in [0, 1, 8, 1000] {
            let single = powers.power_bound(Precision::Single, steps);
            assert!((single / (f64::from(steps + 1) * epsilon) - 1.0).abs() < 1e-4, "{steps}: {single:e}");
            let double = powers.power_bound(Precision::Double, steps);
            assert!(double <= f64::from(steps) * 60.0 * f64::EPSILON, "{steps}: {double:e}");
        }
        // Bands of 1 and 2 steps are off by (0 + 1 + 2)ε and (1 + 2 + 2)ε, the path of both by 2·3ε + 2·5ε.
        let bound = |scales: &[u32], with_second| {
            powers.bands_bound(Precision::Single, scales, with_second) / epsilon
        };
        for (found, exact) in
            [(bound(&[1], true), 3.0), (bound(&[1, 2], false), 5.0), (bound(&[1, 2], true), 16.0)]
        {
            assert!((found - exact).abs() < 1e-3, "{found} {exact}");
        }
    }

    #[test]
    fn single_precision_is_never_chosen_beyond_its_accuracy() {
        let powers = powers(20, 0.5);
        let choose = |wanted| WalkAccuracy::choose(wanted, |precision| powers.power_bound(precision, 3));
        assert_eq!(choose(Precision::Auto), choose(Precision::Double));
        assert!(choose(Precision::Double).error_bound < 1e-13);
        assert_eq!(choose(Precision::Single).precision, Precision::Single);
        assert!(choose(Precision::Single).error_bound > 1e-10);
    }
}
