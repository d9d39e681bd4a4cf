//! DMAT of libigl: one matrix, text or binary. No crate reads it.

pub(crate) mod read;
pub(crate) mod write;
