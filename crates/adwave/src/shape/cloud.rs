//! Point clouds.

use super::{ShapeError, check_points};

/// Points without faces, every coordinate finite.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Vec<[f64; 3]>,
}

impl PointCloud {
    /// A cloud of `points` in model units.
    ///
    /// # Errors
    /// [`ShapeError`] when there is no point or a coordinate is not finite.
    pub fn new(points: Vec<[f64; 3]>) -> Result<Self, ShapeError> {
        check_points(&points)?;
        Ok(Self { points })
    }

    /// The points in model units.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }
}
