//! Text in pictures.

use crate::picture::Picture;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont};
use std::sync::LazyLock;

/// A light typeface with Greek letters, under the Ubuntu Font Licence.
static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).expect("the font of the library is one")
});

/// The width of a line in pixels.
pub(crate) fn width(text: &str, size: f32) -> f32 {
    let font = FONT.as_scaled(PxScale::from(size));
    text.chars().map(|c| font.h_advance(font.glyph_id(c))).sum()
}

/// Writes a line; (x, y) is its left end at half the height of its letters.
pub(crate) fn write(picture: &mut Picture, text: &str, x: f32, y: f32, size: f32, color: [u8; 3]) {
    let font = FONT.as_scaled(PxScale::from(size));
    let base = y + 0.35 * font.ascent();
    let mut pen = x;
    for c in text.chars() {
        let id = font.glyph_id(c);
        let glyph = id.with_scale_and_position(PxScale::from(size), ab_glyph::point(pen, base));
        if let Some(outline) = font.outline_glyph(glyph) {
            let bounds = outline.px_bounds();
            outline.draw(|gx, gy, part| {
                let (px, py) = (bounds.min.x as i64 + i64::from(gx), bounds.min.y as i64 + i64::from(gy));
                // Light letters of few pixels are pale; this gives them weight.
                picture.blend(px, py, color, (1.35 * part).min(1.0));
            });
        }
        pen += font.h_advance(id);
    }
}

/// The longest beginning that fits, with an ellipsis where something is left out.
pub(crate) fn fitted(text: &str, size: f32, room: f32) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while kept.pop().is_some() {
        let short: String = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if width(&short, size) <= room {
            return short;
        }
    }
    String::new()
}
