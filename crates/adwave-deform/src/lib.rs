//! Deformation of shapes with their detail kept, and detail that moves to another base.
//!
//! | task | start reading at |
//! |---|---|
//! | bend a shape by handles | [`Deformer`] |
//! | bend a shape by the pose of a recipe | [`bind_pose`] |
//! | blend several poses | [`blend_poses`] |
//! | apply the clones and the pose of a recipe | [`reshape`] |
//! | find where a bent shape crosses itself | [`new_crossings`] |
//! | put detail onto a base that was edited elsewhere | [`with_base`], [`base_points`] |
//! | put detail onto an edited level of subdivision | [`with_level`] |
//! | carry detail onto another mesh of the surface | [`transfer`](fn@transfer) |
//! | clone detail from place to place | [`transplant`](fn@transplant) |
//! | blend two shapes with the same faces, band by band | [`morph`](fn@morph) |
//!
//! | module | content |
//! |---|---|
//! | `rotation` | quaternions, nearest rotations |
//! | `handle_motion` | affine motions of handles |
//! | `front` | covers and distances along edges |
//! | `symmetry` | mirror planes, for symmetric nodes |
//! | `coarse_base` | the coarse shape S_J, its samples and nodes |
//! | `regions` | held and moved regions, ramps, parts without a handle |
//! | `node_energy` | the energy as sums that do not depend on the number of vertices |
//! | `newton`, `skyline` | truncated Newton steps, and the factorization that they use |
//! | `lengths` | positions that keep the lengths of edges |
//! | `crossings` | triangles that pierce each other after a deformation |
//! | `deformer`, `pose` | the bound deformation; that of a recipe |
//! | `clones` | the clones of a recipe |
//! | `frames`, `surface_frames` | rotations between bases, normals of a base |
//! | `carried_detail`, `level_edit`, `transfer`, `transplant`, `morph` | detail on other bases |

mod carried_detail;
mod clones;
mod coarse_base;
mod crossings;
mod deformer;
mod error;
mod frames;
mod front;
mod handle_motion;
mod lengths;
mod level_edit;
mod morph;
mod newton;
mod node_energy;
mod pose;
mod regions;
mod rotation;
mod skyline;
mod surface_frames;
mod symmetry;
mod transfer;
mod transplant;

pub use carried_detail::{base_points, with_base};
pub use clones::Clones;
pub use coarse_base::default_base;
pub use crossings::{CrossingPlace, NewCrossings, new_crossings};
pub use deformer::{BindInfo, CarriedVertex, DeformInfo, DeformParams, Deformer};
pub use error::DeformError;
pub use frames::{Turn, nearest_turn};
pub use handle_motion::HandleMotion;
pub use level_edit::{EditedLevel, with_level};
pub use morph::morph;
pub use pose::{bind_pose, blend_poses, reshape, set_pose};
pub use regions::DeformRegions;
pub use transfer::{Transferred, transfer, transfer_decomposer};
pub use transplant::{DetailCloner, Stamp, Stamped, Transplant, Transplanted, transplant};
