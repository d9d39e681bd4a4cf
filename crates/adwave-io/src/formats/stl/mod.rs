//! Stereolithography, text and binary.
//!
//! Library: none. Headers, attributes and the names of solids are kept.

pub(crate) mod read;
pub(crate) mod write;

use crate::Format;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{CoordinateType, Evidence, FormatDescriptor, SampleFile};

/// Recognizes a binary STL by its length, because many begin with `solid` like a text.
fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    let n_bytes = file.bytes.len() as u64;
    if read::binary_count(file.bytes).is_some_and(|n| n_bytes == 84 + 50 * n) {
        return Some(Evidence::Length);
    }
    // A file that is truncated, or longer than its count states.
    let is_likely = (n_bytes >= 84 && file.bytes.starts_with(b"solid")) || file.is_named(&STL);
    (!file.is_text() && is_likely).then_some(Evidence::Name)
}

impl Format {
    /// Stereolithography, binary.
    pub const STL: Self = Self::new("stl");
    /// Stereolithography, text.
    pub const STL_ASCII: Self = Self::new("stl-ascii");
}

pub(crate) static STL: FormatDescriptor = FormatDescriptor {
    format: Format::STL,
    title: "Stereolithography, binary",
    extensions: &["stl"],
    reads: "triangles, normals, attributes",
    writes: "triangles in 32-bit floats",
    keeps: "header, attributes, normals of unchanged triangles",
    loses: "shared vertices (recovered from equal coordinates), vertex fields",
    coordinates: CoordinateType::Single,
    recognize,
    read: Some(|bytes, c| read::read_stl(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_stl(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

pub(crate) static STL_ASCII: FormatDescriptor = FormatDescriptor {
    format: Format::STL_ASCII,
    title: "Stereolithography, text",
    reads: "triangles, normals, solids",
    writes: "triangles, solids",
    keeps: "names of solids, normals of unchanged triangles",
    loses: "shared vertices, other fields",
    form_of: Some(Format::STL),
    extensions: &[],
    coordinates: CoordinateType::Double,
    recognize: |file| {
        let text = file.head.trim_ascii_start();
        let begins = text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid");
        (begins && file.is_text()).then_some(Evidence::Keyword)
    },
    has_lines: |_| true,
    read: Some(|bytes, c| read::read_stl_ascii(&bytes, c.limits, c.progress)),
    samples: &[SampleFile { name: "a.stl", bytes: include_bytes!("samples/a.stl") }],
    ..STL
};
