//! Rows of numbers, one per point: XYZ, TXT, PTS, PWN, CSV.

pub(crate) mod meaning;
pub(crate) mod read;
pub(crate) mod write;
