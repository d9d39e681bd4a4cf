//! Polygon meshes.

use super::{Polygons, ShapeError, check_points};

/// Vertices and polygon faces, in the order of the file, with every coordinate finite and every index in range.
///
/// Nothing else is promised: faces may repeat, have no area or fewer than three corners, share an edge three at a
/// time, and vertices may be unreferenced. See [`Health`](super::Health) for a count of each.
#[derive(Clone, Debug)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    faces: Polygons,
}

impl Mesh {
    /// A mesh of `points` (model units) and `faces` (vertex indices from 0).
    ///
    /// # Errors
    /// [`ShapeError`] when there is no vertex, a coordinate is not finite, or a face names a vertex that does not
    /// exist.
    ///
    /// ```
    /// use adwave::shape::{Mesh, Polygons, ShapeError};
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let error = Mesh::new(points, Polygons::from_triangles(&[[0, 1, 3]])).unwrap_err();
    /// assert_eq!(error, ShapeError::IndexOutOfRange { face: 0, index: 3, n_vertices: 3 });
    /// ```
    pub fn new(points: Vec<[f64; 3]>, faces: Polygons) -> Result<Self, ShapeError> {
        check_points(&points)?;
        let n_vertices = points.len();
        if let Some(at) = faces.corners().iter().position(|&c| c as usize >= n_vertices) {
            let face = faces.offsets().partition_point(|&o| o as usize <= at) - 1;
            return Err(ShapeError::IndexOutOfRange { face, index: faces.corners()[at], n_vertices });
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
}
