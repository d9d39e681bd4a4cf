//! Wavefront OBJ: one statement, the whole file, attributes of face corners, and writing.
//!
//! Library: none. Updating a file keeps its text, which needs the place of each row.

pub(crate) mod attributes;
pub(crate) mod line;
#[cfg(feature = "texture")]
mod materials;
mod normals;
pub(crate) mod read;
mod source;
mod subset;
#[cfg(feature = "texture")]
mod texture;
#[cfg(feature = "texture")]
mod texture_corners;
mod turn;
pub(crate) mod write;

use crate::Format;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::Evidence;
use crate::model::format_descriptor::{FormatDescriptor, ProvenanceRoom, SampleFile};
use crate::text::words;

/// First words of statements by which an OBJ is known.
const KEYWORDS: [&[u8]; 16] = [
    b"v", b"vt", b"vn", b"vp", b"f", b"fo", b"l", b"p", b"g", b"o", b"s", b"mg", b"usemtl", b"mtllib",
    b"cstype", b"deg",
];

fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    if !file.is_text() {
        return None;
    }
    let is_statement = |line: &[u8]| words(line).next().is_some_and(|word| KEYWORDS.contains(&word));
    let first = file.statements().next();
    if first.is_some_and(is_statement) {
        return Some(Evidence::Statement);
    }
    let is_likely = || first.is_none() || file.statements().any(is_statement);
    (file.is_named(&OBJ) && is_likely()).then_some(Evidence::Name)
}

impl Format {
    /// Wavefront OBJ.
    pub const OBJ: Self = Self::new("obj");
}

pub(crate) static OBJ: FormatDescriptor = FormatDescriptor {
    format: Format::OBJ,
    title: "Wavefront OBJ",
    extensions: &["obj"],
    reads: "points, faces, lines, texture coordinates, normals, vertex colors",
    writes: "the same",
    keeps: "all text except changed coordinates and normals",
    loses: "fields other than normals, colors and texture coordinates; curved surfaces",
    provenance: ProvenanceRoom::Comment { begin: "#", lines_before: 0 },
    recognize,
    name_foreign: |file| file.text.starts_with(b"newmtl").then_some("a material library of an OBJ"),
    has_lines: |_| true,
    read: Some(|bytes, c| read::read_obj(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_obj(shape, &mut c.report, c.out, c.progress)),
    #[cfg(feature = "texture")]
    texture: Some(texture::colors),
    samples: &[SampleFile { name: "a.obj", bytes: include_bytes!("samples/a.obj") }],
    holds_corner_texcoords: true,
    ..FormatDescriptor::NEW
};
