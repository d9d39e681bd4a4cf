//! Input shapes and the results that are written for them: clouds (LAS, LAZ) and meshes (PLY, OBJ).

pub(crate) mod cloud;
pub(crate) mod input_shape;
pub(crate) mod mesh;
pub(crate) mod record_marker;
pub(crate) mod vertex_values;
