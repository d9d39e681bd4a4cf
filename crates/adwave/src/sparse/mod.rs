//! The products that everything runs on.

mod kernel;
mod product;
mod recurrence;
mod tiles;
mod walk;

pub(crate) use kernel::{with_capacity, zeros};
pub use product::apply;
pub(crate) use recurrence::{Next, Recurrence, Sum, Weighing};
pub(crate) use walk::{MAX_CHANNELS, Walk, difference};
