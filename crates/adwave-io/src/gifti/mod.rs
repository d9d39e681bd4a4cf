//! GIFTI: surfaces and values on them, read only.

pub(crate) mod read;
