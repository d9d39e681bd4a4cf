//! Tables of comma-separated values: fields read from them and written as them.
//!
//! Library: `csv` for reading.

pub(crate) mod read;
pub(crate) mod write;
