//! What a picture can fail by.

use crate::view::{UpError, ViewError};
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// A picture that cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RenderError {
    /// No pixels.
    #[error("a picture of {width}x{height} pixels has none; give at least 1x1")]
    NoPixels {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// More pixels than is sensible to hold.
    #[error("a picture of {width}x{height} pixels is too large; at most {most} pixels, and {side} to a side")]
    TooLarge {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// The most pixels.
        most: u64,
        /// The most pixels of a side.
        side: u32,
    },
    /// Nothing to look at.
    #[error("the shape has no points; there is nothing to see")]
    NoPoints,
    /// A coordinate that is no position.
    #[error("vertex {index} is at ({}, {}, {}); coordinates are finite and at most 1e100 in size", point[0], point[1], point[2])]
    BadPoint {
        /// The vertex, from 0.
        index: usize,
        /// Where it is.
        point: [f64; 3],
    },
    /// A corner that is no vertex.
    #[error("triangle {triangle} has a corner {corner}, but there are {n_vertices} vertices, counted from 0")]
    BadCorner {
        /// The triangle, from 0.
        triangle: usize,
        /// The corner's vertex.
        corner: u32,
        /// How many there are.
        n_vertices: usize,
    },
    /// A paint that does not fit the shape.
    #[error("there are {found} {what} for {expected} vertices; give one for each vertex")]
    PaintLength {
        /// Colors or values.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many vertices there are.
        expected: usize,
    },
    /// A range without width.
    #[error("the range of colors is from {low} to {high}; give two finite numbers, the smaller one first")]
    BadRange {
        /// Its lower end.
        low: f64,
        /// Its upper end.
        high: f64,
    },
    /// A ball that is none.
    #[error("ball {index} has the center ({}, {}, {}) and the radius {radius}; all are finite, the radius above 0", center[0], center[1], center[2])]
    BadBall {
        /// The ball, from 0.
        index: usize,
        /// Its center.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A view that is none.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A parameter out of range.
    #[error("{name} is {value}; it is {range}")]
    BadParam {
        /// Its name.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        range: &'static str,
    },
    /// A zoom out of range.
    #[error(
        "the zoom is {zoom:?}; it is above 0 and at most {most} with pictures of this size, more with smaller ones"
    )]
    BadZoom {
        /// What was given.
        zoom: f64,
        /// The largest.
        most: f64,
    },
    /// A middle of the picture from where nothing of the shape is seen.
    #[error(
        "the focus ({:?}, {:?}, {:?}) is far off the shape, whose middle is ({:?}, {:?}, {:?}); name a place on it",
        focus[0], focus[1], focus[2], middle[0], middle[1], middle[2]
    )]
    FarFocus {
        /// What was given.
        focus: [f64; 3],
        /// The middle of the shape's bounding box.
        middle: [f64; 3],
    },
    /// A sheet without panels.
    #[error("a sheet needs at least one panel and one column")]
    NoPanels,
    /// Pictures of different sizes where they must agree, or a part that is not inside.
    #[error(
        "a part of {width}x{height} pixels at ({left}, {top}) is not inside a picture of {of_width}x{of_height}"
    )]
    BadPart {
        /// Pixels from the left.
        left: u32,
        /// Pixels from the top.
        top: u32,
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Pixels of the whole.
        of_width: u32,
        /// Pixels of the whole.
        of_height: u32,
    },
    /// The picture could not be encoded.
    #[error("the picture cannot be encoded: {reason}")]
    Encoding {
        /// The encoder's words.
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
            | Self::BadPart { .. } => ErrorKind::Input,
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
