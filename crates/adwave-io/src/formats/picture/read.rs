//! Reader of PNG and JPEG.

use std::io::Cursor;
use std::sync::Arc;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageError};

use super::png::PngDocument;
use crate::model::context::ReadContext;
use crate::model::field::ByteOrder;
use crate::model::grid_layout::GridLayout;
use crate::model::grid_values::GridNumbers;
use crate::text::one_line;
use crate::{Format, ReadError, ShapeFile, ValueType};

/// Bytes of pixels that a byte of a file can have at most: 1032 by the compression of PNG, 1024 by that of JPEG.
const MOST_COMPRESSION: u64 = 1100;
/// Byte of a PNG that says how colors are stored.
const COLOR_TYPE: usize = 25;
/// Colors by a palette.
const BY_PALETTE: u8 = 3;
/// Byte order of 16-bit numbers in memory.
pub(super) const NATIVE: ByteOrder =
    if cfg!(target_endian = "big") { ByteOrder::Big } else { ByteOrder::Little };

/// Pixels of an image: rows from the top, all channels of a pixel adjacent.
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) n_channels: usize,
    pub(super) kind: ValueType,
    pub(super) bytes: Vec<u8>,
}

impl Pixels {
    pub(super) fn numbers(&self) -> GridNumbers {
        GridNumbers::new(self.kind, NATIVE, self.width as usize * self.height as usize, self.n_channels)
    }
}

fn broken(error: &ImageError) -> ReadError {
    ReadError::Whole(format!("the picture is damaged ({}); get the whole file", one_line(error)))
}

/// Decodes the pixels, after the size that the header claims was found possible for the bytes of the file.
pub(super) fn decode(
    decoder: impl ImageDecoder,
    n_bytes: usize,
    c: &ReadContext<'_>,
) -> Result<Pixels, ReadError> {
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    if width == 0 || height == 0 {
        return Err(ReadError::Whole("the picture has no pixels; get an intact file".into()));
    }
    c.limits.check_points(u64::from(width) * u64::from(height))?;
    c.limits.check_bytes(decoder.total_bytes())?;
    if decoder.total_bytes() > MOST_COMPRESSION * n_bytes as u64 + (1 << 16) {
        let message =
            format!("the picture claims {width} × {height} pixels in {n_bytes} bytes; get the whole file");
        return Err(ReadError::Whole(message));
    }
    c.progress.check()?;
    let mut bytes = vec![0; decoder.total_bytes() as usize];
    decoder.read_image(&mut bytes).map_err(|e| broken(&e))?;
    let kind = match color {
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => ValueType::U16,
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => ValueType::U8,
        _ => {
            return Err(ReadError::Whole(format!(
                "colors of the kind {color:?} are not supported; save as PNG"
            )));
        }
    };
    Ok(Pixels { width, height, n_channels: color.channel_count().into(), kind, bytes })
}

/// Decoder of a PNG.
pub(super) fn png_decoder(bytes: &[u8]) -> Result<PngDecoder<Cursor<&[u8]>>, ReadError> {
    // The pixels are bounded by the bytes of the file above; this bounds tables and texts beside them.
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(MOST_COMPRESSION * bytes.len() as u64 + (1 << 20));
    PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(|e| broken(&e))
}

pub(super) fn read_png(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let mut decoder = png_decoder(&bytes)?;
    let mut notes = Vec::new();
    if decoder.is_apng().is_ok_and(|is_apng| is_apng) {
        notes.push("the picture is an animation, of which the first frame is read".into());
    }
    match decoder.original_color_type() {
        _ if bytes.get(COLOR_TYPE) == Some(&BY_PALETTE) => {
            notes.push("the colors of the palette are channels".into());
        }
        ExtendedColorType::L1 | ExtendedColorType::L2 | ExtendedColorType::L4 => {
            notes.push("gray levels of fewer than 8 bits are spread over 0 to 255".into());
        }
        _ => {}
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    if orientation != Orientation::NoTransforms {
        notes.push(
            "rows and columns are those of the file, without the rotation that its EXIF orientation asks for"
                .into(),
        );
    }
    let pixels = decode(decoder, bytes.len(), c)?;
    let mut shape = shape(&pixels, notes, c)?;
    shape.format = Some(Format::PNG);
    shape.original = Some(Arc::new(PngDocument { bytes }));
    Ok(shape)
}

pub(super) fn read_jpeg(bytes: &[u8], c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let mut decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(|e| broken(&e))?;
    let mut notes = Vec::new();
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut pixels = decode(decoder, bytes.len(), c)?;
    if orientation != Orientation::NoTransforms {
        notes.push("the picture is turned as its EXIF orientation says".into());
        pixels = turn(pixels, orientation);
    }
    let mut shape = shape(&pixels, notes, c)?;
    shape.format = Some(Format::JPEG);
    Ok(shape)
}

/// Pixels of 8 bits, turned.
fn turn(pixels: Pixels, orientation: Orientation) -> Pixels {
    let Pixels { width, height, n_channels, kind, bytes } = pixels;
    let image = match (n_channels, kind) {
        (1, ValueType::U8) => {
            image::GrayImage::from_raw(width, height, bytes.clone()).map(DynamicImage::from)
        }
        (3, ValueType::U8) => image::RgbImage::from_raw(width, height, bytes.clone()).map(DynamicImage::from),
        _ => None,
    };
    let Some(mut image) = image else { return Pixels { width, height, n_channels, kind, bytes } };
    image.apply_orientation(orientation);
    Pixels { width: image.width(), height: image.height(), n_channels, kind, bytes: image.into_bytes() }
}

fn shape(pixels: &Pixels, mut notes: Vec<String>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let sizes = [pixels.height as usize, pixels.width as usize];
    let values = pixels.numbers().read(&pixels.bytes, c.progress)?;
    if pixels.n_channels.is_multiple_of(2) {
        notes.push(format!("channel {} is opacity", pixels.n_channels - 1));
    }
    let mut shape = ShapeFile::from_grid(GridLayout::new(&sizes, &[1.0, 1.0]))
        .map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(values.field);
    shape.notes = notes;
    Ok(shape)
}
