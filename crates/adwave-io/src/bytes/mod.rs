//! Numbers of binary files, and archives.

pub(crate) mod cursor;
pub(crate) mod package;
