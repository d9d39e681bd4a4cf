//! Wavefront OBJ: one statement, the whole file, attributes of face corners, and writing.

pub(crate) mod attributes;
pub(crate) mod line;
pub(crate) mod read;
pub(crate) mod write;
