//! Errors of simplification.

use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Failure of a simplification.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SimplifyError {
    /// The target distance is negative or not finite.
    #[error("the target distance must be finite and not negative, got {0:?}")]
    Length(f64),
    /// The target is 0 vertices.
    #[error("the number of vertices must be at least 1, got 0")]
    NoVertices,
    /// The target ratio is outside (0, 1].
    #[error("the ratio must be above 0 and at most 1, got {0:?}")]
    Ratio(f64),
    /// The number of labels differs from the number of corners.
    #[error("one label per corner of the faces is needed, got {found} labels for {n_corners} corners")]
    Labels {
        /// Number of labels.
        found: usize,
        /// Number of corners of the faces.
        n_corners: usize,
    },
    /// The number of values differs from `n_channels` per corner, or `n_channels` is 0.
    #[error(
        "{n_channels} values per corner of the faces are needed, at least 1, got {found} values for {n_corners} corners"
    )]
    Values {
        /// Number of values.
        found: usize,
        /// Number of corners of the faces.
        n_corners: usize,
        /// Number of values per corner.
        n_channels: usize,
    },
    /// The number of weights differs from that of the vertices.
    #[error("one weight per vertex is needed, got {found} weights for {n_vertices} vertices")]
    Weights {
        /// Number of weights.
        found: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A weight is not finite.
    #[error("weights must be finite, got {value:?} at vertex {vertex}")]
    Weight {
        /// The value.
        value: f64,
        /// Index of the vertex.
        vertex: usize,
    },
    /// No face has a positive area.
    #[error("no face has a positive area; simplify the shape as a cloud")]
    NoSurface,
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SimplifyError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
