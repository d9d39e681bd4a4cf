//! Medit meshes of INRIA: `.mesh` in text and `.meshb` in binary.
//!
//! The reader is our own: libMeshb is C and trusts the counts of a file; no crate reads the format.

pub(crate) mod binary;
pub(crate) mod read;
pub(crate) mod write;
