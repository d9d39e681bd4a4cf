//! GIFTI: surfaces and values on them.

mod array;
mod numbers;
pub(crate) mod read;
pub(crate) mod update;
pub(crate) mod write;
