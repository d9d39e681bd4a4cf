//! Tables of comma-separated values: reading of fields, and the formatting of all tables.

pub(crate) mod read;
pub(crate) mod write;
