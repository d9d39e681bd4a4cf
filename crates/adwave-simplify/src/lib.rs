//! Simplification of meshes and clouds, with measured deviation.
//!
//! [`simplify_mesh`] collapses edges in the order of the quadric error (`garland1997`). It keeps a subset of the vertices, so
//! that vertex attributes need no interpolation. [`simplify_cloud`] thins a cloud to a Poisson disk sample (`cook1986`): no two
//! points are nearer than a radius, and every dropped point is within that radius of a kept one. The target is a distance
//! or a number of vertices. The reported deviation is measured on the result in double precision, not estimated.
//!
//! | module | content |
//! |---|---|
//! | `mesh` | search for the fewest vertices within a distance, or for a number of vertices |
//! | `wedges` | preparation of a mesh: welding, triangulation, seams, unit box |
//! | `collapse` | one run of edge collapses |
//! | `deviation` | distances between two surfaces |
//! | `provenance` | corners and faces of the original that new ones continue |
//! | `cloud` | thinning of clouds |
//! | `resample` | remeshing, to test independence of the mesh |

mod cloud;
mod collapse;
mod deviation;
mod error;
mod mesh;
mod provenance;
mod resample;
mod wedges;

pub use cloud::{CloudTarget, ThinnedCloud, simplify_cloud};
pub use deviation::{Deviation, OneSided};
pub use error::SimplifyError;
pub use mesh::{Border, MeshParams, MeshTarget, SimplifiedMesh, Why, simplify_mesh};
pub use resample::resample_mesh;
