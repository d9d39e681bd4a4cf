//! LAS 1.0 – 1.4 and its compressed form LAZ, read only.

pub(crate) mod fields;
pub(crate) mod laz;
pub(crate) mod read;
