//! Parts of a mesh that have a border, found by the neighbor lists of all blocks.
//!
//! The connected pieces of each block are joined across blocks. Memory is needed for the pieces and for the runs of the
//! curve in them, a few for each block of a surface, and at most eight bytes a vertex.

use adwave::Progress;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::BLOCKS_AT_A_TIME;
use super::motion::{SURFACE_ROW_BYTES, SurfaceRow};
use crate::error::TilesError;
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::neighbor_index::NeighborIndex;
use crate::index::vertex_rows::VertexRows;

/// The vertices of parts with a border.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OpenParts {
    /// For each block the indices in it where such vertices begin and end, in turn.
    blocks: Vec<Vec<u16>>,
}

impl OpenParts {
    /// Returns true if no part has a border.
    pub(crate) fn is_empty(&self) -> bool {
        self.blocks.iter().all(Vec::is_empty)
    }

    /// Returns true for a vertex of a part with a border.
    pub(crate) fn contains(&self, vertex: usize) -> bool {
        let i = vertex % VERTICES_IN_A_BLOCK;
        let Some(turns) = self.blocks.get(vertex / VERTICES_IN_A_BLOCK) else { return false };
        turns.partition_point(|&turn| usize::from(turn) <= i) % 2 == 1
    }

    /// Finds the parts with a border; `rows` has the rows of [`SurfaceRow`] of all vertices.
    pub(crate) fn find(
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        rows: &VertexRows,
        progress: Progress<'_>,
    ) -> Result<Self, TilesError> {
        let mut pieces = Pieces::default();
        let all: Vec<usize> = (0..blocks.len()).collect();
        for group in all.chunks(BLOCKS_AT_A_TIME) {
            progress.check()?;
            let found = |&block: &usize| BlockPieces::find(blocks, neighbor_index, rows, block);
            let found: Vec<BlockPieces> = group.par_iter().map(found).collect::<Result<_, TilesError>>()?;
            for found in found {
                pieces.push(found);
            }
        }
        Ok(Self { blocks: pieces.open_runs() })
    }
}

/// Disjoint sets of numbers, the smallest of which is the root.
#[derive(Default)]
struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    fn root(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let next = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = next;
            x = next;
        }
        x
    }

    fn join(&mut self, x: u32, y: u32) {
        let (a, b) = (self.root(x), self.root(y));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

/// Consecutive vertices of one piece.
#[derive(Clone, Copy)]
struct PieceRun {
    /// Index of the first vertex in its block.
    start: u16,
    piece: u32,
}

/// The connected pieces of a block, numbered from 0.
struct BlockPieces {
    runs: Vec<PieceRun>,
    /// For each piece, true if a vertex of it is on a border.
    has_border: Vec<bool>,
    /// Pieces with a neighbor in an earlier block, and that neighbor.
    links: Vec<Link>,
}

/// A piece with a neighboring vertex of an earlier block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Link {
    piece: u32,
    vertex: u32,
}

impl BlockPieces {
    fn find(
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        rows: &VertexRows,
        block: usize,
    ) -> Result<Self, TilesError> {
        let vertices = blocks.vertices(block);
        let lists = neighbor_index.read_lists(blocks, block)?;
        let n = vertices.len();
        let mut sets = DisjointSets { parent: (0..n as u32).collect() };
        for i in 0..n {
            for &y in lists.list(i) {
                if vertices.contains(&(y as usize)) {
                    sets.join(i as u32, y - vertices.start as u32);
                }
            }
        }
        let mut is_border = Vec::with_capacity(n);
        rows.visit(vertices.clone(), |rows| {
            is_border
                .extend(rows.chunks_exact(SURFACE_ROW_BYTES).map(|row| SurfaceRow::decode(row).is_border));
        })?;
        let mut numbers = vec![u32::MAX; n];
        let (mut runs, mut has_border, mut links): (Vec<PieceRun>, Vec<bool>, Vec<Link>) =
            (Vec::new(), Vec::new(), Vec::new());
        for (i, is_border) in is_border.into_iter().enumerate() {
            let root = sets.root(i as u32) as usize;
            if numbers[root] == u32::MAX {
                numbers[root] = has_border.len() as u32;
                has_border.push(false);
            }
            let piece = numbers[root];
            has_border[piece as usize] |= is_border;
            if runs.last().is_none_or(|run| run.piece != piece) {
                runs.push(PieceRun { start: i as u16, piece });
            }
            let earlier = lists.list(i).iter().filter(|&&y| (y as usize) < vertices.start);
            links.extend(earlier.map(|&vertex| Link { piece, vertex }));
        }
        links.sort_unstable();
        links.dedup();
        Ok(Self { runs, has_border, links })
    }
}

/// The pieces of all blocks so far, joined.
#[derive(Default)]
struct Pieces {
    sets: DisjointSets,
    has_border: Vec<bool>,
    /// Runs of each block.
    blocks: Vec<Vec<PieceRun>>,
}

impl Pieces {
    fn push(&mut self, found: BlockPieces) {
        let first = self.has_border.len() as u32;
        self.sets.parent.extend(first..first + found.has_border.len() as u32);
        self.has_border.extend(found.has_border);
        for Link { piece, vertex } in found.links {
            let other = self.piece_of(vertex as usize);
            self.sets.join(first + piece, other);
        }
        let runs = found.runs.into_iter().map(|run| PieceRun { piece: first + run.piece, ..run });
        self.blocks.push(runs.collect());
    }

    /// Piece of a vertex of an earlier block.
    fn piece_of(&self, vertex: usize) -> u32 {
        let runs = &self.blocks[vertex / VERTICES_IN_A_BLOCK];
        let i = vertex % VERTICES_IN_A_BLOCK;
        let at = runs.partition_point(|run| usize::from(run.start) <= i);
        runs[at.saturating_sub(1)].piece
    }

    /// For each block the indices in it where vertices of parts with a border begin and end, in turn.
    fn open_runs(mut self) -> Vec<Vec<u16>> {
        let mut is_open = vec![false; self.has_border.len()];
        for piece in 0..self.has_border.len() {
            let root = self.sets.root(piece as u32) as usize;
            is_open[root] |= self.has_border[piece];
        }
        let blocks = std::mem::take(&mut self.blocks);
        let mut turns_of = |runs: Vec<PieceRun>| {
            let (mut turns, mut was_open) = (Vec::new(), false);
            for run in runs {
                let now_open = is_open[self.sets.root(run.piece) as usize];
                if now_open != was_open {
                    turns.push(run.start);
                    was_open = now_open;
                }
            }
            turns
        };
        blocks.into_iter().map(&mut turns_of).collect()
    }
}
