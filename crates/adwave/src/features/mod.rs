//! Features: vertices where a band stands out in place and in scale (Algorithm 2), and what can be done with them.
//!
//! x is a feature of level j when `|R(j,x)| > θ·mean|R(j)|` and R(j,x) is greater (or smaller) than R at every neighbor of
//! x on level j, and at x and its neighbors on levels j − 1 and j + 1. Neighbors are two rings on a mesh and a graph, and
//! the points that one step of the diffusion takes in on a cloud (the 10 nearest, in both directions).

mod best;
mod components;
mod descriptor;
mod detect;
mod matching;
mod params;
mod refine;
mod response;
mod spheres;

pub use best::spread_best;
pub use descriptor::{DESCRIPTOR_LENGTH, Descriptor, describe};
pub use detect::{features, is_extremum};
pub use matching::{Match, match_features};
pub use params::{FEATURE_EXTENT, FeatureParams, Refinement, Response, ThresholdScope};
pub use spheres::{Spheres, spheres};

use crate::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// A place where a band stands out.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// The vertex of the shape; of several at one position the first.
    pub vertex: usize,
    /// Where it is in model units: the vertex, or near it after refinement. `None` on a graph.
    pub position: Option<[f64; 3]>,
    /// The level j.
    pub level: usize,
    /// Its radius in model units: σ_j, or nearby after refinement.
    pub sigma: f64,
    /// R(j,x).
    pub response: f64,
    /// `|R(j,x)| / mean|R(j)|`, which is above θ and compares between levels and responses.
    pub strength: f64,
    /// The channel, where each is searched by itself.
    pub channel: Option<usize>,
}

impl Feature {
    /// The sign of the response: 1 where the signal is above what it is around the vertex, −1 where it is below; a norm is always
    /// positive. Most features are maxima where it is 1 and minima where it is −1, but not all: Algorithm 2 asks for an extremum of
    /// R and for a large |R|, so a minimum of a positive R counts too (a saddle between two bumps).
    pub fn sign(&self) -> i8 {
        if self.response < 0.0 { -1 } else { 1 }
    }
}

/// Why features cannot be looked for.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum FeatureError {
    /// A feature needs a finer and a coarser level beside its own.
    #[error("features need at least 3 levels and there are {n_levels}; take more levels")]
    TooFewLevels {
        /// Levels there are.
        n_levels: usize,
    },
    /// A threshold that every vertex or none passes.
    #[error("the threshold θ is {theta}; it must be a finite number above 0 (useful are 1.6 to 3)")]
    Theta {
        /// The threshold given.
        theta: f64,
    },
    /// An option is not a number that makes sense.
    #[error("the {what} is {value}; it must be a finite number of at least {least}")]
    Option {
        /// Which option.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The least that makes sense.
        least: f64,
    },
    /// The bands are those of another shape.
    #[error("the bands are those of {n_bands} welded vertices, the shape has {n_vertices}")]
    OtherShape {
        /// Welded vertices of the bands.
        n_bands: usize,
        /// Welded vertices of the shape.
        n_vertices: usize,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for FeatureError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}
