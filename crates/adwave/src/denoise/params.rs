//! Parameters of the denoiser, and information about its result.

use super::{DenoiseError, NoiseModel};
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

/// Treatment of the outliers of a cloud: points far from the surface of their neighbors and from their neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Outliers {
    /// Outliers stay where they are.
    #[default]
    Keep,
    /// Outliers move to the height of their neighbors.
    Pull,
    /// Outliers stay, and [`Denoised::outliers`] names them, for the caller to remove.
    Drop,
}

named_values!(Outliers, "treatment of outliers", {
    Keep => "keep", "They stay where they are";
    Pull => "pull", "They are moved to the surface of their neighbors";
    Drop => "drop", "They are removed";
});

/// Noise of a mesh that neighbors share, as scanners make it. It looks like detail of the same size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum SharedNoise {
    /// Shared noise counts as detail and stays.
    #[default]
    Detail,
    /// As much shared noise as the shape admits: everything on its quietest tenth that quadrics do not explain.
    Estimate,
    /// Standard deviation along the normals, in model units.
    Deviation(f64),
}

impl SharedNoise {
    /// The treatment that a word names: `detail` or `auto`.
    pub fn from_word(word: &str) -> Option<Self> {
        match word {
            "detail" => Some(Self::Detail),
            "auto" => Some(Self::Estimate),
            _ => None,
        }
    }
}

/// Parameters of denoising. The defaults need no tuning.
///
/// ```
/// use adwave::denoise::{Creases, DenoiseParams};
/// let params = DenoiseParams::default().with_creases(Creases::Keep);
/// assert_eq!((params.strength, params.noise), (1.0, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct DenoiseParams {
    /// Factor of the noise level: 0 changes nothing, 1 minimizes the estimated risk, 2 assumes twice the noise.
    pub strength: f64,
    /// Treatment of creases.
    pub creases: Creases,
    /// Standard deviation of the noise along the normals in model units, or of a field as `noise_model` measures it;
    /// estimated if `None`.
    pub noise: Option<f64>,
    /// Dependence of the noise of a field on its values; for [`denoise_signal`](super::denoise_signal) only.
    #[serde(default)]
    pub noise_model: NoiseModel,
    /// Fields that smoothing leaves unchanged; for [`denoise_signal`](super::denoise_signal) only.
    #[serde(default = "default_local_fit")]
    pub local_fit: LocalFit,
    /// Treatment of the outliers of a cloud.
    #[serde(default)]
    pub outliers: Outliers,
    /// Noise of a mesh that neighbors share.
    #[serde(default)]
    pub shared: SharedNoise,
}

/// Local fit of a field to be denoised: slopes are not noise.
fn default_local_fit() -> LocalFit {
    LocalFit::Linear
}

impl Default for DenoiseParams {
    fn default() -> Self {
        Self {
            strength: 1.0,
            creases: Creases::Auto,
            noise: None,
            noise_model: NoiseModel::Gaussian,
            local_fit: default_local_fit(),
            outliers: Outliers::Keep,
            shared: SharedNoise::Detail,
        }
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

    /// Sets the dependence of the noise of a field on its values.
    #[must_use]
    pub fn with_noise_model(self, noise_model: NoiseModel) -> Self {
        Self { noise_model, ..self }
    }

    /// Sets the fields that smoothing leaves unchanged.
    #[must_use]
    pub fn with_local_fit(self, local_fit: LocalFit) -> Self {
        Self { local_fit, ..self }
    }

    /// Sets the treatment of the outliers of a cloud.
    #[must_use]
    pub fn with_outliers(self, outliers: Outliers) -> Self {
        Self { outliers, ..self }
    }

    /// Sets the noise of a mesh that neighbors share.
    #[must_use]
    pub fn with_shared(self, shared: SharedNoise) -> Self {
        Self { shared, ..self }
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
        if let SharedNoise::Deviation(shared) = self.shared {
            number("shared noise", shared, MAX_COORDINATE)?;
        }
        self.noise.map_or(Ok(()), |noise| number("noise", noise, MAX_COORDINATE))
    }
}

/// Assumed noise, and the operations applied.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DenoiseInfo {
    /// Standard deviation of the noise along the normals in model units, estimated or given; of a cloud whose noise differs
    /// by place its root mean square over the points, of a curve that of the axes with noise.
    pub noise: f64,
    /// Standard deviation in mean edge lengths of a mesh or of the denoised curve, or mean neighbor distances of a cloud.
    pub noise_in_edges: f64,
    /// Weight of the unchanged normals in the result; 1 if the walks have nothing to do.
    pub kept: f64,
    /// Weights of the walk that respects creases, after 1, 2, 4, … steps.
    pub crease_weights: Vec<f64>,
    /// Weights of the walk that nearly ignores creases, after 1, 2, 4, … steps.
    pub smooth_weights: Vec<f64>,
    /// Number of triangles, or points of a cloud, on which the risk was estimated.
    pub n_sampled: usize,
    /// Number of vertices that would have moved further than three times the assumed noise; those of a mesh or curve
    /// were stopped there.
    pub n_far: usize,
    /// Largest distance that a vertex moved, in model units.
    pub furthest: f64,
    /// Kinds of noise of a mesh, and their treatment; `None` for clouds and curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshDenoising>,
    /// Noise and treatment of a cloud; `None` for meshes and curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cloud: Option<CloudDenoising>,
    /// Noise of a curve by axis, and its length; `None` for meshes and clouds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveDenoising>,
}

impl DenoiseInfo {
    /// Standard deviation of the assumed noise of a mesh along the normals, including the noise that neighbors share,
    /// in model units.
    pub(super) fn total_noise(&self) -> f64 {
        self.noise.hypot(self.mesh.as_ref().map_or(0.0, |mesh| mesh.shared))
    }
}

/// Kinds of noise of a mesh other than noise along the normals, and the treatment of each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshDenoising {
    /// Share of the vertices that impulses moved, in 0..=1; 0 if impulses are not a kind of noise of their own. These
    /// vertices are first moved to where the planes around them meet.
    pub impulse_share: f64,
    /// Root mean square size of the impulses, in model units.
    pub impulse_size: f64,
    /// Share of the triangles that are turned against the surface around them, in 0..=1: noise in all directions turns
    /// them, noise along the normals hardly does.
    pub turned_share: f64,
    /// Largest standard deviation, along the normals and in model units, of noise that neighbors share: stronger shared
    /// noise would show on the quietest places of the shape. Detail of this size looks the same.
    #[serde(default)]
    pub shared_at_most: f64,
    /// Standard deviation of the shared noise that was assumed and removed, in model units; 0 if it counts as detail.
    #[serde(default)]
    pub shared: f64,
    /// Number of means over a vertex and its neighbors that turn white noise into the shared noise.
    #[serde(default)]
    pub shared_steps: usize,
    /// The 5 % and the 95 % quantile of the noise over the vertices if it differs from place to place; else the noise
    /// twice.
    #[serde(default)]
    pub noise_range: [f64; 2],
    /// Weight of the unchanged normals where the surface bends least, in between and where it bends most; empty if one
    /// mixture holds everywhere.
    #[serde(default)]
    pub kept_by_place: Vec<f64>,
    /// Rounds of the linear filter that precede the walks, with a fraction.
    pub linear_rounds: f64,
    /// Number of guides of the walk that respects creases.
    pub n_guides: usize,
}

/// Noise of a cloud by place, and the treatment of its points. Lengths are in model units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CloudDenoising {
    /// The 5 % and the 95 % quantile of the noise over the points.
    pub noise_range: [f64; 2],
    /// Interval around the noise that holds the true one in nine of ten generated clouds; the noise twice
    /// if it is given.
    #[serde(default)]
    pub noise_interval: [f64; 2],
    /// Number of outliers.
    pub n_outliers: usize,
    /// Treatment of the outliers.
    pub outliers: Outliers,
    /// Number of points that stay because their neighbors form no surface, or because they would move farther than
    /// three times the noise there.
    pub n_left: usize,
    /// Step to which the coordinates are rounded; 0 if none is found.
    pub rounding: f64,
    /// Number of nearest points of each from which 48 neighbors are chosen: 48, or more if points lie in lines.
    #[serde(default)]
    pub neighbors: usize,
    /// Mean distance to the nearest neighbor, before and after.
    pub nearest_distance: [f64; 2],
    /// Noise larger than about half the distance of the points, if most places have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strong: Option<StrongNoise>,
    /// Mean over places of the mean absolute residual of a quadric divided by the root mean square (Geary's ratio):
    /// about 0.80 for noise on one surface, 0.82 if neighborhoods hold two surfaces 2.5 standard deviations of the noise
    /// apart, 0.85 at 3.5. `None` unless most places are flat and have noise of a fifth of the distance of the points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual_ratio: Option<f64>,
    /// Share of 2000 places around which a neighborhood of 16 to 768 points, and at most a quarter of
    /// the cloud, is flat; `None` if the noise is given, and for fewer
    /// than 256 points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flat_share: Option<f64>,
}

/// Noise of a curve along each axis, and its length. Lengths are in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CurveDenoising {
    /// Standard deviation along x, y and z; equal where no difference is found, 0 for an exact axis.
    pub noise_by_axis: [f64; 3],
    /// Step to which the coordinates along each axis are rounded; 0 if none is found.
    pub rounding: [f64; 3],
    /// Length of the edges before and after. Noise stretches the first.
    pub length: [f64; 2],
}

/// Noise of a cloud that is larger than about half the distance of its points. Lengths are in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrongNoise {
    /// Median of the standard deviation.
    pub noise: f64,
    /// Lower quartile of the standard deviation, which is assumed where it is not found.
    pub at_least: f64,
    /// Number of neighbors that are needed to see it; the fits have up to four times as many.
    pub neighbors: usize,
}

impl StrongNoise {
    /// Scales all lengths.
    #[must_use]
    fn in_units(self, unit: f64) -> Self {
        Self { noise: self.noise * unit, at_least: self.at_least * unit, ..self }
    }
}

impl CloudDenoising {
    /// Smallest [`residual_ratio`](Self::residual_ratio) that noise on one surface hardly reaches: at most 0.823 on the
    /// generated shapes and sensors of `cargo xtask bench-denoise` that have no walls thinner than a few points.
    const TWO_SURFACES: f64 = 0.83;

    /// Smallest [`flat_share`](Self::flat_share) with which the noise found is trusted: at least 0.6 on generated spheres,
    /// tori, saddles, planes, boxes, cylinders and stairs with noise of 0.05 to 3 spacings.
    const MOSTLY_FLAT: f64 = 0.5;

    /// True if the noise may be larger than found: at most places no neighborhood is flat, because the surface is bent,
    /// thin or a volume, or because the noise is larger than the distance of the points.
    pub fn is_noise_doubtful(&self) -> bool {
        self.strong.is_none() && self.flat_share.is_some_and(|share| share < Self::MOSTLY_FLAT)
    }

    /// True if most neighborhoods seem to hold two surfaces: thin walls, or passes that are shifted against each other.
    pub fn has_two_surfaces(&self) -> bool {
        self.residual_ratio.is_some_and(|ratio| ratio > Self::TWO_SURFACES)
    }

    /// All lengths times `unit`.
    #[must_use]
    pub fn in_units(self, unit: f64) -> Self {
        Self {
            noise_range: self.noise_range.map(|s| s * unit),
            noise_interval: self.noise_interval.map(|s| s * unit),
            rounding: self.rounding * unit,
            nearest_distance: self.nearest_distance.map(|d| d * unit),
            strong: self.strong.map(|strong| strong.in_units(unit)),
            ..self
        }
    }
}

/// A denoised shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// New positions, in the order of the shape.
    pub points: Vec<[f64; 3]>,
    /// Outliers of a cloud, ascending.
    pub outliers: Vec<u32>,
    /// Standard deviation of the noise at each vertex, in model units: along the normals of a mesh or cloud, the root of
    /// the sum of the squares along the axes of a curve; 0 for vertices that take no part. No vertex moves farther than
    /// three times its noise (times the strength, if that is above 1), except those that impulses moved and outliers
    /// that are pulled.
    pub noise: Vec<f64>,
    /// Assumed noise, and the operations applied.
    pub info: DenoiseInfo,
}
