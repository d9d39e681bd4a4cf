//! Point Cloud Library files: text, binary, and compressed by LZF.
//!
//! Library: none. A text is written again byte for byte.

mod lzf;
pub(crate) mod read;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, CoordinateType, Evidence, FormatDescriptor, SampleFile};

/// Words with which a header without the remark before it begins.
const HEADER_WORDS: [&[u8]; 3] = [b"VERSION", b"FIELDS", b"COLUMNS"];

impl Format {
    /// Point Cloud Library, binary.
    pub const PCD: Self = Self::new("pcd");
    /// Point Cloud Library, text.
    pub const PCD_ASCII: Self = Self::new("pcd-ascii");
    /// Point Cloud Library, compressed.
    pub const PCD_COMPRESSED: Self = Self::new("pcd-compressed");
}

pub(crate) static PCD: FormatDescriptor = FormatDescriptor {
    format: Format::PCD,
    title: "Point Cloud Library, binary",
    extensions: &["pcd"],
    reads: "points and fields; points without a position are skipped",
    writes: "points and fields",
    keeps: "view point, width and height, points without a position",
    loses: "faces",
    content: ContentKind::Cloud,
    has_byte_colors: true,
    holds_fields: true,
    coordinates: CoordinateType::OfShape,
    holds_missing: true,
    recognize: |file| {
        let begins = file.head.trim_ascii_start().starts_with(b"# .PCD");
        let is_header = |word: &[u8]| HEADER_WORDS.iter().any(|k| word.eq_ignore_ascii_case(k));
        (begins || file.keyword().is_some_and(is_header)).then_some(Evidence::Keyword)
    },
    read: Some(|bytes, c| read::read_pcd(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_pcd(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

pub(crate) static PCD_ASCII: FormatDescriptor = FormatDescriptor {
    format: Format::PCD_ASCII,
    title: "Point Cloud Library, text",
    reads: "points and fields",
    writes: "points and fields",
    keeps: "all text except changed coordinates",
    loses: "faces",
    form_of: Some(Format::PCD),
    extensions: &[],
    recognize: |_| None,
    samples: &[SampleFile { name: "a.pcd", bytes: include_bytes!("samples/a.pcd") }],
    ..PCD
};

pub(crate) static PCD_COMPRESSED: FormatDescriptor = FormatDescriptor {
    format: Format::PCD_COMPRESSED,
    title: "Point Cloud Library, compressed",
    reads: "as binary",
    writes: "points and fields",
    keeps: "view point, width and height, points without a position",
    loses: "faces",
    form_of: Some(Format::PCD),
    extensions: &[],
    recognize: |_| None,
    ..PCD
};
