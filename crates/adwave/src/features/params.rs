//! What a caller may ask of features.

use super::FeatureError;
use crate::named_values;

/// How wide the last level is where no number of levels is asked for, as a share of the bounding box's diagonal: twice
/// [`DEFAULT_EXTENT`](crate::bands::DEFAULT_EXTENT), which is two levels more.
///
/// The last level holds no feature; the widest that does is the one before it, σ from 2.8 to 4 % of the diagonal. That is
/// how wide the ends of limbs, a nose or a knee are on a figure; on the default of the bands they would be too wide to be
/// found. It gives a figure of 43 000 vertices the 8 levels of the paper.
pub const FEATURE_EXTENT: f64 = 2.0 * crate::bands::DEFAULT_EXTENT;

/// The number R(j,x) that is compared in place and scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Response {
    /// `W_f(j,x) / mean_x‖W_f(j,x)‖`: each level by its own mean, so that levels compare.
    #[default]
    Normalized,
    /// W_f itself, as Algorithm 2 is printed; the norm of several channels. That of coordinates grows with j almost
    /// everywhere, so hardly any is largest on a middle level.
    Literal,
    /// Every channel of W_f by itself, and all features together; for coordinates they depend on the axes.
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

/// Over what the mean in the threshold is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThresholdScope {
    /// The whole shape.
    #[default]
    Shape,
    /// Each connected component by itself, so that a rough part does not hide a smooth one.
    Component,
}

/// Whether features are placed between vertices and levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refinement {
    /// At the vertex, with σ_j.
    #[default]
    Off,
    /// At the top of a quadric that is fitted to R over the neighborhood, and of a parabola through R over log σ.
    Quadratic,
}

/// What counts as a feature.
///
/// ```
/// use adwave::features::{FeatureParams, Response};
/// let params = FeatureParams::default().with_theta(2.0).with_best(50);
/// assert_eq!((params.response, params.best), (Response::Normalized, Some(50)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureParams {
    /// How many times the mean |R| of its level a response must be; > 0, useful are 1.6 to 3.
    pub theta: f64,
    /// What R is.
    pub response: Response,
    /// Over what the mean is taken.
    pub scope: ThresholdScope,
    /// Whether places and sizes are refined.
    pub refinement: Refinement,
    /// Reject edges: the largest ratio of the principal curvatures of R at a feature, ≥ 1; SIFT takes 10.
    pub max_edge_ratio: Option<f64>,
    /// Reject features within so many σ of the border of a mesh or cloud, or of masked vertices; ≥ 0. A
    /// graph has no border.
    pub border_sigmas: Option<f64>,
    /// Keep only so many, the strong ones well spread (see [`spread_best`](super::spread_best)).
    pub best: Option<usize>,
}

impl Default for FeatureParams {
    fn default() -> Self {
        Self {
            theta: 2.4,
            response: Response::default(),
            scope: ThresholdScope::default(),
            refinement: Refinement::default(),
            max_edge_ratio: None,
            border_sigmas: None,
            best: None,
        }
    }
}

impl FeatureParams {
    /// Sets θ.
    #[must_use]
    pub fn with_theta(self, theta: f64) -> Self {
        Self { theta, ..self }
    }

    /// Sets what R is.
    #[must_use]
    pub fn with_response(self, response: Response) -> Self {
        Self { response, ..self }
    }

    /// Sets over what the mean is taken.
    #[must_use]
    pub fn with_scope(self, scope: ThresholdScope) -> Self {
        Self { scope, ..self }
    }

    /// Sets whether places and sizes are refined.
    #[must_use]
    pub fn with_refinement(self, refinement: Refinement) -> Self {
        Self { refinement, ..self }
    }

    /// Rejects features on edges.
    #[must_use]
    pub fn with_max_edge_ratio(self, ratio: f64) -> Self {
        Self { max_edge_ratio: Some(ratio), ..self }
    }

    /// Rejects features near a border.
    #[must_use]
    pub fn with_border_sigmas(self, sigmas: f64) -> Self {
        Self { border_sigmas: Some(sigmas), ..self }
    }

    /// Keeps only so many.
    #[must_use]
    pub fn with_best(self, best: usize) -> Self {
        Self { best: Some(best), ..self }
    }

    /// Checks that the numbers make sense.
    ///
    /// # Errors
    /// [`FeatureError`] naming the one that does not.
    pub fn check(&self) -> Result<(), FeatureError> {
        if !(self.theta.is_finite() && self.theta > 0.0) {
            return Err(FeatureError::Theta { theta: self.theta });
        }
        for (what, value, least) in
            [("edge ratio", self.max_edge_ratio, 1.0), ("distance from the border", self.border_sigmas, 0.0)]
        {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v >= least)) {
                return Err(FeatureError::Option { what, value, least });
            }
        }
        Ok(())
    }
}
