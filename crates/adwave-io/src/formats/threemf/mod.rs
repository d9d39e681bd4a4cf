//! 3MF: a ZIP archive of models in XML.
//!
//! Library: `zip` for the archive, `roxmltree` for the XML. `threemf` (0.8) reads no colors and no components of other
//! parts of the archive; `lib3mf` is C++ and a service of its own.

pub(crate) mod model;
pub(crate) mod read;
pub(crate) mod write;

use crate::bytes::package::package_has;
use crate::model::format_descriptor::{Evidence, FormatDescriptor};
use crate::model::units::UnitRoom;
use crate::{Format, LengthUnit};

impl Format {
    /// 3D manufacturing format, an archive of XML.
    pub const THREE_MF: Self = Self::new("3mf");
}

/// Units of the core specification, the default first.
pub(crate) static UNITS: [LengthUnit; 6] = [
    LengthUnit::MILLIMETER,
    LengthUnit::MICRON,
    LengthUnit::CENTIMETER,
    LengthUnit::INCH,
    LengthUnit::FOOT,
    LengthUnit::METER,
];

pub(crate) static THREE_MF: FormatDescriptor = FormatDescriptor {
    format: Format::THREE_MF,
    title: "3D manufacturing format",
    extensions: &["3mf"],
    reads: "the build items with components of all parts, transforms and units; colors of vertices or faces",
    writes: "objects of triangles, colors of vertices or faces in bytes, the unit of length",
    loses: "other fields, metadata, materials, textures",
    has_byte_colors: true,
    unit: UnitRoom::Stated(&UNITS),
    recognize: |file| {
        // An archive that was cut has lost its list of names, but its own name says what it was.
        let is_cut_archive = || file.is_archive() && file.is_named(&THREE_MF);
        let by_name = || is_cut_archive().then_some(Evidence::NameAlone);
        package_has(file.bytes, ".model").then_some(Evidence::Signature).or_else(by_name)
    },
    read: Some(|bytes, c| read::read_3mf(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_3mf(shape, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};
