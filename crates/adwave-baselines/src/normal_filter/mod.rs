//! Mesh denoising in two steps: unit normals of the faces are filtered, then vertices follow them.
//!
//! Sources: `zheng2011` (bilateral weights), `zhang2015` (weights that compare a guidance instead of the noisy
//! normals), `sun2007` (the vertices). Strength: flat faces and sharp edges, if the width of the range weight suits the
//! noise. Weaknesses: this width has to be chosen for each mesh, smooth shapes become facetted, and both methods
//! compare the normals of faces that share a vertex, so that strong noise hides edges from them.
//!
//! The modules `bilateral` and `guided` are the methods, `faces` has the triangles with their neighbors, areas,
//! centroids and normals, and `vertex_update` is the second step. Both methods work on welded vertices and return
//! positions in the order of the shape.

mod bilateral;
mod faces;
mod guided;
#[cfg(test)]
mod tests;
mod vertex_update;

pub use bilateral::{BilateralParams, NormalScheme, bilateral_normals};
pub use guided::{GuidedParams, guided_normals};
pub use vertex_update::{Border, update_vertices};

use crate::linalg::LinalgError;
use adwave::Cancelled;
use adwave::shape::PreparedGeometry;
use thiserror::Error;

/// Reason for which a mesh cannot be denoised.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum NormalFilterError {
    /// The shape has no faces and therefore no normals.
    #[error(
        "normal filtering needs a mesh with faces; this shape is a cloud, a graph or a mesh without faces"
    )]
    NotAMesh,
    /// A parameter is out of range.
    #[error("{name} must be {wanted}, got {value}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Valid values, as a phrase that follows "must be".
        wanted: &'static str,
    },
    /// A vertex has so many faces that the neighbor lists would exhaust the memory.
    #[error(
        "a vertex may have at most {most} faces, but vertex {vertex} (counted from 0) has {n_faces}; \
        remesh the shape"
    )]
    TooManyFaces {
        /// Vertex in the order of the shape.
        vertex: usize,
        /// Number of faces at the vertex.
        n_faces: usize,
        /// Largest number of faces.
        most: usize,
    },
    /// The number of normals differs from the number of triangles.
    #[error("expected {wanted} normals, one per triangle; got {got}")]
    Normals {
        /// Number of normals given.
        got: usize,
        /// Number of triangles.
        wanted: usize,
    },
    /// The equations of the global scheme could not be solved.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Neighborhood of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum FaceNeighbors {
    /// Faces that share a vertex.
    #[default]
    ByVertex,
    /// Faces that share an edge.
    ByEdge,
}

/// Largest number of rounds.
const MAX_ITERATIONS: usize = 10_000;

fn check_iterations(name: &'static str, got: usize) -> Result<(), NormalFilterError> {
    if got > MAX_ITERATIONS {
        return Err(NormalFilterError::Parameter { name, value: got as f64, wanted: "0 to 10000" });
    }
    Ok(())
}

fn check_positive(name: &'static str, value: f64) -> Result<(), NormalFilterError> {
    if !(value > 0.0 && value.is_finite()) {
        return Err(NormalFilterError::Parameter { name, value, wanted: "a finite number above 0" });
    }
    Ok(())
}

/// Returns the welded positions in units of a power of two near the diagonal, so that squared areas stay finite, and
/// this power.
fn unit_points(geometry: &PreparedGeometry) -> (Vec<[f64; 3]>, f64) {
    let size = adwave::shape::diagonal(geometry.points());
    let unit = if size > 0.0 { size.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
    (geometry.points().iter().map(|p| p.map(|c| c / unit)).collect(), unit)
}

/// Converts positions of welded vertices to model units and the order of the shape.
fn to_shape_order(geometry: &PreparedGeometry, points: &[[f64; 3]], unit: f64) -> Vec<[f64; 3]> {
    let scaled: Vec<f64> = points.iter().flat_map(|p| p.map(|c| c * unit)).collect();
    geometry.vertex_map().scatter(&scaled, 3).as_chunks().0.to_vec()
}
