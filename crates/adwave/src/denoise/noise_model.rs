//! Models of the noise of a field, and variance stabilization: values whose noise is the same everywhere.
//!
//! Sources: `anscombe1948` for counts, the unbiased inverse of `makitalo2011`; `foi2011` for magnitudes.

use super::magnitudes::Magnitudes;
use super::{DenoiseError, DenoiseParams};
use crate::named_values;
use serde::{Deserialize, Serialize};

/// Dependence of the noise of a field on its values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum NoiseModel {
    /// The standard deviation is the same everywhere.
    #[default]
    Gaussian,
    /// The variance is proportional to the value, as in counts or a multiple of them.
    Poisson,
    /// The standard deviation is proportional to the value.
    Multiplicative,
    /// The values are magnitudes of complex ones whose two parts have noise of the same standard deviation, as in
    /// magnetic resonance images. The result is the magnitude without noise.
    Rician,
}

named_values!(NoiseModel, "noise model", {
    Gaussian => "gaussian", "The same standard deviation everywhere";
    Poisson => "poisson", "A variance proportional to the value, as in counts";
    Multiplicative => "multiplicative", "A standard deviation proportional to the value";
    Rician => "rician", "Magnitudes of complex values with noise in both parts, as in MRI";
});

/// Rounds that estimate noise on which the transform depends, each with the transform of the round before.
const GAIN_ROUNDS: usize = 3;

/// Rounds for magnitudes, whose first transform is none at all.
const MAGNITUDE_ROUNDS: usize = 8;

/// Offset of Anscombe's transform, in counts.
const OFFSET: f64 = 0.375;

/// Transform into values with noise of the same standard deviation everywhere, and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stabilizer {
    model: NoiseModel,
    /// Standard deviation of the noise of the transformed values: that of a value of 1 with Poisson noise, and the
    /// relative one with multiplicative noise.
    pub(super) noise: f64,
}

impl Stabilizer {
    /// The transform for the noise of `params`, or for that which `estimate` finds in transformed values.
    pub(super) fn new(
        data: &[f64],
        params: &DenoiseParams,
        estimate: impl Fn(&[f64]) -> Result<f64, DenoiseError>,
    ) -> Result<Self, DenoiseError> {
        let model = params.noise_model;
        let mut now = Self { model, noise: params.noise.unwrap_or(0.0) };
        if params.noise.is_none() {
            let n_rounds = match model {
                NoiseModel::Poisson => GAIN_ROUNDS,
                NoiseModel::Rician => MAGNITUDE_ROUNDS,
                NoiseModel::Gaussian | NoiseModel::Multiplicative => 1,
            };
            for _ in 0..n_rounds {
                now.noise = estimate(&now.transformed(data))?;
            }
        }
        Ok(now)
    }

    /// The lowest value that the model allows, and true if that itself is allowed.
    fn lowest(model: NoiseModel) -> (f64, bool) {
        match model {
            NoiseModel::Gaussian => (f64::NEG_INFINITY, true),
            NoiseModel::Poisson | NoiseModel::Rician => (0.0, true),
            NoiseModel::Multiplicative => (0.0, false),
        }
    }

    /// Returns true if a value is possible with this noise.
    pub(super) fn is_possible(model: NoiseModel, value: f64) -> bool {
        let (lowest, is_allowed) = Self::lowest(model);
        value > lowest || (is_allowed && value == lowest)
    }

    /// Values whose noise has the standard deviation [`noise`](Self::noise): `2·√(f + 3a/8)` with a = noise² for
    /// Poisson noise of variance a·f, ln f for multiplicative noise, and [`Magnitudes`] stretched where they are small.
    /// Impossible values, of masked vertices, become 0.
    pub(super) fn transformed(&self, data: &[f64]) -> Vec<f64> {
        let a = self.noise * self.noise;
        let of = |f: f64| match self.model {
            _ if !Self::is_possible(self.model, f) => 0.0,
            NoiseModel::Rician if self.noise > 0.0 => {
                self.noise * Magnitudes::get().transformed(f / self.noise)
            }
            NoiseModel::Gaussian | NoiseModel::Rician => f,
            NoiseModel::Poisson => 2.0 * (f + OFFSET * a).sqrt(),
            NoiseModel::Multiplicative => f.ln(),
        };
        data.iter().map(|f| of(*f)).collect()
    }

    /// Mean of the field at a transformed and smoothed value that retains the share `remaining` of the variance of the
    /// noise. For a share of 1 it is the inverse of the transform; for 0 it is the value whose transform has this mean
    /// under the noise.
    pub(super) fn restored(&self, value: f64, remaining: f64) -> f64 {
        let smooth = 1.0 - remaining.clamp(0.0, 1.0);
        match self.model {
            NoiseModel::Poisson if self.noise > 0.0 => {
                let d = value / self.noise;
                let inverse = 0.25 * d * d - OFFSET;
                let mean = smooth * mean_count(d) + (1.0 - smooth) * inverse;
                (mean * self.noise * self.noise).max(0.0)
            }
            NoiseModel::Poisson => 0.25 * value * value,
            NoiseModel::Multiplicative => (value + 0.5 * smooth * self.noise * self.noise).exp(),
            NoiseModel::Rician if self.noise > 0.0 => {
                let (table, value) = (Magnitudes::get(), value / self.noise);
                self.noise * (smooth * table.without_noise(value) + (1.0 - smooth) * table.inverse(value))
            }
            NoiseModel::Gaussian | NoiseModel::Rician => value,
        }
    }
}

/// Mean of the counts whose transformed values have the mean `d`: the closed form of `makitalo2011`, 0 below the
/// transform of no counts.
fn mean_count(d: f64) -> f64 {
    let least = 2.0 * OFFSET.sqrt();
    if d <= least {
        return 0.0;
    }
    let root = 1.5_f64.sqrt();
    let terms = 0.25 * d * d + 0.25 * root / d - 1.375 / (d * d) + 0.625 * root / (d * d * d) - 0.125;
    terms.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stabilizer(model: NoiseModel, noise: f64) -> Stabilizer {
        Stabilizer { model, noise }
    }

    /// Mean of the transformed counts with a Poisson distribution of the given mean, and their standard deviation.
    fn moments_of_counts(mean: f64) -> [f64; 2] {
        let counts = stabilizer(NoiseModel::Poisson, 1.0);
        let (mut p, mut first, mut second) = ((-mean).exp(), 0.0, 0.0);
        for k in 0..2_000_u32 {
            let t = counts.transformed(&[f64::from(k)])[0];
            first += p * t;
            second += p * t * t;
            p *= mean / f64::from(k + 1);
        }
        [first, (second - first * first).sqrt()]
    }

    #[test]
    fn transformed_counts_have_noise_of_one_and_their_mean_leads_back() {
        for mean in [4.0, 10.0, 50.0, 200.0] {
            let [t, deviation] = moments_of_counts(mean);
            assert!((deviation - 1.0).abs() < 0.05, "{mean}: {deviation}");
            let back = stabilizer(NoiseModel::Poisson, 1.0).restored(t, 0.0);
            assert!((back / mean - 1.0).abs() < 0.003, "{mean}: {back}");
        }
        // Where the noise is not stable, the inverse is unbiased all the same.
        let [t, _] = moments_of_counts(1.0);
        assert!((stabilizer(NoiseModel::Poisson, 1.0).restored(t, 0.0) - 1.0).abs() < 0.03);
    }

    #[test]
    fn values_that_keep_their_noise_stay() {
        for model in NoiseModel::ALL.iter().copied() {
            for noise in [0.3, 2.0] {
                let scale = stabilizer(model, noise);
                for value in [0.5, 3.0, 1e6] {
                    let same = scale.restored(scale.transformed(&[value])[0], 1.0);
                    assert!((same / value - 1.0).abs() < 1e-12, "{model}, {noise}: {same} for {value}");
                }
            }
        }
    }

    #[test]
    fn models_know_their_values() {
        let possible = |model, value| Stabilizer::is_possible(model, value);
        assert!(possible(NoiseModel::Gaussian, -1.0));
        assert!(possible(NoiseModel::Poisson, 0.0) && !possible(NoiseModel::Poisson, -1e-9));
        assert!(possible(NoiseModel::Multiplicative, 1e-9) && !possible(NoiseModel::Multiplicative, 0.0));
        assert!(!possible(NoiseModel::Poisson, f64::NAN));
    }
}
