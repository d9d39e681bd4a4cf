//! Errors of hierarchies and their wavelets.

use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Reason why a part of a mesh has no coarser level.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// A vertex would be the midpoint of a coarse edge, but does not have the neighbors of one.
    #[error(
        "vertex {vertex} would be the midpoint of an edge and has {n_neighbors} neighbors; a midpoint has 6, on a border 4"
    )]
    Valence {
        /// Vertex of the mesh.
        vertex: u32,
        /// Number of neighbors of the vertex.
        n_neighbors: usize,
    },
    /// A vertex would be a coarse vertex and a midpoint.
    #[error("vertex {vertex} would be both a coarse vertex and a new one")]
    Parity {
        /// Vertex of the mesh.
        vertex: u32,
    },
    /// A midpoint lies on the border, but its coarse edge does not, or vice versa.
    #[error("the border passes through the midpoint {vertex} of an edge that does not lie on the border")]
    Border {
        /// Vertex of the mesh.
        vertex: u32,
    },
    /// The coarse mesh would not be a manifold mesh of triangles.
    #[error(
        "the coarser mesh at vertex {vertex} would have an edge of more than two faces, or a face without area"
    )]
    Degenerate {
        /// Vertex of the mesh.
        vertex: u32,
    },
    /// The faces at a vertex form more than one fan.
    #[error("the faces at vertex {vertex} touch only in this vertex")]
    Pinched {
        /// Vertex of the mesh.
        vertex: u32,
    },
    /// A face is not a quadrilateral.
    #[error(
        "the face at vertex {vertex} has {n_corners} corners, and every face of a subdivided mesh has four"
    )]
    NotQuad {
        /// First corner of the face.
        vertex: u32,
        /// Number of corners of the face.
        n_corners: usize,
    },
    /// A vertex would be an edge point, but does not have the neighbors of one.
    #[error(
        "vertex {vertex} would lie on a coarse edge and has {n_neighbors} neighbors; such a vertex has 4, on a border 3"
    )]
    EdgePoint {
        /// Vertex of the mesh.
        vertex: u32,
        /// Number of neighbors of the vertex.
        n_neighbors: usize,
    },
    /// A vertex would lie in the middle of a coarse face, but lies on the border.
    #[error("vertex {vertex} would lie in the middle of a coarse face, and lies on the border")]
    FacePoint {
        /// Vertex of the mesh.
        vertex: u32,
    },
    /// The part has no faces.
    #[error("vertex {vertex} belongs to no face")]
    NoFaces {
        /// Vertex of the mesh.
        vertex: u32,
    },
}

/// Failure of a hierarchy or of a transform.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SubdivisionError {
    /// A face is not a triangle.
    #[error(
        "this needs triangles, and face {face} has {n_corners} corners; \
         families 'catmull-clark' and 'linear' take quadrilaterals"
    )]
    NotTriangle {
        /// Index of the face.
        face: usize,
        /// Number of corners of the face.
        n_corners: usize,
    },
    /// A face has fewer than three corners.
    #[error(
        "subdivision levels need faces of three corners or more, and face {face} has {n_corners}; remove it first"
    )]
    FewCorners {
        /// Index of the face.
        face: usize,
        /// Number of corners of the face.
        n_corners: usize,
    },
    /// Two ends of a crease have no common edge.
    #[error("a crease is given between vertices {a} and {b}, and the mesh has no edge there")]
    NoEdge {
        /// One end.
        a: u32,
        /// Other end.
        b: u32,
    },
    /// Pairs of parents are asked for of quadrilaterals.
    #[error("the middle of a face has more than two parents; take them as rows")]
    PairsOfQuads,
    /// The rule for coarse vertices has no usable inverse on a level.
    #[error(
        "Catmull-Clark subdivision of level {level} loses values at vertices of two or three faces (error {error:.0e}); \
         use family 'linear'"
    )]
    Singular {
        /// The coarser level, from 1.
        level: usize,
        /// Largest relative error of solving for the coarse values.
        error: f64,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, and there are {n_vertices} vertices")]
    IndexOutOfRange {
        /// Index of the face.
        face: usize,
        /// Index of the vertex.
        index: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A face has one vertex twice.
    #[error("face {face} has vertex {vertex} twice; remove faces without area first")]
    RepeatedCorner {
        /// Index of the face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// An edge has more than two faces.
    #[error("the edge between vertices {a} and {b} has {n_faces} faces; subdivision levels need at most two")]
    ManyFaces {
        /// One end of the edge.
        a: u32,
        /// Other end of the edge.
        b: u32,
        /// Number of faces of the edge.
        n_faces: usize,
    },
    /// The mesh has no faces.
    #[error("subdivision levels need a mesh with faces, and there are none")]
    NoFaces,
    /// No part of the mesh has a coarser level.
    #[error("the mesh has no levels of subdivision: {obstacle}; family 'irregular' works on any mesh")]
    NoLevels {
        /// Reason for the first part.
        obstacle: Obstacle,
    },
    /// A level does not exist.
    #[error("level must be in 0..={n_levels}, got {level}")]
    Level {
        /// The level that was given.
        level: usize,
        /// Number of levels.
        n_levels: usize,
    },
    /// The number of values does not fit.
    #[error("{expected} {what} are needed, got {n_given}")]
    WrongNumber {
        /// Name of the values, a plural noun.
        what: &'static str,
        /// Number of values given.
        n_given: usize,
        /// Number of values needed.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("{what} must be finite, and the value of {element} is {value}; fill missing values first")]
    NotFinite {
        /// Name of the values, a plural noun.
        what: &'static str,
        /// Index of the vertex or face.
        element: usize,
        /// The value.
        value: f64,
    },
    /// A mass is negative.
    #[error("areas must not be negative, and that of {element} is {value}")]
    NegativeMass {
        /// Index of the vertex or face.
        element: usize,
        /// The value.
        value: f64,
    },
    /// Copies of one vertex have different values.
    #[error(
        "vertices {first} and {vertex} lie at one position and have different values, and a hierarchy has one vertex there; make \
         the values equal first"
    )]
    Seam {
        /// Vertex whose values differ.
        vertex: u32,
        /// The first vertex at that position.
        first: u32,
    },
    /// The share of coefficients is outside [0, 1].
    #[error("the share of coefficients must be in 0..=1, got {0:?}")]
    Share(f64),
    /// A coarse vertex has too many neighbors.
    #[error(
        "wavelets need coarse vertices of at most {most} neighbors, and vertex {vertex} has {n_neighbors}"
    )]
    Crowded {
        /// Vertex of the mesh.
        vertex: u32,
        /// Number of neighbors of the vertex on a coarser level.
        n_neighbors: usize,
        /// Largest number allowed.
        most: usize,
    },
    /// A family cannot be used for the request.
    #[error("family '{family}' {reason}")]
    Family {
        /// Name of the family.
        family: &'static str,
        /// Reason, and the type to use instead.
        reason: &'static str,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SubdivisionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
