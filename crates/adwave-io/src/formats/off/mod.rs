//! Object file format and its variants (COFF, NOFF, STOFF, …), text and binary.
//!
//! Library: none. Updating a file keeps its bytes, which needs the place of each row.

pub(crate) mod binary;
pub(crate) mod read;
pub(crate) mod tokens;
pub(crate) mod write;

use crate::model::binary_rows::CoordinateRows;
use crate::model::context::WriteContext;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::Evidence;
use crate::model::format_descriptor::{CoordinateType, FormatDescriptor, SampleFile};
use crate::model::source_document::{SourceDocument, Update};
use crate::text::words;
use crate::{Format, ShapeFile, WriteError};

/// The bytes of an OFF, in which only coordinates are replaced.
#[derive(Debug)]
pub(crate) struct OffSource(pub(crate) CoordinateRows);

impl SourceDocument for OffSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        self.0.update_coordinates(shape, context)
    }
}

/// Letters before `OFF`, and the rest of the word: `COFF` is `(C, )`, `OFF8` is `(, 8)`.
pub(crate) fn split_keyword(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = memchr::memmem::find(word, b"OFF")?;
    let (letters, rest) = (&word[..at], &word[at + 3..]);
    let known = letters.iter().all(|b| matches!(b, b'S' | b'T' | b'C' | b'N' | b'4' | b'n'));
    (known && rest.iter().all(u8::is_ascii_digit)).then_some((letters, rest))
}

fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    if binary::head(file.bytes).is_some() {
        return Some(Evidence::Signature);
    }
    if !file.is_text() {
        return None;
    }
    if file.keyword().is_some_and(|word| split_keyword(word).is_some()) {
        return Some(Evidence::Statement);
    }
    let begins_with_counts = || file.statements().next().is_some_and(is_counts);
    (file.is_named(&OFF) && begins_with_counts()).then_some(Evidence::Name)
}

/// True if a line is three whole numbers.
fn is_counts(line: &[u8]) -> bool {
    words(line).count() == 3 && words(line).all(|w| w.iter().all(u8::is_ascii_digit))
}

impl Format {
    /// Object file format with its variants (COFF, NOFF, STOFF, …), text.
    pub const OFF: Self = Self::new("off");
    /// Object file format, binary.
    pub const OFF_BINARY: Self = Self::new("off-binary");
}

pub(crate) static OFF: FormatDescriptor = FormatDescriptor {
    format: Format::OFF,
    title: "Object file format, text",
    extensions: &["off", "coff", "noff", "cnoff", "stoff"],
    reads: "OFF, COFF, NOFF, STOFF, nOFF and combinations, by lines or by words; 4OFF divided by the \
           fourth coordinate",
    writes: "points, faces, colors, normals, texture coordinates",
    keeps: "all text except changed coordinates",
    loses: "other fields",
    recognize,
    has_lines: |_| true,
    read: Some(|bytes, c| read::read_off(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_off(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.off", bytes: include_bytes!("samples/a.off") }],
    ..FormatDescriptor::NEW
};

pub(crate) static OFF_BINARY: FormatDescriptor = FormatDescriptor {
    format: Format::OFF_BINARY,
    title: "Object file format, binary",
    reads: "big-endian as in Geomview, or little-endian, with the same variants",
    writes: "points in 32-bit floats, faces, the supported fields in 32-bit floats",
    keeps: "all bytes except changed coordinates",
    loses: "other fields",
    form_of: Some(Format::OFF),
    extensions: &[],
    coordinates: CoordinateType::Single,
    recognize: |_| None,
    write: Some(|shape, c| binary::write_off_binary(shape, &mut c.report, c.out, c.progress)),
    samples: &[],
    ..OFF
};
