//! PLY, text and binary in both byte orders: header, rows, reading, writing from scratch, and the original updated.
//!
//! Library: none. Updating a file keeps its bytes, which needs the place of each row.

pub(crate) mod body;
pub(crate) mod fixed;
pub(crate) mod header;
pub(crate) mod read;
mod turn;
pub(crate) mod update;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{
    CoordinateType, Evidence, FormatDescriptor, ProvenanceRoom, SampleFile,
};

impl Format {
    /// PLY, binary.
    pub const PLY: Self = Self::new("ply");
    /// PLY, text.
    pub const PLY_ASCII: Self = Self::new("ply-ascii");
}

pub(crate) static PLY: FormatDescriptor = FormatDescriptor {
    format: Format::PLY,
    title: "PLY, binary",
    extensions: &["ply"],
    reads: "all elements and properties, both byte orders",
    writes: "all fields",
    keeps: "header, elements, properties, byte order",
    loses: "normals of face corners, groups, materials",
    holds_fields: true,
    holds_face_fields: true,
    holds_corner_texcoords: true,
    has_byte_colors: true,
    coordinates: CoordinateType::OfShape,
    holds_missing: true,
    provenance: ProvenanceRoom::Comment { begin: "comment", lines_before: 2 },
    recognize: |file| {
        let rest = file.bytes.strip_prefix(b"ply")?;
        rest.first().is_none_or(u8::is_ascii_whitespace).then_some(Evidence::Signature)
    },
    has_lines: |bytes| bytes.starts_with(b"ply\rformat ascii"),
    read: Some(|bytes, c| read::read_ply(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_ply(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

pub(crate) static PLY_ASCII: FormatDescriptor = FormatDescriptor {
    format: Format::PLY_ASCII,
    title: "PLY, text",
    reads: "all elements and properties",
    writes: "all fields",
    keeps: "header, elements, properties",
    form_of: Some(Format::PLY),
    extensions: &[],
    recognize: |_| None,
    samples: &[SampleFile { name: "a.ply", bytes: include_bytes!("samples/a.ply") }],
    ..PLY
};
