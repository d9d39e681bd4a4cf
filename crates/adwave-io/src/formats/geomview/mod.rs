//! Geomview's object file formats as far as they are meshes: grids (`MESH`), quadrilaterals, line drawings, and lists
//! of these and of OFF. Read only: the text of a grid has no faces to write.
//!
//! Library: none.

pub(crate) mod grid;
pub(crate) mod read;

use crate::Format;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Objects of Geomview, read only.
    pub const GEOMVIEW: Self = Self::new("geomview");
}

pub(crate) static GEOMVIEW: FormatDescriptor = FormatDescriptor {
    format: Format::GEOMVIEW,
    title: "Geomview",
    extensions: &["oogl", "list", "quad", "vect", "skel"],
    reads: "MESH grids, QUAD, VECT, SKEL, OFF, and lists of these; normals, colors; the fourth coordinate \
           divides",
    loses: "appearance, transforms, curved surfaces",
    recognize: |file| read::is_geomview(file).then_some(Evidence::Keyword),
    read: Some(|bytes, c| read::read_geomview(&bytes, c.limits, c.progress)),
    samples: &[SampleFile { name: "a.list", bytes: include_bytes!("samples/a.list") }],
    ..FormatDescriptor::NEW
};
