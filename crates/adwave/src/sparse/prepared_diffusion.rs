//! The diffusion operator with the forms of its products, as an [`Operator`]: tiles for few channels, whole cache lines
//! for many, in double or single precision.

use super::block_width::{block_width, is_wide};
use super::product::try_apply;
use super::recurrence::Recurrence;
use super::single::SingleWeights;
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion, difference};
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
    /// The operator in single precision, rounded by the first call that asks for it; `None` if it has none.
    single: OnceLock<Option<SingleWeights>>,
}

impl PreparedDiffusion {
    /// Wraps an operator. O(1).
    pub(crate) fn new(diffusion: Arc<Diffusion>) -> Self {
        Self { diffusion, tiled: OnceLock::new(), single: OnceLock::new() }
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

    /// The operator in single precision, if its rounding errors can be bounded. O(entries) for the first call.
    fn single(&self, progress: Progress<'_>) -> Result<Option<&SingleWeights>, Cancelled> {
        if let Some(single) = self.single.get() {
            return Ok(single.as_ref());
        }
        let single = SingleWeights::new(&self.diffusion, self.diffusion.stationary(), progress)?;
        Ok(self.single.get_or_init(|| single).as_ref())
    }

    /// Upper bound of [`bytes`](Operator::bytes), without the diffusion operator, before anything is prepared.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        if is_wide(n_channels) {
            WideRecurrence::<f64>::bytes(diffusion.n_vertices(), n_channels)
        } else {
            TiledDiffusion::forecast_bytes(diffusion, n_channels.min(MAX_CHANNELS))
        }
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
        difference(&self.diffusion, self.diffusion.stationary(), x, n_channels, 0, out, progress)?;
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

    fn bytes(&self, n_channels: usize) -> u64 {
        let tiles = self.tiled.get().map_or(0, TiledDiffusion::bytes);
        let vectors = match self.tiled.get() {
            Some(tiled) if !is_wide(n_channels) => tiled.vector_bytes(n_channels.min(MAX_CHANNELS)),
            _ => Self::forecast_bytes(&self.diffusion, n_channels),
        };
        let single = self.single.get().and_then(Option::as_ref).map_or(0, SingleWeights::bytes);
        self.diffusion.bytes() + tiles + single + vectors
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
        Ok(self.single(progress)?.map(|single| single.rounding(coefficients, n_steps, 1.0)))
    }

    fn rows(&self) -> Option<&Arc<Diffusion>> {
        Some(&self.diffusion)
    }

    fn start<'a>(
        &'a self,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Box<dyn Steps + 'a>, Cancelled> {
        if !is_wide(block.n_channels) {
            return Ok(Box::new(Recurrence::new(self.tiled(progress)?, block, progress)?));
        }
        assert!(matches!(block.output, RowOutput::Channels), "components along normals need three channels");
        let single = match block.precision {
            BlockPrecision::Double => None,
            BlockPrecision::Single => self.single(progress)?,
        };
        Ok(match single {
            Some(single) => Box::new(WideRecurrence::new_single(&self.diffusion, single, block, progress)?),
            None => Box::new(WideRecurrence::new(&self.diffusion, block, progress)?),
        })
    }
}
