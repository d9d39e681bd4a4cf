//! Wavelets for shapes: split the geometry of a mesh, a point cloud or a graph, or any signal on it, into bands
//! from fine to coarse, measure and edit the bands, and put the shape back together without loss.

pub mod bands;
pub mod basis;
mod decomposer;
mod editor;
mod error;
pub mod features;
pub mod filter;
pub mod mask;
pub mod measure;
pub mod operator;
mod parallel;
mod population;
mod progress;
pub mod region;
pub mod rows;
pub mod saliency;
pub mod sample;
pub mod shape;
pub mod signal;
pub mod sparse;
pub mod vector;

pub use decomposer::{BandsRequest, Decomposer, VertexFunctions};
pub use editor::{Editor, Touched};
pub use error::{ClassifiedError, ErrorKind};
pub use progress::{Cancelled, Progress, ProgressCounter};
