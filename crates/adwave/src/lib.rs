//! Wavelets for shapes: split the geometry of a mesh, a point cloud or a graph, or any signal on it, into bands
//! from fine to coarse, measure and edit the bands, and put the shape back together without loss.

mod band_norms;
pub mod bands;
pub mod basis;
mod decomposer;
mod error;
pub mod features;
pub mod filter;
pub mod mask;
pub mod measure;
pub mod operator;
mod parallel;
mod progress;
pub mod region;
pub mod saliency;
pub mod sample;
pub mod shape;
pub mod signal;
pub mod sparse;
pub mod vector;

pub use decomposer::Decomposer;
pub use error::{ClassifiedError, ErrorKind};
pub use progress::{Cancelled, Progress, ProgressCounter};
