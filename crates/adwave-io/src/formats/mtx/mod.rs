//! MatrixMarket coordinate matrices: read as graphs and as sparse matrices, written from graphs and from sparse
//! matrices.
//!
//! Library: none.

mod lines;
pub(crate) mod read;
pub(crate) mod rows;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// MatrixMarket coordinate matrix, read as a weighted graph.
    pub const MTX: Self = Self::new("mtx");
}

pub(crate) static MTX: FormatDescriptor = FormatDescriptor {
    format: Format::MTX,
    title: "MatrixMarket",
    extensions: &["mtx"],
    reads: "coordinate matrices as weighted graphs",
    writes: "edges with weights",
    loses: "points, faces, fields",
    content: ContentKind::Graph,
    recognize: |file| {
        let begins = file.bytes.len() >= 14 && file.bytes[..14].eq_ignore_ascii_case(b"%%MatrixMarket");
        begins.then_some(Evidence::Signature)
    },
    has_lines: |_| true,
    read: Some(|bytes, c| read::read_mtx(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_mtx(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.mtx", bytes: include_bytes!("samples/a.mtx") }],
    ..FormatDescriptor::NEW
};
