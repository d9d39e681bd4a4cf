//! LAS 1.0 – 1.4 and its compressed form LAZ.
//!
//! Library: `laz` for compression; header, records and dimensions are read here. `las::raw` (0.9) reads headers and
//! variable records and writes them back with the same bytes. But it reads streams only, whereas a file that claims
//! four billion records must be refused by its length first, and a changed file must keep all bytes except counts and
//! bounds. It would replace twenty lines of offsets by a dependency on calendars and unique ids.

mod counts;
mod crs;
pub(crate) mod extra;
pub(crate) mod fields;
pub(crate) mod laz;
pub(crate) mod part;
mod places;
pub(crate) mod read;
mod steps;
pub(crate) mod stream;
pub(crate) mod wkt;
pub(crate) mod write;

use adwave::vector::Axis;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, ProvenanceRoom};

impl Format {
    /// LAS, uncompressed.
    pub const LAS: Self = Self::new("las");
    /// LAS, compressed.
    pub const LAZ: Self = Self::new("laz");
    /// Entwine point tiles: a folder, read only.
    pub const EPT: Self = Self::new("ept");
}

pub(crate) static LAS: FormatDescriptor = FormatDescriptor {
    format: Format::LAS,
    title: "LAS, uncompressed",
    extensions: &["las"],
    reads: "versions 1.0 to 1.4, all dimensions, extra bytes",
    writes: "all dimensions, fields as extra bytes",
    keeps: "header, records, content that no field shows",
    loses: "faces",
    content: ContentKind::Cloud,
    holds_fields: true,
    flags_points: true,
    up_axis: Some(Axis::Z),
    provenance: ProvenanceRoom::Metadata,
    recognize: |file| file.bytes.starts_with(b"LASF").then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_las(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_las(shape, c.format, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

pub(crate) static LAZ: FormatDescriptor = FormatDescriptor {
    format: Format::LAZ,
    title: "LAS, compressed",
    extensions: &["laz"],
    reads: "as LAS; COPC, also by box and level",
    writes: "as LAS",
    keeps: "header, records, content that no field shows",
    loses: "faces",
    recognize: |_| None,
    ..LAS
};

pub(crate) static EPT: FormatDescriptor = FormatDescriptor {
    format: Format::EPT,
    title: "Entwine point tiles",
    reads: "a folder with `ept.json` and LAZ tiles, also by box and level",
    loses: "tiles of types `binary` and `zstandard`",
    content: ContentKind::Cloud,
    flags_points: true,
    up_axis: Some(Axis::Z),
    read_folder: Some(part::read_folder),
    ..FormatDescriptor::NEW
};
