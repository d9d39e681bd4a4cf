//! Magnitudes of complex values with noise in both parts: the Rice distribution.
//!
//! Where the magnitude without noise is 0, magnitudes have the mean 1.25 σ and the standard deviation 0.66 σ; at several
//! σ they have its mean and σ. Stretching small values by the reciprocal of the standard deviation makes the noise the
//! same everywhere, and the mean of stretched values tells the magnitude without noise.
//!
//! Sources: `rice1944` for the distribution, `foi2011` for stabilizing its variance.

use crate::bessel::scaled_i0;
use std::sync::OnceLock;

/// Largest magnitude of the table, in σ; above it the distribution is normal, with the mean A + 1/2A.
const LARGEST: f64 = 12.0;

/// Steps of the table in σ.
const STEP: f64 = 0.05;

/// Nodes of the integrals, over 8 σ to both sides.
const N_NODES: usize = 320;

/// Moments of magnitudes and of their transform, all in units of σ.
pub(super) struct Magnitudes {
    /// Means of the magnitudes for the magnitudes 0, [`STEP`], … without noise, ascending.
    means: Vec<f64>,
    /// The transform at these means: the integral of the reciprocal of the standard deviation.
    at_means: Vec<f64>,
    /// Means of the transform, ascending.
    means_of_transform: Vec<f64>,
}

impl Magnitudes {
    pub(super) fn get() -> &'static Self {
        static TABLE: OnceLock<Magnitudes> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let without_noise = (0..=(LARGEST / STEP).round() as usize).map(|k| k as f64 * STEP);
        let (mut means, mut at_means, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
        for a in without_noise.clone() {
            let [mean, square] = [1, 2].map(|power| mean_over_noise(a, |m| m.powi(power)));
            let slope = (square - mean * mean).sqrt().recip();
            let at = match means.last() {
                Some(before) => {
                    let k = at_means.len() - 1;
                    at_means[k] + 0.5 * (slopes[k] + slope) * (mean - before)
                }
                // Below the smallest mean the transform is a line through 0.
                None => slope * mean,
            };
            means.push(mean);
            at_means.push(at);
            slopes.push(slope);
        }
        let mut table = Self { means, at_means, means_of_transform: Vec::new() };
        table.means_of_transform =
            without_noise.map(|a| mean_over_noise(a, |m| table.transformed(m))).collect();
        table
    }

    /// The transform of a magnitude.
    pub(super) fn transformed(&self, magnitude: f64) -> f64 {
        interpolated(&self.means, &self.at_means, magnitude)
    }

    /// The magnitude with a transform.
    pub(super) fn inverse(&self, transformed: f64) -> f64 {
        interpolated(&self.at_means, &self.means, transformed)
    }

    /// The magnitude without noise at which the transform has this mean; 0 below the mean of noise alone.
    pub(super) fn without_noise(&self, mean: f64) -> f64 {
        let last = self.means_of_transform.len() - 1;
        if mean <= self.means_of_transform[0] {
            return 0.0;
        }
        if mean >= self.means_of_transform[last] {
            // The mean of magnitudes is A + 1/2A.
            let magnitude = self.means[last] + (mean - self.means_of_transform[last]);
            return 0.5 * (magnitude + (magnitude * magnitude - 2.0).sqrt());
        }
        let k = self.means_of_transform.partition_point(|m| *m <= mean) - 1;
        let (low, high) = (self.means_of_transform[k], self.means_of_transform[k + 1]);
        STEP * (k as f64 + (mean - low) / (high - low))
    }
}

/// Value at `x` of the broken line through (0, 0) and the points, which goes on with the slope 1.
fn interpolated(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let last = xs.len() - 1;
    match xs.partition_point(|other| *other <= x) {
        0 => x * ys[0] / xs[0],
        k if k > last => ys[last] + (x - xs[last]),
        k => ys[k - 1] + (ys[k] - ys[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1]),
    }
}

/// Mean of a function of the magnitude m over the noise: its density is `m·exp(−(m² + A²)/2)·I₀(mA)`.
fn mean_over_noise(a: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (low, high) = ((a - 8.0).max(0.0), a + 8.0);
    let node = |k: usize| low + (high - low) * (k as f64 + 0.5) / N_NODES as f64;
    let density = |m: f64| m * (-0.5 * (m - a) * (m - a)).exp() * scaled_i0(m * a);
    let (sum, whole) = (0..N_NODES).map(node).fold((0.0, 0.0), |(sum, whole), m| {
        let density = density(m);
        (sum + density * f(m), whole + density)
    });
    sum / whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn moments_are_those_of_noise_alone_and_of_large_magnitudes() {
        let table = Magnitudes::get();
        assert!((table.means[0] - (0.5 * PI).sqrt()).abs() < 1e-4, "{}", table.means[0]);
        let last = table.means.len() - 1;
        assert!((table.means[last] - (LARGEST + 0.5 / LARGEST)).abs() < 1e-3);
        assert!((table.transformed(100.0) - table.transformed(99.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_transform_has_nearly_the_same_noise_everywhere_and_leads_back() {
        let table = Magnitudes::get();
        for a in [0.0, 0.5, 1.0, 2.0, 3.0, 6.0, 11.9] {
            let [mean, square] = [1, 2].map(|power| mean_over_noise(a, |m| table.transformed(m).powi(power)));
            let deviation = (square - mean * mean).sqrt();
            assert!((deviation - 1.0).abs() < 0.12, "{a}: {deviation}");
            assert!((table.without_noise(mean) - a).abs() < 0.02, "{a}: {}", table.without_noise(mean));
            assert!((table.inverse(table.transformed(a)) - a).abs() < 1e-12);
        }
        for a in [12.5, 40.0, 1e4] {
            let mean = table.transformed(a + 0.5 / a);
            assert!((table.without_noise(mean) - a).abs() < 1e-3, "{a}: {}", table.without_noise(mean));
        }
    }
}
