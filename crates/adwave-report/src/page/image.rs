//! Encoded pictures of a page.

use adwave::{ClassifiedError, ErrorKind};
use adwave_render::Picture;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageReader};
use std::io::Cursor;
use thiserror::Error;

/// Background color of the page in light mode, as in its style sheet.
pub const LIGHT_BACKGROUND: [u8; 3] = [255; 3];
/// Background color of the page in dark mode, as in its style sheet.
pub const DARK_BACKGROUND: [u8; 3] = [20; 3];

/// JPEG quality at which shading has no visible blocks.
const QUALITY: u8 = 86;

/// Failure to encode a picture for a page.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("a picture of {width}x{height} pixels cannot be encoded: {reason}")]
pub struct ImageError {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Reason of the failure.
    pub reason: String,
}

impl ClassifiedError for ImageError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Machine
    }
}

/// Encoding of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageKind {
    /// PNG, lossless.
    Png,
    /// JPEG, lossy but small; for shaded surfaces.
    Jpeg,
    /// SVG of a chart on white, which dark mode inverts.
    Svg,
}

/// Location of a picture's bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// Embedded in the page.
    Embedded {
        /// Bytes for light mode.
        light: Vec<u8>,
        /// Bytes for dark mode; empty if they equal those for light mode.
        dark: Vec<u8>,
    },
    /// Path of a file, relative to the page, with `/` between folders.
    File(String),
}

/// Encoded picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Encoding of the picture.
    pub kind: ImageKind,
    /// Width in pixels; 0 if unknown.
    pub width: u32,
    /// Height in pixels; 0 if unknown.
    pub height: u32,
    /// Location of the bytes.
    pub source: Source,
}

impl Image {
    /// Embeds a chart.
    pub fn svg(text: String, width: u32, height: u32) -> Self {
        let source = Source::Embedded { light: text.into_bytes(), dark: Vec::new() };
        Self { kind: ImageKind::Svg, width, height, source }
    }

    /// Links a picture in a file with the content `bytes`; `path` is relative to the page.
    pub fn from_file(path: String, kind: ImageKind, bytes: &[u8]) -> Self {
        let (width, height) = match kind {
            ImageKind::Svg => svg_size(bytes).unwrap_or_default(),
            ImageKind::Png | ImageKind::Jpeg => ImageReader::new(Cursor::new(bytes))
                .with_guessed_format()
                .ok()
                .and_then(|reader| reader.into_dimensions().ok())
                .unwrap_or_default(),
        };
        Self { kind, width, height, source: Source::File(path) }
    }

    /// Embeds a picture with a transparent background, composited on the background of each mode.
    ///
    /// JPEG has no transparency, and a PNG of a shaded surface takes five times as many bytes. Two JPEGs are therefore
    /// the smallest encoding that looks right in both modes.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn shaded(picture: &Picture) -> Result<Self, ImageError> {
        let source = Source::Embedded {
            light: jpeg(picture, LIGHT_BACKGROUND)?,
            dark: jpeg(picture, DARK_BACKGROUND)?,
        };
        Ok(Self { kind: ImageKind::Jpeg, width: picture.width, height: picture.height, source })
    }

    /// Returns the data URI of bytes with this encoding.
    pub(super) fn uri(&self, bytes: &[u8]) -> String {
        let mime = match self.kind {
            ImageKind::Png => "image/png",
            ImageKind::Jpeg => "image/jpeg",
            ImageKind::Svg => "image/svg+xml",
        };
        data_uri(mime, bytes)
    }
}

/// Width and height in the first tag of an SVG file.
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

/// Returns the data URI of bytes: `data:MIME;base64,…`.
pub(super) fn data_uri(mime: &str, bytes: &[u8]) -> String {
    format!("data:{mime};base64,{}", STANDARD.encode(bytes))
}

fn jpeg(picture: &Picture, background: [u8; 3]) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let rgb = picture.rgb(background);
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
    fn a_shaded_picture_is_composited_on_the_background_of_each_mode() {
        let picture = Picture::blank(8, 8, [200, 0, 0, 0]).unwrap();
        let Source::Embedded { light, dark } = Image::shaded(&picture).unwrap().source else {
            panic!("it is inside");
        };
        for (bytes, background) in [(light, LIGHT_BACKGROUND), (dark, DARK_BACKGROUND)] {
            let pixel = image::load_from_memory(&bytes).unwrap().into_rgb8().get_pixel(4, 4).0;
            // JPEG of one color is off by rounding.
            assert!(
                pixel.iter().zip(background).all(|(a, b)| a.abs_diff(b) <= 2),
                "{pixel:?} {background:?}"
            );
        }
    }

    #[test]
    fn pictures_in_files_report_their_size() {
        let png = Picture::blank(7, 5, [1, 2, 3, 255]).unwrap().png().unwrap();
        let size = |kind, bytes: &[u8]| {
            let image = Image::from_file("a".to_owned(), kind, bytes);
            (image.width, image.height)
        };
        assert_eq!(size(ImageKind::Png, &png), (7, 5));
        assert_eq!(size(ImageKind::Svg, br#"<?xml?><svg width="620" height="420" xmlns="x">"#), (620, 420));
        assert_eq!(size(ImageKind::Svg, b"<svg"), (0, 0));
        assert_eq!(size(ImageKind::Png, b"not a picture"), (0, 0));
    }
}
