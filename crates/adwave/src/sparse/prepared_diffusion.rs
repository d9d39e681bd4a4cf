//! The diffusion operator with the forms of its products, as an [`Operator`]: tiles for few channels, whole cache lines
//! for many, in double or single precision.

use super::block_width::{block_width, is_wide};
use super::product::try_apply;
use super::recurrence::Recurrence;
use super::single::{SingleBound, rounded_weights};
use super::tile_weights::TileWeights;
use super::tiled_diffusion::{DifferenceInput, MAX_CHANNELS, TiledDiffusion, difference};
use super::wide_recurrence::WideRecurrence;
use crate::operator::{
    BlockPrecision, Diffusion, Operator, RowOutput, RowWeights, Semigroup, SignalBlock, Steps,
};
use crate::{Cancelled, Progress};
use std::sync::{Arc, OnceLock};

/// A diffusion operator prepared for products. Each form is built by the first call that needs it.
#[derive(Debug)]
pub(crate) struct PreparedDiffusion {
    diffusion: Arc<Diffusion>,
    /// The operator in tiles, cut by the first call with few channels.
    tiled: OnceLock<TiledDiffusion>,
    /// Bound of the rounding in single precision, computed by the first call that asks for it; `None` if there is none.
    bound: OnceLock<Option<SingleBound>>,
    /// Entries in single precision, for many channels and for tiles.
    single_rows: OnceLock<Vec<f32>>,
    single_tiles: OnceLock<TileWeights<f32>>,
}

impl PreparedDiffusion {
    /// Wraps an operator. O(1).
    pub(crate) fn new(diffusion: Arc<Diffusion>) -> Self {
        let (tiled, bound) = (OnceLock::new(), OnceLock::new());
        Self { diffusion, tiled, bound, single_rows: OnceLock::new(), single_tiles: OnceLock::new() }
    }

    /// The operator in tiles. O(entries) for the first call.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn tiled(&self, progress: Progress<'_>) -> Result<&TiledDiffusion, Cancelled> {
        if let Some(tiled) = self.tiled.get() {
            return Ok(tiled);
        }
        // If two threads arrive here at once, one of them works in vain.
        let tiled = TiledDiffusion::new(Arc::clone(&self.diffusion), progress)?;
        Ok(self.tiled.get_or_init(|| tiled))
    }

    /// This operator in tiles of another size.
    #[cfg(test)]
    pub(crate) fn with_tiles(&self, own: usize, depth: usize) -> Self {
        let tiled = self.tiled(Progress::none()).expect("nobody stops it").with_tiles(own, depth);
        Self { tiled: OnceLock::from(tiled), ..Self::new(Arc::clone(&self.diffusion)) }
    }

    /// Bound of the rounding errors in single precision, if there is one. O(entries) for the first call.
    fn bound(&self, progress: Progress<'_>) -> Result<Option<&SingleBound>, Cancelled> {
        if let Some(bound) = self.bound.get() {
            return Ok(bound.as_ref());
        }
        let bound = SingleBound::new(&self.diffusion, self.diffusion.stationary(), progress)?;
        Ok(self.bound.get_or_init(|| bound).as_ref())
    }

    /// The entries row by row in single precision. O(entries) for the first call.
    fn single_rows(&self, progress: Progress<'_>) -> Result<&[f32], Cancelled> {
        if let Some(entries) = self.single_rows.get() {
            return Ok(entries);
        }
        let entries = rounded_weights(&self.diffusion, progress)?;
        Ok(self.single_rows.get_or_init(|| entries))
    }

    /// The entries tile by tile in single precision. O(entries) for the first call.
    fn single_tiles(&self, progress: Progress<'_>) -> Result<&TileWeights<f32>, Cancelled> {
        if let Some(weights) = self.single_tiles.get() {
            return Ok(weights);
        }
        let weights = TileWeights::new(self.tiled(progress)?, progress)?;
        Ok(self.single_tiles.get_or_init(|| weights))
    }

    /// Upper bound of the bytes that single precision adds to [`forecast_bytes`](Self::forecast_bytes).
    pub(crate) fn forecast_single_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        let (n, nnz) = (diffusion.n_vertices(), diffusion.nnz() as u64);
        if is_wide(n_channels) {
            4 * nnz + wide_bytes(n, n_channels, BlockPrecision::Single)
        } else {
            // Entries are repeated as the rows of the tiles are.
            2 * 4 * nnz + 4 * 4 * (n * n_channels.min(MAX_CHANNELS)) as u64
        }
    }

    /// Upper bound of [`bytes`](Operator::bytes), without the diffusion operator, before anything is prepared.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        if is_wide(n_channels) {
            wide_bytes(diffusion.n_vertices(), n_channels, BlockPrecision::Double)
        } else {
            TiledDiffusion::forecast_bytes(diffusion, n_channels.min(MAX_CHANNELS))
        }
    }
}

/// Upper bound of the bytes of a wide recurrence for `n_channels` channels of `n` vertices.
fn wide_bytes(n: usize, n_channels: usize, precision: BlockPrecision) -> u64 {
    match precision {
        BlockPrecision::Double => WideRecurrence::<f64>::bytes(n, n_channels),
        BlockPrecision::Single => WideRecurrence::<f32>::bytes(n, n_channels),
    }
}

impl Operator for PreparedDiffusion {
    fn n_rows(&self) -> usize {
        self.diffusion.n_vertices()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let input = DifferenceInput { signal: x, n_channels, at: 0, scale: 1.0 };
        difference(&self.diffusion, self.diffusion.stationary(), input, out, progress)?;
        Ok(())
    }

    fn is_reversible(&self) -> bool {
        self.diffusion.is_reversible()
    }

    fn multiply(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        try_apply(&self.diffusion, x, out, n_channels, progress)
    }

    fn weights(&self) -> RowWeights<'_> {
        RowWeights::Each(self.diffusion.stationary())
    }

    fn semigroup(&self) -> Semigroup {
        self.diffusion.semigroup()
    }

    fn step_length(&self) -> f64 {
        self.diffusion.step_length()
    }

    fn width(&self, n_channels: usize, n_left: usize, precision: BlockPrecision) -> usize {
        block_width(n_channels, n_left, precision)
    }

    fn bytes(&self, n_channels: usize, precision: BlockPrecision) -> u64 {
        let tiles = self.tiled.get().map_or(0, TiledDiffusion::bytes);
        let width = n_channels.min(MAX_CHANNELS);
        let vectors = match (self.tiled.get(), precision) {
            _ if is_wide(n_channels) => wide_bytes(self.n_rows(), n_channels, precision),
            (Some(tiled), BlockPrecision::Double) => tiled.vector_bytes::<f64>(width),
            (Some(tiled), BlockPrecision::Single) => tiled.vector_bytes::<f32>(width),
            (None, _) => TiledDiffusion::forecast_bytes(&self.diffusion, width),
        };
        let single_rows = self.single_rows.get().map_or(0, |entries| size_of_val(&entries[..]) as u64);
        let single_tiles = self.single_tiles.get().map_or(0, TileWeights::bytes);
        self.diffusion.bytes() + tiles + single_rows + single_tiles + vectors
    }

    fn prepare(&self, progress: Progress<'_>) -> Result<(), Cancelled> {
        self.tiled(progress)?;
        Ok(())
    }

    fn single_rounding(
        &self,
        coefficients: &[f64],
        n_steps: usize,
        progress: Progress<'_>,
    ) -> Result<Option<f64>, Cancelled> {
        Ok(self.bound(progress)?.map(|bound| bound.rounding(coefficients, n_steps, 1.0)))
    }

    fn rows(&self) -> Option<&Arc<Diffusion>> {
        Some(&self.diffusion)
    }

    fn start<'a>(
        &'a self,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Box<dyn Steps + 'a>, Cancelled> {
        let bound = match block.precision {
            BlockPrecision::Double => None,
            BlockPrecision::Single => self.bound(progress)?,
        };
        if !is_wide(block.n_channels) {
            let tiled = self.tiled(progress)?;
            return Ok(match bound {
                Some(bound) => {
                    let weights = self.single_tiles(progress)?;
                    Box::new(Recurrence::new_single(tiled, weights, bound, &block, progress)?)
                }
                None => Box::new(Recurrence::new(tiled, &block, progress)?),
            });
        }
        assert!(matches!(block.output, RowOutput::Channels), "components along normals need three channels");
        Ok(match bound {
            Some(bound) => {
                let entries = self.single_rows(progress)?;
                Box::new(WideRecurrence::new_single(&self.diffusion, entries, bound, block, progress)?)
            }
            None => Box::new(WideRecurrence::new(&self.diffusion, block, progress)?),
        })
    }
}
