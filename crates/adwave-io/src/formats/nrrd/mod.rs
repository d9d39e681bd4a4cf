//! NRRD: volumes with a header of text, in one file or with the values in another one (`.nhdr`).
//!
//! Library: none. `nrrd-rs` (0.1) has no types for axes without a direction and writes another header than it read.

mod header;
mod read;
mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// NRRD, attached or detached.
    pub const NRRD: Self = Self::new("nrrd");
}

pub(crate) static NRRD: FormatDescriptor = FormatDescriptor {
    format: Format::NRRD,
    title: "NRRD",
    extensions: &["nrrd", "nhdr"],
    content: ContentKind::Grid,
    reads: "volumes of integers and floats, raw, as gzip or as text, in both byte orders; directions and origin; axes \
            without a direction as channels; values in a file beside the header",
    writes: "the values in their type, with directions and origin",
    keeps: "the header, the encoding and the type of numbers; values of a file beside it go into the file",
    loses: "fields other than `values`",
    recognize: |file| file.bytes.starts_with(b"NRRD000").then_some(Evidence::Signature),
    read: Some(read::read_nrrd),
    write: Some(write::write_nrrd),
    samples: &[
        SampleFile { name: "a.nrrd", bytes: include_bytes!("samples/a.nrrd") },
        SampleFile { name: "b.nrrd", bytes: include_bytes!("samples/b.nrrd") },
    ],
    ..FormatDescriptor::NEW
};
