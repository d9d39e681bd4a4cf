//! AMF (ISO/ASTM 52915): XML, plain or in a ZIP archive.
//!
//! Library: `roxmltree` for the XML, `zip` for the archive; no crate reads the format.

pub(crate) mod read;
pub(crate) mod write;

use crate::bytes::package::package_has;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile};
use crate::model::units::UnitRoom;
use crate::{Format, LengthUnit};

impl Format {
    /// Additive manufacturing file, XML.
    pub const AMF: Self = Self::new("amf");
}

/// Units of the standard, the default first.
static UNITS: [LengthUnit; 5] =
    [LengthUnit::MILLIMETER, LengthUnit::INCH, LengthUnit::FOOT, LengthUnit::METER, LengthUnit::MICRON];

pub(crate) static AMF: FormatDescriptor = FormatDescriptor {
    format: Format::AMF,
    title: "Additive manufacturing file",
    extensions: &["amf"],
    reads: "objects placed by constellations, plain or zipped; colors of vertices, triangles, volumes and \
           materials; the unit of length",
    writes: "objects of triangles, colors of vertices and faces, the unit of length",
    loses: "other fields, metadata, materials",
    unit: UnitRoom::Stated(&UNITS),
    recognize: |file| {
        let is_document = file.has_element("amf") || package_has(file.bytes, ".amf");
        // An archive that was cut has lost its list of names, but its own name says what it was.
        let is_cut_archive = || file.is_archive() && file.is_named(&AMF);
        let by_name = || is_cut_archive().then_some(Evidence::NameAlone);
        is_document.then_some(Evidence::Signature).or_else(by_name)
    },
    read: Some(|bytes, c| read::read_amf(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_amf(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.amf", bytes: include_bytes!("samples/a.amf") }],
    ..FormatDescriptor::NEW
};
