//! Choice of the axis that points up.

use crate::view::Up;
use adwave::Progress;
use adwave::shape::{PreparedGeometry, Shape, WeldMode, health, one_ring};
use adwave::vector::Axis;

/// Height relative to width and depth below which a shape may be terrain.
const LOW: f64 = 0.25;

/// Height relative to width and depth below which a shape is a flat drawing, which has no heights and is seen from
/// above.
const FLAT: f64 = 1e-3;

impl Up {
    /// Guesses z for a scan of terrain: it has a border or no faces (`is_open`), and its extent along z is less than a
    /// quarter of its extents along x and y, but not negligible. Otherwise guesses y, the convention of most models.
    /// O(n).
    ///
    /// ```
    /// use adwave_render::Up;
    /// let height = |i: i32| f64::from(i % 3) / 2.0;
    /// let land: Vec<[f64; 3]> = (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10), height(i)]).collect();
    /// assert_eq!(Up::guess(&land, || true), Up::Z);
    /// assert_eq!(Up::guess(&land, || false), Up::Y);
    /// ```
    pub fn guess(points: &[[f64; 3]], is_open: impl FnOnce() -> bool) -> Self {
        let extent = |c: usize| {
            let within = |(low, high): (f64, f64), p: &[f64; 3]| (low.min(p[c]), high.max(p[c]));
            let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), within);
            high - low
        };
        let (height, across) = (extent(2), extent(0).min(extent(1)));
        let is_low = height < LOW * across && height > FLAT * across;
        if is_low && is_open() { Self::Z } else { Self::Y }
    }

    /// Name of the axis: `x`, `y` or `z`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// Reason for which an axis points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpReason {
    /// The caller chose the axis.
    Asked,
    /// The axis points up in all files of the format.
    Format,
    /// The shape is as low and open as terrain (see [`Up::guess`]).
    Land,
    /// The axis points up in most models.
    Common,
}

impl Up {
    /// Chooses the axis, with the reason: the requested axis, otherwise that of the file's format, otherwise the guess
    /// of [`Up::guess`]. O(n).
    ///
    /// ```
    /// use adwave::{shape::{PointCloud, Shape}, vector::Axis};
    /// use adwave_render::{Up, UpReason};
    /// let point = Shape::Cloud(PointCloud::new(vec![[0.0; 3]]).unwrap());
    /// assert_eq!(Up::choose(None, Some(Axis::Z), &point), (Up::Z, UpReason::Format));
    /// assert_eq!(Up::choose(None, None, &point), (Up::Y, UpReason::Common));
    /// ```
    pub fn choose(asked: Option<Self>, by_format: Option<Axis>, shape: &Shape) -> (Self, UpReason) {
        match (asked, by_format) {
            (Some(up), _) => (up, UpReason::Asked),
            (None, Some(axis)) => (axis.into(), UpReason::Format),
            (None, None) => {
                let up = Self::guess(shape.points().unwrap_or_default(), || is_open(shape));
                (up, if up == Self::Z { UpReason::Land } else { UpReason::Common })
            }
        }
    }
}

impl From<Axis> for Up {
    fn from(axis: Axis) -> Self {
        match axis {
            Axis::X => Self::X,
            Axis::Y => Self::Y,
            Axis::Z => Self::Z,
        }
    }
}

/// True if a shape has a border or no faces.
fn is_open(shape: &Shape) -> bool {
    if !shape.is_mesh() {
        return true;
    }
    let Ok(geometry) = PreparedGeometry::new(shape, WeldMode::default(), Progress::none()) else {
        return false;
    };
    let ring = one_ring(geometry.n_vertices(), geometry.triangles());
    health(&geometry, &ring, Progress::none()).is_ok_and(|health| !health.is_closed())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grid of 10 × 10 points with heights from 0 to `height` along `axis`.
    fn land(height: f64, axis: usize) -> Vec<[f64; 3]> {
        let point = |i: u32| {
            let mut p = [f64::from(i % 10), f64::from(i / 10), height * f64::from(i % 2)];
            p.swap(2, axis);
            p
        };
        (0..100).map(point).collect()
    }

    #[test]
    fn only_low_open_shapes_with_heights_along_z_are_land() {
        for (height, axis, up) in [
            (1.0, 2, Up::Z),
            (2.2, 2, Up::Z),
            (3.0, 2, Up::Y),
            (0.0, 2, Up::Y),
            (1.0, 1, Up::Y),
            (1.0, 0, Up::Y),
        ] {
            assert_eq!(Up::guess(&land(height, axis), || true), up, "{height} along {axis}");
        }
        assert_eq!(Up::guess(&land(1.0, 2), || false), Up::Y);
        assert_eq!(Up::guess(&[], || true), Up::Y);
        assert_eq!(Up::guess(&[[1.0; 3]], || true), Up::Y);
    }
}
