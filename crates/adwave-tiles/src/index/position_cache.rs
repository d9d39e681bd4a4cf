//! Positions of vertices of other tiles, with the most recently used blocks in memory.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};

/// Number of vertices of a group, which has a bounding box of its own.
const VERTICES_IN_A_GROUP: usize = 64;

/// Positions of a block, with a bounding box for each group of vertices.
pub(crate) struct BlockPositions {
    positions: Vec<[f64; 3]>,
    group_bounds: Vec<BoundingBox>,
}

/// A vertex by its index, with its position.
#[derive(Clone, Copy)]
pub(crate) struct IndexedPoint {
    pub(crate) vertex: u32,
    pub(crate) position: [f64; 3],
}

impl BlockPositions {
    fn new(positions: Vec<[f64; 3]>) -> Self {
        let bounds =
            |group: &[[f64; 3]]| BoundingBox::union(group.iter().map(|p| BoundingBox::from_point(*p)));
        let group_bounds = positions.chunks(VERTICES_IN_A_GROUP).map(bounds).collect();
        Self { positions, group_bounds }
    }

    /// All points; `first_vertex` is the index of the first vertex of the block.
    pub(crate) fn points(&self, first_vertex: usize) -> impl Iterator<Item = IndexedPoint> + '_ {
        let vertices = first_vertex..;
        vertices
            .zip(&self.positions)
            .map(|(vertex, &position)| IndexedPoint { vertex: vertex as u32, position })
    }

    /// The points in groups whose boxes intersect `bounds`; `first_vertex` is the index of the first vertex of the
    /// block.
    pub(crate) fn points_near<'a>(
        &'a self,
        bounds: &'a BoundingBox,
        first_vertex: usize,
    ) -> impl Iterator<Item = IndexedPoint> + 'a {
        let groups = self.positions.chunks(VERTICES_IN_A_GROUP).enumerate();
        groups.filter(move |(group, _)| self.group_bounds[*group].intersects(bounds)).flat_map(
            move |(group, positions)| {
                let vertices = first_vertex + group * VERTICES_IN_A_GROUP..;
                vertices
                    .zip(positions)
                    .map(|(vertex, &position)| IndexedPoint { vertex: vertex as u32, position })
            },
        )
    }
}

/// Number of blocks in the cache, about 50 MB.
const CAPACITY: usize = 512;

/// A least-recently-used cache of positions, shared by threads.
pub(crate) struct PositionCache<'a> {
    pub(crate) blocks: &'a Blocks,
    entries: Mutex<CacheEntries>,
}

#[derive(Default)]
struct CacheEntries {
    /// Number of queries.
    clock: u64,
    by_block: HashMap<usize, CacheEntry>,
}

struct CacheEntry {
    last_used: u64,
    positions: Arc<BlockPositions>,
}

impl<'a> PositionCache<'a> {
    pub(crate) fn new(blocks: &'a Blocks) -> Self {
        Self { blocks, entries: Mutex::default() }
    }

    pub(crate) fn position(&self, vertex: usize) -> Result<[f64; 3], TilesError> {
        Ok(self.block(vertex / VERTICES_IN_A_BLOCK)?.positions[vertex % VERTICES_IN_A_BLOCK])
    }

    pub(crate) fn block(&self, block: usize) -> Result<Arc<BlockPositions>, TilesError> {
        let lock = || self.entries.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        {
            let mut entries = lock();
            entries.clock += 1;
            let clock = entries.clock;
            if let Some(entry) = entries.by_block.get_mut(&block) {
                entry.last_used = clock;
                return Ok(Arc::clone(&entry.positions));
            }
        }
        let positions = Arc::new(BlockPositions::new(self.blocks.read_positions(block)?));
        let mut entries = lock();
        let CacheEntries { clock, by_block } = &mut *entries;
        if by_block.len() >= CAPACITY {
            // Evict the older half.
            let mut times: Vec<u64> = by_block.values().map(|entry| entry.last_used).collect();
            let median = *times.select_nth_unstable(CAPACITY / 2).1;
            by_block.retain(|_, entry| entry.last_used > median);
        }
        by_block.insert(block, CacheEntry { last_used: *clock, positions: Arc::clone(&positions) });
        Ok(positions)
    }
}
