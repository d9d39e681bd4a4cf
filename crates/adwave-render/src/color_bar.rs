//! Color bar, which shows the value of each color.

use crate::color_range::ColorScale;
use crate::picture::Picture;
use crate::text;
use crate::ticks::Ticks;

/// Color of text and lines.
pub(crate) const INK: [u8; 3] = [38, 42, 48];

/// Position of the bar in the picture, in pixels, and its labels.
#[derive(Debug)]
pub(crate) struct Bar {
    /// Left edge of the area of the bar and its labels.
    pub(crate) left_edge: f64,
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) thick: f64,
    pub(crate) tall: f64,
    pub(crate) gap: f64,
    /// Font size, in pixels.
    pub(crate) size: f32,
    pub(crate) label: String,
    pub(crate) ticks: Ticks,
}

/// Draws the bar with `high` at the top; an arrowhead at an end marks the existence of values beyond it.
pub(crate) fn draw(picture: &mut Picture, bar: &Bar, scale: &ColorScale) {
    let (left, top) = (bar.left.round() as i64, bar.top.round() as i64);
    let (thick, tall) = (bar.thick.round().max(1.0) as i64, bar.tall.round().max(2.0) as i64);
    for y in 0..tall {
        let color = scale.map.color(1.0 - y as f64 / (tall - 1) as f64);
        for x in 0..thick {
            picture.blend(left + x, top + y, color, 1.0);
        }
    }
    let tip = thick * 3 / 5;
    for k in 1..=tip {
        // Narrower with each row, with smoothed edges.
        let half = thick as f32 / 2.0 * (1.0 - k as f32 / (tip + 1) as f32);
        for x in 0..thick {
            let off = (x as f32 + 0.5 - thick as f32 / 2.0).abs();
            let coverage = (half - off + 0.5).clamp(0.0, 1.0);
            if scale.above {
                picture.blend(left + x, top - k, scale.map.color(1.0), coverage);
            }
            if scale.below {
                picture.blend(left + x, top + tall - 1 + k, scale.map.color(0.0), coverage);
            }
        }
    }
    for (value, text) in &bar.ticks.marks {
        let y = bar.top + (1.0 - scale.position(*value)) * (bar.tall - 1.0);
        for x in 0..(bar.gap * 0.5).round() as i64 {
            picture.blend(left + thick + x, y.round() as i64, INK, 0.8);
        }
        let from = (left + thick) as f32 + bar.gap as f32;
        text::draw(picture, text, bar.size, from, y as f32 + 0.5, INK);
    }
    let above = bar.top - 0.6 * bar.thick - 0.95 * f64::from(bar.size);
    text::draw(picture, &bar.label, bar.size, left as f32, above as f32, INK);
    if let Some(offset) = &bar.ticks.offset {
        let below = bar.top + bar.tall + 0.6 * bar.thick + 0.95 * f64::from(bar.size);
        text::draw(picture, offset, bar.size, left as f32, below as f32, INK);
    }
}
