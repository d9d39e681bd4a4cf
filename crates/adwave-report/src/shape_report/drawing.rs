//! Pictures of the shape for the page, with one camera, and their legends.

use super::{Subject, Viewpoint};
use crate::page::{Figure, Image, Legend};
use crate::table::range_end;
use adwave::shape::{Shape, triangulate};
use adwave::{Cancelled, Progress};
use adwave_render::{
    Background, Ball, ColorBar, ColorMap, FieldPaint, Paint, Panel, Picture, Projection, RenderParams,
    SharedCamera, Surface, Up, ValueRange, View, grid, value_range,
};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::time::Instant;

/// Side of a picture in pixels, sharp on a narrow screen; a picture takes about 30 kB.
const SIDE: u32 = 560;
/// Number of empty rows above and below the shape.
const MARGIN: u32 = 10;
/// Smallest height of a picture, in pixels.
const MIN_HEIGHT: u32 = 160;
/// Number of vertices above which a shape is thinned out before it is drawn.
const MAX_VERTICES: usize = 250_000;
/// Number of cells along the diagonal, each of which keeps one vertex; a cell is about as wide as a pixel.
const CELLS: f64 = 800.0;
/// Number of colors in the bar of a legend; browsers interpolate between them.
const N_STOPS: u32 = 16;

/// Shape as it is drawn, with the camera.
pub(crate) struct Studio<'a> {
    /// Positions of the drawn vertices.
    points: Cow<'a, [[f64; 3]]>,
    triangles: Vec<[u32; 3]>,
    /// Indices of the drawn vertices; `None` if all are drawn.
    drawn_vertices: Option<Vec<u32>>,
    view: View,
    up: Up,
    projection: Projection,
    progress: Progress<'a>,
    n_pictures: usize,
    seconds: f64,
}

/// Content of a picture.
pub(crate) struct PictureSpec<'a> {
    /// Positions of the vertices, in model units; `None` for those of the shape.
    pub(crate) points: Option<Cow<'a, [[f64; 3]]>>,
    /// Field that colors the shape.
    pub(crate) field: Option<FieldLook>,
    /// Balls that are drawn with the shape.
    pub(crate) balls: Vec<Ball>,
    /// Text shown instead of the picture.
    pub(crate) alt: String,
    /// Caption below the picture.
    pub(crate) caption: String,
}

impl<'a> PictureSpec<'a> {
    /// Describes a picture of the shape in one color.
    pub(crate) fn plain(alt: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { points: None, field: None, balls: Vec::new(), alt: alt.into(), caption: caption.into() }
    }

    /// Sets the positions of the vertices.
    pub(crate) fn with_positions(self, points: impl Into<Cow<'a, [[f64; 3]]>>) -> Self {
        Self { points: Some(points.into()), ..self }
    }

    /// Colors the shape by a field.
    pub(crate) fn field(self, look: FieldLook) -> Self {
        Self { field: Some(look), ..self }
    }

    /// Adds balls.
    pub(crate) fn balls(self, balls: Vec<Ball>) -> Self {
        Self { balls, ..self }
    }
}

/// Pictures of values of a subject's signal: as positions of the vertices, or as colors in the range of the signal.
pub(crate) struct SignalPictures<'s> {
    subject: &'s Subject<'s>,
    /// Colors; `None` for positions.
    scale: Option<Scale>,
}

impl<'s> SignalPictures<'s> {
    /// Finds the range of the signal. O(vertices).
    pub(crate) fn new(subject: &'s Subject<'s>) -> Self {
        let scale = (!subject.is_geometry()).then(|| {
            let scale = Scale::from_percentiles(&subject.scalar(subject.values));
            if subject.grid.is_some() { scale.in_gray() } else { scale }
        });
        Self { subject, scale }
    }

    /// Describes a picture of `values`, n_vertices × n_channels.
    pub(crate) fn picture(&self, values: &[f64], alt: String, caption: String) -> PictureSpec<'static> {
        let (subject, spec) = (self.subject, PictureSpec::plain(alt, caption));
        match self.scale {
            None => spec.with_positions(values.as_chunks().0.to_vec()),
            Some(scale) => spec.field(FieldLook::new(subject.scalar(values), subject.scalar_name(), scale)),
        }
    }
}

/// Positions and values of the drawn vertices.
type DrawnValues<'a> = (Cow<'a, [[f64; 3]]>, Option<Cow<'a, [f64]>>);

/// Field with its name and colors.
pub(crate) struct FieldLook {
    values: Vec<f64>,
    label: String,
    scale: Scale,
}

/// Range of values that the colors span.
#[derive(Clone, Copy)]
pub(crate) struct Scale {
    low: f64,
    high: f64,
    map: ColorMap,
}

impl Scale {
    /// Creates a scale from 0 to the quantile `share` of the values.
    pub(crate) fn from_zero(values: &[f64], share: f64) -> Self {
        Self::new(0.0, value_range(values, 0.0, share).1)
    }

    /// Creates a scale symmetric about 0, up to the quantile `share` of the absolute values.
    pub(crate) fn about_zero(values: &[f64], share: f64) -> Self {
        let sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
        let most = value_range(&sizes, 0.0, share).1;
        Self::new(-most, most)
    }

    /// Creates a scale from the 1st to the 99th percentile, or symmetric about 0 for a field with both signs.
    pub(crate) fn from_percentiles(values: &[f64]) -> Self {
        /// Ratio of the smaller to the larger magnitude of the ends above which a field has both signs.
        const BOTH_SIGNS: f64 = 0.1;
        let (low, high) = value_range(values, 0.01, 0.99);
        if -low > BOTH_SIGNS * high.max(0.0) && high > BOTH_SIGNS * (-low).max(0.0) {
            let most = high.max(-low);
            return Self::new(-most, most);
        }
        Self::new(low, high)
    }

    /// Shows values of one sign in gray, as images are shown.
    pub(crate) fn in_gray(self) -> Self {
        let has_both_signs = self.low < 0.0 && self.high > 0.0;
        let gray = ColorMap::from_name("gray").filter(|_| !has_both_signs);
        Self { map: gray.unwrap_or(self.map), ..self }
    }

    fn new(low: f64, high: f64) -> Self {
        // The width of the range must be finite.
        let (low, high) = (low.clamp(-1e300, 1e300), high.clamp(-1e300, 1e300));
        let name = if low < 0.0 && high > 0.0 { "coolwarm" } else { "viridis" };
        let map = ColorMap::from_name(name).expect("a color map that exists");
        if low < high {
            return Self { low, high, map };
        }
        let room = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        Self { low: low - room, high: low + room, map }
    }
}

impl FieldLook {
    /// Creates a field from one value per vertex; `label` has its name and unit.
    pub(crate) fn new(values: Vec<f64>, label: impl Into<String>, scale: Scale) -> Self {
        Self { values, label: label.into(), scale }
    }

    fn legend(&self) -> Legend {
        let (least, most) = value_range(&self.values, 0.0, 1.0);
        let Scale { low, high, map } = self.scale;
        let end = |value: f64, beyond: bool, sign: &str| {
            let sign = if beyond { sign } else { "" };
            format!("{sign}{}", range_end(value, high - low))
        };
        Legend::Bar {
            label: self.label.clone(),
            low: end(low, least < low, "≤ "),
            high: end(high, most > high, "≥ "),
            colors: (0..N_STOPS).map(|k| map.color(f64::from(k) / f64::from(N_STOPS - 1))).collect(),
        }
    }
}

impl<'a> Studio<'a> {
    pub(crate) fn new(
        shape: &'a Shape,
        viewpoint: Viewpoint,
        progress: Progress<'a>,
    ) -> Result<Self, Cancelled> {
        let points = shape.points().unwrap_or_default();
        let triangles = match shape {
            Shape::Mesh(mesh) => triangulate(points, mesh.faces()),
            _ => Vec::new(),
        };
        let start = Instant::now();
        let (points, drawn_vertices, triangles) = if points.len() > MAX_VERTICES {
            let (drawn, triangles) = thin_out(points, &triangles, shape.diagonal() / CELLS, progress)?;
            let points = drawn.iter().map(|&v| points[v as usize]).collect();
            (Cow::Owned(points), Some(drawn), triangles)
        } else {
            (Cow::Borrowed(points), None, triangles)
        };
        Ok(Self {
            points,
            triangles,
            drawn_vertices,
            progress: progress.quiet(),
            view: viewpoint.view.unwrap_or(View::THREE_QUARTER),
            up: viewpoint.up,
            projection: RenderParams::default().projection,
            n_pictures: 0,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// The studio of a shape, or of the sheet of an image or a volume, which is seen from the front.
    pub(crate) fn new_for_subject(
        subject: &Subject<'a>,
        viewpoint: Viewpoint,
        progress: Progress<'a>,
    ) -> Result<Self, Cancelled> {
        let studio = Self::new(subject.shape, viewpoint, progress)?;
        let Some(sheet) = subject.grid.and_then(|grid| grid.sheet) else { return Ok(studio) };
        Ok(Self {
            points: Cow::Borrowed(sheet.points),
            triangles: sheet.triangles.to_vec(),
            drawn_vertices: Some(sheet.places.to_vec()),
            view: View::FRONT,
            up: Up::Y,
            projection: Projection::Orthographic,
            ..studio
        })
    }

    /// True if the shape has positions.
    pub(crate) fn can_draw(&self) -> bool {
        !self.points.is_empty()
    }

    /// Axis that points up.
    pub(crate) fn up(&self) -> Up {
        self.up
    }

    /// Number of drawn vertices; `None` if all are drawn.
    pub(crate) fn n_drawn(&self) -> Option<usize> {
        self.drawn_vertices.as_ref().map(Vec::len)
    }

    /// Number of pictures drawn so far.
    pub(crate) fn n_pictures(&self) -> usize {
        self.n_pictures
    }

    /// Seconds spent on drawing so far.
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Draws pictures with one camera, so that they can be compared; none for a shape without positions.
    ///
    /// # Errors
    /// A message if they cannot be drawn.
    pub(crate) fn draw(&mut self, specs: &[PictureSpec<'_>]) -> Result<Vec<Figure>, String> {
        let start = Instant::now();
        let pictures = self.pictures(self.view, specs)?;
        self.figures(start, &pictures, specs)
    }

    /// Draws `front` like [`draw`](Self::draw), and `back` from the opposite side, which a sheet does not have; all pictures
    /// have the same height.
    ///
    /// # Errors
    /// A message if they cannot be drawn.
    pub(crate) fn draw_both(
        &mut self,
        front: Vec<PictureSpec<'_>>,
        back: Vec<PictureSpec<'_>>,
    ) -> Result<Vec<Figure>, String> {
        // A sheet is seen without perspective.
        if self.projection == Projection::Orthographic {
            return self.draw(&front);
        }
        let start = Instant::now();
        let View { azimuth, elevation } = self.view;
        let mut pictures = self.pictures(self.view, &front)?;
        pictures.extend(self.pictures(View { azimuth: azimuth + 180.0, elevation }, &back)?);
        let specs: Vec<PictureSpec<'_>> = front.into_iter().chain(back).collect();
        self.figures(start, &pictures, &specs)
    }

    /// Crops the rows above and below that are empty in all pictures, and adds captions and legends.
    fn figures(
        &mut self,
        start: Instant,
        pictures: &[Picture],
        specs: &[PictureSpec<'_>],
    ) -> Result<Vec<Figure>, String> {
        let rows = used_rows(pictures);
        let figures: Vec<Figure> = pictures
            .iter()
            .zip(specs)
            .map(|(picture, f)| {
                let picture =
                    picture.crop(0, rows.start, SIDE, rows.len() as u32).map_err(|e| e.to_string())?;
                Ok(Figure {
                    image: Image::shaded(&picture).map_err(|e| e.to_string())?,
                    alt: f.alt.clone(),
                    caption: f.caption.clone(),
                    legend: f.field.as_ref().map(FieldLook::legend),
                    link: None,
                })
            })
            .collect::<Result<_, String>>()?;
        self.n_pictures += figures.len();
        self.seconds += start.elapsed().as_secs_f64();
        Ok(figures)
    }

    fn pictures(&self, view: View, specs: &[PictureSpec<'_>]) -> Result<Vec<Picture>, String> {
        if !self.can_draw() || specs.is_empty() {
            return Ok(Vec::new());
        }
        let shown: Vec<DrawnValues<'_>> = specs
            .iter()
            .map(|f| {
                let points =
                    f.points.as_deref().map_or(Cow::Borrowed(&*self.points), |own| self.select_drawn(own));
                (points, f.field.as_ref().map(|look| self.select_drawn(&look.values)))
            })
            .collect();
        let panels: Vec<Panel<'_>> = specs
            .iter()
            .zip(&shown)
            .map(|(f, (points, values))| self.panel(f, points, values.as_deref()))
            .collect();
        let params = RenderParams::default()
            .with_size(SIDE, SIDE)
            .with_view(view)
            .with_up(self.up)
            .with_projection(self.projection)
            .with_background(Background::Transparent)
            .with_color_bar(ColorBar::Hidden);
        let sheet =
            grid(&panels, 1, SharedCamera::Same, &params, self.progress).map_err(|e| e.to_string())?;
        let one = 4 * SIDE as usize * SIDE as usize;
        let picture = |rgba: &[u8]| Picture { width: SIDE, height: SIDE, rgba: rgba.to_vec() };
        Ok(sheet.rgba.chunks_exact(one).map(picture).collect())
    }

    fn panel<'p>(
        &'p self,
        spec: &PictureSpec<'_>,
        points: &'p [[f64; 3]],
        values: Option<&'p [f64]>,
    ) -> Panel<'p> {
        let paint = match (&spec.field, values) {
            (Some(look), Some(values)) => Paint::Field(FieldPaint {
                values,
                label: String::new(),
                color_map: Some(look.scale.map),
                range: ValueRange::Fixed(look.scale.low, look.scale.high),
            }),
            _ => Paint::CLAY,
        };
        Panel {
            surface: Surface { points, triangles: &self.triangles, paint },
            balls: spec.balls.clone(),
            caption: String::new(),
        }
    }

    /// Selects the values of the drawn vertices.
    fn select_drawn<'v, T: Copy>(&self, values: &'v [T]) -> Cow<'v, [T]>
    where
        [T]: ToOwned<Owned = Vec<T>>,
    {
        match &self.drawn_vertices {
            None => Cow::Borrowed(values),
            Some(drawn) => Cow::Owned(drawn.iter().map(|&v| values[v as usize]).collect()),
        }
    }
}

/// Range of the rows that are used in a picture, with a margin.
fn used_rows(pictures: &[Picture]) -> Range<u32> {
    let is_used = |row: &[u8]| row.chunks_exact(4).any(|pixel| pixel[3] > 0);
    let row = 4 * SIDE as usize;
    let used =
        || pictures.iter().flat_map(|p| p.rgba.chunks_exact(row).enumerate()).filter(|(_, r)| is_used(r));
    let first = used().map(|(y, _)| y as u32).min().unwrap_or(0);
    let last = used().map(|(y, _)| y as u32).max().unwrap_or(SIDE - 1);
    // A flat shape that is seen from its edge still gets a picture of some height.
    let room = MARGIN.max(MIN_HEIGHT.saturating_sub(last + 1 - first) / 2);
    first.saturating_sub(room)..(last + 1 + room).min(SIDE)
}

/// Thins out a mesh for drawing: keeps the first vertex of each cell of width `cell` (model units), by ascending index,
/// and the distinct triangles whose corners are in three cells. The details that it drops are smaller than a pixel.
fn thin_out(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    cell: f64,
    progress: Progress<'_>,
) -> Result<(Vec<u32>, Vec<[u32; 3]>), Cancelled> {
    let mut index_of: HashMap<[i64; 3], u32> = HashMap::new();
    let mut kept = Vec::new();
    let mut cell_of = Vec::with_capacity(points.len());
    for (v, p) in points.iter().enumerate() {
        if v % (1 << 14) == 0 {
            progress.check()?;
        }
        cell_of.push(*index_of.entry(p.map(|c| (c / cell).floor() as i64)).or_insert_with(|| {
            kept.push(v as u32);
            kept.len() as u32 - 1
        }));
    }
    let mut thin: Vec<[u32; 3]> = triangles
        .iter()
        .map(|t| t.map(|v| cell_of[v as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        // Rotate the smallest corner to the front, which preserves the orientation.
        .map(|[a, b, c]| {
            if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            }
        })
        .collect();
    progress.check()?;
    thin.sort_unstable();
    thin.dedup();
    Ok((kept, thin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_mesh_has_one_vertex_per_cell_and_no_duplicate_triangles() {
        // A strip of 8 × 2 vertices a tenth of a cell apart, but for the last two, which are a cell further on.
        let points: Vec<[f64; 3]> = (0..16)
            .map(|i| {
                let x = f64::from(i / 2);
                [if i < 14 { 0.1 * x } else { 1.5 }, if i % 2 == 0 { 0.2 } else { 1.2 }, 0.5]
            })
            .collect();
        let triangles: Vec<[u32; 3]> =
            (0..14).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        let (kept, thin) = thin_out(&points, &triangles, 1.0, Progress::none()).unwrap();
        assert_eq!(kept, [0, 1, 14, 15]);
        assert_eq!(thin.len(), 2);
    }

    #[test]
    fn rows_that_are_empty_in_all_pictures_are_cropped() {
        let mut picture = Picture::blank(SIDE, SIDE, [0; 4]).unwrap();
        assert_eq!(used_rows(std::slice::from_ref(&picture)), 0..SIDE);
        picture.place(&Picture::blank(1, 1, [9, 9, 9, 255]).unwrap(), 3, 100);
        let other = Picture::blank(SIDE, SIDE, [0; 4]).unwrap();
        let rows = used_rows(&[other.clone(), picture.clone()]);
        assert!(
            rows.contains(&100) && (MIN_HEIGHT - 1..=MIN_HEIGHT).contains(&(rows.len() as u32)),
            "{rows:?}"
        );
        picture.place(&Picture::blank(1, 1, [9, 9, 9, 255]).unwrap(), 3, 500);
        assert_eq!(used_rows(&[picture, other]), 100 - MARGIN..501 + MARGIN);
    }

    #[test]
    fn scales_have_a_positive_width_for_all_values() {
        for values in [&[0.0; 5][..], &[-3.0; 5], &[f64::NAN; 3], &[], &[-1e308, 1e308]] {
            for scale in [Scale::from_percentiles(values), Scale::from_zero(values, 0.95)] {
                assert!(scale.low < scale.high && (scale.high - scale.low).is_finite(), "{values:?}");
            }
        }
        let both = Scale::from_percentiles(&[-1.0, 0.5, 0.25]);
        assert_eq!((both.low, both.high, both.map.name()), (-1.0, 1.0, "coolwarm"));
    }
}
