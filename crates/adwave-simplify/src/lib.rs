//! Shapes with fewer vertices, and how far they are from what they were, measured.
//!
//! [`simplify_mesh`] collapses edges in the order of the quadric error (`garland1997`) and keeps a subset of the vertices, so
//! that what vertices carry is kept without interpolation. [`simplify_cloud`] thins a cloud to a Poisson disk sample
//! (`cook1986`): no two points nearer than a radius, and every dropped one within that radius of a kept one. Both aim at a
//! distance or at a number of vertices. Whatever estimate steered the work, the distance that is reported is measured
//! afterwards, from surface to surface or from point to point, in double precision.
//!
//! | where | what |
//! |---|---|
//! | `mesh` | the search for the fewest vertices within a distance, or for a number of vertices |
//! | `wedges` | a mesh made ready: welded, cut into triangles, split along seams, in the unit box |
//! | `collapse` | one run of the collapses |
//! | `deviation` | how far two surfaces are apart |
//! | `provenance` | which corner and face of the original each new one continues |
//! | `cloud` | thinning of points |
//! | `resample` | another mesh of the same surface, to try what should not depend on the mesh |

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
