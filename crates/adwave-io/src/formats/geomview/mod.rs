//! Geomview's object file formats as far as they are meshes: grids (`MESH`), quadrilaterals, line drawings, and lists of these and of OFF.
//! Read only: the text of a grid has no faces to write.

pub(crate) mod grid;
pub(crate) mod read;
