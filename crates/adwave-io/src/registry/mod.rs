//! Choosing the format of a file, reading and writing it.

pub(crate) mod format;
pub(crate) mod read;
pub(crate) mod sniff;
pub(crate) mod surface_values;
pub(crate) mod write;
