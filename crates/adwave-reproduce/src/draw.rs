//! Sheets of pictures.

use crate::{Context, FigureError, Model, Outcome};
use adwave::features::Feature;
use adwave_render::{Ball, FieldPaint, Paint, Panel, RenderParams, SharedCamera, Surface, grid, value_range};
pub(crate) use adwave_render::{ValueRange, View};
use std::borrow::Cow;

/// Color of features.
pub(crate) const GREEN: [u8; 3] = [52, 168, 83];
/// Color of a second kind of marked places.
pub(crate) const ORANGE: [u8; 3] = [230, 126, 34];
/// Side of a panel, in pixels.
const PANEL: u32 = 460;

/// Colors of a panel.
enum PanelColors {
    Clay,
    Colors(Vec<[u8; 3]>),
    Field { values: Vec<f64>, label: String, range: ValueRange },
}

/// Panel that owns its content.
pub(crate) struct SheetPanel<'a> {
    points: Cow<'a, [[f64; 3]]>,
    triangles: &'a [[u32; 3]],
    colors: PanelColors,
    balls: Vec<Ball>,
    caption: String,
}

impl<'a> SheetPanel<'a> {
    /// Creates a panel of a model in one color.
    pub(crate) fn new(model: &'a Model, caption: impl Into<String>) -> Self {
        Self::with_points(model, model.points().to_vec(), caption)
    }

    /// Creates a panel of a model with other positions of its vertices, in one color.
    pub(crate) fn with_points(model: &'a Model, points: Vec<[f64; 3]>, caption: impl Into<String>) -> Self {
        let turn = upright_axes(&model.name);
        let points = match turn {
            Some(turn) => points.iter().map(|p| rotate_axes(p, turn)).collect(),
            None => points,
        };
        Self {
            points: Cow::Owned(points),
            triangles: &model.triangles,
            colors: PanelColors::Clay,
            balls: Vec::new(),
            caption: caption.into(),
        }
    }

    /// Colors the model by a field, with a range from percentiles.
    pub(crate) fn field(self, values: &[f64], label: &str) -> Self {
        self.field_in_range(values, label, ValueRange::Auto)
    }

    /// Colors the model by a field, with a given range.
    pub(crate) fn field_in_range(self, values: &[f64], label: &str, range: ValueRange) -> Self {
        let colors = PanelColors::Field { values: values.to_vec(), label: label.to_owned(), range };
        Self { colors, ..self }
    }

    /// Colors the model by a saliency map. The top 5 % have the brightest color, so that a few tips do not leave the
    /// rest dark.
    pub(crate) fn saliency(self, map: &[f64]) -> Self {
        self.field_in_range(map, "saliency", ValueRange::Fixed(0.0, value_range(map, 0.0, 0.95).1))
    }

    /// Sets a color for each vertex.
    pub(crate) fn colors(self, colors: Vec<[u8; 3]>) -> Self {
        Self { colors: PanelColors::Colors(colors), ..self }
    }

    /// Adds a ball of radius σ for each feature.
    pub(crate) fn features(self, model: &Model, features: &[Feature]) -> Self {
        let places = features.iter().filter_map(|f| Some((f.position?, f.sigma)));
        self.balls(model, places, GREEN)
    }

    /// Adds balls with the centers and radii `places`, in model units.
    pub(crate) fn balls(
        mut self,
        model: &Model,
        places: impl IntoIterator<Item = ([f64; 3], f64)>,
        color: [u8; 3],
    ) -> Self {
        let turn = upright_axes(&model.name);
        self.balls.extend(places.into_iter().map(|(place, radius)| Ball {
            center: turn.map_or(place, |turn| rotate_axes(&place, turn)),
            radius,
            color,
        }));
        self
    }
}

/// Sheet of panels in rows.
pub(crate) struct Sheet<'a> {
    panels: Vec<SheetPanel<'a>>,
    columns: usize,
    camera: SharedCamera,
    view: View,
    /// True to draw each face flat.
    shows_facets: bool,
}

impl<'a> Sheet<'a> {
    /// Creates a sheet with `columns` columns, with all panels at one scale.
    pub(crate) fn new(columns: usize) -> Self {
        Self {
            panels: Vec::new(),
            columns,
            camera: SharedCamera::Same,
            view: View::THREE_QUARTER,
            shows_facets: false,
        }
    }

    /// Draws each face flat.
    pub(crate) fn facets(self) -> Self {
        Self { shows_facets: true, ..self }
    }

    /// Scales every panel to its own shape.
    pub(crate) fn own_cameras(self) -> Self {
        Self { camera: SharedCamera::Own, ..self }
    }

    /// Sets the direction of the view.
    pub(crate) fn view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// Adds a panel.
    pub(crate) fn push(&mut self, panel: SheetPanel<'a>) {
        self.panels.push(panel);
    }

    /// Draws the sheet and encodes it as PNG.
    fn png(&self, context: &Context<'_>) -> Result<Vec<u8>, FigureError> {
        context.progress.step(0, 1)?;
        let panels: Vec<Panel<'_>> = self.panels.iter().map(render_panel).collect();
        let mut params = RenderParams::default().with_size(PANEL, PANEL).with_view(self.view);
        if self.shows_facets {
            params = params.with_crease_angle(0.0);
        }
        Ok(grid(&panels, self.columns, self.camera, &params, context.progress.quiet())?.png()?)
    }

    /// Captions of the panels, row by row.
    fn legend(&self) -> String {
        let rows = self.panels.chunks(self.columns);
        let row = |panels: &[SheetPanel<'_>]| {
            panels.iter().map(|f| f.caption.as_str()).collect::<Vec<_>>().join(" · ")
        };
        rows.map(row).collect::<Vec<_>>().join("; ")
    }
}

impl Outcome {
    /// Adds a sheet as a picture. Its caption ends with the captions of the panels.
    pub(crate) fn sheet(
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

fn render_panel<'a>(panel: &'a SheetPanel<'_>) -> Panel<'a> {
    let paint = match &panel.colors {
        PanelColors::Clay => Paint::CLAY,
        PanelColors::Colors(colors) => Paint::Colors(colors),
        PanelColors::Field { values, label, range } => {
            let range = match *range {
                ValueRange::Auto => percentile_range(values),
                other => other,
            };
            Paint::Field(FieldPaint { values, label: label.clone(), color_map: None, range })
        }
    };
    Panel {
        surface: Surface { points: &panel.points, triangles: panel.triangles, paint },
        balls: panel.balls.clone(),
        caption: panel.caption.clone(),
    }
}

/// Range from the 2nd to the 98th percentile of a field, symmetric about 0 if it has both signs. Each field has its own
/// range, because levels of different magnitude would be invisible in a common range.
fn percentile_range(values: &[f64]) -> ValueRange {
    let (low, high) = value_range(values, 0.02, 0.98);
    let most = high.max(-low);
    let (low, high) = if low < 0.0 && high > 0.0 { (-most, most) } else { (low, high) };
    if low < high && (high - low).is_finite() { ValueRange::Fixed(low, high) } else { ValueRange::Auto }
}

/// Signed axes (1 to 3) of the usual file of a model that become x, y and z, so that the model stands upright and faces
/// the viewer. The bumps of the plane point up. `None` if the model needs no rotation.
fn upright_axes(name: &str) -> Option<[i8; 3]> {
    match name.trim_start_matches("built-in ").split_whitespace().next()? {
        "plane" => Some([1, -3, 2]),
        "horse" => Some([2, 3, 1]),
        "skull" => Some([1, 3, -2]),
        "spot" => Some([-1, 2, -3]),
        _ => None,
    }
}

fn rotate_axes(p: &[f64; 3], turn: [i8; 3]) -> [f64; 3] {
    turn.map(|axis| f64::from(axis.signum()) * p[usize::from(axis.unsigned_abs()) - 1])
}
