//! The pieces of a tile: points that edges of the spanning tree certainly connect, and the file that stores them.
//!
//! Edges are taken by ascending cost. An edge that joins two groups, one of which has no neighbor in another tile, is the cheapest edge
//! that leaves this group, so that it is in the tree whatever the other tiles have.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave::signal::{PointWithNormal, plane_normals, side_step};
use rayon::prelude::*;

use super::union_find::UnionFindParity;
use crate::bytes::{ByteCursor, u32_at};
use crate::error::TilesError;
use crate::files::{RandomAccessFile, write_atomic};
use crate::halo::{HaloLimits, TileWithHalo, visit_tiles_with_halo};
use crate::index::blocks::Blocks;
use crate::index::neighbor_index::NeighborIndex;

/// A pair of neighbors that may be in the spanning tree. Edges are ordered by cost, then by their ends along the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TreeEdge {
    /// Bits of the cost as a 32-bit float, which have the order of the costs.
    cost: u32,
    pub(super) x: u32,
    pub(super) y: u32,
    /// True if the normals of the planes at the two ends point to opposite sides.
    pub(super) flips: bool,
}

/// First bytes of a piece file.
const MAGIC: &[u8; 8] = b"adwside1";
/// Bytes before the labels: the magic bytes and the numbers of vertices, pieces and edges.
const HEADER_BYTES: usize = 8 + 3 * 8;
/// Bytes of a label: twice the index of the piece in its tile, plus 1 if the vertex is flipped relative to its piece.
const LABEL_BYTES: usize = 4;
const EDGE_BYTES: usize = 16;

/// Finds the pieces of the blocks `interior` and writes them to `path`.
pub(crate) fn write_pieces(
    blocks: &Blocks,
    neighbor_index: &NeighborIndex,
    interior: Range<usize>,
    limits: HaloLimits,
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let mut pieces = TilePieces::default();
    // An edge needs the normals of its ends, and a normal the positions of the neighbors.
    let limits = HaloLimits { n_rings: 2, ..limits };
    visit_tiles_with_halo(blocks, neighbor_index, interior, limits, progress, |tile, _| {
        pieces.add_tile(&tile, neighbor_index, progress)
    })?;
    write_atomic(path, |out| {
        let mut head = MAGIC.to_vec();
        for n in [pieces.labels.len(), pieces.n_pieces as usize, pieces.edges.len()] {
            head.extend((n as u64).to_le_bytes());
        }
        let mut put = |bytes: &[u8]| out.write_all(bytes).map_err(TilesError::io(path));
        put(&head)?;
        pieces.labels.iter().try_for_each(|label| put(&label.to_le_bytes()))?;
        pieces.edges.iter().try_for_each(|edge| {
            [edge.cost, edge.x, edge.y, edge.flips.into()].iter().try_for_each(|n| put(&n.to_le_bytes()))
        })
    })
}

/// Number of vertices whose edges a thread computes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// The pieces of a tile.
#[derive(Default)]
struct TilePieces {
    /// One label per vertex.
    labels: Vec<u32>,
    n_pieces: u32,
    /// Edges between pieces that may be in the spanning tree, by vertex index.
    edges: Vec<TreeEdge>,
}

/// Edges of a tile, by local index.
#[derive(Default)]
struct TileEdges {
    /// Edges within the interior, once each.
    interior: Vec<TreeEdge>,
    /// Edges from the interior to the halo.
    border: Vec<TreeEdge>,
}

impl TilePieces {
    fn add_tile(
        &mut self,
        tile: &TileWithHalo,
        neighbor_index: &NeighborIndex,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let TileEdges { mut interior, border } = tile_edges(tile, neighbor_index, progress)?;
        interior.par_sort_unstable();
        progress.check()?;
        let start = tile.interior_range.start as u32;
        let n = tile.interior_range.len();
        // `groups` are joined by every edge that is the cheapest between two of them, `pieces` only by those that are certain. An open
        // group has a neighbor in another tile.
        let (mut groups, mut pieces) = (UnionFindParity::new(n), UnionFindParity::new(n));
        let mut is_open = vec![false; n];
        for edge in &border {
            is_open[(edge.x - start) as usize] = true;
        }
        let vertex_index = |x: u32| tile.vertices.select(x as usize) as u32;
        let with_vertex_indices =
            |edge: &TreeEdge| TreeEdge { x: vertex_index(edge.x), y: vertex_index(edge.y), ..*edge };
        for edge in &interior {
            let (x, y) = (edge.x - start, edge.y - start);
            let (a, b) = (groups.find(x).0, groups.find(y).0);
            let is_certain = !is_open[a as usize] || !is_open[b as usize];
            let Some([root, child]) = groups.join(x, y, edge.flips) else { continue };
            is_open[root as usize] |= is_open[child as usize];
            if is_certain {
                pieces.join(x, y, edge.flips);
            } else {
                self.edges.push(with_vertex_indices(edge));
            }
        }
        // An edge between two tiles is stored by the first of them.
        self.edges.extend(border.iter().map(with_vertex_indices).filter(|edge| edge.x < edge.y));
        let mut indices = vec![u32::MAX; n];
        for x in 0..n as u32 {
            let (root, is_flipped) = pieces.find(x);
            let index = &mut indices[root as usize];
            if *index == u32::MAX {
                *index = self.n_pieces;
                self.n_pieces += 1;
            }
            self.labels.push(*index << 1 | u32::from(is_flipped));
        }
        Ok(())
    }
}

fn tile_edges(
    tile: &TileWithHalo,
    neighbor_index: &NeighborIndex,
    progress: Progress<'_>,
) -> Result<TileEdges, TilesError> {
    let normals = plane_normals(&tile.points, &tile.neighbors, progress)?;
    let step = |x: usize, y: usize| {
        let point = |x: usize| PointWithNormal {
            position: tile.points[x],
            normal: normals[x],
            radius: neighbor_index.rule.radius(tile.areas[x]),
        };
        side_step(point(x), point(y))
    };
    let interior = &tile.interior_range;
    let edges_of = |range: Range<usize>| {
        progress.check()?;
        let mut edges = TileEdges::default();
        for x in range {
            for &y in tile.neighbors.row(x) {
                let y = y as usize;
                if y < x && interior.contains(&y) {
                    continue; // the edge was added from its other end
                }
                let step = step(x, y);
                let cost = (step.cost as f32).to_bits();
                let edge = TreeEdge { cost, x: x as u32, y: y as u32, flips: step.turns };
                if interior.contains(&y) { edges.interior.push(edge) } else { edges.border.push(edge) }
            }
        }
        Ok(edges)
    };
    let starts: Vec<usize> = interior.clone().step_by(VERTICES_AT_A_TIME).collect();
    let chunks: Vec<TileEdges> = starts
        .into_par_iter()
        .map(|start| edges_of(start..(start + VERTICES_AT_A_TIME).min(interior.end)))
        .collect::<Result<_, TilesError>>()?;
    let (interior, border): (Vec<_>, Vec<_>) =
        chunks.into_iter().map(|edges| (edges.interior, edges.border)).unzip();
    Ok(TileEdges { interior: interior.concat(), border: border.concat() })
}

/// The piece of a vertex, by its index in the tile, and whether the vertex is flipped relative to it.
#[derive(Clone, Copy)]
pub(super) struct PieceLabel {
    pub(super) piece: usize,
    pub(super) is_flipped: bool,
}

/// The piece file of a tile.
pub(super) struct PieceFile {
    pub(super) file: RandomAccessFile,
    pub(super) n_vertices: usize,
    pub(super) n_pieces: usize,
    n_edges: usize,
}

impl PieceFile {
    /// Opens the file of a tile of `n_vertices` vertices.
    pub(super) fn open(path: &Path, n_vertices: usize) -> Result<Self, TilesError> {
        let file = RandomAccessFile::open(path)?;
        let head = file.read(0, HEADER_BYTES)?;
        let broken = |reason: &str| TilesError::broken(path, reason);
        let mut cursor = ByteCursor {
            bytes: head.strip_prefix(MAGIC).ok_or_else(|| broken("it is not an orientation file"))?,
        };
        let mut number = || cursor.u64().and_then(|n| usize::try_from(n).ok());
        let (Some(n_labels), Some(n_pieces), Some(n_edges)) = (number(), number(), number()) else {
            return Err(broken("it ends early"));
        };
        let n_bytes = n_edges
            .checked_mul(EDGE_BYTES)
            .and_then(|bytes| bytes.checked_add(HEADER_BYTES + LABEL_BYTES * n_vertices));
        if n_labels != n_vertices || n_pieces > n_vertices || n_bytes.map(|n| n as u64) != Some(file.len()) {
            return Err(broken("it belongs to other vertices"));
        }
        Ok(Self { file, n_vertices, n_pieces, n_edges })
    }

    /// Reads the labels of some vertices of the tile, counted from its first vertex.
    pub(super) fn read_labels(&self, range: Range<usize>) -> Result<Vec<PieceLabel>, TilesError> {
        let start = HEADER_BYTES + LABEL_BYTES * range.start;
        let bytes = self.file.read(start as u64, LABEL_BYTES * range.len())?;
        let label = |bytes: &[u8; LABEL_BYTES]| {
            let label = u32::from_le_bytes(*bytes);
            let piece = (label >> 1) as usize;
            (piece < self.n_pieces).then_some(PieceLabel { piece, is_flipped: label & 1 == 1 })
        };
        let labels: Option<Vec<_>> = bytes.as_chunks::<LABEL_BYTES>().0.iter().map(label).collect();
        labels.ok_or_else(|| TilesError::broken(self.file.path(), "it refers to a piece that does not exist"))
    }

    pub(super) fn read_edges(&self) -> Result<Vec<TreeEdge>, TilesError> {
        let start = HEADER_BYTES + LABEL_BYTES * self.n_vertices;
        let bytes = self.file.read(start as u64, EDGE_BYTES * self.n_edges)?;
        let edge = |bytes: &[u8; EDGE_BYTES]| {
            let [cost, x, y, flips] = [0, 4, 8, 12].map(|at| u32_at(bytes, at));
            TreeEdge { cost, x, y, flips: flips != 0 }
        };
        Ok(bytes.as_chunks::<EDGE_BYTES>().0.iter().map(edge).collect())
    }
}
