//! Division of a picture into shape, color bar and caption.

use crate::camera::Rect;
use crate::color_bar::Bar;
use crate::color_range::ColorScale;
use crate::params::{ColorBar, RenderParams};
use crate::text;
use crate::ticks::Ticks;

/// Font size in a picture whose shorter side is [`USUAL_SIDE`], in pixels.
const LETTERS: f64 = 22.0;
const USUAL_SIDE: f64 = 900.0;

/// Exponent of the picture size in the font size. Text shrinks less than pictures, so that it stays legible in small
/// panels.
const SHRINKING: f64 = 0.6;
const SMALLEST_LETTERS: f64 = 11.0;

/// Margin between the shape and the border of the picture, as a fraction of the shorter side.
pub(crate) const MARGIN: f64 = 0.035;

/// Largest fraction of a picture's width that a color bar may take.
const MAX_FOR_BAR: f64 = 0.4;

/// Smallest side of a picture with text, in font sizes.
const MIN_LETTERS: f64 = 7.0;

/// Areas of one picture.
#[derive(Debug)]
pub(crate) struct Layout {
    /// Area of the shape, in pixels.
    pub(crate) stage: Rect,
    /// Width and height of the area left of the color bar and above the caption, in pixels.
    pub(crate) room: [u32; 2],
    /// Color bar, if there is room for it.
    pub(crate) bar: Option<Bar>,
    /// Caption: text, font size, left edge, and vertical middle of the line, in pixels.
    pub(crate) caption: Option<(String, f32, f32, f32)>,
}

/// Font size for pictures of a size, in pixels.
pub(crate) fn letter_size(width: f64, height: f64) -> f64 {
    (LETTERS * (width.min(height) / USUAL_SIDE).powf(SHRINKING)).max(SMALLEST_LETTERS)
}

/// Height of a caption in a font size, in pixels.
pub(crate) fn caption_height(size: f64) -> f64 {
    2.0 * size
}

impl Layout {
    pub(crate) fn new(
        params: &RenderParams,
        field: Option<(&ColorScale, &str)>,
        caption: Option<&str>,
    ) -> Self {
        let (width, height) = (f64::from(params.width), f64::from(params.height));
        let size = letter_size(width, height);
        let roomy = width.min(height) > MIN_LETTERS * size;
        let line = if caption.is_some() && roomy { caption_height(size) } else { 0.0 };
        let bar = field
            .filter(|_| roomy && params.color_bar == ColorBar::Shown)
            .and_then(|(scale, label)| bar(scale, label, size, width, height - line));
        let taken = bar.as_ref().map_or(0.0, |b| width - b.left_edge);
        let margin = MARGIN * width.min(height);
        let inside = |whole: f64| (whole - 2.0 * margin).max(0.5);
        let stage =
            Rect { left: margin, top: margin, width: inside(width - taken), height: inside(height - line) };
        let beside = |taken: f64| if taken > 0.0 { taken + margin } else { 0.0 };
        let room = [width - beside(taken), height - line].map(|side| side.max(0.0) as u32);
        let caption = caption.filter(|_| roomy).map(|text| {
            let text = text::shorten(text, size as f32, (width - size) as f32);
            let left = (width - f64::from(text::width(&text, size as f32))) / 2.0;
            (text, size as f32, left as f32, (height - 1.1 * size) as f32)
        });
        Self { stage, room, bar, caption }
    }
}

/// Color bar at the right border of `width` × `height` pixels; `None` if the bar would leave no room for the shape.
pub(crate) fn bar(scale: &ColorScale, label: &str, size: f64, width: f64, height: f64) -> Option<Bar> {
    let ticks = Ticks::new(scale.low, scale.high);
    let letters = size as f32;
    let numbers = ticks.marks.iter().map(|m| f64::from(text::width(&m.1, letters))).fold(0.0, f64::max);
    let (thick, gap) = (0.9 * size, 0.4 * size);
    let most = MAX_FOR_BAR * width;
    let label = text::shorten(label, letters, (most - size) as f32);
    let beside = thick + 2.0 * gap + numbers;
    let offset = ticks.offset.as_deref().map_or(0.0, |offset| f64::from(text::width(offset, letters)));
    let needed = beside.max(f64::from(text::width(&label, letters))).max(offset) + size;
    if needed > most {
        return None;
    }
    let tall = (0.62 * height).min(height - 6.0 * size);
    (tall > 3.0 * size).then(|| Bar {
        left_edge: width - needed,
        left: width - needed,
        top: (height - tall) / 2.0 + 0.9 * size,
        thick,
        tall,
        gap,
        size: letters,
        label,
        ticks,
    })
}
