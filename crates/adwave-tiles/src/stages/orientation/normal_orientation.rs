//! The orientation of all normals, from the pieces of all tiles.

use std::io::Write;
use std::path::{Path, PathBuf};

use adwave::Progress;
use rayon::prelude::*;

use super::pieces::{PieceFile, TreeEdge};
use super::union_find::UnionFindParity;
use crate::error::TilesError;
use crate::files::write_atomic;
use crate::index::interval_set::IntervalSet;

/// The orientation of the normals of all vertices: the labels of the tiles on disk, the flips of the pieces in memory.
pub(crate) struct NormalOrientation {
    tiles: Vec<PieceFile>,
    /// 1 for each piece that is flipped, tile after tile.
    piece_flips: Vec<u8>,
    /// Index of the first piece of each tile in `piece_flips`.
    first_pieces: Vec<usize>,
    /// Number of vertices of every tile but the last.
    vertices_per_tile: usize,
}

impl NormalOrientation {
    /// Opens the piece files of all tiles. The flips of the pieces are read from `path`, or computed and written there.
    pub(crate) fn open(
        piece_files: &[PathBuf],
        path: &Path,
        n_vertices: usize,
        vertices_per_tile: usize,
        progress: Progress<'_>,
    ) -> Result<Self, TilesError> {
        let (mut tiles, mut first_pieces, mut n_pieces) = (Vec::new(), Vec::new(), 0);
        for (tile, path) in piece_files.iter().enumerate() {
            let first = tile * vertices_per_tile;
            let file = PieceFile::open(path, vertices_per_tile.min(n_vertices.saturating_sub(first)))?;
            first_pieces.push(n_pieces);
            n_pieces += file.n_pieces;
            tiles.push(file);
        }
        let mut orientation = Self { tiles, piece_flips: Vec::new(), first_pieces, vertices_per_tile };
        if !path.exists() {
            let flips = orientation.compute_piece_flips(n_pieces, progress)?;
            write_atomic(path, |out| out.write_all(&flips).map_err(TilesError::io(path)))?;
        }
        orientation.piece_flips = std::fs::read(path).map_err(TilesError::io(path))?;
        if orientation.piece_flips.len() != n_pieces {
            return Err(TilesError::broken(path, "it belongs to other pieces"));
        }
        Ok(orientation)
    }

    /// Joins the pieces by the remaining edges of the spanning tree. Returns 1 for each piece that is flipped relative to the first piece
    /// that it is connected with.
    fn compute_piece_flips(&self, n_pieces: usize, progress: Progress<'_>) -> Result<Vec<u8>, TilesError> {
        let mut edges: Vec<TreeEdge> = Vec::new();
        for tile in &self.tiles {
            progress.check()?;
            edges.extend(tile.read_edges()?);
        }
        edges.par_sort_unstable();
        let mut ends: Vec<u32> = edges.iter().flat_map(|edge| [edge.x, edge.y]).collect();
        ends.par_sort_unstable();
        ends.dedup();
        let labels = self.read_end_labels(&ends, progress)?;
        let label = |x: u32| labels[ends.partition_point(|&end| end < x)];
        let mut groups = UnionFindParity::new(n_pieces);
        for edge in &edges {
            let (x, y) = (label(edge.x), label(edge.y));
            groups.join(x.piece, y.piece, edge.flips ^ x.is_flipped ^ y.is_flipped);
        }
        Ok((0..n_pieces as u32).map(|piece| u8::from(groups.find(piece).1)).collect())
    }

    /// Labels of the vertices `ends`, which are ascending.
    fn read_end_labels(&self, ends: &[u32], progress: Progress<'_>) -> Result<Vec<EndLabel>, TilesError> {
        let mut end_labels = Vec::with_capacity(ends.len());
        let mut rest = ends;
        for (tile, file) in self.tiles.iter().enumerate() {
            progress.check()?;
            let first = tile * self.vertices_per_tile;
            let n_in_tile = rest.partition_point(|&x| (x as usize) < first + file.n_vertices);
            let (in_tile, after) = rest.split_at(n_in_tile);
            rest = after;
            let labels = if in_tile.is_empty() { Vec::new() } else { file.read_labels(0..file.n_vertices)? };
            end_labels.extend(in_tile.iter().map(|&x| {
                let label = labels[x as usize - first];
                let piece = (self.first_pieces[tile] + label.piece) as u32;
                EndLabel { piece, is_flipped: label.is_flipped }
            }));
        }
        if !rest.is_empty() {
            let path = self.tiles.first().map_or_else(PathBuf::new, |tile| tile.file.path().to_owned());
            return Err(TilesError::broken(&path, "it refers to a vertex that does not exist"));
        }
        Ok(end_labels)
    }

    /// For each of the vertices, whether the normal of its plane has to be flipped.
    pub(crate) fn flips(&self, vertices: &IntervalSet) -> Result<Vec<bool>, TilesError> {
        let mut flips = Vec::with_capacity(vertices.len());
        for range in vertices.ranges() {
            let mut start = range.start;
            while start < range.end {
                let tile = start / self.vertices_per_tile;
                let first = tile * self.vertices_per_tile;
                let end = range.end.min(first + self.tiles[tile].n_vertices);
                let labels = self.tiles[tile].read_labels(start - first..end - first)?;
                flips.extend(labels.into_iter().map(|label| {
                    label.is_flipped ^ (self.piece_flips[self.first_pieces[tile] + label.piece] != 0)
                }));
                start = end;
            }
        }
        Ok(flips)
    }
}

/// The piece of a vertex by its index among the pieces of all tiles, and whether the vertex is flipped relative to it.
#[derive(Clone, Copy)]
struct EndLabel {
    piece: u32,
    is_flipped: bool,
}
