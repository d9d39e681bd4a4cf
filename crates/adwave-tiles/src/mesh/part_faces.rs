//! The triangles of a part of a mesh.

use std::path::PathBuf;

use adwave::Progress;
use adwave::shape::{Polygons, triangulate};

use super::neighbors::{first_face, places};
use crate::stretches::Stretches;
use crate::{TilesError, VERTICES_IN_A_BLOCK};

/// The files of all tiles' faces, with their lengths.
pub(crate) struct FaceFiles {
    pub(crate) files: Vec<(PathBuf, u64)>,
    pub(crate) blocks_per_tile: usize,
}

impl FaceFiles {
    /// The triangles whose corners are all at `vertices`, as their numbers there; `points` are the positions. Faces of one tile come in the
    /// order of the mesh.
    pub(crate) fn triangles(
        &self,
        vertices: &Stretches,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[u32; 3]>, TilesError> {
        let per_tile = self.blocks_per_tile * VERTICES_IN_A_BLOCK;
        let mut tiles: Vec<usize> = vertices
            .ranges()
            .iter()
            .flat_map(|range| range.start / per_tile..=(range.end - 1) / per_tile)
            .collect();
        tiles.dedup();
        let mut faces = Polygons::new();
        let mut numbers = Vec::new();
        for tile in tiles {
            progress.check()?;
            let Some((path, n_bytes)) = self.files.get(tile) else { continue };
            let bytes = std::fs::read(path).map_err(TilesError::io(path))?;
            let broken = || TilesError::broken(path, "its faces are not whole");
            if bytes.len() as u64 != *n_bytes {
                return Err(broken());
            }
            let mut rest = &bytes[..];
            while !rest.is_empty() {
                let (corners, after) = first_face(rest).ok_or_else(broken)?;
                rest = after;
                // A face is in the files of all tiles of its corners, and is taken from the first of these.
                let first = places(corners).min().unwrap_or(u32::MAX) as usize;
                if first / per_tile != tile {
                    continue;
                }
                numbers.clear();
                numbers.extend(places(corners).map_while(|place| vertices.number(place as usize)));
                if numbers.len() == corners.len() / 4 {
                    faces.push(&numbers.iter().map(|&number| number as u32).collect::<Vec<_>>());
                }
            }
        }
        Ok(triangulate(points, &faces))
    }
}
