//! Parameters of the denoiser, and information about its result.

use super::DenoiseError;
use crate::local_fit::LocalFit;
use crate::named_values;
use crate::shape::MAX_COORDINATE;
use serde::{Deserialize, Serialize};

/// Largest factor of the noise level; all detail is gone long before.
const MAX_STRENGTH: f64 = 1e6;

/// Treatment of creases, where the surface turns abruptly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Creases {
    /// Whatever the estimated risk prefers.
    #[default]
    Auto,
    /// Creases stay sharp: a walk that hardly crosses them.
    Keep,
    /// Creases are smoothed like everything else.
    None,
}

named_values!(Creases, "creases", {
    Auto => "auto", "Kept or smoothed, whichever has the smaller estimated error";
    Keep => "keep", "Kept sharp";
    None => "none", "Smoothed like everything else";
});

/// Parameters of denoising. The defaults need no tuning.
///
/// ```
/// use adwave::denoise::{Creases, DenoiseParams};
/// let params = DenoiseParams::default().with_creases(Creases::Keep);
/// assert_eq!((params.strength, params.noise), (1.0, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DenoiseParams {
    /// Factor of the noise level: 0 changes nothing, 1 minimizes the estimated risk, 2 assumes twice the noise.
    pub strength: f64,
    /// Treatment of creases.
    pub creases: Creases,
    /// Standard deviation of the noise along the normals in model units; estimated if `None`.
    pub noise: Option<f64>,
    /// Fields that smoothing leaves unchanged; for [`denoise_signal`](super::denoise_signal) only.
    #[serde(default = "default_local_fit")]
    pub local_fit: LocalFit,
}

/// Local fit of a field to be denoised: slopes are not noise.
fn default_local_fit() -> LocalFit {
    LocalFit::Linear
}

impl Default for DenoiseParams {
    fn default() -> Self {
        Self { strength: 1.0, creases: Creases::Auto, noise: None, local_fit: default_local_fit() }
    }
}

impl DenoiseParams {
    /// Sets the factor of the noise level.
    #[must_use]
    pub fn with_strength(self, strength: f64) -> Self {
        Self { strength, ..self }
    }

    /// Sets the treatment of creases.
    #[must_use]
    pub fn with_creases(self, creases: Creases) -> Self {
        Self { creases, ..self }
    }

    /// Sets the standard deviation of the noise, in model units.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise: Some(noise), ..self }
    }

    /// Sets the fields that smoothing leaves unchanged.
    #[must_use]
    pub fn with_local_fit(self, local_fit: LocalFit) -> Self {
        Self { local_fit, ..self }
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// [`DenoiseError::Number`] for a strength that is not in 0..=10⁶, or a noise that is not in 0..=10¹⁰⁰.
    pub fn check(&self) -> Result<(), DenoiseError> {
        let number = |what, value: f64, most: f64| {
            if (0.0..=most).contains(&value) {
                Ok(())
            } else {
                Err(DenoiseError::Number { what, value, most })
            }
        };
        number("strength", self.strength, MAX_STRENGTH)?;
        self.noise.map_or(Ok(()), |noise| number("noise", noise, MAX_COORDINATE))
    }
}

/// Assumed noise, and the operations applied.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DenoiseInfo {
    /// Standard deviation of the noise along the normals in model units, estimated or given.
    pub noise: f64,
    /// Standard deviation in mean edge lengths of a mesh, or mean neighbor distances of a cloud.
    pub noise_in_edges: f64,
    /// Weight of the unchanged normals in the result; 1 if nothing is to be done.
    pub kept: f64,
    /// Weights of the walk that respects creases, after 1, 2, 4, … steps.
    pub crease_weights: Vec<f64>,
    /// Weights of the walk that nearly ignores creases, after 1, 2, 4, … steps.
    pub smooth_weights: Vec<f64>,
    /// Number of triangles, or points of a cloud, on which the risk was estimated.
    pub n_sampled: usize,
    /// Number of vertices that moved further than three times the estimated noise.
    pub n_far: usize,
    /// Largest distance that a vertex moved, in model units.
    pub furthest: f64,
}

/// A denoised shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// New positions, in the order of the shape.
    pub points: Vec<[f64; 3]>,
    /// Assumed noise, and the operations applied.
    pub info: DenoiseInfo,
}
