//! Directories of a TIFF: tags with their values.

use std::collections::HashSet;

use crate::ReadError;
use crate::model::field::{ByteOrder, Number};

pub(super) const SUBFILE: u16 = 254;
pub(super) const WIDTH: u16 = 256;
pub(super) const HEIGHT: u16 = 257;
pub(super) const BITS: u16 = 258;
pub(super) const COMPRESSION: u16 = 259;
pub(super) const PHOTOMETRIC: u16 = 262;
pub(super) const FILL_ORDER: u16 = 266;
pub(super) const DESCRIPTION: u16 = 270;
pub(super) const STRIP_OFFSETS: u16 = 273;
pub(super) const SAMPLES: u16 = 277;
pub(super) const ROWS_PER_STRIP: u16 = 278;
pub(super) const STRIP_COUNTS: u16 = 279;
pub(super) const LEAST_SAMPLE: u16 = 280;
pub(super) const GREATEST_SAMPLE: u16 = 281;
pub(super) const X_RESOLUTION: u16 = 282;
pub(super) const Y_RESOLUTION: u16 = 283;
pub(super) const PLANAR: u16 = 284;
pub(super) const PREDICTOR: u16 = 317;
pub(super) const TILE_WIDTH: u16 = 322;
pub(super) const TILE_HEIGHT: u16 = 323;
pub(super) const TILE_OFFSETS: u16 = 324;
pub(super) const TILE_COUNTS: u16 = 325;
pub(super) const SUB_DIRECTORIES: u16 = 330;
pub(super) const EXTRA_SAMPLES: u16 = 338;
pub(super) const SAMPLE_FORMAT: u16 = 339;
pub(super) const S_LEAST: u16 = 340;
pub(super) const S_GREATEST: u16 = 341;
pub(super) const PIXEL_SCALE: u16 = 33550;
pub(super) const TIEPOINTS: u16 = 33922;
pub(super) const TRANSFORMATION: u16 = 34264;
pub(super) const EXIF: u16 = 34665;
pub(super) const GPS: u16 = 34853;
pub(super) const NODATA: u16 = 42113;

/// Types of values.
pub(super) const ASCII: u16 = 2;
pub(super) const SHORT: u16 = 3;
pub(super) const LONG: u16 = 4;
pub(super) const DOUBLE: u16 = 12;
pub(super) const LONG8: u16 = 16;

/// Bytes of a value of a type; 0 for an unknown type.
pub(super) fn width_of(kind: u16) -> usize {
    match kind {
        1 | 2 | 6 | 7 => 1,
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16 | 17 | 18 => 8,
        _ => 0,
    }
}

/// Tag with its values, which lie in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) tag: u16,
    pub(super) kind: u16,
    pub(super) count: usize,
    /// First byte of the values.
    pub(super) at: usize,
}

impl Entry {
    pub(super) fn n_bytes(&self) -> usize {
        self.count * width_of(self.kind)
    }
}

/// Tags of one page.
#[derive(Clone, Debug)]
pub(super) struct Directory {
    pub(super) entries: Vec<Entry>,
}

/// File with its byte order and the width of its offsets.
#[derive(Clone, Copy)]
pub(super) struct Container<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) order: ByteOrder,
    /// True for offsets of 64 bits.
    pub(super) is_big: bool,
}

fn cut(bytes: &[u8]) -> ReadError {
    ReadError::byte_error(bytes.len(), "the file ends within its tags; get the whole file")
}

impl<'a> Container<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let order = if bytes.starts_with(b"II") { ByteOrder::Little } else { ByteOrder::Big };
        let container = Self { bytes, order, is_big: false };
        let is_big = container.short(2)? == 43;
        Ok(Self { is_big, ..container })
    }

    fn short(&self, at: usize) -> Result<u16, ReadError> {
        let own = self.bytes.get(at..at.saturating_add(2)).ok_or_else(|| cut(self.bytes))?;
        Ok(u16::from_bytes(own, self.order))
    }

    /// Offset or count, in the width of the file.
    fn offset(&self, at: usize) -> Result<usize, ReadError> {
        let width = self.offset_width();
        let own = self.bytes.get(at..at.saturating_add(width)).ok_or_else(|| cut(self.bytes))?;
        let offset = if self.is_big {
            u64::from_bytes(own, self.order)
        } else {
            u32::from_bytes(own, self.order).into()
        };
        usize::try_from(offset).map_err(|_| cut(self.bytes))
    }

    pub(super) fn offset_width(&self) -> usize {
        if self.is_big { 8 } else { 4 }
    }

    /// Directories of all pages.
    pub(super) fn directories(&self) -> Result<Vec<Directory>, ReadError> {
        let mut at = self.offset(if self.is_big { 8 } else { 4 })?;
        let (mut directories, mut seen) = (Vec::new(), HashSet::new());
        while at != 0 {
            if !seen.insert(at) {
                return Err(ReadError::byte_error(
                    at,
                    "the pages name each other in a circle; get an intact file",
                ));
            }
            let (directory, next) = self.directory(at)?;
            directories.push(directory);
            at = next;
        }
        if directories.is_empty() {
            return Err(ReadError::Whole("the file has no page; get an intact file".into()));
        }
        Ok(directories)
    }

    /// Directory at a byte, and the place of the next one.
    fn directory(&self, at: usize) -> Result<(Directory, usize), ReadError> {
        let (head, row) = if self.is_big { (8, 20) } else { (2, 12) };
        let n = if self.is_big { self.offset(at)? } else { self.short(at)?.into() };
        let start = at.saturating_add(head);
        let rows = n.checked_mul(row).and_then(|n| self.bytes.get(start..start.checked_add(n)?));
        let n_bytes = rows.ok_or_else(|| cut(self.bytes))?.len();
        let mut entries = Vec::with_capacity(n);
        for at in (start..start + n_bytes).step_by(row) {
            let (tag, kind) = (self.short(at)?, self.short(at + 2)?);
            let width = width_of(kind);
            if width == 0 {
                continue;
            }
            let count = self.offset(at + 4)?;
            let value = at + 4 + self.offset_width();
            let n_bytes = count.checked_mul(width).ok_or_else(|| cut(self.bytes))?;
            let at = if n_bytes <= self.offset_width() { value } else { self.offset(value)? };
            if at.checked_add(n_bytes).is_none_or(|end| end > self.bytes.len()) {
                return Err(cut(self.bytes));
            }
            entries.push(Entry { tag, kind, count, at });
        }
        Ok((Directory { entries }, self.offset(start + n_bytes)?))
    }

    pub(super) fn value_bytes(&self, entry: &Entry) -> &'a [u8] {
        &self.bytes[entry.at..entry.at + entry.n_bytes()]
    }

    /// Numbers of a tag; empty if the tag is missing or is no number.
    pub(super) fn numbers(&self, directory: &Directory, tag: u16) -> Vec<f64> {
        let Some(entry) = directory.entries.iter().find(|entry| entry.tag == tag) else { return Vec::new() };
        let (width, order) = (width_of(entry.kind), self.order);
        let number = |own: &[u8]| match entry.kind {
            1 | 2 | 7 => f64::from(own[0]),
            3 => u16::from_bytes(own, order).into(),
            4 | 13 => u32::from_bytes(own, order).into(),
            5 => f64::from(u32::from_bytes(own, order)) / f64::from(u32::from_bytes(&own[4..], order)),
            6 => f64::from(i8::from_bytes(own, order)),
            8 => i16::from_bytes(own, order).into(),
            9 => i32::from_bytes(own, order).into(),
            10 => f64::from(i32::from_bytes(own, order)) / f64::from(i32::from_bytes(&own[4..], order)),
            11 => f32::from_bytes(own, order).into(),
            12 => f64::from_bytes(own, order),
            17 => i64::from_bytes(own, order) as f64,
            _ => u64::from_bytes(own, order) as f64,
        };
        self.value_bytes(entry).chunks_exact(width).map(number).collect()
    }

    /// Non-negative whole numbers of a tag.
    pub(super) fn counts(&self, directory: &Directory, tag: u16) -> Vec<u64> {
        self.numbers(directory, tag).into_iter().map(|x| x as u64).collect()
    }

    /// First number of a tag.
    pub(super) fn count(&self, directory: &Directory, tag: u16) -> Option<u64> {
        self.counts(directory, tag).first().copied()
    }

    /// Text of a tag, up to its first zero.
    pub(super) fn text(&self, directory: &Directory, tag: u16) -> Option<String> {
        let entry = directory.entries.iter().find(|entry| entry.tag == tag && entry.kind == ASCII)?;
        let text = self.value_bytes(entry).split(|&b| b == 0).next().unwrap_or_default();
        Some(String::from_utf8_lossy(text).into_owned())
    }
}
