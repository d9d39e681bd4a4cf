//! Tiles with their halos.
//!
//! A tile is an *interior*, a range of blocks, plus a *halo*: the rings of neighbors around it that its result depends
//! on. The halo is found by breadth-first search over the stored neighbor lists, so that no distance has to be guessed.

mod ring_search;
mod symmetrize;
mod tile_with_halo;

use std::ops::Range;

use adwave::Progress;
use adwave::pages::release_freed;

use crate::error::TilesError;
use crate::index::blocks::Blocks;
use crate::index::neighbor_index::NeighborIndex;
use ring_search::{RingSearch, touched_blocks};
pub(crate) use tile_with_halo::TileWithHalo;

/// Number of rings of a halo, and the memory for a tile as numbers of vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HaloLimits {
    pub(crate) n_rings: usize,
    /// Largest number of vertices of a tile with its halo.
    pub(crate) max_vertices: u64,
    /// Largest number of vertices in the blocks that the search loads.
    pub(crate) max_loaded: u64,
}

/// Calls `visit(tile, interior)` for the blocks `interior` with their halo.
///
/// A range of the curve can consist of several patches, which have a larger halo than one patch. If the tile exceeds
/// the limits, it is split in halves, which are visited in the order of their blocks.
pub(crate) fn visit_tiles_with_halo(
    blocks: &Blocks,
    neighbor_index: &NeighborIndex,
    interior: Range<usize>,
    limits: HaloLimits,
    progress: Progress<'_>,
    mut visit: impl FnMut(TileWithHalo, Range<usize>) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let mut to_do = vec![interior];
    while let Some(interior) = to_do.pop() {
        release_freed();
        if let Some(tile) = collect_tile(blocks, neighbor_index, interior.clone(), limits, progress)? {
            visit(tile, interior)?;
        } else {
            let middle = interior.start.midpoint(interior.end);
            to_do.extend([middle..interior.end, interior.start..middle]);
        }
    }
    Ok(())
}

/// Collects the blocks `interior` and their halo; `None` as soon as they exceed the limits. A single block is always
/// collected.
pub(crate) fn collect_tile(
    blocks: &Blocks,
    neighbor_index: &NeighborIndex,
    interior: Range<usize>,
    limits: HaloLimits,
    progress: Progress<'_>,
) -> Result<Option<TileWithHalo>, TilesError> {
    let n_rings = limits.n_rings;
    let mut search = RingSearch::new(blocks, neighbor_index);
    let mut frontier = search.start(&interior, progress)?;
    let mut n_reached = frontier.len() as u64;
    for ring in 1..=n_rings {
        progress.check()?;
        frontier = search.next_ring(&frontier, ring as u16, progress)?;
        n_reached += frontier.len() as u64;
        let is_too_large = n_reached > limits.max_vertices || search.n_loaded() > limits.max_loaded;
        if is_too_large && interior.len() > 1 {
            return Ok(None);
        }
        // The next ring needs the complete lists of this one; the last ring needs none.
        if ring < n_rings {
            search.symmetrize_blocks(touched_blocks(&frontier), progress)?;
        }
    }
    TileWithHalo::from_search(search, &interior, n_rings as u16).map(Some)
}
