//! Breadth-first search over the stored neighbor lists, ring by ring, loading blocks as it reaches them.

use std::ops::Range;

use adwave::Progress;
use rayon::prelude::*;

use super::symmetrize::{DirectedEdge, cross_block_edges, symmetrize};
use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::neighbor_index::{NeighborIndex, NeighborRule};
use crate::index::neighbor_lists::NeighborLists;

/// Ring of a vertex that the search has not reached.
pub(crate) const NOT_IN_HALO: u16 = u16::MAX;

/// Slot of a block that is not in memory.
const NOT_LOADED: u32 = u32::MAX;

/// A block in memory.
pub(crate) struct LoadedBlock {
    pub(crate) block: usize,
    /// Lists as stored, until they are symmetrized.
    stored_lists: Option<NeighborLists>,
    /// Edges from this block to vertices of other blocks, sorted.
    cross_block_edges: Vec<DirectedEdge>,
    /// Symmetrized lists, once the search needs them.
    symmetric_lists: Option<NeighborLists>,
    /// Ring of each vertex, 0 in the interior.
    pub(crate) rings: Vec<u16>,
}

impl LoadedBlock {
    /// Symmetrized neighbors of the `i`-th vertex; empty if its list has not been symmetrized.
    pub(crate) fn neighbors(&self, i: usize) -> &[u32] {
        self.symmetric_lists.as_ref().map_or(&[], |lists| lists.list(i))
    }
}

pub(crate) struct RingSearch<'a> {
    pub(crate) blocks: &'a Blocks,
    pub(crate) neighbor_index: &'a NeighborIndex,
    pub(crate) loaded: Vec<LoadedBlock>,
    /// Index of each block in `loaded`, or [`NOT_LOADED`].
    slots: Vec<u32>,
}

/// Number of blocks near a block above which its vertices are examined one by one; on a surface about nine blocks are
/// near. It is low in tests, which have few blocks.
const MANY_BLOCKS: usize = if cfg!(test) { 2 } else { 32 };

/// A vertex by its block and its index in the block.
#[derive(Clone, Copy)]
pub(crate) struct BlockVertex {
    block: usize,
    pub(crate) i: usize,
}

impl BlockVertex {
    pub(crate) fn from_index(vertex: u32) -> Self {
        Self { block: vertex as usize / VERTICES_IN_A_BLOCK, i: vertex as usize % VERTICES_IN_A_BLOCK }
    }
}

/// Blocks of some vertices, ascending and without repetition.
pub(crate) fn touched_blocks(vertices: &[u32]) -> Vec<usize> {
    let mut touched: Vec<usize> = vertices.iter().map(|&x| BlockVertex::from_index(x).block).collect();
    touched.dedup();
    touched.sort_unstable();
    touched.dedup();
    touched
}

impl<'a> RingSearch<'a> {
    pub(crate) fn new(blocks: &'a Blocks, neighbor_index: &'a NeighborIndex) -> Self {
        Self { blocks, neighbor_index, loaded: Vec::new(), slots: vec![NOT_LOADED; blocks.len()] }
    }

    /// Loads the interior as ring 0. Returns its vertices.
    pub(crate) fn start(
        &mut self,
        interior: &Range<usize>,
        progress: Progress<'_>,
    ) -> Result<Vec<u32>, TilesError> {
        self.symmetrize_blocks(interior.clone().collect(), progress)?;
        let mut vertices = Vec::new();
        for block in interior.clone() {
            let slot = self.slots[block] as usize;
            self.loaded[slot].rings.fill(0);
            vertices.extend(self.blocks.vertices(block).map(|vertex| vertex as u32));
        }
        Ok(vertices)
    }

    /// Number of vertices in the blocks in memory; the last block counts as a full one.
    pub(crate) fn n_loaded(&self) -> u64 {
        (self.loaded.len() * VERTICES_IN_A_BLOCK) as u64
    }

    fn get(&self, block: usize) -> Option<&LoadedBlock> {
        self.loaded.get(self.slots[block] as usize)
    }

    /// Slot of the block of a vertex, which must be loaded.
    pub(crate) fn slot(&self, vertex: BlockVertex) -> usize {
        self.slots[vertex.block] as usize
    }

    fn load(&mut self, mut blocks: Vec<usize>, progress: Progress<'_>) -> Result<(), TilesError> {
        blocks.retain(|&block| self.slots[block] == NOT_LOADED);
        let load = |&block: &usize| {
            progress.check()?;
            let vertices = self.blocks.vertices(block);
            let mut lists = self.neighbor_index.read_lists(self.blocks, block)?;
            lists.measures = Vec::new();
            let cross_block_edges = match self.neighbor_index.rule {
                NeighborRule::Nearest(_) => cross_block_edges(&vertices, &lists),
                NeighborRule::Edges => Vec::new(),
            };
            let rings = vec![NOT_IN_HALO; vertices.len()];
            Ok(LoadedBlock {
                block,
                stored_lists: Some(lists),
                cross_block_edges,
                symmetric_lists: None,
                rings,
            })
        };
        let loaded: Vec<LoadedBlock> = blocks.par_iter().map(load).collect::<Result<_, TilesError>>()?;
        for loaded in loaded {
            self.slots[loaded.block] = self.loaded.len() as u32;
            self.loaded.push(loaded);
        }
        Ok(())
    }

    /// Blocks that may have vertices with a neighbor in `block`, in ascending order.
    fn referring_blocks(&self, block: usize) -> Result<Vec<usize>, TilesError> {
        let mut found = Vec::new();
        let balls = &self.neighbor_index.ball_bounds;
        balls.visit_intersecting(&self.blocks.bounds[block], &(0..0), &mut |other| found.push(other));
        if found.len() > MANY_BLOCKS {
            // If the curve leaves the shape between two vertices, the box of their block spans the gap: examine the
            // vertices one by one.
            found.clear();
            let mut last = usize::MAX;
            for position in self.blocks.read_positions(block)? {
                balls.visit_intersecting(&BoundingBox::from_point(position), &(0..0), &mut |other| {
                    if other != last {
                        found.push(other);
                        last = other;
                    }
                });
            }
            found.sort_unstable();
            found.dedup();
        }
        Ok(found)
    }

    /// Symmetrizes the lists of `blocks`, which loads all blocks that may refer to their vertices.
    pub(crate) fn symmetrize_blocks(
        &mut self,
        mut blocks: Vec<usize>,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        blocks.retain(|&block| self.get(block).is_none_or(|loaded| loaded.symmetric_lists.is_none()));
        if self.neighbor_index.rule == NeighborRule::Edges {
            // The lists of a mesh are symmetric.
            self.load(blocks.clone(), progress)?;
            for block in blocks {
                let loaded = &mut self.loaded[self.slots[block] as usize];
                loaded.symmetric_lists = loaded.stored_lists.take();
            }
            return Ok(());
        }
        let referring: Vec<Vec<usize>> =
            blocks.par_iter().map(|&block| self.referring_blocks(block)).collect::<Result<_, _>>()?;
        let mut needed: Vec<usize> =
            referring.iter().flatten().copied().chain(blocks.iter().copied()).collect();
        needed.sort_unstable();
        needed.dedup();
        self.load(needed, progress)?;
        let symmetrize_block = |(&block, referring): (&usize, &Vec<usize>)| {
            progress.check()?;
            let slot = self.slots[block] as usize;
            let incoming: Vec<&[DirectedEdge]> = referring
                .iter()
                .filter_map(|&other| self.get(other))
                .map(|other| &other.cross_block_edges[..])
                .collect();
            let stored = self.loaded[slot].stored_lists.as_ref();
            Ok(stored.map(|lists| (slot, symmetrize(self.blocks.vertices(block), lists, &incoming))))
        };
        let symmetric: Vec<Option<(usize, NeighborLists)>> =
            blocks.par_iter().zip(&referring).map(symmetrize_block).collect::<Result<_, TilesError>>()?;
        for (slot, lists) in symmetric.into_iter().flatten() {
            let loaded = &mut self.loaded[slot];
            loaded.symmetric_lists = Some(lists);
            loaded.stored_lists = None;
        }
        Ok(())
    }

    /// Marks the unreached neighbors of the frontier as `ring` and returns them as the next frontier. The lists of the
    /// frontier must be symmetrized.
    pub(crate) fn next_ring(
        &mut self,
        frontier: &[u32],
        ring: u16,
        progress: Progress<'_>,
    ) -> Result<Vec<u32>, TilesError> {
        let is_new = |vertex: u32| {
            let vertex = BlockVertex::from_index(vertex);
            self.get(vertex.block).is_none_or(|loaded| loaded.rings[vertex.i] == NOT_IN_HALO)
        };
        let unreached_neighbors = |frontier: &[u32]| {
            let mut found = Vec::new();
            for &x in frontier {
                let x = BlockVertex::from_index(x);
                let neighbors = self.get(x.block).map_or(&[][..], |loaded| loaded.neighbors(x.i));
                found.extend(neighbors.iter().copied().filter(|&y| is_new(y)));
            }
            found.sort_unstable();
            found.dedup();
            found
        };
        let mut next: Vec<u32> =
            frontier.par_chunks(VERTICES_IN_A_BLOCK).flat_map_iter(unreached_neighbors).collect();
        next.par_sort_unstable();
        next.dedup();
        self.load(touched_blocks(&next), progress)?;
        for &y in &next {
            let y = BlockVertex::from_index(y);
            let slot = self.slot(y);
            self.loaded[slot].rings[y.i] = ring;
        }
        Ok(next)
    }

    /// Drops the blocks without a reached vertex and sorts the others.
    pub(crate) fn retain_reached(&mut self) {
        self.loaded.retain(|loaded| loaded.rings.iter().any(|&ring| ring != NOT_IN_HALO));
        self.loaded.sort_unstable_by_key(|loaded| loaded.block);
        for (slot, loaded) in self.loaded.iter().enumerate() {
            self.slots[loaded.block] = slot as u32;
        }
    }
}
