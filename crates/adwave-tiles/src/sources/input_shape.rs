//! The shape that a job computes on, as its files describe it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::layout::RecordLayout;

/// An input file as it was when the job was planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
    pub(crate) n_points: u64,
    /// Added to the quantized coordinates, so that all files share one offset.
    pub(crate) shift: [i64; 3],
}

impl InputFile {
    /// Error for a file that differs from the one that was planned.
    pub(crate) fn changed(&self) -> TilesError {
        TilesError::Input(format!(
            "{} has changed since the job was planned; delete the work folder and start again",
            self.path.display()
        ))
    }
}

/// One cloud from one or several files, or one mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputShape {
    pub(crate) files: Vec<InputFile>,
    pub(crate) layout: RecordLayout,
    /// Bounding box of all points, which decides their order and nothing else. For a cloud it comes from the headers,
    /// in multiples of the scale; for a mesh it is in model units.
    pub(crate) bounds: BoundingBox,
    pub(crate) n_points: u64,
    /// Number of faces; 0 for a cloud.
    pub(crate) n_faces: u64,
}

impl InputShape {
    pub(crate) fn is_mesh(&self) -> bool {
        matches!(self.layout, RecordLayout::Mesh(_))
    }
}

/// Error about an input file.
pub(crate) fn input_error(path: &Path, message: &str) -> TilesError {
    TilesError::Input(format!("{}: {message}", path.display()))
}
