//! The modified Bessel function I₀, which gives heat on a line of places and the noise of magnitudes.

use std::f64::consts::PI;

/// Argument up to which the integral is used, and beyond it the asymptotic series.
const FAR: f64 = 30.0;

/// Nodes of the trapezoidal rule, whose error is far below rounding up to [`FAR`].
const N_NODES: usize = 40;

/// `e^(−x) I₀(x) = 1/π ∫ exp(−x(1 − cos θ)) dθ` over 0 … π, for x ≥ 0, to 1e-8 of it.
pub(crate) fn scaled_i0(x: f64) -> f64 {
    if x > FAR {
        // Term k is that before times (2k − 1)²/8kx.
        let terms = (1..6).scan(1.0, |term, k| {
            *term *= f64::from((2 * k - 1) * (2 * k - 1)) / (8.0 * f64::from(k) * x);
            Some(*term)
        });
        return (1.0 + terms.sum::<f64>()) / (2.0 * PI * x).sqrt();
    }
    let node = |k: usize| (-x * (1.0 - (PI * k as f64 / N_NODES as f64).cos())).exp();
    (0.5 * (node(0) + node(N_NODES)) + (1..N_NODES).map(node).sum::<f64>()) / N_NODES as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_the_power_series_and_join_at_the_border() {
        for x in [0.0, 0.1, 1.0, 5.0, 20.0_f64] {
            // Σ (x/2)^2k / k!²
            let terms = (1..200).scan(1.0, |term, k| {
                *term *= (0.5 * x / f64::from(k)).powi(2);
                Some(*term)
            });
            let wanted = (1.0 + terms.sum::<f64>()) * (-x).exp();
            assert!((scaled_i0(x) / wanted - 1.0).abs() < 1e-13, "{x}");
        }
        assert!((scaled_i0(FAR * (1.0 + 1e-12)) / scaled_i0(FAR) - 1.0).abs() < 1e-8);
    }
}
