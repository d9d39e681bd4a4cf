//! Content of a picture: a shape, its paint, and balls that mark positions.

use crate::color_map::ColorMap;
use crate::color_range::ValueRange;
use crate::error::RenderError;
use adwave::shape::MAX_COORDINATE;

/// Mesh, or cloud if there are no triangles. A cloud is drawn as discs whose radii follow its spacing.
#[derive(Clone, Debug)]
pub struct Surface<'a> {
    /// Positions in model units.
    pub points: &'a [[f64; 3]],
    /// Three vertices of each triangle, in either orientation; both sides are visible.
    pub triangles: &'a [[u32; 3]],
    /// Colors of the surface.
    pub paint: Paint<'a>,
}

/// Colors of a surface.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Paint<'a> {
    /// One color: red, green and blue.
    Plain([u8; 3]),
    /// One color per vertex.
    Colors(&'a [[u8; 3]]),
    /// One value per vertex, shown by a color map.
    Field(FieldPaint<'a>),
}

impl Paint<'_> {
    /// Default color of a surface: a light clay that shows relief best.
    pub const CLAY: Paint<'static> = Paint::Plain([204, 196, 184]);
}

/// Field shown by a color map with a color bar.
#[derive(Clone, Debug)]
pub struct FieldPaint<'a> {
    /// One value per vertex; the surface is gray where it is NaN.
    pub values: &'a [f64],
    /// Name and unit, for the color bar.
    pub label: String,
    /// Color map; `None` selects a diverging map centered on 0 for a field of both signs, otherwise viridis.
    pub color_map: Option<ColorMap>,
    /// Values at the ends of the map.
    pub range: ValueRange,
}

/// Ball that marks a position, such as a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Center in model units.
    pub center: [f64; 3],
    /// Radius in model units.
    pub radius: f64,
    /// Red, green and blue.
    pub color: [u8; 3],
}

impl Surface<'_> {
    /// Checks that the surface can be drawn. O(n).
    ///
    /// # Errors
    ///
    /// A surface without points, coordinates that are not finite or too large, triangles with vertices that do not
    /// exist, and paint whose length differs from the number of vertices.
    pub fn check(&self) -> Result<(), RenderError> {
        let n = self.points.len();
        if n == 0 {
            return Err(RenderError::NoPoints);
        }
        let bad = |p: &[f64; 3]| !p.iter().all(|c| c.abs() <= MAX_COORDINATE);
        if let Some(index) = self.points.iter().position(bad) {
            return Err(RenderError::BadPoint { index, point: self.points[index] });
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&corner) = corners.iter().find(|&&v| v as usize >= n) {
                return Err(RenderError::BadCorner { triangle, corner, n_vertices: n });
            }
        }
        let length = |what, found| {
            if found == n { Ok(()) } else { Err(RenderError::PaintLength { what, found, expected: n }) }
        };
        match &self.paint {
            Paint::Plain(_) => Ok(()),
            Paint::Colors(colors) => length("colors", colors.len()),
            Paint::Field(field) => {
                length("values", field.values.len())?;
                field.range.check()
            }
        }
    }
}

/// Checks that the balls can be drawn.
pub(crate) fn check_balls(balls: &[Ball]) -> Result<(), RenderError> {
    let bad = |b: &Ball| {
        !(b.center.iter().all(|c| c.abs() <= MAX_COORDINATE) && b.radius > 0.0 && b.radius <= MAX_COORDINATE)
    };
    match balls.iter().position(bad) {
        None => Ok(()),
        Some(index) => {
            let Ball { center, radius, .. } = balls[index];
            Err(RenderError::BadBall { index, center, radius })
        }
    }
}
