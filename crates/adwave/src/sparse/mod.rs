//! Products with the diffusion operator.

mod block_width;
mod kernel;
mod prepared_diffusion;
mod product;
mod recurrence;
mod single;
mod tile_weights;
mod tiled_diffusion;
mod tiles;
mod vector_diffusion;
mod vector_recurrence;
mod wide_clenshaw;
mod wide_recurrence;

pub(crate) use block_width::{block_width, is_wide};
pub(crate) use prepared_diffusion::PreparedDiffusion;
pub use product::apply;
pub(crate) use product::{copied, try_apply};
pub(crate) use vector_diffusion::VectorDiffusion;
pub(crate) use wide_clenshaw::{ClenshawTerm, wide_clenshaw};

/// Values of a signal, n_vertices × n_channels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignalView<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_channels: usize,
}
