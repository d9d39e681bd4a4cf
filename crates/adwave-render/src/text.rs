//! Drawing of text in pictures.

use crate::picture::Picture;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use std::sync::LazyLock;

/// Plain sans-serif font with Greek letters, and a fallback with nearly all other characters.
static FONTS: LazyLock<[FontRef<'static>; 2]> = LazyLock::new(|| {
    [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR]
        .map(|bytes| FontRef::try_from_slice(bytes).expect("the built-in font is valid"))
});

/// Finds a font that contains the letter; the plain font if none does.
fn font_of(letter: char) -> &'static FontRef<'static> {
    FONTS.iter().find(|f| f.glyph_id(letter).0 != 0).unwrap_or(&FONTS[0])
}

/// Letters of a line with their start positions, and the width of the line, in pixels.
fn letter_positions(text: &str, size: f32) -> (Vec<(char, f32)>, f32) {
    let mut x = 0.0;
    let mut letters = Vec::new();
    let mut last: Option<(char, &FontRef)> = None;
    for letter in text.chars().map(|c| if c.is_control() { ' ' } else { c }) {
        let font = font_of(letter);
        let scaled = font.as_scaled(PxScale::from(size));
        if let Some((before, known)) = last
            && std::ptr::eq(known, font)
        {
            x += scaled.kern(font.glyph_id(before), font.glyph_id(letter));
        }
        letters.push((letter, x));
        x += scaled.h_advance(font.glyph_id(letter));
        last = Some((letter, font));
    }
    (letters, x)
}

/// Width of a line of text, in pixels.
pub(crate) fn width(text: &str, size: f32) -> f32 {
    letter_positions(text, size).1
}

/// Shortens a line of text at its end if it is wider than `most` pixels.
pub(crate) fn shorten(text: &str, size: f32, most: f32) -> String {
    // No line of a picture has more letters than the widest picture has pixels.
    let mut letters: Vec<char> = text.chars().take(crate::params::MAX_SIDE as usize).collect();
    if letters.len() == text.chars().count() && width(text, size) <= most {
        return text.to_owned();
    }
    let mut widths: f32 = letters.iter().map(|c| width(&c.to_string(), size)).sum();
    let dots = width("…", size);
    while let Some(last) = letters.pop() {
        widths -= width(&last.to_string(), size);
        if widths + dots <= most {
            return letters.into_iter().collect::<String>().trim_end().to_owned() + "…";
        }
    }
    String::new()
}

/// Draws a line of text from (`left`, `middle`) in pixels; its lowercase letters are vertically centered on `middle`.
pub(crate) fn draw(picture: &mut Picture, text: &str, size: f32, left: f32, middle: f32, color: [u8; 3]) {
    let baseline = (middle + 0.26 * size).round();
    for (letter, x) in letter_positions(text, size).0 {
        let font = font_of(letter);
        let glyph =
            font.glyph_id(letter).with_scale_and_position(PxScale::from(size), point(left + x, baseline));
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            // A light font on a light background is more legible when drawn slightly heavier.
            let coverage = coverage.powf(0.7);
            picture.blend(corner.x as i64 + i64::from(dx), corner.y as i64 + i64::from(dy), color, coverage);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greek_letters_and_signs_are_there() {
        for letter in "σφψΛλεθαΦΨ₀₁₂²³·×−±≥≤°µ…%0123456789".chars() {
            assert!(FONTS.iter().any(|f| f.glyph_id(letter).0 != 0), "{letter}");
        }
    }

    #[test]
    fn long_lines_are_cut_to_the_room() {
        let long = "mean curvature ".repeat(40);
        let cut = shorten(&long, 20.0, 200.0);
        assert!(cut.ends_with('…') && width(&cut, 20.0) <= 200.0 && width(&cut, 20.0) > 150.0, "{cut}");
        assert_eq!(shorten("σ", 20.0, 200.0), "σ");
        assert_eq!(shorten("wide", 20.0, 1.0), "");
    }
}
