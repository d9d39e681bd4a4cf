//! Ground truth for denoisers: random meshes and clouds by seed, and noise of many kinds.

mod closest;
mod meshes;
mod noise;
mod random;
mod sampling;
mod sensors;
mod surfaces;

pub use closest::{Tree, chamfer, into_unit_sphere};
pub use meshes::{CleanMesh, MeshNoise, MeshShape};
pub use noise::{CloudNoise, NoisyCloud};
pub use random::Random;
pub use sampling::{CleanCloud, CloudShape};
pub use sensors::Sensor;
