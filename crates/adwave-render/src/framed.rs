//! Main part of a surface, without a few vertices that are so far away that the rest would be a dot in the picture.

use std::borrow::Cow;

use crate::params::Frame;
use crate::surface::{FieldPaint, Paint, Surface};
use adwave::shape::picture_frame;

/// Surface without the vertices and triangles outside its frame.
pub(crate) struct FramedSurface<'a> {
    points: Cow<'a, [[f64; 3]]>,
    triangles: Cow<'a, [[u32; 3]]>,
    paint: FramedPaint<'a>,
}

/// Paint of the vertices that are kept.
enum FramedPaint<'a> {
    Plain([u8; 3]),
    Colors(Cow<'a, [[u8; 3]]>),
    Field(FieldPaint<'a>, Option<Vec<f64>>),
}

impl<'a> FramedSurface<'a> {
    /// Leaves out vertices outside the frame, and triangles with such a vertex. O(n).
    pub(crate) fn new(surface: &'a Surface<'a>, frame: Frame) -> Self {
        let Some(kept) = kept_vertices(surface, frame) else {
            let paint = match &surface.paint {
                Paint::Plain(color) => FramedPaint::Plain(*color),
                Paint::Colors(colors) => FramedPaint::Colors(Cow::Borrowed(colors)),
                Paint::Field(field) => FramedPaint::Field(field.clone(), None),
            };
            let (points, triangles) = (Cow::Borrowed(surface.points), Cow::Borrowed(surface.triangles));
            return Self { points, triangles, paint };
        };
        let mut number = vec![u32::MAX; surface.points.len()];
        for (k, &v) in kept.iter().enumerate() {
            number[v] = k as u32;
        }
        let renamed = surface.triangles.iter().map(|t| t.map(|v| number[v as usize]));
        let paint = match &surface.paint {
            Paint::Plain(color) => FramedPaint::Plain(*color),
            Paint::Colors(colors) => FramedPaint::Colors(kept.iter().map(|&v| colors[v]).collect()),
            Paint::Field(field) => {
                FramedPaint::Field(field.clone(), Some(kept.iter().map(|&v| field.values[v]).collect()))
            }
        };
        Self {
            points: kept.iter().map(|&v| surface.points[v]).collect(),
            triangles: renamed.filter(|t| !t.contains(&u32::MAX)).collect(),
            paint,
        }
    }

    /// Returns the surface to draw.
    pub(crate) fn surface(&self) -> Surface<'_> {
        let paint = match &self.paint {
            FramedPaint::Plain(color) => Paint::Plain(*color),
            FramedPaint::Colors(colors) => Paint::Colors(colors),
            FramedPaint::Field(field, values) => Paint::Field(FieldPaint {
                values: values.as_deref().unwrap_or(field.values),
                ..field.clone()
            }),
        };
        Surface { points: &self.points, triangles: &self.triangles, paint }
    }
}

impl Surface<'_> {
    /// Number of visible vertices that a picture with `frame` leaves out. O(n).
    ///
    /// ```
    /// use adwave_render::{Frame, Paint, Surface};
    /// let mut points: Vec<[f64; 3]> = (0..900).map(|i| [f64::from(i % 30), f64::from(i / 30), 0.0]).collect();
    /// points.push([1e6, 0.0, 0.0]);
    /// let surface = Surface { points: &points, triangles: &[], paint: Paint::CLAY };
    /// assert_eq!((surface.n_outside(Frame::Main), surface.n_outside(Frame::All)), (1, 0));
    /// ```
    pub fn n_outside(&self, frame: Frame) -> usize {
        let n_used =
            used_vertices(self).map_or(self.points.len(), |used| used.iter().filter(|u| **u).count());
        kept_vertices(self, frame).map_or(0, |kept| n_used - kept.len())
    }
}

/// Marks the vertices that triangles use; `None` for a cloud.
fn used_vertices(surface: &Surface<'_>) -> Option<Vec<bool>> {
    if surface.triangles.is_empty() {
        return None;
    }
    let mut used = vec![false; surface.points.len()];
    for &v in surface.triangles.as_flattened() {
        used[v as usize] = true;
    }
    Some(used)
}

/// Lists the used vertices inside the frame; `None` if all of them are.
fn kept_vertices(surface: &Surface<'_>, frame: Frame) -> Option<Vec<usize>> {
    if frame == Frame::All {
        return None;
    }
    let used = used_vertices(surface);
    let is_used = |v: usize| used.as_ref().is_none_or(|used| used[v]);
    let (low, high) = picture_frame(surface.points, used.as_deref())?;
    let is_inside =
        |v: &usize| (0..3).all(|c| (low[c]..=high[c]).contains(&surface.points[*v][c])) && is_used(*v);
    let kept: Vec<usize> = (0..surface.points.len()).filter(is_inside).collect();
    let n_used = (0..surface.points.len()).filter(|&v| is_used(v)).count();
    (kept.len() < n_used).then_some(kept)
}
