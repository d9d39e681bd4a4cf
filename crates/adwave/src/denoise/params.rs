//! What a caller may ask of a denoiser, and what is reported back.

use super::DenoiseError;
use crate::named_values;
use serde::{Deserialize, Serialize};

/// What becomes of edges where the surface turns at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Creases {
    /// What the estimated risk prefers.
    #[default]
    Auto,
    /// They stay sharp: a walk that hardly crosses them.
    Keep,
    /// They are smoothed like all else.
    None,
}

named_values!(Creases, "creases", {
    Auto => "auto", "Kept or smoothed, whichever has the smaller estimated error";
    Keep => "keep", "Kept sharp";
    None => "none", "Smoothed like everything else";
});

/// How a shape is denoised. The defaults need no thought.
///
/// ```
/// use adwave::denoise::{Creases, DenoiseParams};
/// let params = DenoiseParams::default().with_creases(Creases::Keep);
/// assert_eq!((params.strength, params.noise), (1.0, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DenoiseParams {
    /// By how much the noise counts: 0 changes nothing, 1 is the least estimated risk, 2 takes the noise for twice as large.
    pub strength: f64,
    /// What becomes of creases.
    pub creases: Creases,
    /// Standard deviation of the noise along the normals in model units; estimated where not given.
    pub noise: Option<f64>,
}

impl Default for DenoiseParams {
    fn default() -> Self {
        Self { strength: 1.0, creases: Creases::Auto, noise: None }
    }
}

impl DenoiseParams {
    /// Sets by how much the noise counts.
    #[must_use]
    pub fn with_strength(self, strength: f64) -> Self {
        Self { strength, ..self }
    }

    /// Sets what becomes of creases.
    #[must_use]
    pub fn with_creases(self, creases: Creases) -> Self {
        Self { creases, ..self }
    }

    /// Sets the standard deviation of the noise, in model units.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise: Some(noise), ..self }
    }

    /// Whether all is in its range.
    ///
    /// # Errors
    /// [`DenoiseError::Number`] for what is not finite or below 0.
    pub fn check(&self) -> Result<(), DenoiseError> {
        let number = |what, value: f64| {
            if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(DenoiseError::Number { what, value }) }
        };
        number("strength", self.strength)?;
        self.noise.map_or(Ok(()), |noise| number("noise", noise))
    }
}

/// What was assumed of the noise, and what was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DenoiseInfo {
    /// Standard deviation of the noise along the normals, in model units: as estimated or given.
    pub noise: f64,
    /// The same in mean edges of a mesh, or mean distances to the neighbors of a cloud.
    pub noise_in_edges: f64,
    /// How much of the result comes from the normals as they are, by what is assumed of the noise: 1 where nothing is to be done.
    pub kept: f64,
    /// How much comes from the walk that respects creases after 1, 2, 4, … steps.
    pub crease_weights: Vec<f64>,
    /// How much comes from the walk that all but ignores them after 1, 2, 4, … steps.
    pub smooth_weights: Vec<f64>,
    /// Triangles, or points of a cloud, that the risk was estimated on.
    pub n_sampled: usize,
    /// Vertices of the shape that moved farther than three times the estimated noise.
    pub n_far: usize,
    /// The greatest distance that a vertex moved, in model units.
    pub furthest: f64,
}

/// A denoised shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// New positions, in the order of the shape.
    pub points: Vec<[f64; 3]>,
    /// What was assumed and done.
    pub info: DenoiseInfo,
}
