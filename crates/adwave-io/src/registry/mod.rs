//! Choice of the format of a file, reading and writing: this module knows the table of formats, but no single format.

pub(crate) mod names;
pub(crate) mod read;
mod sniff;
pub(crate) mod values;
pub(crate) mod write;
