//! Point clouds.

use super::{ShapeError, check_points};
use std::sync::Arc;

/// Points without faces and with finite coordinates. Copies share the points.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Arc<Vec<[f64; 3]>>,
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
        Ok(Self { points })
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
