//! Rows of numbers, one row per point: XYZ, TXT, PTS, PWN, CSV.

pub(crate) mod meaning;
pub(crate) mod read;
pub(crate) mod write;
