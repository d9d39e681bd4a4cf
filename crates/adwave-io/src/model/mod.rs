//! Content of a file in memory, the description of a format for the registry, and helpers that formats share.

pub(crate) mod binary_rows;
#[cfg(any(feature = "vtk", feature = "volume"))]
pub(crate) mod brain_layout;
pub(crate) mod cells;
pub(crate) mod colors;
pub(crate) mod context;
pub(crate) mod f32_limits;
pub(crate) mod face_cells;
pub(crate) mod field;
pub(crate) mod file_head;
pub(crate) mod float_steps;
pub(crate) mod format_descriptor;
#[cfg(any(feature = "las", feature = "grid"))]
pub(crate) mod geo_keys;
pub(crate) mod graph_changes;
pub(crate) mod grid_layout;
pub(crate) mod grid_values;
pub(crate) mod grouping;
#[cfg(feature = "print3d")]
pub(crate) mod instances;
pub(crate) mod label_table;
pub(crate) mod moved_attributes;
pub(crate) mod numbers;
pub(crate) mod partial;
mod partial_subset;
pub(crate) mod point_flags;
pub(crate) mod report;
pub(crate) mod shape;
pub(crate) mod shape_file;
pub(crate) mod source_document;
pub(crate) mod subset;
pub(crate) mod text_rows;
pub(crate) mod texture;
pub(crate) mod turned_faces;
pub(crate) mod units;
#[cfg(feature = "volume")]
pub(crate) mod volume;
