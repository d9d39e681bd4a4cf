//! The XML formats of VTK: PolyData (VTP), UnstructuredGrid (VTU), ImageData (VTI), RectilinearGrid (VTR) and
//! StructuredGrid (VTS), as written by ParaView. ImageData is an image or a volume, the others are shapes.
//!
//! Library: `roxmltree` for the XML. `vtkio` trusts the counts of a file when it makes room for its arrays, panics on
//! some that are cut, and copies each array three times.

mod array;
mod blocks;
mod document;
mod grid;
pub(crate) mod read;
mod update;
pub(crate) mod write;

use crate::Format;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::Evidence;
use crate::model::format_descriptor::{
    ContentKind, CoordinateType, FormatDescriptor, ProvenanceRoom, SampleFile,
};

/// Recognizes VTK XML of the kind that `format` stands for.
fn recognize(file: &FileHead<'_>, format: Format) -> Option<Evidence> {
    let is_xml = file.text.starts_with(b"<");
    (is_xml && read::kind_of(file.head) == Some(Ok(format))).then_some(Evidence::Signature)
}

impl Format {
    /// VTK XML PolyData.
    pub const VTP: Self = Self::new("vtp");
    /// VTK XML UnstructuredGrid.
    pub const VTU: Self = Self::new("vtu");
    /// VTK XML ImageData: images and volumes.
    pub const VTI: Self = Self::new("vti");
    /// VTK XML RectilinearGrid, read as its surface.
    pub const VTR: Self = Self::new("vtr");
    /// VTK XML StructuredGrid, read as its surface.
    pub const VTS: Self = Self::new("vts");
}

pub(crate) static VTP: FormatDescriptor = FormatDescriptor {
    format: Format::VTP,
    title: "VTK XML PolyData",
    extensions: &["vtp"],
    reads: "points, polygons, strips, lines, all arrays; text, base64 and appended data, with zlib or \
           uncompressed",
    writes: "points, faces, lines, all fields",
    loses: "texts of field data, values of lines",
    holds_fields: true,
    holds_face_fields: true,
    holds_field_data: true,
    coordinates: CoordinateType::OfShape,
    provenance: ProvenanceRoom::Metadata,
    recognize: |file| recognize(file, Format::VTP),
    name_foreign: |file| read::kind_of(file.text_head())?.err(),
    read: Some(|bytes, c| read::read_vtk_xml(&bytes, Format::VTP, c.limits, c.progress)),
    write: Some(|shape, c| write::write_vtp(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.vtp", bytes: include_bytes!("samples/a.vtp") }],
    ..FormatDescriptor::NEW
};

pub(crate) static VTU: FormatDescriptor = FormatDescriptor {
    format: Format::VTU,
    title: "VTK XML UnstructuredGrid",
    extensions: &["vtu"],
    reads: "as VTP; the boundary of volumes, the corners of cells of higher order",
    writes: "points, faces, lines, all fields",
    loses: "volumes and the points inside them, texts of field data, values of lines",
    holds_fields: true,
    holds_face_fields: true,
    holds_field_data: true,
    coordinates: CoordinateType::OfShape,
    provenance: ProvenanceRoom::Metadata,
    recognize: |file| recognize(file, Format::VTU),
    read: Some(|bytes, c| read::read_vtk_xml(&bytes, Format::VTU, c.limits, c.progress)),
    write: Some(|shape, c| write::write_vtu(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.vtu", bytes: include_bytes!("samples/a.vtu") }],
    ..FormatDescriptor::NEW
};

pub(crate) static VTI: FormatDescriptor = FormatDescriptor {
    format: Format::VTI,
    title: "VTK XML ImageData",
    extensions: &["vti"],
    content: ContentKind::Grid,
    reads: "images and volumes with origin, spacing and direction; the active or first array of the points is the \
            values, or of the cells if the points have none; all encodings of VTP, several pieces; hidden places have \
            no data",
    writes: "the values in their type and all further fields, with origin, spacing and direction",
    keeps: "everything but the numbers that were edited, in their encoding",
    loses: "in other formats, further arrays; of files in several pieces, values of cells beside those of points",
    holds_field_data: true,
    recognize: |file| recognize(file, Format::VTI),
    read: Some(|bytes, c| read::read_vti(bytes, c.limits, c.progress)),
    write: Some(write::write_vti),
    samples: &[
        SampleFile { name: "a.vti", bytes: include_bytes!("samples/a.vti") },
        SampleFile { name: "b.vti", bytes: include_bytes!("samples/b.vti") },
    ],
    ..FormatDescriptor::NEW
};

pub(crate) static VTR: FormatDescriptor = FormatDescriptor {
    format: Format::VTR,
    title: "VTK XML RectilinearGrid",
    extensions: &["vtr"],
    reads: "flat grids as quadrilaterals, others as their boundary, with all arrays",
    loses: "the interior",
    recognize: |file| recognize(file, Format::VTR),
    read: Some(|bytes, c| read::read_vtk_xml(&bytes, Format::VTR, c.limits, c.progress)),
    samples: &[SampleFile { name: "a.vtr", bytes: include_bytes!("samples/a.vtr") }],
    ..FormatDescriptor::NEW
};

pub(crate) static VTS: FormatDescriptor = FormatDescriptor {
    format: Format::VTS,
    title: "VTK XML StructuredGrid",
    extensions: &["vts"],
    reads: "as VTR",
    loses: "the interior",
    recognize: |file| recognize(file, Format::VTS),
    read: Some(|bytes, c| read::read_vtk_xml(&bytes, Format::VTS, c.limits, c.progress)),
    samples: &[SampleFile { name: "a.vts", bytes: include_bytes!("samples/a.vts") }],
    ..FormatDescriptor::NEW
};
