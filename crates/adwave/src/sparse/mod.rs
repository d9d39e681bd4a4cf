//! Products with the diffusion operator.

mod kernel;
mod product;
mod recurrence;
mod tiled_diffusion;
mod tiles;

pub use product::apply;
pub(crate) use product::{copied, try_apply};
pub(crate) use recurrence::{Continuation, Recurrence, RowOutput, Sum, Weighing};
pub(crate) use tiled_diffusion::{MAX_CHANNELS, TiledDiffusion, difference};
