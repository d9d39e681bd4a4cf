//! Errors of resampling between spheres.

use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Failure of preparing a sphere, or of resampling between two.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SphereError {
    /// There are no triangles, or a corner does not exist.
    #[error("a sphere needs triangles between its {n_vertices} vertices; give a mesh such as lh.sphere.reg")]
    NoTriangles {
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A coordinate is not finite.
    #[error("the vertices of a sphere must be finite, and vertex {0} is not; repair the file")]
    NotFinite(usize),
    /// The vertices do not lie on a sphere.
    #[error(
        "the vertices must lie on a sphere, and their distance from its center varies from {least:.4} to {most:.4}; give the \
         registered sphere, such as lh.sphere.reg or *.sphere.surf.gii"
    )]
    NoSphere {
        /// Least distance of a vertex from the center in model units.
        least: f64,
        /// Greatest distance of a vertex from the center in model units.
        most: f64,
    },
    /// The triangles leave a hole, or do not agree which side is outside.
    #[error(
        "a sphere must be closed, and the edge between vertices {0} and {1} has not one triangle on each side; give a \
         sphere of all vertices, without cuts, holes or turned faces"
    )]
    Open(u32, u32),
    /// The triangles do not cover each direction once.
    #[error(
        "a sphere must cover each direction once, and this one does so {0} times; give the registered sphere"
    )]
    Cover(i64),
    /// Too many triangles overlap.
    #[error(
        "the triangles of a sphere must lie side by side, and these overlap too often; register it again"
    )]
    Overlap,
    /// The number of areas, of a mask or of values is wrong.
    #[error(
        "{what} must have a number for each of the {expected} vertices of the sphere, got {found}; use those of its mesh"
    )]
    Length {
        /// The numbers, such as `areas`.
        what: &'static str,
        /// Number of vertices of the sphere.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// An area is not positive.
    #[error(
        "the area at each vertex must be positive, got {area} at vertex {vertex}; repair the surface or leave it out"
    )]
    Area {
        /// The vertex.
        vertex: usize,
        /// Its area.
        area: f64,
    },
    /// The target mask leaves out all vertices.
    #[error("the target's mask must keep a vertex, and it leaves out all; turn it around")]
    NothingKept,
    /// A value is infinite.
    #[error("values must be finite or NaN, got {value} at vertex {vertex}; replace it or mark it by NaN")]
    Infinite {
        /// The vertex.
        vertex: usize,
        /// Its value.
        value: f64,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SphereError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(_) => ErrorKind::Cancelled,
            _ => ErrorKind::Input,
        }
    }
}
