//! Wavelets for shapes: split the geometry of a mesh, a point cloud or a graph, or any signal on it, into bands
//! from fine to coarse, measure and edit the bands, and put the shape back together without loss.

pub mod sample;
pub mod shape;
