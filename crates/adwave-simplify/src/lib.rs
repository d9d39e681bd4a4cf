//! Simplification of meshes and clouds, with proven deviation.
//!
//! [`simplify_mesh`] collapses edges in the order of the quadric error (`garland1997`) and keeps the topology. It keeps
//! a subset of the vertices, so that vertex attributes need no interpolation. [`simplify_cloud`] thins a cloud to a
//! Poisson disk sample (`cook1986`): no two points are nearer than a radius, and every dropped point is within that
//! radius of a kept one. The target is a distance or a number of vertices. The deviation of a mesh is bounded over all
//! points of both surfaces; that of a cloud is measured at every point. Both are computed in double precision.
//!
//! | module | content |
//! |---|---|
//! | `mesh` | targets, results, and the steps of a simplification |
//! | `wedges` | preparation of a mesh: welding, triangulation, seams, unit box |
//! | `connectivity` | faces around vertices, and collapses that keep the topology |
//! | `quadric` | cost of a collapse |
//! | `collapse` | collapses in the order of their costs |
//! | `parts` | collapses of large meshes, part by part |
//! | `certificate` | proof during collapses that the original stays within a limit |
//! | `appearance`, `colors` | colors and texture coordinates as part of the error |
//! | `proof` | bounds of the largest distance from a triangle to a surface |
//! | `surface` | the nearest triangle to a point |
//! | `deviation` | distances between two surfaces |
//! | `provenance` | corners and faces of the original that those of the result continue |
//! | `cloud` | thinning of clouds |
//! | `resample` | remeshing, to test independence of the mesh |

mod appearance;
mod certificate;
mod cloud;
mod collapse;
mod colors;
mod connectivity;
mod deviation;
mod error;
mod geometry;
mod mesh;
mod parts;
mod proof;
mod provenance;
mod quadric;
mod resample;
mod surface;
mod wedges;

pub use appearance::{Appearance, AppearanceValues};
pub use cloud::{CloudTarget, ThinnedCloud, simplify_cloud};
pub use deviation::{Deviation, OneSided, Triangles, surface_distance};
pub use error::SimplifyError;
pub use mesh::{
    Border, MeshParams, MeshTarget, SimplifiedMesh, Why, measure_coarse_mesh, simplify_mesh,
    simplify_mesh_with_appearance,
};
pub use resample::resample_mesh;
pub use wedges::Parts;
