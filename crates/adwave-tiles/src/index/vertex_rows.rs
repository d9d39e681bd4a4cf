//! Rows of bytes of all vertices, in one file per tile.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

use crate::error::TilesError;
use crate::files::RandomAccessFile;

/// Rows of the same number of bytes, one per vertex, in one file per tile.
pub(crate) struct VertexRows {
    paths: Vec<PathBuf>,
    /// The files that have been opened.
    files: Vec<OnceLock<RandomAccessFile>>,
    row_bytes: usize,
    /// Number of vertices of every tile but the last.
    vertices_per_tile: usize,
}

impl VertexRows {
    pub(crate) fn new(paths: Vec<PathBuf>, row_bytes: usize, vertices_per_tile: usize) -> Self {
        let files = paths.iter().map(|_| OnceLock::new()).collect();
        Self { paths, files, row_bytes, vertices_per_tile }
    }

    /// Calls `visit` with the rows of some vertices, in order and in one piece for each tile.
    pub(crate) fn visit(
        &self,
        vertices: Range<usize>,
        mut visit: impl FnMut(&[u8]),
    ) -> Result<(), TilesError> {
        let mut next = vertices.start;
        while next < vertices.end {
            let tile = next / self.vertices_per_tile;
            let first = tile * self.vertices_per_tile;
            let end = vertices.end.min(first + self.vertices_per_tile);
            let file = if let Some(file) = self.files[tile].get() {
                file
            } else {
                let opened = RandomAccessFile::open(&self.paths[tile])?;
                self.files[tile].get_or_init(|| opened)
            };
            let offset = (next - first) * self.row_bytes;
            visit(&file.read(offset as u64, (end - next) * self.row_bytes)?);
            next = end;
        }
        Ok(())
    }
}
