//! Points of regions that lie off the shape.

use super::{BrushStroke, Location, Region, RegionError, SurfaceMetric};
use crate::Progress;

/// Distance from the shape, as a share of the radius, from which a point is reported.
const REPORTED: f64 = 0.1;

/// Center of a ball, or place of a stroke, that lies off the shape: the nearest location on the shape replaces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarPoint {
    /// The point, in model units.
    pub point: [f64; 3],
    /// The nearest location on the shape.
    pub nearest: [f64; 3],
    /// Distance between the two.
    pub distance: f64,
    /// Radius of the ball or stroke.
    pub radius: f64,
}

impl FarPoint {
    /// Describes the location that replaces the point.
    pub fn describe(&self) -> String {
        let place = |p: [f64; 3]| p.map(|c| format!("{c}")).join(" ");
        format!(
            "the point {} of the region lies {:.4} from the shape, with a radius of {}; the region is around {} instead, the \
             nearest location",
            place(self.point),
            self.distance,
            self.radius,
            place(self.nearest)
        )
    }
}

impl Region {
    /// Points of balls and strokes that lie farther from the shape than a tenth of their radius. O(log n) per point.
    ///
    /// # Errors
    /// [`RegionError::Cancelled`] if the call is cancelled.
    ///
    /// ```
    /// use adwave::region::parse_region;
    /// use adwave::sample::Sample;
    /// use adwave::shape::{Mesh, Shape};
    /// use adwave::{Decomposer, Progress};
    /// let sphere = Sample::from_name("sphere", Some(500))?;
    /// let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(sphere.points, sphere.faces)?));
    /// let find = |text: &str| parse_region(text).unwrap().far_points(decomposer.metric(), Progress::none());
    /// assert_eq!(find("ball:point=0 0 1,radius=0.6")?, []);
    /// let middle = find("ball:point=0 0 0,radius=0.6")?;
    /// assert!((middle[0].distance - 1.0).abs() < 0.03);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn far_points(
        &self,
        metric: &SurfaceMetric,
        progress: Progress<'_>,
    ) -> Result<Vec<FarPoint>, RegionError> {
        let mut found = Vec::new();
        self.collect_far_points(metric, progress, &mut found)?;
        Ok(found)
    }

    fn collect_far_points(
        &self,
        metric: &SurfaceMetric,
        progress: Progress<'_>,
        found: &mut Vec<FarPoint>,
    ) -> Result<(), RegionError> {
        let (path, radius) = match self {
            Self::Ball { center, radius, .. } => (std::slice::from_ref(center), radius),
            Self::Stroke { path, radius, .. } => (&path[..], radius),
            Self::Grown { region, .. }
            | Self::Blurred { region, .. }
            | Self::Faded { region, .. }
            | Self::Not(region) => return region.collect_far_points(metric, progress, found),
            Self::Any(regions) | Self::All(regions) => {
                return regions.iter().try_for_each(|r| r.collect_far_points(metric, progress, found));
            }
            Self::Painted(strokes) => {
                return strokes.iter().try_for_each(|stroke| {
                    let (BrushStroke::Add(region)
                    | BrushStroke::Subtract(region)
                    | BrushStroke::Smooth { region, .. }) = stroke;
                    region.collect_far_points(metric, progress, found)
                });
            }
            _ => return Ok(()),
        };
        let radius = radius.to_model_units(metric.diagonal());
        for location in path {
            if let Location::Point(point) = *location
                && point.iter().all(|c| c.is_finite())
                && !metric.positions().is_empty()
            {
                let place = metric.nearest_place(&point, progress)?;
                if place.distance > REPORTED * radius {
                    let (nearest, distance) = (place.point, place.distance);
                    found.push(FarPoint { point, nearest, distance, radius });
                }
            }
        }
        Ok(())
    }
}
