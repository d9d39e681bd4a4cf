//! ASTM E57: scans of laser scanners.
//!
//! Library: `e57`, which checks the sums of all pages and unpacks the records. Three faults that it does not detect are
//! checked here before it reads a record: reversed ranges of whole numbers (it panics), scans whose records take no
//! bits at all (it does not end), and a stream that runs ahead of the others (its queues grow without bound).

pub(crate) mod read;
pub(crate) mod record;

use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor};
use crate::model::units::UnitRoom;
use crate::{Format, LengthUnit};

impl Format {
    /// ASTM E57, read only.
    pub const E57: Self = Self::new("e57");
}

/// Unit of Cartesian coordinates, by the standard.
static UNIT: LengthUnit = LengthUnit::METER;

pub(crate) static E57: FormatDescriptor = FormatDescriptor {
    format: Format::E57,
    title: "ASTM E57",
    extensions: &["e57"],
    reads: "all scans placed by their poses, in Cartesian or spherical coordinates, with all their records",
    loses: "records without a position, pictures",
    content: ContentKind::Cloud,
    unit: UnitRoom::Fixed(&UNIT),
    recognize: |file| file.bytes.starts_with(b"ASTM-E57").then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_e57(bytes, c.limits, c.progress)),
    ..FormatDescriptor::NEW
};
