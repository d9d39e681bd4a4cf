//! Several pictures on one sheet.

use crate::camera::Camera;
use crate::color_bar;
use crate::color_range::{ColorScale, ValueRange};
use crate::error::RenderError;
use crate::layout::{Layout, MARGIN, bar, caption_height, letter_size};
use crate::params::{ColorBar, RenderParams, check_size};
use crate::picture::Picture;
use crate::render::{Subject, keep_room};
use crate::surface::{Ball, FieldPaint, Paint, Surface, check_balls};
use crate::text;
use adwave::Progress;

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// What is drawn.
    pub surface: Surface<'a>,
    /// Places that are marked.
    pub balls: Vec<Ball>,
    /// What is written below; nothing where it is empty.
    pub caption: String,
}

/// Whether the panels of a sheet are seen alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SharedCamera {
    /// One camera frames them all: sizes and places compare.
    #[default]
    Same,
    /// Each is framed by itself, from the same direction.
    Own,
}

/// A sheet of panels in rows of `columns`, each of the size in `params`; the sheet is wider where one bar serves them all.
///
/// Fields with the same name and an automatic range share one range of colors; where all panels show the same one, its bar stands once at the
/// right. Captions stand below the panels and make the sheet higher.
///
/// # Errors
///
/// As [`crate::render`]; no panels or columns; a sheet of more than [`crate::MAX_PIXELS`].
pub fn grid(
    panels: &[Panel],
    columns: usize,
    shared: SharedCamera,
    params: &RenderParams,
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    params.check()?;
    if panels.is_empty() || columns == 0 {
        return Err(RenderError::NoPanels);
    }
    for panel in panels {
        panel.surface.check()?;
        check_balls(&panel.balls)?;
    }
    let columns = columns.min(panels.len());
    let rows = panels.len().div_ceil(columns);
    let captioned = panels.iter().any(|p| !p.caption.is_empty());
    let size = letter_size(f64::from(params.width), f64::from(params.height));
    let strip = if captioned { caption_height(size).ceil() as u32 } else { 0 };
    let params = &params.clone().with_size(params.width, params.height.saturating_add(strip));
    let (width, height) = (f64::from(params.width), f64::from(params.height));
    let scales: Vec<Option<ColorScale>> = panels.iter().map(|p| scale_of(p, panels)).collect();
    let labels: Vec<&str> = panels.iter().filter_map(field).map(|f| f.label.as_str()).collect();
    let shown = params.color_bar == ColorBar::Shown;
    let drawn: Vec<&ColorScale> = scales.iter().flatten().collect();
    let one_bar = shown
        && panels.len() > 1
        && labels.len() == panels.len()
        && labels.iter().all(|l| *l == labels[0])
        && drawn.iter().all(|s| s.stands_for_the_same(drawn[0]));
    let sheet_height = height * rows as f64;
    let common = scales.iter().flatten().next().filter(|_| one_bar).and_then(|scale| {
        // As if it stood in a picture of its own, then as wide as it needs to be.
        bar(scale, labels[0], size, 2.0 * width, sheet_height.min(1.6 * height)).map(|bar| (scale, bar))
    });
    let bar_width = common.as_ref().map_or(0.0, |(_, b)| (2.0 * width - b.left_edge).ceil());
    let sum = |panels: usize, pixels: u32, more: u32| {
        u32::try_from(panels)
            .ok()
            .and_then(|n| n.checked_mul(pixels))
            .and_then(|n| n.checked_add(more))
            .unwrap_or(u32::MAX)
    };
    let (sheet_width, sheet_rows) =
        (sum(columns, params.width, bar_width as u32), sum(rows, params.height, 0));
    check_size(sheet_width, sheet_rows)?;
    let mut sheet = Picture::filled(sheet_width, sheet_rows, params.background.pixel())?;
    let own = if common.is_some() { params.clone().with_color_bar(ColorBar::Hidden) } else { params.clone() };
    let subjects: Vec<Subject> =
        panels.iter().map(|p| Subject::new(&p.surface, &p.balls, progress)).collect::<Result<_, _>>()?;
    let layouts: Vec<Layout> = panels
        .iter()
        .zip(&scales)
        .map(|(panel, scale)| {
            let field = scale.as_ref().zip(field(panel).map(|f| f.label.as_str()));
            Layout::new(&own, field, captioned.then_some(panel.caption.as_str()))
        })
        .collect();
    let all: Vec<_> = match shared {
        SharedCamera::Same => subjects.iter().flat_map(|s| s.framed.iter().copied()).collect(),
        SharedCamera::Own => Vec::new(),
    };
    // The narrowest stage, so that a panel with a bar shows things as large as one without.
    let narrowest = layouts.iter().map(|l| l.stage).min_by(|a, b| a.width.total_cmp(&b.width));
    for (k, (subject, layout)) in subjects.iter().zip(&layouts).enumerate() {
        let camera = match (shared, narrowest) {
            (SharedCamera::Same, Some(stage)) => Camera::fit(&all, params, stage, progress)?,
            _ => Camera::fit(&subject.framed, params, layout.stage, progress)?,
        };
        let mut picture = subject.picture(&camera, scales[k].as_ref(), params, progress)?;
        // Close-ups fill their panels, which would run into each other.
        let gap = (MARGIN * width.min(height) / 2.0).ceil() as u32;
        let [right, bottom] = layout.room;
        keep_room(&mut picture, [gap, gap], [right.min(params.width.saturating_sub(gap)), bottom], params);
        if let (Some(scale), Some(bar)) = (&scales[k], &layout.bar) {
            color_bar::draw(&mut picture, bar, scale);
        }
        if let Some((line, size, left, middle)) = &layout.caption {
            text::draw(&mut picture, line, *size, *left, *middle, color_bar::INK);
        }
        sheet.place(&picture, (k % columns) as u32 * params.width, (k / columns) as u32 * params.height);
    }
    if let Some((scale, mut bar)) = common {
        bar.left = width * columns as f64;
        bar.top = (sheet_height - bar.tall) / 2.0;
        color_bar::draw(&mut sheet, &bar, scale);
    }
    Ok(sheet)
}

fn field<'a>(panel: &'a Panel) -> Option<&'a FieldPaint<'a>> {
    match &panel.surface.paint {
        Paint::Field(field) => Some(field),
        _ => None,
    }
}

/// The colors of a panel's field: those of its own range, or those that all fields of its name without one share.
fn scale_of(panel: &Panel, panels: &[Panel]) -> Option<ColorScale> {
    let own = field(panel)?;
    if own.range != ValueRange::Auto {
        return Some(ColorScale::of(&[own]));
    }
    let alike = |f: &&FieldPaint| f.label == own.label && f.range == ValueRange::Auto;
    Some(ColorScale::of(&panels.iter().filter_map(field).filter(alike).collect::<Vec<_>>()))
}
