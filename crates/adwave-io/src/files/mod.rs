//! Replacing files as a whole.

pub(crate) mod atomic;
