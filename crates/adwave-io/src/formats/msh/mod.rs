//! Gmsh MSH, versions 2 and 4, text and binary.
//!
//! Library: none. `mshio` (0.4) reads version 4.1 alone and no fields, and stops at the first section that it does not
//! know; `gmsh-sys` needs the program itself.

pub(crate) mod elements;
pub(crate) mod fields;
pub(crate) mod input;
pub(crate) mod kinds;
pub(crate) mod nodes;
pub(crate) mod read;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Gmsh, binary.
    pub const MSH: Self = Self::new("msh");
    /// Gmsh, text.
    pub const MSH_ASCII: Self = Self::new("msh-ascii");
}

pub(crate) static MSH: FormatDescriptor = FormatDescriptor {
    format: Format::MSH,
    title: "Gmsh, binary",
    extensions: &["msh"],
    reads: "versions 2 and 4, both byte orders: triangles, quadrilaterals, corners of higher orders, else \
           the boundary of volume cells, else lines; tags and fields",
    writes: "version 2.2 with all fields",
    keeps: "all sections, cells and bytes except changed coordinates and fields",
    loses: "polygons of more than four corners, edges beside faces",
    holds_fields: true,
    holds_face_fields: true,
    recognize: |file| {
        let begins = [&b"$MeshFormat"[..], b"$Comments", b"$NOD"];
        begins.iter().any(|begin| file.text.starts_with(begin)).then_some(Evidence::Signature)
    },
    read: Some(|bytes, c| read::read_msh(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_msh(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

pub(crate) static MSH_ASCII: FormatDescriptor = FormatDescriptor {
    format: Format::MSH_ASCII,
    title: "Gmsh, text",
    reads: "as binary",
    writes: "version 2.2 with all fields",
    keeps: "all text except changed coordinates and fields",
    loses: "as binary",
    form_of: Some(Format::MSH),
    extensions: &[],
    recognize: |_| None,
    samples: &[SampleFile { name: "a.msh", bytes: include_bytes!("samples/a.msh") }],
    ..MSH
};
