//! Readers and writers.
//!
//! [`read_path`] and [`read_bytes`] identify the format by the content first and by the name second, and return a
//! [`ShapeFile`]: points, faces, edges and every attribute as a named [`Field`]. [`write_path`] and [`write_bytes`]
//! write it; writing in the original format loses nothing but the changed content, and for another format a
//! [`WriteReport`] lists what it cannot store.
//!
//! [`LasReader`] and [`LasWriter`] process the points of a LAS or LAZ in blocks, for scans that do not fit in memory.
//! [`read_cloud_part`] reads the points of a COPC, EPT, LAS or LAZ in a box, and for the first two only the levels
//! needed for a resolution.
//!
//! [`Format::markdown_list`] lists the content read, written, kept and lost by each format; `docs/FORMATS.md` contains
//! it. Arrays are read from NPY and written as NPY and NPZ. Lists of edges and matrices that are too large for a shape
//! are read as streams into sparse rows: [`read_edge_rows`], [`read_matrix_market`], [`open_text`].
//!
//! [`read_gltf_animation`] and [`write_glb_animation`] read and write shapes that move, as morph targets of a glTF.
//!
//! All files may be compressed by gzip.
//!
//! # Map
//!
//! | room | content |
//! |---|---|
//! | `error`, `format`, `limits`, `progress` | errors, the id of a format, bounds on reading, progress and cancellation |
//! | `text`, `bytes`, `files` | lines, words and numbers of texts; numbers of binary files; files read and replaced |
//! | `model` | what was read, fields, subsets; the description of a format; helpers that formats share |
//! | `formats` | a folder per format, and the one table |
//! | `registry` | formats by content and by name; reading and writing |
//! | `mesh_stream`, `cloud_part`, `texture` | meshes in portions, parts of clouds, colors of pictures |
//! | `selection` | the vertices that take part, by fields, masks and flags |
//! | `signal`, `region_field`, `recipe`, `provenance` | signals and fields by name, edits as TOML, the origin of a result |
//!
//! # Features
//!
//! OBJ, PLY, STL, OFF, rows of numbers (XYZ, PTS, CSV) and NPY are always there. The other formats belong to features,
//! all of them default: `grid`, `las`, `gltf`, `vtk`, `neuro`, `e57`, `pcd`, `volume`, `graph`, `print3d`, `more`, and
//! `texture` for colors of pictures.

// Headers are a few lines of text; `write!` into a string would return an error that cannot occur.
#![allow(clippy::format_push_string, clippy::format_collect)]
// Counts are below 2^32 before they become signed.
#![allow(clippy::cast_possible_wrap)]
// Builds without some formats leave the helpers of those unused.
#![cfg_attr(not(feature = "default"), allow(dead_code))]

mod bytes;
#[cfg(feature = "las")]
mod cloud_part;
mod error;
mod files;
mod format;
mod formats;
mod labels;
mod limits;
mod mesh_stream;
mod model;
mod pose;
mod progress;
mod provenance;
mod recipe;
mod region_field;
mod registry;
mod selection;
mod signal;
mod text;
#[cfg(feature = "texture")]
mod texture;
mod transaction;
mod unknown;

#[cfg(feature = "las")]
pub use cloud_part::{read_cloud_part, read_cloud_part_with};
pub use error::{ReadError, WriteError};
pub use files::atomic::{atomic_write, atomic_write_with, remove_temporaries};
pub use format::Format;
#[cfg(feature = "neuro")]
pub use formats::cifti::write::{CiftiColumns, CiftiPart, write_cifti_fields, write_cifti_parts};
pub use formats::csv::read::{
    CsvMatrix, parse_csv_fields, read_csv_fields, read_csv_fields_with, read_csv_matrix,
};
pub use formats::csv::write::{write_csv_fields, write_csv_fields_with};
#[cfg(feature = "more")]
pub use formats::dmat::read::{parse_dmat_field, read_dmat_field};
#[cfg(feature = "neuro")]
pub use formats::freesurfer::annotation::write_annotation;
#[cfg(feature = "neuro")]
pub use formats::gifti::read::{parse_gifti_fields, read_gifti_fields, read_gifti_fields_with};
#[cfg(feature = "neuro")]
pub use formats::gifti::write::{write_gifti_fields, write_gifti_fields_with};
#[cfg(feature = "gltf")]
pub use formats::gltf::animation::ShapeFrames;
#[cfg(feature = "graph")]
pub use formats::graph::edge_rows::{EdgeRows, read_edge_rows};
#[cfg(feature = "las")]
pub use formats::las::fields::is_flagged_record;
#[cfg(feature = "las")]
pub use formats::las::part::{CloudLevels, CloudPart, cloud_levels};
#[cfg(feature = "las")]
pub use formats::las::stream::{LasColumn, LasLayout, LasReader, LasWriter};
#[cfg(feature = "graph")]
pub use formats::mtx::rows::read_matrix_market;
#[cfg(feature = "graph")]
pub use formats::mtx::write::{write_matrix_market, write_matrix_market_with};
#[cfg(feature = "grid")]
pub use formats::nifti::series::{SeriesVolume, VolumeSeries, VolumeSeriesWriter};
pub use formats::npy::columns::{NpyColumns, NpyColumnsWriter};
pub use formats::npy::read::{NpyArray, read_npy, read_npy_bytes, read_npy_with};
pub use formats::npy::write::{
    ArrayValues, Compression, MatrixValue, NpzWriter, write_npy, write_npz, write_sparse_npz,
};
pub use labels::{distinct_labels, labels_of_field};
pub use limits::{ReadLimits, free_memory};
pub use mesh_stream::{MeshReader, VertexColumn, VertexEdit, rewrite_mesh};
pub use model::brain_layout::{BRAIN_VALUES, BrainLayout, BrainPart, BrainPlaces};
pub use model::face_cells::FaceCells;
pub use model::field::{COORDS, Field, FieldValues, ValueType};
pub use model::graph_changes::GraphChanges;
pub use model::grid_layout::{GRID_VALUES, GridLayout};
pub use model::label_table::{LabelEntry, LabelTable};
pub use model::moved_attributes::{MovedAttributes, MovedNormals};
pub use model::partial::FileRows;
pub use model::point_flags::{NOISE_CLASSES, WITHHELD_FLAG};
pub use model::report::WriteReport;
pub use model::shape::{ShapeFileError, ShapeKind};
pub use model::shape_file::{CoordinatePrecision, Direction, Edges, ShapeFile, ShapeParts};
pub use model::subset::{CornerValues, Subset};
pub use model::texture::TextureError;
pub use model::units::{CoordinateSystem, CoordinateSystemKind, LengthUnit};
pub use pose::{DetailClone, Pose, PoseHandle};
pub use provenance::{Provenance, ProvenanceInput};
pub use recipe::{Recipe, parse_recipe, read_recipe, recipe_to_text, write_recipe};
pub use region_field::region_field;
#[cfg(feature = "gltf")]
pub use registry::animation::{read_gltf_animation, write_glb_animation};
pub use registry::read::{read_bytes, read_bytes_with, read_path, read_path_with};
pub use registry::values::{parse_surface_values, read_surface_values, rewrite_values};
pub use registry::write::{write_bytes, write_bytes_with, write_path, write_path_with};
pub use selection::{
    ClosedInterval, FieldCondition, FieldConditionError, FlaggedPoints, MaskFile, MaskSide, SelectedShape,
    Selection, SelectionError,
};
pub use signal::{
    DEGREE, NamedSignal, NamedSignalError, SignalSource, SignalValues, default_signal, file_normals,
    keep_left_out_values, named_axis, named_signal, with_axis, written_signal,
};
pub use text::csv::{csv_number, push_csv_row};
pub use text::stream::open_text;
#[cfg(feature = "texture")]
pub use texture::texture_colors;
pub use transaction::Transaction;
pub use unknown::{UnknownValue, describe_unknown, mark_unknown};
