//! Pictures inside a page.

use adwave::{ClassifiedError, ErrorKind};
use adwave_render::Picture;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageReader};
use std::io::Cursor;
use thiserror::Error;

/// What stands behind the page in light mode, as in its style sheet.
pub const LIGHT_GROUND: [u8; 3] = [255; 3];
/// What stands behind the page in dark mode, as in its style sheet.
pub const DARK_GROUND: [u8; 3] = [20; 3];

/// Quality of JPEG: shading without visible blocks.
const QUALITY: u8 = 86;

/// A picture that cannot be put into a page.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("a picture of {width}x{height} pixels cannot be encoded: {reason}")]
pub struct ImageError {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Why.
    pub reason: String,
}

impl ClassifiedError for ImageError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Machine
    }
}

/// How a picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageKind {
    /// Pixels without loss.
    Png,
    /// Shaded pixels in few bytes.
    Jpeg,
    /// Lines: a chart on white, which dark mode inverts.
    Svg,
}

/// Where a picture's bytes are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// In the page.
    Inside {
        /// The file for light mode.
        light: Vec<u8>,
        /// The file for dark mode; empty where it is the same.
        dark: Vec<u8>,
    },
    /// In a file beside the page, the path relative to it, with `/` between folders.
    Beside(String),
}

/// An encoded picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Its encoding.
    pub kind: ImageKind,
    /// Pixels; 0 where that is not known.
    pub width: u32,
    /// Pixels; 0 where that is not known.
    pub height: u32,
    /// Its bytes.
    pub source: Source,
}

impl Image {
    /// A chart.
    pub fn svg(text: String, width: u32, height: u32) -> Self {
        let source = Source::Inside { light: text.into_bytes(), dark: Vec::new() };
        Self { kind: ImageKind::Svg, width, height, source }
    }

    /// The picture of a file beside the page, of which `bytes` is the content.
    pub fn beside(path: String, kind: ImageKind, bytes: &[u8]) -> Self {
        let (width, height) = match kind {
            ImageKind::Svg => svg_size(bytes).unwrap_or_default(),
            ImageKind::Png | ImageKind::Jpeg => ImageReader::new(Cursor::new(bytes))
                .with_guessed_format()
                .ok()
                .and_then(|reader| reader.into_dimensions().ok())
                .unwrap_or_default(),
        };
        Self { kind, width, height, source: Source::Beside(path) }
    }

    /// A picture with a transparent ground, laid on the page's ground of each mode.
    ///
    /// JPEG has no transparency, and PNG of shaded surfaces takes five times its bytes: two JPEGs are the smallest that
    /// look right in both modes.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn shaded(picture: &Picture) -> Result<Self, ImageError> {
        let source =
            Source::Inside { light: jpeg(picture, LIGHT_GROUND)?, dark: jpeg(picture, DARK_GROUND)? };
        Ok(Self { kind: ImageKind::Jpeg, width: picture.width, height: picture.height, source })
    }

    /// Its bytes as a data URI.
    pub(super) fn uri(&self, bytes: &[u8]) -> String {
        let mime = match self.kind {
            ImageKind::Png => "image/png",
            ImageKind::Jpeg => "image/jpeg",
            ImageKind::Svg => "image/svg+xml",
        };
        data_uri(mime, bytes)
    }
}

/// The width and height that the first tag of an SVG file names.
fn svg_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let text = std::str::from_utf8(bytes).ok()?;
    let tag = &text[text.find("<svg")?..];
    let tag = &tag[..tag.find('>')?];
    let side = |name: &str| {
        let from = tag.find(&format!(" {name}=\""))? + name.len() + 3;
        tag[from..].split('"').next()?.parse().ok()
    };
    Some((side("width")?, side("height")?))
}

/// `data:MIME;base64,…`.
pub(super) fn data_uri(mime: &str, bytes: &[u8]) -> String {
    format!("data:{mime};base64,{}", STANDARD.encode(bytes))
}

fn jpeg(picture: &Picture, ground: [u8; 3]) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let rgb = picture.rgb(ground);
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY)
        .write_image(&rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| ImageError { width, height, reason: e.to_string() })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shaded_picture_lies_on_the_ground_of_each_mode() {
        let picture = Picture::blank(8, 8, [200, 0, 0, 0]).unwrap();
        let Source::Inside { light, dark } = Image::shaded(&picture).unwrap().source else {
            panic!("it is inside");
        };
        for (bytes, ground) in [(light, LIGHT_GROUND), (dark, DARK_GROUND)] {
            let pixel = image::load_from_memory(&bytes).unwrap().into_rgb8().get_pixel(4, 4).0;
            // JPEG of one color is off by rounding.
            assert!(pixel.iter().zip(ground).all(|(a, b)| a.abs_diff(b) <= 2), "{pixel:?} {ground:?}");
        }
    }

    #[test]
    fn files_beside_the_page_tell_their_size() {
        let png = Picture::blank(7, 5, [1, 2, 3, 255]).unwrap().png().unwrap();
        let size = |kind, bytes: &[u8]| {
            let image = Image::beside("a".to_owned(), kind, bytes);
            (image.width, image.height)
        };
        assert_eq!(size(ImageKind::Png, &png), (7, 5));
        assert_eq!(size(ImageKind::Svg, br#"<?xml?><svg width="620" height="420" xmlns="x">"#), (620, 420));
        assert_eq!(size(ImageKind::Svg, b"<svg"), (0, 0));
        assert_eq!(size(ImageKind::Png, b"not a picture"), (0, 0));
    }
}
