//! glTF 2.0, as text (`.gltf`) and as one binary file (`.glb`).
//!
//! The crate `gltf` was looked at: its types drop what they do not know (extensions, the order of keys), so that a file could not be
//! written again whole. Here the document stays a tree of JSON values in the order of the file; numbers are read through its accessors,
//! and written back into their places or behind them.
//!
//! Points are those of the scene: each mesh where its nodes put it. Primitives that share their attributes share vertices. The places of
//! skinned meshes are those of the mesh before joints move it; morph targets are not applied. Texture coordinates have v upwards, as in
//! all other formats (the file's own v goes down).

pub(crate) mod accessor;
pub(crate) mod document;
pub(crate) mod json;
pub(crate) mod matrix;
pub(crate) mod read;
pub(crate) mod scene;
pub(crate) mod update;
pub(crate) mod write;
