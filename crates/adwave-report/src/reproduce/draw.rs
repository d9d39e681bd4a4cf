//! Sheets of pictures.

use super::{Context, FigureError, Model, Outcome};
use adwave::features::Feature;
use adwave_render::{Ball, FieldPaint, Paint, Panel, RenderParams, SharedCamera, Surface, grid, value_range};
pub(super) use adwave_render::{ValueRange, View};
use std::borrow::Cow;

/// What marks a feature.
pub(super) const GREEN: [u8; 3] = [52, 168, 83];
/// What marks a second kind of place.
pub(super) const ORANGE: [u8; 3] = [230, 126, 34];
/// Sides of one panel, pixels.
const PANEL: u32 = 460;

/// The colors of a panel.
enum Look {
    Clay,
    Colors(Vec<[u8; 3]>),
    Field { values: Vec<f64>, label: String, range: ValueRange },
}

/// A panel that owns what it shows.
pub(super) struct Frame<'a> {
    points: Cow<'a, [[f64; 3]]>,
    triangles: &'a [[u32; 3]],
    look: Look,
    balls: Vec<Ball>,
    caption: String,
}

impl<'a> Frame<'a> {
    /// A model in one color.
    pub(super) fn new(model: &'a Model, caption: impl Into<String>) -> Self {
        Self::moved(model, model.points().to_vec(), caption)
    }

    /// The faces of a model at other positions.
    pub(super) fn moved(model: &'a Model, points: Vec<[f64; 3]>, caption: impl Into<String>) -> Self {
        let turn = turn_of(&model.name);
        let points = match turn {
            Some(turn) => points.iter().map(|p| turned(p, turn)).collect(),
            None => points,
        };
        Self {
            points: Cow::Owned(points),
            triangles: &model.triangles,
            look: Look::Clay,
            balls: Vec::new(),
            caption: caption.into(),
        }
    }

    /// With a field, its range by percentiles.
    pub(super) fn field(self, values: &[f64], label: &str) -> Self {
        self.field_in(values, label, ValueRange::Auto)
    }

    /// With a field and the values that the ends of the colors stand for.
    pub(super) fn field_in(self, values: &[f64], label: &str, range: ValueRange) -> Self {
        let look = Look::Field { values: values.to_vec(), label: label.to_owned(), range };
        Self { look, ..self }
    }

    /// With a saliency map; its top twentieth has the brightest color, so that a few tips do not leave the rest dark.
    pub(super) fn saliency(self, map: &[f64]) -> Self {
        self.field_in(map, "saliency", ValueRange::Fixed(0.0, value_range(map, 0.0, 0.95).1))
    }

    /// With a color for each vertex.
    pub(super) fn colors(self, colors: Vec<[u8; 3]>) -> Self {
        Self { look: Look::Colors(colors), ..self }
    }

    /// With balls of the features' sizes.
    pub(super) fn features(self, model: &Model, features: &[Feature]) -> Self {
        let places = features.iter().filter_map(|f| Some((f.position?, f.sigma)));
        self.balls(model, places, GREEN)
    }

    /// With balls at places of that radius.
    pub(super) fn balls(
        mut self,
        model: &Model,
        places: impl IntoIterator<Item = ([f64; 3], f64)>,
        color: [u8; 3],
    ) -> Self {
        let turn = turn_of(&model.name);
        self.balls.extend(places.into_iter().map(|(place, radius)| Ball {
            center: turn.map_or(place, |turn| turned(&place, turn)),
            radius,
            color,
        }));
        self
    }
}

/// Panels in rows.
pub(super) struct Sheet<'a> {
    frames: Vec<Frame<'a>>,
    columns: usize,
    camera: SharedCamera,
    view: View,
}

impl<'a> Sheet<'a> {
    /// A sheet with that many columns, all of one scale.
    pub(super) fn new(columns: usize) -> Self {
        Self { frames: Vec::new(), columns, camera: SharedCamera::Same, view: View::THREE_QUARTER }
    }

    /// With every panel filled by its own shape.
    pub(super) fn own_cameras(self) -> Self {
        Self { camera: SharedCamera::Own, ..self }
    }

    /// Seen from there.
    pub(super) fn view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// Adds a panel.
    pub(super) fn push(&mut self, frame: Frame<'a>) {
        self.frames.push(frame);
    }

    /// The sheet as PNG.
    fn png(&self, context: &Context<'_>) -> Result<Vec<u8>, FigureError> {
        context.progress.step(0, 1)?;
        let panels: Vec<Panel<'_>> = self.frames.iter().map(panel).collect();
        let params = RenderParams::default().with_size(PANEL, PANEL).with_view(self.view);
        Ok(grid(&panels, self.columns, self.camera, &params, context.progress.quiet())?.png()?)
    }

    /// What the panels show, row by row.
    fn legend(&self) -> String {
        let rows = self.frames.chunks(self.columns);
        let row =
            |frames: &[Frame<'_>]| frames.iter().map(|f| f.caption.as_str()).collect::<Vec<_>>().join(" · ");
        rows.map(row).collect::<Vec<_>>().join("; ")
    }
}

impl Outcome {
    /// Adds a sheet as a picture, its caption followed by what the panels show.
    pub(super) fn sheet(
        self,
        name: &str,
        caption: impl Into<String>,
        sheet: &Sheet<'_>,
        context: &Context<'_>,
    ) -> Result<Self, FigureError> {
        let caption = format!("{} Panels, row by row: {}.", caption.into(), sheet.legend());
        Ok(self.picture(name, caption, sheet.png(context)?))
    }
}

fn panel<'a>(frame: &'a Frame<'_>) -> Panel<'a> {
    let paint = match &frame.look {
        Look::Clay => Paint::CLAY,
        Look::Colors(colors) => Paint::Colors(colors),
        Look::Field { values, label, range } => {
            let range = match *range {
                ValueRange::Auto => own_range(values),
                fixed @ ValueRange::Fixed(..) => fixed,
            };
            Paint::Field(FieldPaint { values, label: label.clone(), color_map: None, range })
        }
    };
    Panel {
        surface: Surface { points: &frame.points, triangles: frame.triangles, paint },
        balls: frame.balls.clone(),
        caption: frame.caption.clone(),
    }
}

/// The 2nd to the 98th percentile of one field, 0 in the middle where there are both signs: levels of different size side by
/// side would hide each other in one range.
fn own_range(values: &[f64]) -> ValueRange {
    let (low, high) = value_range(values, 0.02, 0.98);
    let most = high.max(-low);
    let (low, high) = if low < 0.0 && high > 0.0 { (-most, most) } else { (low, high) };
    if low < high && (high - low).is_finite() { ValueRange::Fixed(low, high) } else { ValueRange::Auto }
}

/// How the well-known files of a model, and the plane, whose bumps point up, have to be turned to stand upright and look at the viewer: which signed axis of the
/// file (1 to 3) becomes x, y and z.
fn turn_of(name: &str) -> Option<[i8; 3]> {
    match name.trim_start_matches("built-in ").split_whitespace().next()? {
        "plane" => Some([1, -3, 2]),
        "horse" => Some([2, 3, 1]),
        "skull" => Some([1, 3, -2]),
        "spot" => Some([-1, 2, -3]),
        _ => None,
    }
}

fn turned(p: &[f64; 3], turn: [i8; 3]) -> [f64; 3] {
    turn.map(|axis| f64::from(axis.signum()) * p[usize::from(axis.unsigned_abs()) - 1])
}
