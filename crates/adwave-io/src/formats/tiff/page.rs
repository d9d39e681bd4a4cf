//! Pages of a TIFF: size, type of numbers and places of the strips or tiles.

use super::codec;
use super::tags::{self, Container, Directory};
use crate::model::field::ByteOrder;
use crate::{ReadError, ValueType};

/// Bytes of values that a byte of a file can have at most: about 2,500 by LZW, 1,032 by Deflate.
const MOST_COMPRESSION: usize = 4096;

/// Size and type of the images, which the pages of a stack share.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PageKind {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Numbers at a pixel.
    pub(super) n_samples: usize,
    pub(super) kind: ValueType,
    /// Bits of a number: fewer than 8 are packed into bytes.
    pub(super) n_bits: usize,
}

impl PageKind {
    /// Bytes of all numbers when no bits are packed.
    pub(super) fn n_bytes(&self) -> usize {
        self.width * self.height * self.n_samples * self.kind.n_bytes()
    }
}

/// A page: image and the places of its strips or tiles.
#[derive(Clone, Debug)]
pub(super) struct Page {
    pub(super) kind: PageKind,
    pub(super) compression: u64,
    pub(super) predictor: u64,
    /// True if each channel has strips or tiles of its own.
    pub(super) is_planar: bool,
    /// Width and height of a strip or tile.
    pub(super) chunk: [usize; 2],
    pub(super) is_tiled: bool,
    pub(super) offsets: Vec<u64>,
    pub(super) counts: Vec<u64>,
}

fn wrong(message: impl Into<String>) -> ReadError {
    ReadError::Whole(message.into())
}

impl Page {
    pub(super) fn parse(container: &Container<'_>, directory: &Directory) -> Result<Self, ReadError> {
        let count = |tag: u16, default: u64| container.count(directory, tag).unwrap_or(default);
        let [width, height] = [tags::WIDTH, tags::HEIGHT].map(|tag| count(tag, 0) as usize);
        let n_samples = count(tags::SAMPLES, 1) as usize;
        if width == 0 || height == 0 || n_samples == 0 {
            return Err(wrong(format!(
                "the image has {width} × {height} pixels of {n_samples} numbers; get an intact file"
            )));
        }
        let compression = count(tags::COMPRESSION, codec::UNCOMPRESSED);
        if let Some(name) = codec::name_of(compression) {
            let message = format!(
                "the compression {name} ({compression}) is not supported; convert the file to Deflate \
                 (gdal_translate -co COMPRESS=DEFLATE, or tiffcp -c zip)"
            );
            return Err(wrong(message));
        }
        let (kind, n_bits) = number_type(container, directory)?;
        let predictor = count(tags::PREDICTOR, 1);
        let is_known = match predictor {
            1 => true,
            2 => n_bits >= 8,
            3 => !kind.is_integer(),
            _ => false,
        };
        if !is_known {
            return Err(wrong(format!(
                "the predictor {predictor} of {n_bits} bits is not supported; save the file again"
            )));
        }
        if count(tags::FILL_ORDER, 1) != 1 && n_bits < 8 {
            return Err(wrong("bits in reverse order are not supported; save the file again"));
        }
        if count(tags::PHOTOMETRIC, 1) == 6 {
            return Err(wrong("colors in YCbCr are not supported; convert the file to RGB"));
        }
        let is_tiled = !container.counts(directory, tags::TILE_OFFSETS).is_empty();
        let chunk = if is_tiled {
            [tags::TILE_WIDTH, tags::TILE_HEIGHT].map(|tag| count(tag, 0) as usize)
        } else {
            [width, (count(tags::ROWS_PER_STRIP, u64::MAX) as usize).min(height)]
        };
        let (offsets, counts) = if is_tiled {
            (tags::TILE_OFFSETS, tags::TILE_COUNTS)
        } else {
            (tags::STRIP_OFFSETS, tags::STRIP_COUNTS)
        };
        let page = Self {
            kind: PageKind { width, height, n_samples, kind, n_bits },
            compression,
            predictor,
            is_planar: count(tags::PLANAR, 1) == 2 && n_samples > 1,
            chunk,
            is_tiled,
            offsets: container.counts(directory, offsets),
            counts: container.counts(directory, counts),
        };
        page.check_sizes(container.bytes.len())?;
        page.with_counts(container.bytes.len())
    }

    /// Checks sizes against the bytes of the file, before room is made for them.
    fn check_sizes(&self, n_bytes: usize) -> Result<(), ReadError> {
        let most = n_bytes.saturating_mul(MOST_COMPRESSION);
        let product = |sizes: [usize; 4]| sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size));
        let PageKind { width, height, n_samples, kind, .. } = self.kind;
        let [chunk_width, chunk_height] = self.chunk;
        let image = product([width, height, n_samples, kind.n_bytes()]);
        let chunk = product([chunk_width, chunk_height, n_samples, kind.n_bytes()]);
        if chunk == Some(0) || [image, chunk].iter().any(|n| n.is_none_or(|n| n > most)) {
            let message = format!(
                "the image claims {width} × {height} pixels, in parts of {chunk_width} × {chunk_height}, in {n_bytes} \
                 bytes; get the whole file"
            );
            return Err(wrong(message));
        }
        let n_chunks = self.n_chunks();
        if self.offsets.len() < n_chunks {
            let n = self.offsets.len();
            return Err(wrong(format!(
                "the image has {n} strips or tiles of {n_chunks}; get the whole file"
            )));
        }
        Ok(())
    }

    /// Computes the lengths of strips that the file does not state.
    fn with_counts(mut self, n_bytes: usize) -> Result<Self, ReadError> {
        if self.counts.len() < self.offsets.len() {
            if self.compression != codec::UNCOMPRESSED && self.offsets.len() > 1 {
                return Err(wrong("the lengths of the strips are missing; save the file again"));
            }
            let chunk = self.chunk_bytes() as u64;
            let left = |offset: &u64| (n_bytes as u64).saturating_sub(*offset);
            self.counts = self.offsets.iter().map(|offset| left(offset).min(chunk.max(1))).collect();
            if self.compression != codec::UNCOMPRESSED {
                self.counts = self.offsets.iter().map(left).collect();
            }
        }
        Ok(self)
    }

    /// Strips or tiles in a row and in a column.
    pub(super) fn chunk_rows(&self) -> [usize; 2] {
        [self.kind.width.div_ceil(self.chunk[0]), self.kind.height.div_ceil(self.chunk[1])]
    }

    pub(super) fn n_planes(&self) -> usize {
        if self.is_planar { self.kind.n_samples } else { 1 }
    }

    /// Number of strips or tiles.
    pub(super) fn n_chunks(&self) -> usize {
        let [across, down] = self.chunk_rows();
        across * down * self.n_planes()
    }

    /// Numbers at a pixel of a strip or tile.
    pub(super) fn chunk_samples(&self) -> usize {
        if self.is_planar { 1 } else { self.kind.n_samples }
    }

    /// Bytes of a row of a strip or tile.
    pub(super) fn chunk_row_bytes(&self) -> usize {
        (self.chunk[0] * self.chunk_samples() * self.kind.n_bits).div_ceil(8)
    }

    /// Bytes of a whole strip or tile without compression.
    pub(super) fn chunk_bytes(&self) -> usize {
        self.chunk_row_bytes() * self.chunk[1]
    }
}

/// Type of the numbers and their bits.
fn number_type(container: &Container<'_>, directory: &Directory) -> Result<(ValueType, usize), ReadError> {
    let bits = container.counts(directory, tags::BITS);
    let formats = container.counts(directory, tags::SAMPLE_FORMAT);
    let first = |list: &[u64]| list.first().copied().unwrap_or(1);
    let (n_bits, format) = (first(&bits), first(&formats));
    if bits.iter().any(|other| *other != n_bits) || formats.iter().any(|other| *other != format) {
        return Err(wrong("channels of different types are not supported; save each as a file of its own"));
    }
    let kind = match (format, n_bits) {
        (1 | 4, 1 | 2 | 4 | 8) => ValueType::U8,
        (1 | 4, 16) => ValueType::U16,
        (1 | 4, 32) => ValueType::U32,
        (1 | 4, 64) => ValueType::U64,
        (2, 8) => ValueType::I8,
        (2, 16) => ValueType::I16,
        (2, 32) => ValueType::I32,
        (2, 64) => ValueType::I64,
        (3, 32) => ValueType::F32,
        (3, 64) => ValueType::F64,
        _ => {
            let name = match format {
                1 | 4 => "unsigned integers",
                2 => "integers",
                3 => "floats",
                5 | 6 => "complex numbers",
                _ => "numbers of an unknown kind",
            };
            let message =
                format!("{name} of {n_bits} bits are not supported; convert them to floats of 32 bits");
            return Err(wrong(message));
        }
    };
    Ok((kind, n_bits as usize))
}

/// Code of the sample format of a type.
pub(super) fn sample_format(kind: ValueType) -> u16 {
    match kind {
        ValueType::U8 | ValueType::U16 | ValueType::U32 | ValueType::U64 => 1,
        ValueType::I8 | ValueType::I16 | ValueType::I32 | ValueType::I64 => 2,
        ValueType::F32 | ValueType::F64 => 3,
    }
}

/// Bytes of `numbers` in the order of the file, for pixels that no strip or tile has.
pub(super) fn fill_of(kind: ValueType, order: ByteOrder, missing: Option<f64>) -> Vec<u8> {
    let mut values = kind.empty();
    if !missing.is_some_and(|missing| values.push_f64(missing)) {
        values.push_f64(0.0);
    }
    let mut bytes = Vec::new();
    values.write_bytes(0, order, &mut bytes);
    bytes
}
