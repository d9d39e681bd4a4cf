//! Pictures of the shape for the page: one camera, and the colors' meaning beside them.

use super::Viewpoint;
use crate::page::{Figure, Image, Legend};
use crate::table::short;
use adwave::shape::{Shape, triangulate};
use adwave::{Cancelled, Progress};
use adwave_render::{
    Background, Ball, ColorBar, ColorMap, FieldPaint, Paint, Panel, Picture, RenderParams, SharedCamera,
    Surface, Up, ValueRange, View, grid, value_range,
};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::time::Instant;

/// Sides of a picture, pixels: sharp on a phone's screen, and some 30 kB.
const SIDE: u32 = 560;
/// Empty rows that stay above and below.
const MARGIN: u32 = 10;
/// A picture is at least so high.
const MIN_HEIGHT: u32 = 160;
/// Shapes of more vertices are thinned out before they are drawn.
const MAX_VERTICES: usize = 250_000;
/// Cells along the diagonal of which one vertex each is kept: as wide as a pixel where the shape fills the picture.
const CELLS: f64 = 800.0;
/// Colors of a legend's bar; a browser mixes those between.
const N_STOPS: u32 = 16;

/// The shape as it is drawn, and the camera.
pub(crate) struct Studio<'a> {
    points: &'a [[f64; 3]],
    triangles: Vec<[u32; 3]>,
    /// The vertices that are drawn; all where there is no list.
    kept: Option<Vec<u32>>,
    view: View,
    up: Up,
    progress: Progress<'a>,
    n_pictures: usize,
    seconds: f64,
}

/// What a picture shows.
pub(crate) struct Frame<'a> {
    /// Other positions for the vertices.
    pub(crate) points: Option<Cow<'a, [[f64; 3]]>>,
    /// Its colors.
    pub(crate) field: Option<FieldLook>,
    /// Balls on it.
    pub(crate) balls: Vec<Ball>,
    /// What it shows, in a few words.
    pub(crate) alt: String,
    /// What to see.
    pub(crate) caption: String,
}

impl<'a> Frame<'a> {
    /// The shape as it is, in one color.
    pub(crate) fn plain(alt: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { points: None, field: None, balls: Vec::new(), alt: alt.into(), caption: caption.into() }
    }

    /// At other positions.
    pub(crate) fn at(self, points: impl Into<Cow<'a, [[f64; 3]]>>) -> Self {
        Self { points: Some(points.into()), ..self }
    }

    /// With a field.
    pub(crate) fn field(self, look: FieldLook) -> Self {
        Self { field: Some(look), ..self }
    }

    /// With balls.
    pub(crate) fn balls(self, balls: Vec<Ball>) -> Self {
        Self { balls, ..self }
    }
}

/// Positions and values of the vertices that are drawn.
type Shown<'a> = (Cow<'a, [[f64; 3]]>, Option<Cow<'a, [f64]>>);

/// A field with its colors.
pub(crate) struct FieldLook {
    values: Vec<f64>,
    label: String,
    scale: Scale,
}

/// Which values the ends of the colors stand for.
#[derive(Clone, Copy)]
pub(crate) struct Scale {
    low: f64,
    high: f64,
    map: ColorMap,
}

impl Scale {
    /// From 0 to the value below which that share of the values lies.
    pub(crate) fn from_zero(values: &[f64], share: f64) -> Self {
        Self::new(0.0, value_range(values, 0.0, share).1)
    }

    /// Symmetric about 0, up to the size below which that share of the sizes lies.
    pub(crate) fn about_zero(values: &[f64], share: f64) -> Self {
        let sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
        let most = value_range(&sizes, 0.0, share).1;
        Self::new(-most, most)
    }

    /// From the 1st to the 99th percentile; symmetric about 0 for a field of both signs.
    pub(crate) fn of(values: &[f64]) -> Self {
        /// A field whose smaller side reaches this part of its larger side has both signs.
        const BOTH_SIGNS: f64 = 0.1;
        let (low, high) = value_range(values, 0.01, 0.99);
        if -low > BOTH_SIGNS * high.max(0.0) && high > BOTH_SIGNS * (-low).max(0.0) {
            let most = high.max(-low);
            return Self::new(-most, most);
        }
        Self::new(low, high)
    }

    fn new(low: f64, high: f64) -> Self {
        // Wider than the largest number cannot be divided by.
        let (low, high) = (low.clamp(-1e300, 1e300), high.clamp(-1e300, 1e300));
        let name = if low < 0.0 && high > 0.0 { "coolwarm" } else { "viridis" };
        let map = ColorMap::from_name(name).expect("a name of the list");
        if low < high {
            return Self { low, high, map };
        }
        let room = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        Self { low: low - room, high: low + room, map }
    }
}

impl FieldLook {
    /// A field of one value per vertex; the label is its name and unit.
    pub(crate) fn new(values: Vec<f64>, label: impl Into<String>, scale: Scale) -> Self {
        Self { values, label: label.into(), scale }
    }

    fn legend(&self) -> Legend {
        let (least, most) = value_range(&self.values, 0.0, 1.0);
        let Scale { low, high, map } = self.scale;
        let end = |value: f64, beyond: bool, sign: &str| {
            let sign = if beyond { sign } else { "" };
            format!("{sign}{}", short(value))
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
        let (kept, triangles) = if points.len() > MAX_VERTICES {
            let (kept, triangles) = thinned(points, &triangles, shape.diagonal() / CELLS, progress)?;
            (Some(kept), triangles)
        } else {
            (None, triangles)
        };
        Ok(Self {
            points,
            triangles,
            kept,
            progress: progress.quiet(),
            view: viewpoint.view.unwrap_or(View::THREE_QUARTER),
            up: viewpoint.up,
            n_pictures: 0,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Whether there is anything to draw.
    pub(crate) fn can_draw(&self) -> bool {
        !self.points.is_empty()
    }

    /// Which axis points up.
    pub(crate) fn up(&self) -> Up {
        self.up
    }

    /// How many of the vertices are drawn, where not all are.
    pub(crate) fn n_drawn(&self) -> Option<usize> {
        self.kept.as_ref().map(Vec::len)
    }

    /// Pictures made.
    pub(crate) fn n_pictures(&self) -> usize {
        self.n_pictures
    }

    /// What they took.
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Pictures of one scale and place, so that they can be compared; none of a shape without positions.
    ///
    /// # Errors
    /// Why they cannot be drawn, in words.
    pub(crate) fn draw(&mut self, frames: &[Frame<'_>]) -> Result<Vec<Figure>, String> {
        let start = Instant::now();
        let pictures = self.pictures(self.view, frames)?;
        self.figures(start, &pictures, frames)
    }

    /// As [`draw`](Self::draw), and then `behind` from the opposite side, all equally high.
    ///
    /// # Errors
    /// Why they cannot be drawn, in words.
    pub(crate) fn draw_both(
        &mut self,
        front: Vec<Frame<'_>>,
        behind: Vec<Frame<'_>>,
    ) -> Result<Vec<Figure>, String> {
        let start = Instant::now();
        let View { azimuth, elevation } = self.view;
        let mut pictures = self.pictures(self.view, &front)?;
        pictures.extend(self.pictures(View { azimuth: azimuth + 180.0, elevation }, &behind)?);
        let frames: Vec<Frame<'_>> = front.into_iter().chain(behind).collect();
        self.figures(start, &pictures, &frames)
    }

    /// The pictures without the rows above and below that are empty in all of them, each with what its frame says.
    fn figures(
        &mut self,
        start: Instant,
        pictures: &[Picture],
        frames: &[Frame<'_>],
    ) -> Result<Vec<Figure>, String> {
        let rows = used_rows(pictures);
        let figures: Vec<Figure> = pictures
            .iter()
            .zip(frames)
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

    fn pictures(&self, view: View, frames: &[Frame<'_>]) -> Result<Vec<Picture>, String> {
        if !self.can_draw() || frames.is_empty() {
            return Ok(Vec::new());
        }
        let shown: Vec<Shown<'_>> = frames
            .iter()
            .map(|f| {
                let points = f.points.as_deref().unwrap_or(self.points);
                (self.taken(points), f.field.as_ref().map(|look| self.taken(&look.values)))
            })
            .collect();
        let panels: Vec<Panel<'_>> = frames
            .iter()
            .zip(&shown)
            .map(|(f, (points, values))| self.panel(f, points, values.as_deref()))
            .collect();
        let params = RenderParams::default()
            .with_size(SIDE, SIDE)
            .with_view(view)
            .with_up(self.up)
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
        frame: &Frame<'_>,
        points: &'p [[f64; 3]],
        values: Option<&'p [f64]>,
    ) -> Panel<'p> {
        let paint = match (&frame.field, values) {
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
            balls: frame.balls.clone(),
            caption: String::new(),
        }
    }

    /// The values of the vertices that are drawn.
    fn taken<'v, T: Copy>(&self, values: &'v [T]) -> Cow<'v, [T]>
    where
        [T]: ToOwned<Owned = Vec<T>>,
    {
        match &self.kept {
            None => Cow::Borrowed(values),
            Some(kept) => Cow::Owned(kept.iter().map(|&v| values[v as usize]).collect()),
        }
    }
}

/// The rows that are not empty in all of the pictures, and a few more.
fn used_rows(pictures: &[Picture]) -> Range<u32> {
    let is_used = |row: &[u8]| row.chunks_exact(4).any(|pixel| pixel[3] > 0);
    let row = 4 * SIDE as usize;
    let used =
        || pictures.iter().flat_map(|p| p.rgba.chunks_exact(row).enumerate()).filter(|(_, r)| is_used(r));
    let first = used().map(|(y, _)| y as u32).min().unwrap_or(0);
    let last = used().map(|(y, _)| y as u32).max().unwrap_or(SIDE - 1);
    // A flat shape seen from its edge still gets a picture that is wide, not a line.
    let room = MARGIN.max(MIN_HEIGHT.saturating_sub(last + 1 - first) / 2);
    first.saturating_sub(room)..(last + 1 + room).min(SIDE)
}

/// The first vertex of each cell of that width, by rising index, and the triangles whose corners are in three cells, each
/// once. Only pictures are made of it: what it leaves out is smaller than a pixel.
fn thinned(
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
        // The same triangle begins at its smallest corner, whichever way round it goes.
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
    fn a_thinned_mesh_has_a_vertex_a_cell_and_no_triangle_twice() {
        // A strip of 8 × 2 vertices a tenth of a cell apart, but for the last two, which are a cell further on.
        let points: Vec<[f64; 3]> = (0..16)
            .map(|i| {
                let x = f64::from(i / 2);
                [if i < 14 { 0.1 * x } else { 1.5 }, if i % 2 == 0 { 0.2 } else { 1.2 }, 0.5]
            })
            .collect();
        let triangles: Vec<[u32; 3]> =
            (0..14).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        let (kept, thin) = thinned(&points, &triangles, 1.0, Progress::none()).unwrap();
        assert_eq!(kept, [0, 1, 14, 15]);
        assert_eq!(thin.len(), 2);
    }

    #[test]
    fn rows_that_are_empty_everywhere_are_cut_off() {
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
    fn scales_have_a_width_whatever_the_values() {
        for values in [&[0.0; 5][..], &[-3.0; 5], &[f64::NAN; 3], &[], &[-1e308, 1e308]] {
            for scale in [Scale::of(values), Scale::from_zero(values, 0.95)] {
                assert!(scale.low < scale.high && (scale.high - scale.low).is_finite(), "{values:?}");
            }
        }
        let both = Scale::of(&[-1.0, 0.5, 0.25]);
        assert_eq!((both.low, both.high, both.map.name()), (-1.0, 1.0, "coolwarm"));
    }
}
