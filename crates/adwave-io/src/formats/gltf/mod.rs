//! glTF 2.0, as text (`.gltf`) and as one binary file (`.glb`).
//!
//! The types of the crate `gltf` drop unknown content (extensions, the order of keys), so that a file could not be
//! written again completely. Here the document stays a tree of JSON values in the order of the file; numbers are read
//! through its accessors and written back in place or appended.
//!
//! Points are in scene coordinates: each mesh is placed by its nodes. Primitives that share their attributes share
//! vertices. Skinned meshes are read in their rest pose; morph targets are not applied. Texture coordinates have v
//! upwards, as in all other formats (in the file v points down).

pub(crate) mod accessor;
pub(crate) mod document;
pub(crate) mod json;
pub(crate) mod matrix;
pub(crate) mod read;
pub(crate) mod scene;
pub(crate) mod update;
pub(crate) mod write;
