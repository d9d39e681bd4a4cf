//! PNG writer.

use adwave::Progress;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::read::{NATIVE, decode, png_decoder};
use crate::model::context::{ReadContext, WriteContext};
use crate::model::grid_layout::GridLayout;
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::all;
use crate::{Field, ReadLimits, ShapeFile, ValueType, WriteError};

/// Signature of a PNG.
const SIGNATURE: usize = 8;
/// Chunks that describe pixels by a palette, or by the bits of a color type.
const COLOR_CHUNKS: &[&[u8; 4]] = &[b"PLTE", b"tRNS", b"sBIT", b"bKGD", b"hIST", b"sPLT"];
/// Chunks with pixels, or with those of an animation.
const PIXEL_CHUNKS: &[&[u8; 4]] = &[b"IDAT", b"IEND", b"acTL", b"fcTL", b"fdAT"];

/// A PNG that was read.
#[derive(Debug)]
pub(super) struct PngDocument {
    pub(super) bytes: Vec<u8>,
}

/// Chunk of a PNG with its length and its checksum.
struct PngChunk<'a> {
    name: &'a [u8],
    bytes: &'a [u8],
}

/// Chunks after the signature, as far as they are complete.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = PngChunk<'_>> {
    let mut at = SIGNATURE;
    std::iter::from_fn(move || {
        let head = bytes.get(at..)?.get(..8)?;
        let n = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let bytes = bytes.get(at..)?.get(..n.checked_add(12)?)?;
        at += bytes.len();
        Some(PngChunk { name: &bytes[4..8], bytes })
    })
}

impl SourceDocument for PngDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) && shape.value_type.is_none() {
            c.out.write_all(&self.bytes)?;
            return Ok(Update::Written);
        }
        let limits = ReadLimits { max_bytes: u64::MAX, ..ReadLimits::default() };
        let context = ReadContext { limits: &limits, progress: Progress::none(), name: None, folder: None };
        let pixels = png_decoder(&self.bytes).and_then(|decoder| decode(decoder, self.bytes.len(), &context));
        let Ok(pixels) = pixels else { return Ok(Update::DoesNotFit) };
        let kind = shape.value_type.unwrap_or(pixels.kind);
        if field.n_channels != pixels.n_channels || kind != pixels.kind {
            return Ok(Update::DoesNotFit);
        }
        let mut raw = Vec::new();
        pixels.numbers().write(Some(&pixels.bytes), field, c.format, &mut raw, c.progress)?;
        if raw == pixels.bytes {
            c.out.write_all(&self.bytes)?;
            return Ok(Update::Written);
        }
        let image = EncodedImage {
            raw,
            width: pixels.width,
            height: pixels.height,
            n_channels: pixels.n_channels,
            kind,
        };
        let new = image.encode()?;
        let head = chunks(&self.bytes).find(|chunk| chunk.name == b"IHDR").map(|chunk| chunk.bytes);
        let new_head = chunks(&new).find(|chunk| chunk.name == b"IHDR").map(|chunk| chunk.bytes);
        // Bit depth and color type.
        let has_same_colors =
            head.and_then(|head| head.get(16..18)) == new_head.and_then(|head| head.get(16..18));
        let is_kept = |chunk: &PngChunk<'_>| {
            let is_listed = |names: &[&[u8; 4]]| names.iter().any(|name| chunk.name == *name);
            !is_listed(PIXEL_CHUNKS) && chunk.name != b"IHDR" && (has_same_colors || !is_listed(COLOR_CHUNKS))
        };
        c.out.write_all(&new[..SIGNATURE])?;
        c.out.write_all(new_head.unwrap_or_default())?;
        let mut is_after = false;
        for chunk in chunks(&self.bytes) {
            if chunk.name == b"IDAT" && !is_after {
                is_after = true;
                for pixels in chunks(&new).filter(|chunk| chunk.name == b"IDAT") {
                    c.out.write_all(pixels.bytes)?;
                }
            } else if is_kept(&chunk) {
                c.out.write_all(chunk.bytes)?;
            }
        }
        for end in chunks(&new).filter(|chunk| chunk.name == b"IEND") {
            c.out.write_all(end.bytes)?;
        }
        Ok(Update::Written)
    }
}

/// Pixels that are compressed to a PNG.
struct EncodedImage {
    raw: Vec<u8>,
    width: u32,
    height: u32,
    n_channels: usize,
    kind: ValueType,
}

impl EncodedImage {
    fn encode(&self) -> Result<Vec<u8>, WriteError> {
        let is_deep = self.kind == ValueType::U16;
        let color = match (self.n_channels, is_deep) {
            (1, false) => ExtendedColorType::L8,
            (2, false) => ExtendedColorType::La8,
            (3, false) => ExtendedColorType::Rgb8,
            (_, false) => ExtendedColorType::Rgba8,
            (1, true) => ExtendedColorType::L16,
            (2, true) => ExtendedColorType::La16,
            (3, true) => ExtendedColorType::Rgb16,
            (_, true) => ExtendedColorType::Rgba16,
        };
        let mut bytes = Vec::new();
        let encoder =
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive);
        let written = encoder.write_image(&self.raw, self.width, self.height, color);
        written.map_err(|e| WriteError::Io(std::io::Error::other(e)))?;
        Ok(bytes)
    }
}

/// Number type of a PNG for these values.
fn png_kind(shape: &ShapeFile, field: &Field, c: &WriteContext<'_>) -> Result<ValueType, WriteError> {
    let cannot = |what: &str| WriteError::CannotHold { format: c.format, what: what.into() };
    match shape.value_type.unwrap_or(field.values.value_type()) {
        kind @ (ValueType::U8 | ValueType::U16) => Ok(kind),
        _ if shape.value_type.is_some() => Err(cannot("this type of number (a TIFF stores it)")),
        _ => {
            let values = &field.values;
            let is_whole = |most: f64| {
                all(values.len(), c.progress, |i| {
                    let x = values.get(i);
                    x.fract() == 0.0 && (0.0..=most).contains(&x)
                })
            };
            if is_whole(255.0)? {
                Ok(ValueType::U8)
            } else if is_whole(65535.0)? {
                Ok(ValueType::U16)
            } else {
                Err(cannot("values that are not whole numbers from 0 to 65535 (a TIFF stores them)"))
            }
        }
    }
}

/// Writes a new image.
pub(super) fn write_png(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let cannot = |what: String| WriteError::CannotHold { format: c.format, what };
    let Some(layout) = shape.grid() else { return Err(cannot("a shape".into())) };
    let [height, width] = layout.sizes[..] else {
        return Err(cannot(format!(
            "a grid of {} axes: it stores images of rows and columns",
            layout.sizes.len()
        )));
    };
    let (Ok(height), Ok(width)) = (u32::try_from(height), u32::try_from(width)) else {
        return Err(cannot(format!("an image of {height} × {width} pixels")));
    };
    let n_channels = field.n_channels;
    if n_channels > 4 {
        return Err(cannot(format!(
            "{n_channels} channels: it stores gray or colors, with opacity or without"
        )));
    }
    if n_channels == 4 || n_channels == 2 {
        c.report.add_note(format!("channel {} is stored as opacity", n_channels - 1));
    }
    let kind = png_kind(shape, field, c)?;
    let plain = GridLayout::new(&layout.sizes, &[1.0, 1.0]);
    if (&plain.spacings, &plain.steps, plain.origin) != (&layout.spacings, &layout.steps, layout.origin) {
        c.report.report_dropped("spacings and position of the image");
    }
    let mut raw = Vec::new();
    let numbers = GridNumbers::new(kind, NATIVE, field.len(), n_channels);
    numbers.write(None, field, c.format, &mut raw, c.progress)?;
    c.out.write_all(&EncodedImage { raw, width, height, n_channels, kind }.encode()?)?;
    Ok(())
}
