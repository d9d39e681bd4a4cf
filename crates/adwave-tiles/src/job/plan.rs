//! The plan of a job: the input, the parameters and the size of a tile.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::params::Params;
use crate::sources::input_shape::InputShape;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) shape: InputShape,
    pub(crate) params: Params,
    pub(crate) blocks_per_tile: usize,
}

impl Plan {
    /// Blocks of a tile, of `n_blocks` in all.
    pub(crate) fn blocks_of_tile(&self, tile: usize, n_blocks: usize) -> Range<usize> {
        let first = tile * self.blocks_per_tile;
        first.min(n_blocks)..(first + self.blocks_per_tile).min(n_blocks)
    }

    pub(crate) fn n_tiles(&self, n_blocks: usize) -> usize {
        n_blocks.div_ceil(self.blocks_per_tile)
    }
}
