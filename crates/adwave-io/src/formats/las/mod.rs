//! LAS 1.0 – 1.4 and its compressed form LAZ.

mod counts;
pub(crate) mod extra;
pub(crate) mod fields;
pub(crate) mod laz;
pub(crate) mod part;
mod places;
pub(crate) mod read;
pub(crate) mod stream;
pub(crate) mod write;
