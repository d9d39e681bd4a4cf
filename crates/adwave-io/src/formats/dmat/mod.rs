//! DMAT of libigl: one matrix, text or binary.
//!
//! Library: none; no crate reads it.

pub(crate) mod read;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Matrix of libigl, text.
    pub const DMAT: Self = Self::new("dmat");
    /// Matrix of libigl, binary.
    pub const DMAT_BINARY: Self = Self::new("dmat-binary");
}

pub(crate) static DMAT: FormatDescriptor = FormatDescriptor {
    format: Format::DMAT,
    title: "DMAT of libigl, text",
    extensions: &["dmat"],
    reads: "matrices of three columns as points, others as signals",
    writes: "points",
    loses: "faces, fields",
    content: ContentKind::Cloud,
    recognize: |file| {
        let is_named = file.is_named(&DMAT).then_some(Evidence::NameAlone);
        is_named.or_else(|| read::begins_as_dmat(file.bytes).then_some(Evidence::Layout))
    },
    read: Some(|bytes, c| read::read_dmat(&bytes, c.limits, c.progress)),
    read_fields: Some(|path, limits| Ok(vec![read::read_dmat_field(path, limits)?])),
    write: Some(|shape, c| write::write_dmat(shape, c.format, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.dmat", bytes: include_bytes!("samples/a.dmat") }],
    ..FormatDescriptor::NEW
};

pub(crate) static DMAT_BINARY: FormatDescriptor = FormatDescriptor {
    format: Format::DMAT_BINARY,
    title: "DMAT of libigl, binary",
    reads: "as text",
    writes: "points",
    loses: "faces, fields",
    form_of: Some(Format::DMAT),
    extensions: &[],
    recognize: |_| None,
    samples: &[],
    ..DMAT
};
