//! MRC and CCP4 maps: volumes of electron microscopy and crystallography.
//!
//! Library: none. `mrc` (0.2) maps the file as an array in the byte order of the machine, without a check of its sizes.

mod header;
mod read;
mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// MRC and CCP4 maps.
    pub const MRC: Self = Self::new("mrc");
}

pub(crate) static MRC: FormatDescriptor = FormatDescriptor {
    format: Format::MRC,
    title: "MRC and CCP4 map",
    extensions: &["mrc", "map", "ccp4", "mrcs", "rec"],
    content: ContentKind::Grid,
    reads: "volumes and stacks of 8- and 16-bit integers and 32-bit floats, in both byte orders; spacings from the cell",
    writes: "one channel, with the cell and the origin",
    keeps: "the header but for least, greatest and mean density, its extension, the type of numbers",
    loses: "other types of numbers (32-bit floats are written), further channels, fields other than `values`",
    recognize: |file| {
        let is_map = file.bytes.get(header::MAGIC..).is_some_and(|rest| rest.starts_with(b"MAP"));
        (is_map && file.bytes.len() >= header::BYTES && header::is_plausible(file.bytes))
            .then_some(Evidence::Signature)
    },
    read: Some(read::read_mrc),
    write: Some(write::write_mrc),
    samples: &[SampleFile { name: "a.mrc", bytes: include_bytes!("samples/a.mrc") }],
    ..FormatDescriptor::NEW
};
