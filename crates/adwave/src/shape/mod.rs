//! The shapes that adwave works on: triangle or polygon meshes, point clouds, weighted graphs.

mod polygons;

pub use polygons::Polygons;
