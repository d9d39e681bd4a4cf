//! Ground truth for denoisers of clouds: random shapes by seed, samples of them, and noise of many kinds.

mod closest;
mod noise;
mod random;
mod sampling;
mod surfaces;

pub use closest::{Tree, chamfer, into_unit_sphere};
pub use noise::{CloudNoise, NoisyCloud};
pub use random::Random;
pub use sampling::{CleanCloud, CloudShape};
