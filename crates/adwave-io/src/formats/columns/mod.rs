//! Rows of numbers, one per point: XYZ, TXT, PTS, PWN, CSV.
//!
//! Library: none. Rows may be separated by any number of blanks and have remarks and counts between them, and the file
//! is written again byte for byte.

pub(crate) mod cells;
pub(crate) mod meaning;
pub(crate) mod read;
pub(crate) mod write;

use crate::model::context::WriteContext;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};
use crate::model::source_document::{SourceDocument, Update};
use crate::model::text_rows::TextRows;
use crate::{Format, ShapeFile, WriteError};

/// The text, with the row of each point.
#[derive(Debug)]
pub(crate) struct ColumnsSource(pub(crate) TextRows);

impl SourceDocument for ColumnsSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        write::update_columns(&self.0, shape, context)
    }
}

impl Format {
    /// Rows of numbers, one per point: XYZ, TXT, ASC.
    pub const XYZ: Self = Self::new("xyz");
    /// Rows of numbers after a count: PTS, PWN.
    pub const PTS: Self = Self::new("pts");
    /// Comma-separated values with a row of names.
    pub const CSV: Self = Self::new("csv");
}

pub(crate) static XYZ: FormatDescriptor = FormatDescriptor {
    format: Format::XYZ,
    title: "rows of numbers, one per point",
    extensions: &["xyz", "txt", "asc", "xyzn", "xyzrgb", "tsv"],
    reads: "points and columns, with or without a row of names",
    writes: "points and fields",
    keeps: "all text except changed coordinates",
    loses: "faces",
    content: ContentKind::Cloud,
    holds_fields: true,
    holds_missing: true,
    recognize: |file| {
        let is_named = file.is_named(&XYZ) && file.is_text();
        is_named.then_some(Evidence::Name).or_else(|| meaning::recognize_numbers(file))
    },
    has_lines: |_| true,
    read: Some(|bytes, c| read::read_columns(bytes, c.limits, c.name, c.progress)),
    write: Some(|shape, c| write::write_columns(shape, c.format, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.xyz", bytes: include_bytes!("samples/a.xyz") }],
    ..FormatDescriptor::NEW
};

pub(crate) static PTS: FormatDescriptor = FormatDescriptor {
    format: Format::PTS,
    title: "rows of numbers after a count",
    extensions: &["pts", "pwn"],
    reads: "points and columns",
    writes: "points, intensity, colors",
    keeps: "all text except changed coordinates",
    loses: "faces",
    holds_fields: false,
    recognize: |file| (file.is_named(&PTS) && file.is_text()).then_some(Evidence::Name),
    samples: &[SampleFile { name: "a.pts", bytes: include_bytes!("samples/a.pts") }],
    ..XYZ
};

pub(crate) static CSV: FormatDescriptor = FormatDescriptor {
    format: Format::CSV,
    title: "comma-separated values with a row of names",
    extensions: &["csv"],
    reads: "points and columns",
    writes: "points and fields",
    keeps: "all text except changed coordinates",
    loses: "faces",
    holds_fields: false,
    recognize: |file| (file.is_named(&CSV) && file.is_text()).then_some(Evidence::Name),
    samples: &[SampleFile { name: "a.csv", bytes: include_bytes!("samples/a.csv") }],
    ..XYZ
};
