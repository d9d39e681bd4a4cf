//! Parameters of saliency: levels, weights and sign.

use super::SaliencyError;
use crate::bands::DEFAULT_EXTENT;
use crate::named_values;

/// Default width of the last level of the signed map, as a share of the diagonal.
pub const SALIENCY_EXTENT: f64 = 0.16;

/// Weights α_j of the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Weighting {
    /// `α_j = (max_x|W_f(j,x)| − mean_x|W_f(j,x)|)²`, one number per level, as the paper's text describes.
    PerLevel,
    /// `α_j(x) = (max_y|W_f(j,y)| − |W_f(j,x)|)²`, as (eq. 17) is printed. It gives the strongest response of a
    /// level weight 0.
    AsPrinted,
    /// `α_j = mean_x(r·ln r)/mean_x|W_f(j,x)|` with `r(x) = |W_f(j,x)|/mean|W_f(j)|`: every level is divided by its
    /// mean and weighted by its unevenness. mean(r·ln r) ≥ 0 is the difference between the entropy of an even level
    /// and that of the level; it is 0 if |W| is the same everywhere (a sphere), so a level on which nothing stands
    /// out contributes nothing. For heat on a mesh, the triangles and noise explain deviations from the mean ⟨W(j)⟩ up to
    /// `d = 6·√(0.09·s²·a/σ_j² + 0.04·⟨W⟩²·e⁴/σ_j⁴)` at x: s² is the variance of independent displacements that would
    /// make the two finest levels as rough as they are around x, a the area of x, e the mean length of its edges, and
    /// s²·a and e⁴ are the largest among x, its neighbors and the mean of all. α_j is multiplied by
    /// `t = max|W − ⟨W⟩|²/d² − 1` within [0, 1], and W(j,x) is brought closer to the mean by (1 − t)·d. A perfect
    /// sphere has saliency 0.
    #[default]
    Entropy,
    /// `α_j = 1/mean_x|W_f(j,x)|`: every level has the same weight, as for features.
    Normalized,
    /// Ranks instead of values on every level: the share of vertices with a smaller |W_f(j)|, equal ones counting
    /// half, so that no level and no outlier dominates.
    Ranks,
    /// `α_j = 1`.
    Uniform,
}

/// Treatment of the sign, which distinguishes bumps from dents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// W_f(j) with its sign: that of a scalar signal, or, for coordinates, that along the outward normal. Norms of
    /// several channels have no sign, and their map is the unsigned one.
    #[default]
    Signed,
    /// |W_f(j)|: bumps and dents alike, as in the paper.
    Unsigned,
}

/// Weighting of the levels of a map by its name; all but `signed` give a map without a sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MapWeighting {
    /// [`Weighting::Entropy`] with the sign, over all levels.
    #[default]
    Signed,
    /// [`Weighting::PerLevel`] without the two finest levels.
    Paper,
    /// [`Weighting::AsPrinted`] without the two finest levels.
    Printed,
    /// [`Weighting::Normalized`] without the two finest levels.
    Normalized,
    /// [`Weighting::Ranks`] without the two finest levels.
    Ranks,
    /// [`Weighting::Uniform`] without the two finest levels.
    None,
}

named_values!(MapWeighting, "weighting", {
    Signed => "signed", "1/mean, times how unevenly the level is spread, with the sign: of coordinates + where the shape is convex";
    Paper => "paper" | "level", "(max − mean)², one number per level";
    Printed => "printed", "(max − |W|)² at each vertex, as printed (eq. 17)";
    Normalized => "normalized", "1/mean, so that every level counts alike";
    Ranks => "ranks", "Ranks instead of values";
    None => "none", "1 for every level";
});

impl MapWeighting {
    /// Parameters of a map with this weighting. `sign` matters for [`Signed`](Self::Signed) only.
    pub fn params(self, sign: Sign) -> SaliencyParams {
        let weighting = match self {
            Self::Signed => return SaliencyParams::default().with_sign(sign),
            Self::Paper => Weighting::PerLevel,
            Self::Printed => Weighting::AsPrinted,
            Self::Normalized => Weighting::Normalized,
            Self::Ranks => Weighting::Ranks,
            Self::None => Weighting::Uniform,
        };
        SaliencyParams::paper().with_weighting(weighting)
    }

    /// Share of the diagonal that the last level reaches if no number of levels is asked for.
    pub fn extent(self) -> f64 {
        if self == Self::Signed { SALIENCY_EXTENT } else { DEFAULT_EXTENT }
    }
}

/// Parameters of a saliency map.
///
/// ```
/// use adwave::saliency::{SaliencyParams, Sign, Weighting};
/// let params = SaliencyParams::default();
/// assert_eq!((params.skip, params.weighting, params.sign), (0, Weighting::Entropy, Sign::Signed));
/// let params = SaliencyParams::paper();
/// assert_eq!((params.skip, params.weighting, params.sign), (2, Weighting::PerLevel, Sign::Unsigned));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SaliencyParams {
    /// Number of finest levels that are skipped.
    pub skip: usize,
    /// Weights α_j.
    pub weighting: Weighting,
    /// Treatment of the sign.
    pub sign: Sign,
    /// Fades out the effect of the border of a mesh or cloud, or of masked vertices. With a value S ≥ 0, |W_f(j)|
    /// is multiplied by 0 within S·σ_j of the border along the surface and by 1 beyond 2S·σ_j, with a smooth
    /// transition. The factor differs between levels, so vertices too close to the border for a coarse level are
    /// still judged by fine ones, and the map is defined everywhere. Coordinates need S = 1: along a straight
    /// border S_f(j) shrinks by σ_j/√π, and at a distance of σ_j by a tenth of that. A graph has no border.
    pub border_sigmas: Option<f64>,
}

impl SaliencyParams {
    /// Parameters of the paper's map (eq. 17): all but the two finest levels, which hold the noise, with
    /// [`Weighting::PerLevel`] and without sign.
    pub fn paper() -> Self {
        Self { skip: 2, weighting: Weighting::PerLevel, sign: Sign::Unsigned, border_sigmas: None }
    }

    /// Sets the treatment of the sign.
    #[must_use]
    pub fn with_sign(self, sign: Sign) -> Self {
        Self { sign, ..self }
    }

    /// Sets the number of finest levels that are skipped.
    #[must_use]
    pub fn with_skip(self, skip: usize) -> Self {
        Self { skip, ..self }
    }

    /// Sets the weights α_j.
    #[must_use]
    pub fn with_weighting(self, weighting: Weighting) -> Self {
        Self { weighting, ..self }
    }

    /// Fades out the border within the given distance in σ; `None` does not fade it.
    #[must_use]
    pub fn with_border_sigmas(self, sigmas: impl Into<Option<f64>>) -> Self {
        Self { border_sigmas: sigmas.into(), ..self }
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`SaliencyError::Border`] if the border distance is invalid.
    pub fn check(&self) -> Result<(), SaliencyError> {
        match self.border_sigmas {
            Some(sigmas) if !(sigmas.is_finite() && sigmas >= 0.0) => Err(SaliencyError::Border { sigmas }),
            _ => Ok(()),
        }
    }
}
