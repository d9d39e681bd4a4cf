//! Legacy VTK, text and binary, versions 1 to 5.1: surfaces, unstructured grids and structured grids of all kinds;
//! written as binary PolyData of version 4.2, which all readers of the format support.
//!
//! Library: none. `vtkio` trusts the counts of a file when it makes room for its arrays, and stops at keywords that it
//! does not know.

mod arrays;
mod cells;
pub(crate) mod read;
mod scanner;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{CoordinateType, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Legacy VTK, text and binary.
    pub const VTK: Self = Self::new("vtk");
}

pub(crate) static VTK: FormatDescriptor = FormatDescriptor {
    format: Format::VTK,
    title: "legacy VTK",
    extensions: &["vtk"],
    reads: "text and binary up to version 5.1, all content of VTP, VTU, VTI, VTR and VTS",
    writes: "points, faces, lines, all fields, binary",
    loses: "the interior of volumes, field data, tables of colors, values of lines",
    holds_fields: true,
    holds_face_fields: true,
    coordinates: CoordinateType::OfShape,
    recognize: |file| file.bytes.starts_with(read::MAGIC).then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_vtk(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_vtk(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.vtk", bytes: include_bytes!("samples/a.vtk") }],
    ..FormatDescriptor::NEW
};
