//! Drawing surface of all charts: SVG or pixels.

use super::{MAX_SIDE, MIN_SIDE, PlotError};
use crate::picture::Picture;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::sync::Once;

/// Drawing area of either backend.
pub(super) type Area<B> = DrawingArea<B, Shift>;

/// Chart that can be drawn on an area.
pub(super) trait Drawable {
    /// Checks that the chart can be drawn.
    fn check(&self) -> Result<(), PlotError>;
    /// Draws the chart.
    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Result<(), PlotError>;
}

pub(super) fn svg(drawn: &impl Drawable, width: u32, height: u32) -> Result<String, PlotError> {
    prepare(drawn, width, height)?;
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
    drawn.draw(&area)?;
    area.present().map_err(|e| PlotError::drawing(&e))?;
    drop(area);
    Ok(text)
}

pub(super) fn picture(drawn: &impl Drawable, width: u32, height: u32) -> Result<Picture, PlotError> {
    prepare(drawn, width, height)?;
    let mut rgb = vec![255; 3 * width as usize * height as usize];
    let area = BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area();
    drawn.draw(&area)?;
    area.present().map_err(|e| PlotError::drawing(&e))?;
    drop(area);
    let rgba = rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    Ok(Picture { width, height, rgba })
}

/// Guard that registers the font exactly once.
static FONT: Once = Once::new();

fn prepare(drawn: &impl Drawable, width: u32, height: u32) -> Result<(), PlotError> {
    if ![width, height].iter().all(|s| (MIN_SIDE..=MAX_SIDE).contains(s)) {
        return Err(PlotError::Size { width, height });
    }
    drawn.check()?;
    // Pixels need an embedded font; SVG refers to a font of its viewer.
    FONT.call_once(|| {
        let registered = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
        assert!(registered.is_ok(), "the embedded font is valid");
    });
    Ok(())
}

/// Font size on an area, in pixels.
pub(super) fn letters<B: DrawingBackend>(area: &Area<B>) -> u32 {
    (area.dim_in_pixel().1 / 24).clamp(11, 40)
}

/// Width of a line of text, in pixels.
pub(super) fn width_of<B: DrawingBackend>(area: &Area<B>, text: &str, size: u32) -> Result<u32, PlotError> {
    let style = ("sans-serif", size).into_text_style(area);
    area.estimate_text_size(text, &style).map(|(w, _)| w).map_err(|e| PlotError::drawing(&e))
}
