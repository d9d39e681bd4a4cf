//! From surfaces to pictures.

use crate::color_bar::{self, ink, letter_size};
use crate::color_range::{ColorScale, ValueRange};
use crate::error::RenderError;
use crate::frame::{Extent, Frame};
use crate::normals::{corner_normals, discs};
use crate::params::{Background, ColorBar, RenderParams, check_size};
use crate::picture::Picture;
use crate::raster::{Color, Pixel, Primitive, draw};
use crate::surface::{Ball, FieldPaint, Paint, Surface, check_balls};
use crate::{occlusion, text};
use adwave::shape::MAX_COORDINATE;
use rayon::prelude::*;

/// A disc of a cloud, by the distance to its nearest neighbours: they overlap, so that no background shows between.
const DISC: f64 = 1.15;

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// What is seen.
    pub surface: Surface<'a>,
    /// Balls beside it.
    pub balls: Vec<Ball>,
    /// The line below.
    pub caption: String,
}

/// Whether the panels of a sheet have one scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SharedCamera {
    /// The same size and place in all, so that shapes can be compared.
    #[default]
    Same,
    /// Each panel is filled by its own shape.
    Own,
}

/// A picture of a shape. O(vertices + pixels × samples²).
///
/// ```
/// use adwave_render::{Paint, RenderParams, Surface, render};
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let surface = Surface { points: &points, triangles: &[[0, 1, 2]], paint: Paint::CLAY };
/// let picture = render(&surface, &[], &RenderParams::default().with_size(40, 30))?;
/// assert_eq!(picture.pixel(0, 0), [255; 4]);
/// assert_ne!(picture.pixel(18, 18), [255; 4]);
/// # Ok::<(), adwave_render::RenderError>(())
/// ```
///
/// # Errors
///
/// What [`RenderParams::check`] and [`Surface::check`] refuse, and balls without size.
pub fn render(surface: &Surface, balls: &[Ball], params: &RenderParams) -> Result<Picture, RenderError> {
    check(surface, balls, params)?;
    let fitted = Fitted::new(surface, balls);
    let axes = Frame::axes(params.view, params.up);
    let extent = Extent::of(&fitted.surface(surface), &fitted.balls, &axes);
    let scale = scale_of(surface);
    Ok(panel(&fitted.surface(surface), &fitted.balls, params, &extent, scale.as_ref()))
}

/// Several pictures of `params`' size on one sheet, row by row, each with its caption. Fields of the same label whose
/// range is automatic have one range for all.
///
/// # Errors
///
/// As [`render`]; no panels, no columns, or a sheet that is too large.
pub fn grid(
    panels: &[Panel],
    columns: usize,
    camera: SharedCamera,
    params: &RenderParams,
) -> Result<Picture, RenderError> {
    if panels.is_empty() || columns == 0 {
        return Err(RenderError::NoPanels);
    }
    params.check()?;
    let columns = columns.min(panels.len());
    let size = letter_size(params.width, params.height);
    let below = if panels.iter().all(|p| p.caption.is_empty()) { 0 } else { (2.0 * size) as u32 };
    let n_rows = panels.len().div_ceil(columns) as u32;
    let whole = |n: u32, each: u32| n.saturating_mul(each);
    let (width, height) =
        (whole(columns as u32, params.width), whole(n_rows, params.height.saturating_add(below)));
    check_size(width, height)?;
    panels.iter().try_for_each(|p| check(&p.surface, &p.balls, params))?;
    let axes = Frame::axes(params.view, params.up);
    // One unit for all, or the scales could not be compared.
    let unit = Unit::of(
        panels.iter().flat_map(|p| p.surface.points.iter().chain(p.balls.iter().map(|b| &b.center))),
    );
    let fitted: Vec<Fitted> = panels.iter().map(|p| Fitted::by(&unit, &p.surface, &p.balls)).collect();
    let extents: Vec<Extent> = panels
        .iter()
        .zip(&fitted)
        .map(|(p, f)| Extent::of(&f.surface(&p.surface), &f.balls, &axes))
        .collect();
    let all = extents.iter().copied().reduce(Extent::with).expect("at least one panel");
    let background = background(params);
    let mut sheet = Picture::filled(width, height, background);
    for (k, (p, f)) in panels.iter().zip(&fitted).enumerate() {
        let extent = if camera == SharedCamera::Same { &all } else { &extents[k] };
        let scale = shared_scale(panels, &p.surface);
        let picture = panel(&f.surface(&p.surface), &f.balls, params, extent, scale.as_ref());
        let (left, top) =
            ((k % columns) as u32 * params.width, (k / columns) as u32 * (params.height + below));
        sheet.put(&picture, left, top);
        let caption = text::fitted(&p.caption, size, params.width as f32 - size);
        let start = left as f32 + 0.5 * (params.width as f32 - text::width(&caption, size));
        let middle = (top + params.height) as f32 + 0.8 * size;
        text::write(
            &mut sheet,
            &caption,
            start,
            middle,
            size,
            ink([background[0], background[1], background[2]]),
        );
    }
    Ok(sheet)
}

fn check(surface: &Surface, balls: &[Ball], params: &RenderParams) -> Result<(), RenderError> {
    params.check()?;
    surface.check()?;
    check_balls(balls)
}

/// Subtract the middle, then multiply: coordinates of about 1, whose squares neither overflow nor vanish.
struct Unit {
    middle: [f64; 3],
    factor: f64,
}

impl Unit {
    fn of<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> Self {
        let (low, high) = points.fold(([MAX_COORDINATE; 3], [-MAX_COORDINATE; 3]), |(low, high), p| {
            ([0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k])))
        });
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let factor = 1.0 / size;
        Self {
            middle: [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k]),
            factor: if factor.is_finite() { factor } else { 1.0 },
        }
    }

    fn place(&self, p: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| (p[k] - self.middle[k]) * self.factor)
    }
}

/// What is drawn, in coordinates of about 1.
struct Fitted {
    points: Vec<[f64; 3]>,
    balls: Vec<Ball>,
}

impl Fitted {
    fn new(surface: &Surface, balls: &[Ball]) -> Self {
        Self::by(&Unit::of(surface.points.iter()), surface, balls)
    }

    fn by(unit: &Unit, surface: &Surface, balls: &[Ball]) -> Self {
        let ball =
            |b: &Ball| Ball { center: unit.place(&b.center), radius: b.radius * unit.factor, color: b.color };
        Self {
            points: surface.points.par_iter().map(|p| unit.place(p)).collect(),
            balls: balls.iter().map(ball).collect(),
        }
    }

    fn surface<'a>(&'a self, of: &Surface<'a>) -> Surface<'a> {
        Surface { points: &self.points, triangles: of.triangles, paint: of.paint.clone() }
    }
}

fn scale_of(surface: &Surface) -> Option<ColorScale> {
    match &surface.paint {
        Paint::Field(field) => Some(ColorScale::of(&[field])),
        _ => None,
    }
}

/// The field's own range, or the scale that all fields of its label without one share.
fn shared_scale(panels: &[Panel], surface: &Surface) -> Option<ColorScale> {
    let Paint::Field(own) = &surface.paint else { return None };
    if own.range != ValueRange::Auto {
        return Some(ColorScale::of(&[own]));
    }
    let same: Vec<&FieldPaint> = panels
        .iter()
        .filter_map(|p| match &p.surface.paint {
            Paint::Field(field) if field.label == own.label && field.range == own.range => Some(field),
            _ => None,
        })
        .collect();
    Some(ColorScale::of(&same))
}

fn background(params: &RenderParams) -> [u8; 4] {
    match params.background {
        Background::Transparent => [255, 255, 255, 0],
        Background::Color([r, g, b]) => [r, g, b, 255],
    }
}

/// One panel, all checked before.
fn panel(
    surface: &Surface,
    balls: &[Ball],
    params: &RenderParams,
    extent: &Extent,
    scale: Option<&ColorScale>,
) -> Picture {
    let bar = scale.filter(|_| params.color_bar == ColorBar::Shown);
    let (width, height) = (params.width as usize, params.height as usize);
    let beside = if bar.is_some() { color_bar::room(params.width, params.height) } else { 0 };
    let samples = params.samples as usize;
    let axes = Frame::axes(params.view, params.up);
    let room = f64::from(params.width - beside);
    let frame = Frame::new(axes, extent, room * samples as f64, f64::from(params.height) * samples as f64);
    let primitives = primitives(surface, balls, &frame, params.crease_angle, scale);
    let mut pixels = draw(&primitives, width, height, samples);
    drop(primitives);
    occlusion::darken(&mut pixels, width, height);
    let background = background(params);
    let mut picture =
        Picture { width: params.width, height: params.height, rgba: compose(&pixels, background) };
    if let (Some(scale), Paint::Field(field)) = (bar, &surface.paint) {
        color_bar::draw(
            &mut picture,
            scale,
            &field.label,
            ink([background[0], background[1], background[2]]),
        );
    }
    picture
}

fn compose(pixels: &[Pixel], background: [u8; 4]) -> Vec<u8> {
    let byte = |v: f32| v.round().clamp(0.0, 255.0) as u8;
    let mut rgba = vec![0; 4 * pixels.len()];
    rgba.par_chunks_exact_mut(4).zip(pixels.par_iter()).for_each(|(out, pixel)| {
        let part = pixel.coverage;
        if background[3] == 0 {
            let color = if part > 0.0 { pixel.color.map(byte) } else { [255; 3] };
            out.copy_from_slice(&[color[0], color[1], color[2], byte(255.0 * part)]);
        } else {
            for c in 0..3 {
                out[c] = byte(pixel.color[c] * part + f32::from(background[c]) * (1.0 - part));
            }
            out[3] = 255;
        }
    });
    rgba
}

fn primitives(
    surface: &Surface,
    balls: &[Ball],
    frame: &Frame,
    crease_angle: f64,
    scale: Option<&ColorScale>,
) -> Vec<Primitive> {
    let float = |c: [u8; 3]| c.map(f32::from);
    let color = |v: usize| -> Color {
        match (&surface.paint, scale) {
            (Paint::Plain(color), _) => float(*color),
            (Paint::Colors(colors), _) => float(colors[v]),
            (Paint::Field(field), Some(scale)) => float(scale.map.color(scale.place(field.values[v]))),
            (Paint::Field(_), None) => float([128; 3]),
        }
    };
    let mut list: Vec<Primitive> = if surface.triangles.is_empty() {
        let (normals, spacing) = discs(surface.points);
        let typical = typical(&spacing);
        (0..surface.points.len())
            .into_par_iter()
            .map(|v| {
                let place = frame.place(&surface.points[v]);
                // Never less than can be seen, and stray points not as large as their distance from the rest.
                let radius = (DISC * frame.scale * spacing[v].min(2.5 * typical)).max(1.2);
                Primitive::Disc { center: place, radius, normal: frame.turn(&normals[v]), color: color(v) }
            })
            .collect()
    } else {
        let places: Vec<_> = surface.points.par_iter().map(|p| frame.place(p)).collect();
        let normals = corner_normals(surface, crease_angle);
        surface
            .triangles
            .par_iter()
            .zip(normals)
            .map(|(t, normals)| Primitive::Triangle {
                corners: t.map(|v| places[v as usize]),
                normals: normals.map(|n| frame.turn(&n)),
                colors: t.map(|v| color(v as usize)),
            })
            .collect()
    };
    list.extend(balls.iter().map(|b| Primitive::Ball {
        center: frame.place(&b.center),
        radius: (frame.scale * b.radius).max(1.0),
        color: float(b.color),
    }));
    list
}

/// The median.
fn typical(spacing: &[f64]) -> f64 {
    let mut sorted = spacing.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
