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
//! [`Format::table`] lists the content read, written, kept and lost by each format; `docs/FORMATS.md` contains it.
//! Arrays are read from NPY and written as NPY and NPZ.
//!
//! All files may be compressed by gzip.
//!
//! # Map
//!
//! | where | what |
//! |---|---|
//! | `read`, `write` | a path or bytes, the format found or chosen |
//! | `sniff`, `format`, `limits`, `error` | which format, its names, how much a file may ask for, what went wrong |
//! | `shape_file`, `shape` | what was read, and the shape that it is |
//! | `field`, `grouping` | values per vertex or face; columns as fields and back |
//! | `cells`, `volume`, `instances` | cells of grids and volumes, and the surface around them; objects that are placed several times |
//! | `original`, `binary_rows` | the bytes of a file that is written again with other coordinates |
//! | `ply`, `obj`, `off`, `stl`, `columns`, `pcd`, `las`, `mtx`, `gifti`, `gltf`, `e57`, `vtk_xml`, `vtk_legacy`, `freesurfer`, `msh`, `medit`, `amf`, `threemf`, `dmat`, `graph`, `geomview` | a folder per format: `read`, `write`, and what only this format needs |
//! | `npy`, `csv` | arrays and tables as fields, and written |
//! | `cifti`, `surface_values` | values at the vertices of a surface, in files of their own |
//! | `single` | what 32-bit floats and triangles hold, for formats of such |
//! | `subset` | a file with fewer vertices |
//! | `signal` | signals by name: fields, what the shape gives itself, other files |
//! | `texture` | colors of pictures at vertices |
//! | `recipe` | edits as TOML |
//! | `region_field` | fields that a region may name |
//! | `atomic` | files replaced as a whole |
//! | `progress` | how far reading and writing are, and whether to stop |
//! | `numbers` | arrays of numbers, binary or text, as lists |
//! | `text`, `lines`, `tokens`, `encoding`, `cursor` | numbers, words and lines of text formats; numbers of binary ones |
//! | `xml`, `package` | documents of XML, and ZIP archives |

// Headers are a few lines of text; `write!` into a string would return an error that cannot occur.
#![allow(clippy::format_push_string, clippy::format_collect)]
// Counts are below 2^32 where they become signed.
#![allow(clippy::cast_possible_wrap)]

mod bytes;
mod error;
mod files;
mod formats;
mod limits;
mod mesh_stream;
mod model;
mod progress;
mod provenance;
mod recipe;
mod region_field;
mod registry;
mod signal;
mod text;
mod texture;

pub use error::{ReadError, WriteError};
pub use files::atomic::{atomic_write, atomic_write_with, remove_temporaries, write_together};
pub use formats::csv::read::{parse_csv_fields, read_csv_fields, read_csv_fields_with};
pub use formats::csv::write::{csv_number, push_csv_row, write_csv_fields};
pub use formats::dmat::read::{parse_dmat_field, read_dmat_field};
pub use formats::gifti::read::{parse_gifti_fields, read_gifti_fields, read_gifti_fields_with};
pub use formats::gifti::write::{write_gifti_fields, write_gifti_fields_with};
pub use formats::las::part::{CloudLevels, CloudPart, cloud_levels, read_cloud_part, read_cloud_part_with};
pub use formats::las::stream::{LasLayout, LasReader, LasWriter};
pub use formats::mtx::write::{MatrixValues, SparseRows, write_matrix_market, write_matrix_market_with};
pub use formats::npy::read::{NpyArray, read_npy, read_npy_bytes, read_npy_with};
pub use formats::npy::write::{ArrayValues, Compression, NpzWriter, write_npy, write_npz, write_sparse_npz};
pub use limits::ReadLimits;
pub use mesh_stream::{MeshReader, VertexEdit, rewrite_mesh};
pub use model::field::{Field, FieldValues, ValueType};
pub use model::shape::{ShapeFileError, ShapeKind};
pub use model::shape_file::{Direction, Edges, Precision, ShapeFile, ShapeParts};
pub use model::subset::Subset;
pub use provenance::{Provenance, ProvenanceInput};
pub use recipe::{Levels, Recipe, parse_recipe, read_recipe, recipe_to_text, write_recipe};
pub use region_field::region_field;
pub use registry::format::Format;
pub use registry::read::{read_bytes, read_bytes_with, read_path, read_path_with};
pub use registry::surface_values::{parse_surface_values, read_surface_values};
pub use registry::write::{WriteReport, write_bytes, write_bytes_with, write_path, write_path_with};
pub use signal::{
    COORDS, DEGREE, NamedSignal, NamedSignalError, SignalSource, SignalValues, default_signal, file_normals,
    named_axis, named_signal, with_axis, written_signal,
};
pub use texture::{TextureError, texture_colors};
