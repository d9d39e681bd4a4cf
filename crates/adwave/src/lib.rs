//! Wavelets for shapes: split the geometry of a mesh, a point cloud or a graph, or any signal on it, into bands
//! from fine to coarse, measure and edit the bands, and put the shape back together without loss.

pub mod bands;
pub mod basis;
mod decomposer;
pub mod filter;
pub mod operator;
mod progress;
mod reduce;
pub mod region;
pub mod sample;
pub mod shape;
pub mod sparse;

pub use decomposer::Decomposer;
pub use progress::{Cancelled, Progress};
