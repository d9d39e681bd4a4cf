//! Numbers of binary files, and archives.

pub(crate) mod cursor;
#[cfg(feature = "print3d")]
pub(crate) mod package;
