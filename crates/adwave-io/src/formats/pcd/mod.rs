//! Point Cloud Library files: text, binary, and compressed by LZF.

mod lzf;
pub(crate) mod missing;
pub(crate) mod read;
pub(crate) mod write;
