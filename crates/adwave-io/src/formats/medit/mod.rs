//! Medit meshes of INRIA: `.mesh` in text and `.meshb` in binary.
//!
//! Library: none; libMeshb is C and trusts the counts of a file, and no crate reads the format.

pub(crate) mod binary;
pub(crate) mod read;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Medit of INRIA, text.
    pub const MEDIT: Self = Self::new("medit");
    /// Medit of INRIA, binary.
    pub const MEDIT_BINARY: Self = Self::new("meshb");
}

pub(crate) static MEDIT: FormatDescriptor = FormatDescriptor {
    format: Format::MEDIT,
    title: "Medit, text",
    extensions: &["mesh"],
    reads: "triangles, quadrilaterals, else the boundary of volume cells, else edges; references",
    writes: "points, triangles, quadrilaterals or edges, references",
    keeps: "all text except changed coordinates",
    loses: "other fields, polygons of more than four corners, the order of triangles among quadrilaterals",
    recognize: |file| (file.keyword() == Some(b"MeshVersionFormatted")).then_some(Evidence::Keyword),
    read: Some(|bytes, c| read::read_medit(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_medit(shape, c.format, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.mesh", bytes: include_bytes!("samples/a.mesh") }],
    ..FormatDescriptor::NEW
};

pub(crate) static MEDIT_BINARY: FormatDescriptor = FormatDescriptor {
    format: Format::MEDIT_BINARY,
    title: "Medit, binary",
    extensions: &["meshb"],
    reads: "versions 1 to 4, both byte orders, as text",
    writes: "as text",
    keeps: "all bytes except changed coordinates",
    loses: "as text",
    recognize: |file| binary::begins_as_meshb(file.bytes).map(|_| Evidence::Signature),
    read: Some(|bytes, c| binary::read_meshb(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_medit(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};
