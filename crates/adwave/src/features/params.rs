//! Parameters of feature detection.

use super::FeatureError;
use crate::grid::Grid;
use crate::operator::OperatorKind;
use crate::{Decomposer, named_values};

/// Default width of the last level as a share of the bounding box's diagonal: twice
/// [`DEFAULT_EXTENT`](crate::bands::DEFAULT_EXTENT), that is two levels more.
///
/// The last level has no features; the widest level with features is the one before it, with σ between 2.8 and 4 %
/// of the diagonal. That is the width of the ends of limbs, a nose or a knee on a figure, which the default of the
/// bands would miss. A figure of 43 000 vertices gets the 8 levels of the paper.
pub const FEATURE_EXTENT: f64 = 2.0 * crate::bands::DEFAULT_EXTENT;

/// Width of the last level, in mean edges, up to which significant features of a mesh are looked for at least: those
/// of the level before are 12 edges wide.
const LEAST_EDGES: f64 = 17.0;

/// Largest width of the last level, as a share of the extent: wider ones are the shape itself.
const MOST_EXTENT: f64 = 0.1;

/// Default width of the last level for features, as a share of the extent of the shape: [`FEATURE_EXTENT`]; for heat on
/// a mesh at least 17 mean edges, but for that no more than 0.1. On a grid it is 0.1, so that the widest spots that are
/// found have a standard deviation of 4 % of the diagonal.
pub fn feature_extent(decomposer: &Decomposer) -> f64 {
    if Grid::from_domain(&**decomposer.domain()).is_some() {
        return MOST_EXTENT;
    }
    if !FeatureParams::default().finds_significant(decomposer)
        || decomposer.operator_kind() == OperatorKind::Walk
    {
        return FEATURE_EXTENT;
    }
    let edges = LEAST_EDGES * decomposer.mean_length() / decomposer.extent();
    if edges.is_nan() { FEATURE_EXTENT } else { edges.clamp(FEATURE_EXTENT, MOST_EXTENT) }
}

/// Default threshold θ of Algorithm 2.
pub const DEFAULT_THETA: f64 = 2.4;

/// Response R(j,x) that is compared in space and scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Response {
    /// `W_f(j,x) / mean_x‖W_f(j,x)‖`: each level divided by its own mean, so that levels are comparable.
    #[default]
    Normalized,
    /// W_f itself, as Algorithm 2 is printed; the norm of several channels. For coordinates it grows with j almost
    /// everywhere, so hardly any value is extremal on a middle level.
    Literal,
    /// Each channel of W_f separately, with all features combined; for coordinates they depend on the axes.
    Channels,
    /// `W_f(j,x) / σ_j`.
    Sigma,
}

named_values!(Response, "response", {
    Normalized => "normalized", "Each level divided by its own mean";
    Literal => "literal", "W itself, as printed in the paper; finds the size of bumps of a scalar";
    Channels => "channels", "Every channel on its own";
    Sigma => "sigma", "W divided by σ of its level";
});

/// Set of vertices over which the threshold takes its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ThresholdScope {
    /// The whole shape.
    #[default]
    Shape,
    /// Each connected component separately, so that a rough part does not hide a smooth one.
    Component,
}

/// Refinement of features between vertices and levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refinement {
    /// No refinement: the vertex and σ_j.
    #[default]
    Off,
    /// The maximum of a quadric fitted to R over the neighborhood, and of a parabola through R over log σ.
    Quadratic,
}

/// Parameters of feature detection.
///
/// ```
/// use adwave::features::{FeatureParams, Response};
/// let params = FeatureParams::default().with_theta(2.0).with_best(50);
/// assert_eq!((params.response, params.best), (Response::Normalized, Some(50)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FeatureParams {
    /// Threshold θ > 0 of Algorithm 2: a response must exceed θ times the mean |R| of its level; useful values are 1.6
    /// to 3. `None` is [`DEFAULT_THETA`] where Algorithm 2 applies, and significance where
    /// [`finds_significant`](Self::finds_significant) says so.
    pub theta: Option<f64>,
    /// Response R.
    pub response: Response,
    /// Scope of the mean.
    pub scope: ThresholdScope,
    /// Refinement of positions and sizes.
    pub refinement: Refinement,
    /// Largest ratio of the principal curvatures of R at a feature, ≥ 1; features above it are rejected as edges.
    /// SIFT uses 10.
    pub max_edge_ratio: Option<f64>,
    /// Distance from the border of a mesh or cloud, or from masked vertices, within which features are rejected, in
    /// σ, ≥ 0. A graph has no border.
    pub border_sigmas: Option<f64>,
    /// Number of features to keep; the strong ones, well spread (see [`select_spread`](super::select_spread)). For the
    /// coordinates of a mesh they are those of the largest |C|.
    pub best: Option<usize>,
    /// Step to which the values of a grid are rounded, in their unit ([`value_step`](super::value_step)); `None` if they
    /// are not. Features of the error of rounding are not significant.
    pub value_step: Option<f64>,
}

impl FeatureParams {
    /// Sets the threshold θ; `None` is the default.
    #[must_use]
    pub fn with_theta(self, theta: impl Into<Option<f64>>) -> Self {
        Self { theta: theta.into(), ..self }
    }

    /// The threshold θ of Algorithm 2.
    pub fn theta(&self) -> f64 {
        self.theta.unwrap_or(DEFAULT_THETA)
    }

    /// True if the features of the values of a grid ([`features`](super::features)), or of the coordinates of the shape
    /// of `decomposer` ([`coordinate_features`](super::coordinate_features)), are significant ones: on a cloud, unless
    /// channels are searched separately; on a grid, and on a mesh with heat on the surface, unless θ, a response or the
    /// scope asks for Algorithm 2.
    pub fn finds_significant(&self, decomposer: &Decomposer) -> bool {
        let is_default =
            (self.theta, self.response, self.scope) == (None, Response::default(), ThresholdScope::default());
        if Grid::from_domain(&**decomposer.domain()).is_some() {
            return is_default;
        }
        let Some(geometry) = decomposer.geometry() else { return false };
        if geometry.shape().is_cloud() {
            return self.response != Response::Channels;
        }
        is_default && decomposer.operator_kind() == OperatorKind::Surface && !geometry.triangles().is_empty()
    }

    /// Sets the response R.
    #[must_use]
    pub fn with_response(self, response: Response) -> Self {
        Self { response, ..self }
    }

    /// Sets the scope of the mean.
    #[must_use]
    pub fn with_scope(self, scope: ThresholdScope) -> Self {
        Self { scope, ..self }
    }

    /// Sets the refinement of positions and sizes.
    #[must_use]
    pub fn with_refinement(self, refinement: Refinement) -> Self {
        Self { refinement, ..self }
    }

    /// Rejects features on edges with a curvature ratio above `ratio`; `None` rejects none.
    #[must_use]
    pub fn with_max_edge_ratio(self, ratio: impl Into<Option<f64>>) -> Self {
        Self { max_edge_ratio: ratio.into(), ..self }
    }

    /// Rejects features within `sigmas`·σ of a border; `None` rejects none.
    #[must_use]
    pub fn with_border_sigmas(self, sigmas: impl Into<Option<f64>>) -> Self {
        Self { border_sigmas: sigmas.into(), ..self }
    }

    /// Keeps at most `best` features; `None` keeps all.
    #[must_use]
    pub fn with_best(self, best: impl Into<Option<usize>>) -> Self {
        Self { best: best.into(), ..self }
    }

    /// Sets the step to which the values of a grid are rounded; `None` if they are not.
    #[must_use]
    pub fn with_value_step(self, step: impl Into<Option<f64>>) -> Self {
        Self { value_step: step.into(), ..self }
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`FeatureError`] naming the option that is out of its range.
    pub fn check(&self) -> Result<(), FeatureError> {
        if let Some(theta) = self.theta.filter(|theta| !(theta.is_finite() && *theta > 0.0)) {
            return Err(FeatureError::Theta { theta });
        }
        for (what, value, least) in [
            ("edge ratio", self.max_edge_ratio, 1.0),
            ("distance from the border", self.border_sigmas, 0.0),
            ("step of the values", self.value_step, 0.0),
        ] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v >= least)) {
                return Err(FeatureError::Option { what, value, least });
            }
        }
        Ok(())
    }
}
