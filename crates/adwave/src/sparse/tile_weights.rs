//! The entries of the operator in the order of the tiles.

use super::kernel::{self, VectorNumber};
use super::tiled_diffusion::TiledDiffusion;
use super::tiles::{Index, TileList, Tiles};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};

/// The entries of the rows of all tiles, rounded: those that several tiles need are repeated, so that a pass gathers
/// none.
#[derive(Debug)]
pub(super) struct TileWeights<T> {
    weights: Vec<T>,
    /// Start of each tile, and the end of the last.
    starts: Vec<usize>,
}

impl<T: VectorNumber> TileWeights<T> {
    /// Rounds the entries. O(entries of the tiles).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(super) fn new(operator: &TiledDiffusion, progress: Progress<'_>) -> Result<Self, Cancelled> {
        match &operator.tiles {
            Tiles::Narrow(tiles) => Self::gather_all(operator, tiles, progress),
            Tiles::Wide(tiles) => Self::gather_all(operator, tiles, progress),
        }
    }

    fn gather_all<I: Index>(
        operator: &TiledDiffusion,
        tiles: &TileList<I>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let mut starts = vec![0];
        for tile in tiles.iter() {
            starts.push(starts[starts.len() - 1] + kernel::n_tile_entries(tile));
        }
        let mut weights: Vec<T> = zeros(starts[starts.len() - 1]);
        let mut rest = &mut weights[..];
        let mut jobs = Vec::with_capacity(tiles.len());
        for (tile, range) in tiles.iter().zip(starts.windows(2)) {
            let (of_tile, others) = rest.split_at_mut(range[1] - range[0]);
            jobs.push((tile, of_tile));
            rest = others;
        }
        let exact = operator.diffusion().weights();
        parallel::try_map_owned(jobs, operator.n_vertices(), progress, |(tile, of_tile)| {
            kernel::gather_tile(tile, exact, of_tile);
        })?;
        Ok(Self { weights, starts })
    }

    /// Entries of the rows of a tile, in its order.
    pub(super) fn tile_entries(&self, tile: usize) -> &[T] {
        &self.weights[self.starts[tile]..self.starts[tile + 1]]
    }

    /// Bytes of memory.
    pub(super) fn bytes(&self) -> u64 {
        (size_of_val(&self.weights[..]) + size_of_val(&self.starts[..])) as u64
    }
}
