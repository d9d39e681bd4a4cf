//! Choosing the format of a file, reading and writing it: knows the table of formats, and no format.

pub(crate) mod names;
pub(crate) mod read;
mod sniff;
pub(crate) mod values;
pub(crate) mod write;
