//! Values carried from the vertices of one sphere to those of another that is registered to it, as in studies of the
//! cortex: [`Sphere`], [`SphereResampler`].

mod error;
mod locate;
mod prepared;
mod resample;
mod wall;
mod weights;

pub use error::SphereError;
pub use prepared::Sphere;
pub use resample::{Keep, Resampled, SphereResampler, Zeros};
