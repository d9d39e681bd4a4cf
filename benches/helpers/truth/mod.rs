//! Ground truth for denoisers: random meshes, clouds and tracks by seed, noise of many kinds, and the best fits of
//! quadrics and quadratics that the truth chooses.

mod closest;
mod exact;
mod meshes;
mod noise;
mod quadric;
mod random;
mod sampling;
mod sensors;
mod surfaces;
mod tracks;

pub use closest::{Tree, chamfer, into_unit_sphere};
pub use exact::{ExactCloud, ExactShape, root_mean_square};
pub use meshes::{CleanMesh, MeshNoise, MeshShape};
pub use noise::{CloudNoise, NoisyCloud};
pub use quadric::best_quadric_error;
pub use random::Random;
pub use sampling::{CleanCloud, CloudShape, Sampling};
pub use sensors::Sensor;
pub use tracks::{AxisNoise, NoisyTrack, TrackShape};
