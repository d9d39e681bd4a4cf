//! Object file format and its variants (COFF, NOFF, STOFF, …), text.

pub(crate) mod read;
pub(crate) mod write;
