//! PLY, text and binary in both byte orders: header, rows, reading, writing from scratch, and the original updated.

pub(crate) mod body;
pub(crate) mod fixed;
pub(crate) mod header;
pub(crate) mod read;
pub(crate) mod update;
pub(crate) mod write;
