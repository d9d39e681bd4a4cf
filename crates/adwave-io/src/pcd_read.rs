//! Point Cloud Library files.

/// What is kept of a PCD to write it again.
#[derive(Debug)]
pub(crate) struct PcdOriginal {
    pub(crate) viewpoint: String,
    pub(crate) width: u64,
    pub(crate) height: u64,
}
