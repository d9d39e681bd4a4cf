//! The products that everything runs on.

mod product;
mod recurrence;
mod walk;

pub use product::apply;
pub(crate) use recurrence::{Recurrence, Sum};
pub(crate) use walk::{MAX_CHANNELS, Walk};
