//! The faces of each tile of a mesh, and the triangles of a set of vertices.
//!
//! A face file has one record per face: the number of corners, then the vertex index of each corner, all as 32-bit
//! numbers.

use std::path::PathBuf;

use adwave::Progress;
use adwave::shape::{Polygons, triangulate};

use crate::error::TilesError;
use crate::index::blocks::VERTICES_IN_A_BLOCK;
use crate::index::interval_set::IntervalSet;

/// A file with all faces that have a corner in a tile, in the order of the mesh.
pub(crate) struct FaceFile {
    pub(crate) path: PathBuf,
    /// Length of the complete file.
    pub(crate) n_bytes: u64,
}

impl FaceFile {
    /// Reads the file; an error if it does not have its full length.
    pub(crate) fn read(&self) -> Result<Vec<u8>, TilesError> {
        let bytes = std::fs::read(&self.path).map_err(TilesError::io(&self.path))?;
        if bytes.len() as u64 == self.n_bytes { Ok(bytes) } else { Err(self.incomplete()) }
    }

    /// Error for a file whose faces cannot be decoded.
    pub(crate) fn incomplete(&self) -> TilesError {
        TilesError::broken(&self.path, "its faces are incomplete")
    }
}

/// Appends a face.
pub(crate) fn encode_face(corners: &[u32], bytes: &mut Vec<u8>) {
    bytes.extend((corners.len() as u32).to_le_bytes());
    bytes.extend(corners.iter().flat_map(|vertex| vertex.to_le_bytes()));
}

/// Splits off the corners of the first face, four bytes each; `None` if the face is incomplete.
pub(crate) fn split_first_face(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (n, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked((u32::from_le_bytes(*n) as usize).checked_mul(4)?)
}

/// Vertex indices of the corners of a face.
pub(crate) fn decode_corners(corners: &[u8]) -> impl Iterator<Item = u32> {
    corners.as_chunks::<4>().0.iter().map(|vertex| u32::from_le_bytes(*vertex))
}

/// Vertex indices of the corners of all faces, one face after the other.
pub(crate) fn decode_all_corners(bytes: &[u8]) -> impl Iterator<Item = u32> {
    let mut rest = bytes;
    let faces = std::iter::from_fn(move || {
        let (corners, after) = split_first_face(rest)?;
        rest = after;
        Some(corners)
    });
    faces.flat_map(decode_corners)
}

/// The face files of all tiles.
pub(crate) struct FaceFiles {
    pub(crate) files: Vec<FaceFile>,
    pub(crate) blocks_per_tile: usize,
}

impl FaceFiles {
    /// Triangles whose corners are all in `vertices`, as ranks in this set; `points` are the positions of its vertices.
    /// Faces of one tile come in the order of the mesh.
    pub(crate) fn triangles(
        &self,
        vertices: &IntervalSet,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[u32; 3]>, TilesError> {
        let vertices_per_tile = self.blocks_per_tile * VERTICES_IN_A_BLOCK;
        let mut tiles: Vec<usize> = vertices
            .ranges()
            .iter()
            .flat_map(|range| range.start / vertices_per_tile..=(range.end - 1) / vertices_per_tile)
            .collect();
        tiles.dedup();
        let mut faces = Polygons::new();
        let mut ranks = Vec::new();
        for tile in tiles {
            progress.check()?;
            let Some(file) = self.files.get(tile) else { continue };
            let bytes = file.read()?;
            let mut rest = &bytes[..];
            while !rest.is_empty() {
                let (corners, after) = split_first_face(rest).ok_or_else(|| file.incomplete())?;
                rest = after;
                // A face is in the files of all tiles of its corners; only the first of these counts.
                let first = decode_corners(corners).min().unwrap_or(u32::MAX) as usize;
                if first / vertices_per_tile != tile {
                    continue;
                }
                ranks.clear();
                ranks.extend(
                    decode_corners(corners)
                        .map_while(|vertex| vertices.rank(vertex as usize))
                        .map(|rank| rank as u32),
                );
                if ranks.len() == corners.len() / 4 {
                    faces.push(&ranks);
                }
            }
        }
        Ok(triangulate(points, &faces.with_canonical_starts(points)))
    }
}
