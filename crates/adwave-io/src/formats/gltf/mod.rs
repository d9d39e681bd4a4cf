//! glTF 2.0, as text (`.gltf`) and as one binary file (`.glb`).
//!
//! Library: `serde_json` parses the text; the tree is in `json`. The types of the crate `gltf` drop unknown content
//! (extensions, the order of keys), so that a file could not be written again whole. `serde_json::Value` keeps the
//! order of keys with the feature `preserve_order` alone, which would hold for the whole workspace and change the order
//! of keys in all other JSON that is written (provenance, output for machines). Numbers are read through the file's
//! accessors, and written back into their places or behind them.
//!
//! Points are those of the scene: each mesh where its nodes put it. Primitives that share their attributes share
//! vertices. The places of skinned meshes are those of the mesh before joints move it; morph targets are applied by
//! `animation` alone. Texture coordinates have v upwards, as in all other formats (the file's own v goes down).

pub(crate) mod accessor;
pub(crate) mod animation;
pub(crate) mod document;
pub(crate) mod json;
pub(crate) mod matrix;
pub(crate) mod read;
pub(crate) mod scene;
#[cfg(feature = "texture")]
mod texture;
pub(crate) mod update;
pub(crate) mod write;

use crate::model::format_descriptor::{
    CoordinateType, Evidence, FormatDescriptor, ProvenanceRoom, SampleFile,
};
use crate::model::units::UnitRoom;
use crate::{Format, LengthUnit};

impl Format {
    /// glTF 2.0 as one binary file.
    pub const GLB: Self = Self::new("glb");
    /// glTF 2.0 as text.
    pub const GLTF: Self = Self::new("gltf");
}

/// Unit of all distances, by the specification.
static UNIT: LengthUnit = LengthUnit::METER;

pub(crate) static GLB: FormatDescriptor = FormatDescriptor {
    format: Format::GLB,
    title: "glTF 2.0, binary",
    extensions: &["glb", "vrm"],
    reads: "meshes, lines and points placed by the nodes of the scene, all attributes, including sparse \
           and quantized ones",
    writes: "triangles, lines, points and fields in 32-bit floats and integers of up to 16 bits",
    keeps: "materials, pictures, nodes, animations, all other content; only changed positions and fields \
           are replaced",
    loses: "polygons (split into triangles), face fields, weights of edges; Draco and meshopt compression \
           is not read",
    holds_fields: true,
    coordinates: CoordinateType::Single,
    unit: UnitRoom::Fixed(&UNIT),
    provenance: ProvenanceRoom::Metadata,
    recognize: |file| file.bytes.starts_with(b"glTF").then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_gltf(bytes, c.folder, c.limits, c.progress)),
    write: Some(|shape, c| write::write_gltf(shape, c.format, &mut c.report, c.out, c.progress)),
    #[cfg(feature = "texture")]
    texture: Some(texture::colors),
    ..FormatDescriptor::NEW
};

pub(crate) static GLTF: FormatDescriptor = FormatDescriptor {
    format: Format::GLTF,
    title: "glTF 2.0, text",
    extensions: &["gltf"],
    reads: "as GLB; buffers in the text or beside the file",
    writes: "as GLB, with buffers and pictures in the text",
    keeps: "as GLB",
    loses: "as GLB",
    recognize: |file| {
        // Every glTF says `asset`.
        let is_json = file.text.starts_with(b"{") && memchr::memmem::find(file.text, b"\"asset\"").is_some();
        is_json.then_some(Evidence::Signature)
    },
    samples: &[SampleFile { name: "a.gltf", bytes: include_bytes!("samples/a.gltf") }],
    ..GLB
};
