//! Polygon meshes.

use super::{Polygons, ShapeError, check_points};
use std::sync::Arc;

/// Vertices and polygon faces in the order of the file, with finite coordinates and valid indices. Copies share
/// both.
///
/// Nothing else is guaranteed: faces may repeat, have no area or fewer than three corners, share an edge three at a
/// time, and vertices may be unreferenced. [`Health`](super::Health) counts each.
#[derive(Clone, Debug)]
pub struct Mesh {
    points: Arc<Vec<[f64; 3]>>,
    faces: Arc<Polygons>,
}

impl Mesh {
    /// Builds a mesh of `points` (model units) and `faces` (vertex indices from 0).
    ///
    /// # Errors
    /// [`ShapeError`] if there is no vertex, a coordinate is not finite, or a face names a vertex that does not
    /// exist.
    ///
    /// ```
    /// use adwave::shape::{Mesh, Polygons, ShapeError};
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let error = Mesh::new(points, Polygons::from_triangles(&[[0, 1, 3]])).unwrap_err();
    /// assert_eq!(error, ShapeError::IndexOutOfRange { face: 0, index: 3, n_vertices: 3 });
    /// ```
    pub fn new(points: Vec<[f64; 3]>, faces: Polygons) -> Result<Self, ShapeError> {
        Self::from_shared(Arc::new(points), Arc::new(faces))
    }

    /// [`new`](Self::new) with shared points and faces.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn from_shared(points: Arc<Vec<[f64; 3]>>, faces: Arc<Polygons>) -> Result<Self, ShapeError> {
        check_points(&points)?;
        let n_vertices = points.len();
        if faces.corners().iter().any(|&c| c as usize >= n_vertices) {
            for (face, corners) in faces.iter().enumerate() {
                if let Some(&index) = corners.iter().find(|&&c| c as usize >= n_vertices) {
                    return Err(ShapeError::IndexOutOfRange { face, index, n_vertices });
                }
            }
        }
        Ok(Self { points, faces })
    }

    /// The vertices in model units.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The faces.
    pub fn faces(&self) -> &Polygons {
        &self.faces
    }

    /// The vertices, shared instead of copied.
    pub fn shared_points(&self) -> Arc<Vec<[f64; 3]>> {
        Arc::clone(&self.points)
    }

    /// The faces, shared instead of copied.
    pub fn shared_faces(&self) -> Arc<Polygons> {
        Arc::clone(&self.faces)
    }
}
