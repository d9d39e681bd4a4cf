//! Subdivision hierarchies.
mod coarsening;
mod coefficients;
mod error;
mod even_solve;
mod family;
mod haar;
mod hierarchy;
mod irregular;
mod lifting;
mod refine;
mod riesz;
mod rows;
mod stencils;
mod topology;
mod update;

pub use coefficients::Coefficients;
pub use error::{Obstacle, SubdivisionError};
pub use family::Family;
pub use haar::HaarWavelets;
pub use hierarchy::{Hierarchy, SubdivisionPart, triangles_of};
pub use lifting::LiftedWavelets;
pub use riesz::RieszBounds;
pub use refine::{SubdividedMesh, subdivide};
