//! Sheets of several pictures.

use crate::camera::Camera;
use crate::color_bar;
use crate::color_range::{ColorScale, ValueRange};
use crate::error::RenderError;
use crate::framed::FramedSurface;
use crate::layout::{Layout, MARGIN, bar, caption_height, letter_size};
use crate::params::{ColorBar, RenderParams, check_size};
use crate::picture::Picture;
use crate::render::{PreparedSurface, keep_room};
use crate::surface::{Ball, FieldPaint, Paint, Surface, check_balls};
use crate::text;
use adwave::Progress;

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// Surface to draw.
    pub surface: Surface<'a>,
    /// Balls that mark positions on the surface.
    pub balls: Vec<Ball>,
    /// Text below the picture. If any panel of the sheet has a caption, every panel reserves a line for it.
    pub caption: String,
}

/// Choice of the camera for the panels of a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SharedCamera {
    /// One camera frames all panels, so that sizes and positions can be compared.
    #[default]
    Same,
    /// Each panel has its own framing, from the same direction.
    Own,
}

/// Draws a sheet of panels in rows of `columns`, each panel of the size in `params`. The sheet is wider if all panels
/// share one color bar.
///
/// Fields with equal names and an automatic range share one color range. If all panels share it, a single color bar is
/// drawn at the right. Captions are drawn below the panels and make the sheet higher.
///
/// # Errors
///
/// The errors of [`crate::render`], a sheet without panels or columns, and a sheet of more than [`crate::MAX_PIXELS`].
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
        progress.check()?;
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
    let one_bar = params.color_bar == ColorBar::Shown && all_share_a_range(&labels, &scales, panels.len());
    let sheet_height = height * rows as f64;
    let common = scales.iter().flatten().next().filter(|_| one_bar).and_then(|scale| {
        // Laid out as in a picture of its own, then cut to the width it needs.
        bar(scale, labels[0], size, 2.0 * width, sheet_height.min(1.6 * height)).map(|bar| (scale, bar))
    });
    let bar_width = common.as_ref().map_or(0.0, |(_, b)| (2.0 * width - b.left_edge).ceil());
    let sheet_width = sheet_side(columns, params.width, bar_width as u32);
    let sheet_rows = sheet_side(rows, params.height, 0);
    check_size(sheet_width, sheet_rows)?;
    let mut sheet = Picture::blank(sheet_width, sheet_rows, params.background.pixel())?;
    let own = if common.is_some() { params.clone().with_color_bar(ColorBar::Hidden) } else { params.clone() };
    let mut framed = Vec::with_capacity(panels.len());
    for panel in panels {
        progress.check()?;
        framed.push(FramedSurface::new(&panel.surface, params.frame));
    }
    let surfaces: Vec<Surface> = framed.iter().map(FramedSurface::surface).collect();
    let subjects: Vec<PreparedSurface> = panels
        .iter()
        .zip(&surfaces)
        .map(|(p, surface)| PreparedSurface::new(surface, &p.balls, progress))
        .collect::<Result<_, _>>()?;
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
    // The narrowest shape area, so that a panel with a color bar shows shapes as large as one without.
    let narrowest = layouts.iter().map(|l| l.stage).min_by(|a, b| a.width.total_cmp(&b.width));
    for (k, (subject, layout)) in subjects.iter().zip(&layouts).enumerate() {
        let camera = match (shared, narrowest) {
            (SharedCamera::Same, Some(stage)) => Camera::fit(&all, params, stage, progress)?,
            _ => Camera::fit(&subject.framed, params, layout.stage, progress)?,
        };
        let mut picture = subject.picture(&camera, scales[k].as_ref(), params, progress)?;
        // Zoomed shapes fill their panels and would overlap.
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

/// Number of pixels along a side of the sheet: `n_panels` times `pixels`, plus `more`; the largest number on overflow.
fn sheet_side(n_panels: usize, pixels: u32, more: u32) -> u32 {
    let panels = u32::try_from(n_panels).ok().and_then(|n| n.checked_mul(pixels));
    panels.and_then(|n| n.checked_add(more)).unwrap_or(u32::MAX)
}

/// True if there are several panels and all show fields of one name and one range.
fn all_share_a_range(labels: &[&str], scales: &[Option<ColorScale>], n_panels: usize) -> bool {
    let scales: Vec<&ColorScale> = scales.iter().flatten().collect();
    n_panels > 1
        && labels.len() == n_panels
        && labels.iter().all(|l| *l == labels[0])
        && scales.iter().all(|s| s.has_same_range_as(scales[0]))
}

fn field<'a>(panel: &'a Panel) -> Option<&'a FieldPaint<'a>> {
    match &panel.surface.paint {
        Paint::Field(field) => Some(field),
        _ => None,
    }
}

/// Color scale of a panel's field: its own fixed range, or the range shared by all fields of that name with an
/// automatic range.
fn scale_of(panel: &Panel, panels: &[Panel]) -> Option<ColorScale> {
    let own = field(panel)?;
    if own.range != ValueRange::Auto {
        return Some(ColorScale::from_fields(&[own]));
    }
    let alike = |f: &&FieldPaint| f.label == own.label && f.range == ValueRange::Auto;
    Some(ColorScale::from_fields(&panels.iter().filter_map(field).filter(alike).collect::<Vec<_>>()))
}
