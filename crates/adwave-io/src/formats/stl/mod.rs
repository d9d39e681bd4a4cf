//! Stereolithography, text and binary.

pub(crate) mod read;
pub(crate) mod write;
