//! Mesh denoising in two steps: unit normals of the faces are filtered, then vertices follow them.
//!
//! Sources: `zheng2011` (bilateral weights), `zhang2015` (weights that compare a guidance in place of the noisy normals),
//! `sun2007` (the vertices). Where they win: flat faces and sharp edges, with a width of the range weight that suits the
//! noise. Where they do not: that width has to be chosen for each mesh, smooth shapes become facetted, and both compare
//! normals of faces that share a vertex, so that strong noise hides edges from them.
//!
//! `bilateral` and `guided` are the methods, `faces` has the triangles with their neighbors, areas, centroids and normals,
//! `vertex_update` the second step. Both work on welded vertices and give positions in the order of the shape's.

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

/// Why a mesh is not denoised.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NormalFilterError {
    /// The shape has no faces, so no normals.
    #[error("normals of faces need a mesh; this is a cloud, a graph or a mesh without faces")]
    NotAMesh,
    /// A parameter that is none.
    #[error("{name} = {value}; give {wanted}")]
    Parameter {
        /// Which.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What it may be.
        wanted: &'static str,
    },
    /// So many faces at a vertex that lists of neighbors would fill the memory.
    #[error(
        "vertex {vertex} (counted from 0) has {n_faces} faces, more than the {most} that the filter takes; remesh it"
    )]
    TooManyFaces {
        /// The vertex in the order of the shape.
        vertex: usize,
        /// Faces there.
        n_faces: usize,
        /// The most.
        most: usize,
    },
    /// Normals that do not fit.
    #[error("{got} normals for {wanted} faces; give one for each triangle")]
    Normals {
        /// Given.
        got: usize,
        /// Triangles.
        wanted: usize,
    },
    /// The global scheme's equations were not solved.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Which faces are neighbors of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceNeighbors {
    /// Those that share a vertex.
    #[default]
    ByVertex,
    /// Those that share an edge.
    ByEdge,
}

/// No filter takes more rounds.
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

/// The welded positions in units of a power of two near the diagonal, in which squares of areas stay finite, and that unit.
fn unit_points(geometry: &PreparedGeometry) -> (Vec<[f64; 3]>, f64) {
    let size = adwave::shape::diagonal(geometry.points());
    let unit = if size > 0.0 { size.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
    (geometry.points().iter().map(|p| p.map(|c| c / unit)).collect(), unit)
}

/// Positions of welded vertices in the order of the shape, in model units.
fn to_shape_order(geometry: &PreparedGeometry, points: &[[f64; 3]], unit: f64) -> Vec<[f64; 3]> {
    let scaled: Vec<f64> = points.iter().flat_map(|p| p.map(|c| c * unit)).collect();
    geometry.vertex_map().scatter(&scaled, 3).as_chunks().0.to_vec()
}
