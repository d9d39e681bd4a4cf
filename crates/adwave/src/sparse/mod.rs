//! Products with the diffusion operator.

mod block_recurrence;
mod kernel;
mod product;
mod recurrence;
mod single;
mod tiled_diffusion;
mod tiles;
mod wide_clenshaw;
mod wide_recurrence;

pub(crate) use block_recurrence::{
    BlockPrecision, SumOutputs, WeightedOperator, block_width, is_wide, start_recurrence,
};
pub use product::apply;
pub(crate) use product::{copied, try_apply};
pub(crate) use recurrence::{Continuation, RowOutput, Sum, Weighing};
pub(crate) use single::SingleWeights;
pub(crate) use tiled_diffusion::{MAX_CHANNELS, TiledDiffusion, difference};
pub(crate) use wide_clenshaw::{ClenshawTerm, wide_clenshaw};
pub(crate) use wide_recurrence::WideRecurrence;

/// Values of a signal, n_vertices × n_channels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignalView<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_channels: usize,
}
