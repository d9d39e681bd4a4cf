//! Errors of deformation and of detail that moves to another base.

use adwave::bands::BandsError;
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use adwave_subdivision::SubdivisionError;
use thiserror::Error;

/// Failure of a deformation, or of carrying detail to another base.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DeformError {
    /// The shape has no positions.
    #[error("a deformation needs positions, and this graph has none; give its nodes positions")]
    NoPositions,
    /// There is nothing to move.
    #[error("a deformation needs at least one handle, got none")]
    NoHandles,
    /// A region holds no vertices.
    #[error("{region} holds no vertex that takes part in the analysis; enlarge it")]
    EmptyRegion {
        /// The region, such as `handle 2` or `the fixed part`.
        region: String,
    },
    /// A region names a vertex that does not exist.
    #[error("{region} names vertex {vertex}, but the shape has {n_vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// The region.
        region: String,
        /// The vertex.
        vertex: u32,
        /// Number of vertices of the shape.
        n_vertices: usize,
    },
    /// A vertex belongs to two regions, or copies of one vertex belong to different ones.
    #[error(
        "vertex {vertex} (or one at the same position) is in {first} and in {second}; a vertex can move one way only"
    )]
    TwoRegions {
        /// The vertex.
        vertex: u32,
        /// First region.
        first: String,
        /// Second region.
        second: String,
    },
    /// There is no such handle.
    #[error("handle {handle} does not exist; there are {n_handles}, counted from 1")]
    NoSuchHandle {
        /// Number asked for, from 1.
        handle: usize,
        /// Number of handles.
        n_handles: usize,
    },
    /// A number of a motion is not finite.
    #[error("a motion must have finite numbers, got {0}")]
    BadMotion(f64),
    /// The axis of a rotation has no direction.
    #[error("the axis of a rotation must be finite and not 0, got {0:?}")]
    BadAxis([f64; 3]),
    /// The map mirrors or flattens.
    #[error("a motion must keep the orientation: the determinant must be positive, got {0}")]
    Mirrored(f64),
    /// The matrix is not affine.
    #[error("the last row of the matrix must be 0 0 0 1, got {0:?}")]
    NotAffine([f64; 4]),
    /// The bending length is not a length.
    #[error("the stiffness must be a finite length of at least 0, got {0}")]
    BadStiffness(f64),
    /// The share of lengths is not in \[0, 1\].
    #[error("the share of lengths must be in 0..=1, got {0}")]
    BadLengths(f64),
    /// The shape is too large for a solve of all its vertices.
    #[error(
        "lengths can be kept on up to {most} vertices that move, got {n_free}; simplify the shape or leave their share at 0"
    )]
    TooLargeForLengths {
        /// Vertices that move.
        n_free: usize,
        /// Most that can.
        most: usize,
    },
    /// The base has another number of vertices.
    #[error(
        "the base must have the {expected} vertices of the shape in their order, got {found}; \
         export it without merging, splitting or adding vertices"
    )]
    WrongBase {
        /// Vertices of the shape.
        expected: usize,
        /// Vertices of the base.
        found: usize,
    },
    /// The base belongs to another shape, or its vertices have another order.
    #[error(
        "neighbors are {ratio:.0} times as far apart in this base as in the shape's own, relative to its size: its \
         vertices are in another order, or it belongs to another shape; export it with the order of vertices kept"
    )]
    OtherBase {
        /// Mean length of edges relative to the size, over that of the shape.
        ratio: f64,
    },
    /// A coordinate is not finite.
    #[error("coordinates of the base must be finite; vertex {vertex} has {value}")]
    BadPoint {
        /// The vertex, from 0.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// All points of the base coincide.
    #[error("all points of the base coincide; it must be an edited copy of the shape's base")]
    CollapsedBase,
    /// The base is a mirror image.
    #[error("the base is mirrored: it encloses its volume from the other side; export it without mirroring")]
    MirroredBase,
    /// The number of weights differs from that of the vertices.
    #[error("one weight per vertex is needed, {expected} in all, got {found}")]
    WrongWeights {
        /// Vertices of the shape.
        expected: usize,
        /// Weights given.
        found: usize,
    },
    /// A width or radius is no length.
    #[error("{what} must be a finite length above 0, got {value}")]
    BadLength {
        /// Name of the length.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// The two shapes of a morph do not have the same vertices and faces.
    #[error("{0}; a morph needs two shapes with the same vertices and faces in the same order")]
    NotAlike(String),
    /// A number of a morph is not finite, or their number is wrong.
    #[error("{0}")]
    BadShare(String),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The levels of the mesh or their wavelets cannot be computed.
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    /// An edited level has another number of vertices.
    #[error(
        "level {level} has {expected} vertices, and the edited one has {found}; \
         keep their number and order, without merging"
    )]
    WrongLevel {
        /// The level, from 1.
        level: usize,
        /// Vertices of the level.
        expected: usize,
        /// Vertices given.
        found: usize,
    },
    /// The equations of the nodes cannot be solved.
    #[error(
        "the equations of the deformation cannot be solved ({0}); check the shape for equal or far points"
    )]
    Singular(String),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<adwave::shape::NoShape> for DeformError {
    fn from(_: adwave::shape::NoShape) -> Self {
        Self::NoPositions
    }
}

impl ClassifiedError for DeformError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            Self::Bands(error) => error.kind(),
            Self::Subdivision(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
