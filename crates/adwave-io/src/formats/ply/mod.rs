//! PLY, text and binary in both byte orders: header, rows, reader, writer, and update of an original.

pub(crate) mod body;
pub(crate) mod fixed;
pub(crate) mod header;
pub(crate) mod read;
pub(crate) mod update;
pub(crate) mod write;
