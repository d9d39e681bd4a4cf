//! Chebyshev series of the bands: the polynomials of Φ₁ that map u = (I − Φ₁)f to W_f(j).
//!
//! With `u = (I − Φ₁)f`, a band between n_{j−1} = a and n_j = b steps is `W = Σ_{i=a}^{b−1} Φ₁ⁱ u = q(Φ₁)u`. In
//! `y = 2λ − 1 ∈ [−1, 1]` the powers are `λⁿ = Σ_k c_k T_k(y)`, `c_0 = C(2n,n)/4ⁿ`, `c_k = 2C(2n,n−k)/4ⁿ`: the
//! distribution of a symmetric walk of 2n half steps. Dividing `λᵃ − λᵇ` by `1 − λ` sums the tails of that
//! distribution twice, so all coefficients of q are positive and sum to `q(1) = b − a`, and the truncation error is
//! known exactly. Starting from u instead of f makes every error relative to W itself: on a fine mesh W_f(1) is a
//! millionth of the coordinates.
//!
//! Source for the coefficients of λⁿ: `carne1985`.

/// Smallest probability that is computed, far below the rounding of any sum that contains it.
pub(super) const NEGLIGIBLE: f64 = 1e-40;

/// Number of steps up to which a band is summed power by power, because the tails of nearly equal powers cancel.
const SUMMED_DIRECTLY: u64 = 64;

/// Relative distance of two powers below which they are subtracted through their quotient.
const CLOSE: f64 = 1.0 / 16.0;

/// Remainder of a series relative to its value at λ = 1 below which terms are omitted; rounding leaves as much.
const FLOOR: f64 = 1e-19;

/// Growth of `‖T_k(Y)‖` with k in the norm of the errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Growth {
    /// `‖T_k(Y)‖` is at most 1: the walk is reversible and its stationary distribution is positive everywhere.
    Bounded,
    /// `‖T_k(Y)‖` is at most 2 + 1.2k: some vertices are left and never entered.
    Linear,
}

impl Growth {
    fn bound(self, k: usize) -> f64 {
        match self {
            Self::Bounded => 1.0,
            Self::Linear => 2.0 + 1.2 * k as f64,
        }
    }
}

/// Error bound of a whole polynomial: `always·‖u‖ + guarded·‖guard(Φ₁)u‖`. It is 0 for whole steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TruncationBound {
    pub(crate) always: f64,
    /// The part that must be measured; see [`real_series`](super::real_series).
    pub(crate) guarded: f64,
}

impl TruncationBound {
    fn plus(self, factor: f64, other: Self) -> Self {
        let factor = factor.abs();
        Self { always: self.always + factor * other.always, guarded: self.guarded + factor * other.guarded }
    }
}

/// A polynomial `Σ_k a_k T_k(2λ − 1)` with the error of each truncation.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Coefficients a_0 … a_d.
    pub(crate) coefficients: Vec<f64>,
    /// Tails `tail[k] ≥ ‖Σ_{m>k} a_m T_m(Y)‖`; the last one covers terms that are not stored. The error bounded by
    /// `rest` comes on top.
    pub(crate) tail: Vec<f64>,
    /// Sum `Σ|a_k|`; for a band of whole steps the number of steps b − a.
    pub(crate) total: f64,
    pub(crate) rest: TruncationBound,
}

impl Series {
    pub(super) fn new(mut coefficients: Vec<f64>, growth: Growth) -> Self {
        let total: f64 = coefficients.iter().rev().map(|a| a.abs()).sum();
        let mut tail = vec![0.0; coefficients.len()];
        for k in (1..coefficients.len()).rev() {
            tail[k - 1] = tail[k] + coefficients[k].abs() * growth.bound(k);
        }
        let kept = tail.partition_point(|&t| t > FLOOR * total) + 1;
        coefficients.truncate(kept);
        tail.truncate(kept);
        Self { coefficients, tail, total, rest: TruncationBound::default() }
    }

    /// This polynomial without a tail, so that it is never truncated.
    pub(super) fn without_tail(self) -> Self {
        let tail = vec![0.0; self.coefficients.len()];
        Self { tail, total: 0.0, rest: TruncationBound::default(), ..self }
    }

    /// A polynomial with the error bound `rest`.
    pub(crate) fn real(coefficients: Vec<f64>, rest: TruncationBound, growth: Growth) -> Self {
        Self { rest, ..Self::new(coefficients, growth) }
    }

    /// Series of `q(λ) = Σ_{i=a}^{b−1} λⁱ`, `a < b`. O(√b) terms.
    pub(crate) fn band(a: u64, b: u64, growth: Growth) -> Self {
        let mut q: Vec<f64> = Vec::new();
        if b - a <= SUMMED_DIRECTLY {
            for n in a..b {
                let law = walk_law(n as f64);
                q.resize(q.len().max(law.len()), 0.0);
                for (q, p) in q.iter_mut().zip(law) {
                    *q += p;
                }
            }
        } else {
            q = double_tails(&walk_law(b as f64));
            for (q, less) in q.iter_mut().zip(double_tails(&walk_law(a as f64))) {
                *q -= less;
            }
            for q in &mut q {
                *q *= 4.0;
            }
        }
        for q in &mut q[1..] {
            *q *= 2.0;
        }
        Self::new(q, growth)
    }

    /// Series of `(λᵃ − λᵇ)/(1 − λ)` for real `a < b`, a ≥ 32. Terms beyond degree b are omitted; they are about
    /// 4⁻³² of the band. O(√b) terms.
    pub(crate) fn deep_band(a: f64, b: f64, growth: Growth) -> Self {
        let (law, less) = (walk_law(b), walk_law(a));
        let mut difference = law;
        // If the powers are close, the quotient of the distributions is more accurate than their difference.
        let is_close = b - a < CLOSE * a;
        let mut log_quotient = 0.0;
        let quotients: Vec<f64> = (0..less.len().min(difference.len()))
            .map(|k| {
                if k > 0 {
                    let i = (k - 1) as f64;
                    log_quotient += ((b - a) * (2.0 * i + 1.0) / ((b + i + 1.0) * (a - i))).ln_1p();
                }
                log_quotient
            })
            .collect();
        // Both distributions sum to 1 over both sides, which determines the quotient at 0.
        let excess = |k: usize| less[k] * quotients[k].exp_m1();
        let at_zero = -(excess(0) + 2.0 * (1..quotients.len()).rev().map(excess).sum::<f64>()).ln_1p();
        for (k, p) in difference.iter_mut().enumerate() {
            match quotients.get(k).map(|log| log + at_zero) {
                Some(log) if is_close && log < 1.0 => *p = less[k] * log.exp_m1(),
                _ => *p -= less.get(k).unwrap_or(&0.0),
            }
        }
        let mut q = double_tails(&difference);
        for q in &mut q {
            *q *= 4.0;
        }
        for q in &mut q[1..] {
            *q *= 2.0;
        }
        Self::new(q, growth)
    }

    /// The combination `Σ_j factors[j]·series[j]`.
    pub(crate) fn combination(bands: &[Self], factors: &[f64], growth: Growth) -> Self {
        let n_terms = bands.iter().map(|s| s.coefficients.len()).max().unwrap_or(1);
        let mut sum = vec![0.0; n_terms];
        let mut rest = TruncationBound::default();
        for (series, factor) in bands.iter().zip(factors) {
            for (s, a) in sum.iter_mut().zip(&series.coefficients) {
                *s += factor * a;
            }
            rest = rest.plus(*factor, series.rest);
        }
        Self::real(sum, rest, growth)
    }

    /// Degree of the stored polynomial.
    pub(crate) fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Lowest degree, not below `from`, whose truncation error is at most `budget`; the full degree if there is
    /// none.
    pub(crate) fn degree_within(&self, budget: f64, from: usize) -> usize {
        self.tail.partition_point(|&t| t + self.rest.always > budget).max(from).min(self.degree())
    }
}

/// Probabilities `C(2n, n−k)/4ⁿ` for k = 0, 1, … until they are negligible or k > n. The relative error is a few
/// roundings times √k.
fn walk_law(n: f64) -> Vec<f64> {
    let mut law = vec![1.0];
    let (mut p, mut k) = (1.0, 0.0);
    while k < n {
        p *= (n - k) / (n + k + 1.0);
        if p < NEGLIGIBLE {
            break;
        }
        law.push(p);
        k += 1.0;
    }
    // Both sides of the distribution sum to 1; adding the small terms first loses none of them.
    let one_side: f64 = law[1..].iter().rev().sum();
    let total = 1.0 + 2.0 * one_side;
    for p in &mut law {
        *p /= total;
    }
    law
}

/// Double tails `Σ_{m>k} (m − k)·law[m]` for each k.
pub(super) fn double_tails(law: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; law.len()];
    let (mut tail, mut double) = (0.0, 0.0);
    for k in (0..law.len() - 1).rev() {
        tail += law[k + 1];
        double += tail;
        sums[k] = double;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative rounding of sums over thousands of terms.
    const ROUNDING: f64 = 1e-12;

    fn value(series: &Series, lambda: f64) -> f64 {
        let theta = (2.0 * lambda - 1.0).clamp(-1.0, 1.0).acos();
        series.coefficients.iter().zip(0..).map(|(a, k)| a * (f64::from(k) * theta).cos()).sum()
    }

    fn band_value(a: u64, b: u64, lambda: f64) -> f64 {
        (a..b).map(|i| lambda.powf(i as f64)).sum()
    }

    #[test]
    fn the_law_is_that_of_the_binomials() {
        for n in 0_u64..=20 {
            let law = walk_law(n as f64);
            assert_eq!(law.len() as u64, n + 1);
            let mut binomial = 1_u64; // C(2n, i), i rising to n
            let mut exact = vec![0.0; n as usize + 1];
            for i in 0..=n {
                exact[(n - i) as usize] = binomial as f64 / 4.0_f64.powi(n as i32);
                binomial = binomial * (2 * n - i) / (i + 1);
            }
            for (p, e) in law.iter().zip(&exact) {
                assert!((p - e).abs() <= 1e-14 * e, "n = {n}: {p} for {e}");
            }
        }
    }

    #[test]
    fn coefficients_are_positive_and_sum_to_the_number_of_steps() {
        let bands =
            [(0, 1), (1, 2), (2, 4), (64, 128), (7, 300), (100, 101), (1 << 19, 1 << 20), (1 << 30, 1 << 31)];
        for (a, b) in bands {
            let series = Series::band(a, b, Growth::Bounded);
            assert!(series.coefficients.iter().all(|&c| c > 0.0), "{a}..{b}");
            let sum: f64 = series.coefficients.iter().rev().sum();
            let steps = (b - a) as f64;
            assert!((sum - steps).abs() <= ROUNDING * b as f64, "{a}..{b}: {sum} for {steps}");
            assert!(series.degree() < b as usize);
        }
    }

    #[test]
    fn the_series_is_the_geometric_sum() {
        for (a, b) in [(0, 1), (1, 2), (2, 4), (4, 8), (5, 90), (64, 128), (0, 200), (128, 256)] {
            let series = Series::band(a, b, Growth::Bounded);
            for i in 0..=50 {
                let lambda = f64::from(i) / 50.0;
                let (found, exact) = (value(&series, lambda), band_value(a, b, lambda));
                assert!(
                    (found - exact).abs() <= ROUNDING * b as f64,
                    "{a}..{b} at {lambda}: {found}, {exact}"
                );
            }
        }
    }

    #[test]
    fn close_powers_by_sums_and_by_tails_agree() {
        let n = 1000;
        let summed = Series::band(n, n + SUMMED_DIRECTLY, Growth::Bounded);
        let mut tails = double_tails(&walk_law((n + SUMMED_DIRECTLY) as f64));
        for (t, less) in tails.iter_mut().zip(double_tails(&walk_law(n as f64))) {
            *t -= less;
        }
        assert!((summed.coefficients[0] - 4.0 * tails[0]).abs() <= 1e-10 * summed.coefficients[0]);
        assert!((summed.coefficients[30] - 8.0 * tails[30]).abs() <= 1e-10 * summed.coefficients[30]);
    }

    #[test]
    fn deep_bands_of_real_steps_are_those_of_whole_ones_and_add_up() {
        for (a, b) in [(32, 33), (64, 128), (100, 101), (1000, 1064), (1 << 20, 1 << 21)] {
            let (whole, real) =
                (Series::band(a, b, Growth::Bounded), Series::deep_band(a as f64, b as f64, Growth::Bounded));
            let middle = a as f64 + 0.3 * (b - a) as f64;
            let parts = [(a as f64, middle), (middle, b as f64)]
                .map(|(a, b)| Series::deep_band(a, b, Growth::Bounded));
            let sum = Series::combination(&parts, &[1.0, 1.0], Growth::Bounded);
            for found in [real, sum] {
                let off: f64 =
                    whole.coefficients.iter().zip(&found.coefficients).map(|(w, f)| (w - f).abs()).sum();
                assert!(off <= ROUNDING * (b - a) as f64, "{a}..{b}: {off:e}");
            }
        }
    }

    #[test]
    fn deep_bands_that_are_hardly_apart_keep_their_accuracy() {
        for (a, width) in [(32.0, 1e-9), (1000.0, 1e-6), (1e6, 1e-3), (1e9, 1e-6)] {
            let b = a + width;
            let series = Series::deep_band(a, b, Growth::Bounded);
            for lambda in [1.0, 1.0 - 0.1 / a, 1.0 - 1.0 / a, 1.0 - 5.0 / a] {
                let log = f64::ln_1p(lambda - 1.0);
                let exact = if lambda == 1.0 {
                    b - a
                } else {
                    (a * log).exp() * -((b - a) * log).exp_m1() / (1.0 - lambda)
                };
                let found = value(&series, lambda);
                // cos(k·acos y) near y = 1 loses digits itself.
                assert!(
                    (found / exact - 1.0).abs() < 1e-8,
                    "{a} + {width} at {lambda}: {found:e}, {exact:e}"
                );
            }
        }
    }

    #[test]
    fn the_tail_bounds_what_is_cut_off() {
        let series = Series::band(64, 128, Growth::Bounded);
        for degree in [5, 20, 35] {
            let cut = Series {
                coefficients: series.coefficients[..=degree].to_vec(),
                tail: series.tail[..=degree].to_vec(),
                total: 64.0,
                rest: TruncationBound::default(),
            };
            // At λ = 1 every T_k is 1, so the bound is attained.
            let missing = 64.0 - value(&cut, 1.0);
            assert!((missing / series.tail[degree] - 1.0).abs() < 1e-6, "{missing} {}", series.tail[degree]);
            for i in 0..=100 {
                let lambda = f64::from(i) / 100.0;
                let error = (value(&cut, lambda) - band_value(64, 128, lambda)).abs();
                assert!(error <= series.tail[degree] * (1.0 + 1e-9) + ROUNDING, "{error} at {lambda}");
            }
        }
        let degree = series.degree_within(1e-6, 0);
        assert!(series.tail[degree] <= 1e-6 && series.tail[degree - 1] > 1e-6);
    }
}
