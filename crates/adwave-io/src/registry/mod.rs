//! Choice of the format of a file, reading and writing: this module knows the table of formats, but no single format,
//! except for the functions of `animation`.

#[cfg(feature = "gltf")]
pub(crate) mod animation;
pub(crate) mod names;
pub(crate) mod read;
mod sniff;
pub(crate) mod values;
pub(crate) mod write;
