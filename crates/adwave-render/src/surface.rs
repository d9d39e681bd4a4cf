//! What is drawn: a shape, its paint, and balls that mark places.

use crate::color_map::ColorMap;
use crate::color_range::ValueRange;
use crate::error::RenderError;
use adwave::shape::MAX_COORDINATE;

/// A mesh, or without triangles a cloud, which is drawn as discs of the size that its spacing asks for.
#[derive(Clone, Debug)]
pub struct Surface<'a> {
    /// Positions, model units.
    pub points: &'a [[f64; 3]],
    /// Three vertices each; either orientation, seen from both sides.
    pub triangles: &'a [[u32; 3]],
    /// Its colors.
    pub paint: Paint<'a>,
}

/// The colors of a surface.
#[derive(Clone, Debug)]
pub enum Paint<'a> {
    /// One color, red, green and blue.
    Plain([u8; 3]),
    /// A color for each vertex.
    Colors(&'a [[u8; 3]]),
    /// A number for each vertex, and the colors that stand for numbers.
    Field(FieldPaint<'a>),
}

impl Paint<'_> {
    /// The color of a surface that nothing is known of: a light clay, on which relief shows best.
    pub const CLAY: Paint<'static> = Paint::Plain([204, 196, 184]);
}

/// A field, shown by a color map with a bar beside it.
#[derive(Clone, Debug)]
pub struct FieldPaint<'a> {
    /// One value per vertex; where it is NaN the surface is gray.
    pub values: &'a [f64],
    /// Its name and unit, for the bar.
    pub label: String,
    /// The colors; without a choice a diverging map centered on 0 for a field of both signs, else viridis.
    pub color_map: Option<ColorMap>,
    /// Which values the ends of the map stand for.
    pub range: ValueRange,
}

/// A ball that marks a place, such as a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its center, model units.
    pub center: [f64; 3],
    /// Its radius, model units.
    pub radius: f64,
    /// Red, green and blue.
    pub color: [u8; 3],
}

impl Surface<'_> {
    /// Refuses what cannot be drawn. O(n).
    ///
    /// # Errors
    ///
    /// No points, coordinates that are not finite, triangles of vertices that are not there, paint of another length.
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

/// Refuses balls that cannot be drawn.
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
