//! Smoothing by Taubin's filters, the windowed sinc and λ|μ, with a gain of ½ at the frequency where adwave's gain is
//! ½.

use super::shared::{row, smoothing};
use super::{CompareError, Comparison, ComparisonInput};
use crate::differential::Differential;
use crate::taubin::{WindowedSinc, lambda_mu, lambda_mu_with_half_gain};
use adwave::bands::Bands;
use adwave::measure::rms;
use adwave::operator::Semigroup;
use std::time::Instant;

/// Largest number of iterations of λ|μ, which needs about 3/k² iterations at the frequency k; if it needs more, it is
/// skipped.
const MOST_ITERATIONS: usize = 4000;

/// Gain of n steps at the frequency k, an eigenvalue of `2(I − Φ₁)`.
fn gain(semigroup: Semigroup, n: f64, k: f64) -> f64 {
    match semigroup {
        Semigroup::Steps => (1.0 - k / 2.0).max(0.0).powf(n),
        Semigroup::PlainSteps => (1.0 - k).abs().powf(n),
        Semigroup::Heat { rate, dispersion } => (-0.5 * rate * n * k * (1.0 + 0.5 * dispersion * k)).exp(),
    }
}

/// Frequency in (0, 2) at which [`gain`] is ½.
fn half_gain_frequency(semigroup: Semigroup, n: f64) -> f64 {
    let k = match semigroup {
        Semigroup::Steps => 2.0 * (1.0 - (-1.0 / n).exp2()),
        Semigroup::PlainSteps => 1.0 - (-1.0 / n).exp2(),
        Semigroup::Heat { rate, dispersion } => {
            let exponent = std::f64::consts::LN_2 / (rate * n);
            // The positive root u of u + dispersion·u² = exponent, with k = 2u.
            4.0 * exponent / (1.0 + (1.0 + 4.0 * dispersion * exponent).sqrt())
        }
    };
    k.clamp(1e-6, 1.9)
}

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
) -> Result<Comparison, CompareError> {
    let (steps, semigroup) = (bands.steps[bands.n_levels()], input.decomposer.operator().semigroup());
    let frequency = half_gain_frequency(semigroup, steps);
    let degree = (8.0 / (1.0 - frequency / 2.0).acos()).ceil().clamp(10.0, 20_000.0) as usize;
    let start = Instant::now();
    let k = Differential::from_diffusion(
        input.decomposer.rows("a windowed sinc filter")?,
        input.decomposer.vertex_map().clone(),
    );
    let filter = WindowedSinc::half_gain(frequency, degree)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let theirs = filter.apply(&k, input.signal, input.n_channels)?;
    let filtered = start.elapsed().as_secs_f64();
    let gains = |k: f64| (gain(semigroup, steps, k), filter.gain(k));
    let gain_row = |quantity: &str, k: f64| row(quantity, gains(k).0, gains(k).1);
    let mut rows = vec![
        row("prepare, s", input.prepare_seconds, prepared),
        row("smooth, s", seconds, filtered),
        row("products with the operator", bands.info.products as f64, degree as f64),
        gain_row("gain at the frequency", frequency),
        gain_row("gain at half the frequency", frequency / 2.0),
        gain_row("gain at twice the frequency", (2.0 * frequency).min(2.0)),
    ];
    let (factors, iterations) = lambda_mu_with_half_gain(frequency);
    if iterations <= MOST_ITERATIONS {
        let start = Instant::now();
        let other = lambda_mu(&k, input.signal, input.n_channels, factors, iterations)?;
        rows.extend([
            row("λ|μ with the same half-gain frequency: s", None, start.elapsed().as_secs_f64()),
            row("λ|μ: products with the operator", None, 2.0 * iterations as f64),
            row("λ|μ: rms change of the signal", None, rms(input.signal, &other, input.n_channels)),
            row("λ|μ: rms difference from adwave", None, rms(bands.coarsest(), &other, input.n_channels)),
        ]);
    }
    let task = format!(
        "smooth with a gain of ½ at the frequency {frequency:.4} of the operator; windowed sinc after Hamming"
    );
    Ok(smoothing(input, task, bands.coarsest(), theirs, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_is_half() {
        for semigroup in [
            Semigroup::Steps,
            Semigroup::Heat { rate: 7.0, dispersion: 0.0 },
            Semigroup::Heat { rate: 7.0, dispersion: 0.5 },
        ] {
            assert!(
                (gain(semigroup, 32.0, half_gain_frequency(semigroup, 32.0)) - 0.5).abs() < 1e-12,
                "{semigroup:?}"
            );
        }
    }
}
