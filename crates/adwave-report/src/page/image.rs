//! Pictures inside a page.

use adwave_render::Picture;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
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

/// An encoded picture, with another for dark mode where there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Its encoding.
    pub kind: ImageKind,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The file for light mode.
    pub light: Vec<u8>,
    /// The file for dark mode; empty where it is the same.
    pub dark: Vec<u8>,
}

impl Image {
    /// A chart.
    pub fn svg(text: String, width: u32, height: u32) -> Self {
        Self { kind: ImageKind::Svg, width, height, light: text.into_bytes(), dark: Vec::new() }
    }

    /// A file that exists, the same in light and dark mode.
    pub fn file(kind: ImageKind, width: u32, height: u32, bytes: Vec<u8>) -> Self {
        Self { kind, width, height, light: bytes, dark: Vec::new() }
    }

    /// A picture with a transparent ground, laid on the page's ground of each mode.
    ///
    /// JPEG has no transparency, and PNG of shaded surfaces takes five times its bytes: two JPEGs are the smallest that
    /// look right in both modes.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn shaded(picture: &Picture) -> Result<Self, ImageError> {
        Ok(Self {
            kind: ImageKind::Jpeg,
            width: picture.width,
            height: picture.height,
            light: jpeg(picture, LIGHT_GROUND)?,
            dark: jpeg(picture, DARK_GROUND)?,
        })
    }

    /// The light picture as a data URI.
    pub(super) fn light_uri(&self) -> String {
        self.uri(&self.light)
    }

    /// The dark picture as a data URI, where there is one.
    pub(super) fn dark_uri(&self) -> Option<String> {
        (!self.dark.is_empty()).then(|| self.uri(&self.dark))
    }

    fn uri(&self, bytes: &[u8]) -> String {
        let mime = match self.kind {
            ImageKind::Png => "image/png",
            ImageKind::Jpeg => "image/jpeg",
            ImageKind::Svg => "image/svg+xml",
        };
        data_uri(mime, bytes)
    }
}

/// `data:MIME;base64,…`.
pub(super) fn data_uri(mime: &str, bytes: &[u8]) -> String {
    format!("data:{mime};base64,{}", STANDARD.encode(bytes))
}

fn jpeg(picture: &Picture, ground: [u8; 3]) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let over = |p: &[u8]| {
        let part = u32::from(p[3]);
        let mix = |c: usize| (u32::from(p[c]) * part + u32::from(ground[c]) * (255 - part) + 127) / 255;
        [mix(0) as u8, mix(1) as u8, mix(2) as u8]
    };
    let rgb: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(over).collect();
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY)
        .write_image(&rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| ImageError { width, height, reason: e.to_string() })?;
    Ok(bytes)
}
