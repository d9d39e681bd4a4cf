//! Neighbors: the neighbor lists of a tile's vertices, exact across its border.

pub(crate) mod by_faces;
pub(crate) mod nearest;
mod strays;
