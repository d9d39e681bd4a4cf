//! Errors of rendering.

use crate::view::{UpError, ViewError};
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Reason for which a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture has no pixels.
    #[error("the picture must have at least 1x1 pixels, got {width}x{height}")]
    NoPixels {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The picture exceeds the memory limits.
    #[error("the picture may have at most {most} pixels and {side} pixels per side, got {width}x{height}")]
    TooLarge {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Largest number of pixels.
        most: u64,
        /// Largest number of pixels per side.
        side: u32,
    },
    /// The shape is empty.
    #[error("the shape has no points to draw")]
    NoPoints,
    /// A coordinate is not finite or too large.
    #[error("coordinates must be finite and at most 1e100 in magnitude, but vertex {index} is at ({}, {}, {})", point[0], point[1], point[2])]
    BadPoint {
        /// Index of the vertex, from 0.
        index: usize,
        /// Position of the vertex.
        point: [f64; 3],
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} has the corner {corner}, which must be below {n_vertices} (counted from 0)")]
    BadCorner {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// Vertex index of the corner.
        corner: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The number of colors or values differs from the number of vertices.
    #[error("expected {expected} {what}, one per vertex; got {found}")]
    PaintLength {
        /// `"colors"` or `"values"`.
        what: &'static str,
        /// Number of items given.
        found: usize,
        /// Number of vertices.
        expected: usize,
    },
    /// The color range has no positive width.
    #[error("the color range needs two finite numbers in ascending order, got {low} to {high}")]
    BadRange {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A ball has an invalid center or radius.
    #[error("ball {index} needs a finite center and a finite radius above 0, got ({}, {}, {}) and {radius}", center[0], center[1], center[2])]
    BadBall {
        /// Index of the ball, from 0.
        index: usize,
        /// Center of the ball.
        center: [f64; 3],
        /// Radius of the ball.
        radius: f64,
    },
    /// The caller cancelled the rendering.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The view is invalid.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A parameter is out of range.
    #[error("{name} must be {range}, got {value}")]
    BadParam {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Valid values, as a phrase that follows "must be".
        range: &'static str,
    },
    /// The zoom is out of range.
    #[error(
        "the zoom must be above 0 and at most {most} at this picture size (smaller pictures allow more), \
        got {zoom:?}"
    )]
    BadZoom {
        /// Zoom given.
        zoom: f64,
        /// Largest zoom.
        most: f64,
    },
    /// The focus is so far away that the shape is not visible.
    #[error(
        "the focus ({:?}, {:?}, {:?}) is far from the shape, whose middle is ({:?}, {:?}, {:?}); choose a \
        point on the shape",
        focus[0], focus[1], focus[2], middle[0], middle[1], middle[2]
    )]
    FarFocus {
        /// Focus given.
        focus: [f64; 3],
        /// Middle of the shape's bounding box.
        middle: [f64; 3],
    },
    /// The sheet has no panels or no columns.
    #[error("a sheet needs at least one panel and one column")]
    NoPanels,
    /// A region extends beyond the borders of the picture.
    #[error(
        "a region of {width}x{height} pixels at ({left}, {top}) must lie inside the picture of \
        {of_width}x{of_height} pixels"
    )]
    BadRegion {
        /// Left edge of the region, in pixels.
        left: u32,
        /// Top edge of the region, in pixels.
        top: u32,
        /// Width of the region, in pixels.
        width: u32,
        /// Height of the region, in pixels.
        height: u32,
        /// Width of the picture, in pixels.
        of_width: u32,
        /// Height of the picture, in pixels.
        of_height: u32,
    },
    /// The picture could not be encoded.
    #[error("the picture cannot be encoded: {reason}")]
    Encoding {
        /// Message of the encoder.
        reason: String,
    },
}

impl ClassifiedError for RenderError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            Self::View(error) => error.kind(),
            Self::NoPixels { .. }
            | Self::TooLarge { .. }
            | Self::NoPoints
            | Self::BadPoint { .. }
            | Self::BadCorner { .. }
            | Self::PaintLength { .. }
            | Self::BadRange { .. }
            | Self::BadBall { .. }
            | Self::BadParam { .. }
            | Self::BadZoom { .. }
            | Self::FarFocus { .. }
            | Self::NoPanels
            | Self::BadRegion { .. } => ErrorKind::Input,
            Self::Encoding { .. } => ErrorKind::Machine,
        }
    }
}

impl ClassifiedError for ViewError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl ClassifiedError for UpError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}
