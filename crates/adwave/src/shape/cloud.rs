//! Point clouds.

use super::{ShapeError, check_points};
use std::sync::Arc;

/// Points without faces, every coordinate finite. Copies share the points.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Arc<Vec<[f64; 3]>>,
}

impl PointCloud {
    /// A cloud of `points` in model units.
    ///
    /// # Errors
    /// [`ShapeError`] when there is no point or a coordinate is not finite.
    pub fn new(points: Vec<[f64; 3]>) -> Result<Self, ShapeError> {
        Self::from_shared(Arc::new(points))
    }

    /// [`new`](Self::new) of points that others use too.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_shared(points: Arc<Vec<[f64; 3]>>) -> Result<Self, ShapeError> {
        check_points(&points)?;
        Ok(Self { points })
    }

    /// The points in model units.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The points, to be used elsewhere without a copy.
    pub fn shared_points(&self) -> Arc<Vec<[f64; 3]>> {
        Arc::clone(&self.points)
    }
}
