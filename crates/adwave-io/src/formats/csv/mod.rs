//! Tables of comma-separated values: fields read from them, and the one place that writes their text.

pub(crate) mod read;
pub(crate) mod write;
