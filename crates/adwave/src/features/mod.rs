//! Features: vertices at which a band is extremal in space and in scale (Algorithm 2), and their use.
//!
//! The vertex x is a feature of level j if `|R(j,x)| > θ·mean|R(j)|` and R(j,x) is greater (or smaller) than R at
//! every neighbor of x on level j, and at x and its neighbors on levels j − 1 and j + 1. The neighborhood is two
//! rings on a mesh or graph, and on a cloud the points of one diffusion step (the 10 nearest, in both directions).

mod best;
mod cloud;
mod components;
mod coordinates;
mod descriptor;
mod detect;
mod disk;
mod grid;
mod matching;
mod params;
mod refine;
mod response;
mod sample;
mod spheres;
mod surface;

pub use best::select_spread;
pub use coordinates::{CoordinateFeatureError, CoordinateFeatures, ShapeCoordinates, coordinate_features};
pub use descriptor::{DESCRIPTOR_LENGTH, Descriptor, describe};
pub use detect::{features, is_extremum};
pub use grid::value_step;
pub use matching::{Match, match_features};
pub use params::{
    DEFAULT_THETA, FEATURE_EXTENT, FeatureParams, Refinement, Response, ThresholdScope, feature_extent,
};
pub use spheres::{Spheres, spheres};

use crate::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// A location at which a band is extremal.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Index of the vertex of the shape; the first one if several share the position.
    pub vertex: usize,
    /// Position in model units: the vertex, or near it after refinement. `None` on a graph.
    pub position: Option<[f64; 3]>,
    /// The level j.
    pub level: usize,
    /// Radius in model units: σ_j, or near it after refinement.
    pub sigma: f64,
    /// The response R(j,x), for significant features of a grid less its median over a ring around the place.
    pub response: f64,
    /// Strength `|R(j,x)| / mean|R(j)|`, which is above θ and comparable between levels and responses.
    pub strength: f64,
    /// The channel, if channels are searched separately.
    pub channel: Option<usize>,
}

impl Feature {
    /// Sign of the response: 1 if the signal is above its surroundings, −1 if it is below; a norm is always
    /// positive. Most features are maxima for 1 and minima for −1, but not all: Algorithm 2 requires an extremum of
    /// R and a large |R|, so a minimum of a positive R counts too (a saddle between two bumps).
    pub fn sign(&self) -> i8 {
        if self.response < 0.0 { -1 } else { 1 }
    }
}

/// Error of feature detection.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FeatureError {
    /// There are fewer than 3 levels; a feature needs a finer and a coarser level.
    #[error("features need at least 3 levels, got {n_levels}; use more levels")]
    TooFewLevels {
        /// Number of levels.
        n_levels: usize,
    },
    /// The threshold is not positive and finite.
    #[error("the threshold θ is {theta}; it must be a finite number above 0 (useful are 1.6 to 3)")]
    Theta {
        /// The threshold.
        theta: f64,
    },
    /// An option is out of its range.
    #[error("the {what} is {value}; it must be a finite number of at least {least}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value of the option.
        value: f64,
        /// Smallest valid value.
        least: f64,
    },
    /// The bands belong to another shape.
    #[error("the bands are those of {n_bands} welded vertices, the shape has {n_vertices}")]
    OtherShape {
        /// Number of welded vertices of the bands.
        n_bands: usize,
        /// Number of welded vertices of the shape.
        n_vertices: usize,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for FeatureError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}
