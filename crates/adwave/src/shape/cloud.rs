//! Point clouds.

use super::{ShapeError, check_points};
use std::sync::Arc;

/// Points without faces and with finite coordinates, and perhaps given normals. Copies share them.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Arc<Vec<[f64; 3]>>,
    normals: Option<Arc<Vec<[f64; 3]>>>,
    are_sides_known: bool,
}

impl PointCloud {
    /// Builds a cloud of `points` in model units.
    ///
    /// # Errors
    /// [`ShapeError`] if there is no point or a coordinate is not finite.
    pub fn new(points: Vec<[f64; 3]>) -> Result<Self, ShapeError> {
        Self::from_shared(Arc::new(points))
    }

    /// [`new`](Self::new) with shared points.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn from_shared(points: Arc<Vec<[f64; 3]>>) -> Result<Self, ShapeError> {
        check_points(&points)?;
        Ok(Self { points, normals: None, are_sides_known: false })
    }

    /// The cloud with given normals, of any length, zero or NaN where there is none. They separate sheets that are
    /// closer to each other than the points: a point with the opposite normal is not a neighbor. If the positions show
    /// that the signs of the normals are arbitrary, the normals are not used.
    ///
    /// # Panics
    /// Unless there is one normal per point.
    #[must_use]
    pub fn with_normals(self, normals: Vec<[f64; 3]>) -> Self {
        assert_eq!(normals.len(), self.points.len(), "a normal for each point");
        Self { normals: Some(Arc::new(normals)), ..self }
    }

    /// [`with_normals`](Self::with_normals) whose signs are certain, as those of
    /// [`normals_facing`](crate::signal::normals_facing) are: points with opposite normals belong to different sheets even
    /// where the positions do not show it.
    ///
    /// # Panics
    /// Unless there is one normal per point.
    #[must_use]
    pub fn with_sides(self, normals: Vec<[f64; 3]>) -> Self {
        Self { are_sides_known: true, ..self.with_normals(normals) }
    }

    /// True if the signs of the normals are certain.
    pub(crate) fn are_sides_known(&self) -> bool {
        self.are_sides_known
    }

    /// The given normals.
    pub fn normals(&self) -> Option<&[[f64; 3]]> {
        self.normals.as_deref().map(Vec::as_slice)
    }

    /// The points in model units.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The points, shared instead of copied.
    pub fn shared_points(&self) -> Arc<Vec<[f64; 3]>> {
        Arc::clone(&self.points)
    }
}
