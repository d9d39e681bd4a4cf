//! GIFTI: surfaces and values on them.
//!
//! Library: `roxmltree` for the XML, `flate2` and `base64` for the arrays. Updating a file keeps its text.

mod array;
mod numbers;
pub(crate) mod read;
pub(crate) mod update;
pub(crate) mod write;

use adwave::vector::Axis;

use crate::Format;
use crate::model::format_descriptor::{CoordinateType, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// GIFTI surface.
    pub const GIFTI: Self = Self::new("gifti");
}

pub(crate) static GIFTI: FormatDescriptor = FormatDescriptor {
    format: Format::GIFTI,
    title: "GIFTI",
    extensions: &["gii"],
    reads: "surfaces with their fields; fields alone as signals",
    writes: "surfaces and fields in 32-bit floats",
    keeps: "metadata, encodings, all other text",
    loses: "faces of more than three corners",
    coordinates: CoordinateType::Single,
    up_axis: Some(Axis::Z),
    recognize: |file| {
        (file.text.starts_with(b"<") && read::is_gifti(file.head)).then_some(Evidence::Signature)
    },
    read: Some(|bytes, c| read::read_gifti(bytes, c.folder, c.limits, c.progress)),
    read_fields: Some(read::read_gifti_fields),
    rewrite_values: Some(update::rewrite),
    write: Some(|shape, c| write::write_gifti(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.gii", bytes: include_bytes!("samples/a.gii") }],
    ..FormatDescriptor::NEW
};
