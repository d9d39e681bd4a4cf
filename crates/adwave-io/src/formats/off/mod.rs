//! Object file format and its variants (COFF, NOFF, STOFF, …), text and binary.

pub(crate) mod binary;
pub(crate) mod read;
pub(crate) mod tokens;
pub(crate) mod write;
