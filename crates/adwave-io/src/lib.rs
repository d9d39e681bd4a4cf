//! Readers and writers.
//!
//! [`read_path`] and [`read_bytes`] find the format from the content first and from the name second, and give a
//! [`ShapeFile`]: points, faces, edges and every attribute as a named [`Field`]. [`write_path`] and [`write_bytes`]
//! write it; in the format that it came from nothing is lost but what was changed, in another format a
//! [`WriteReport`] names what did not fit.
//!
//! [`LasReader`] and [`LasWriter`] take the points of a LAS or LAZ in portions, for scans that do not fit in memory.
//! [`read_cloud_part`] reads what lies in a box of a COPC, EPT, LAS or LAZ, and of the first two no more levels than a resolution needs.
//!
//! [`Format::table`] says what is read, written, kept and lost of each format; `docs/FORMATS.md` has it. Arrays are read from NPY and
//! written as NPY and NPZ.
//!
//! All may be compressed by gzip.
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

// Headers are a few lines of text; `write!` into a string would bring an error that cannot happen.
#![allow(clippy::format_push_string, clippy::format_collect)]
// Counts are below 2^32 where they become signed.
#![allow(clippy::cast_possible_wrap)]

mod amf;
mod atomic;
mod binary_rows;
mod cells;
mod cifti;
mod columns;
mod csv;
mod cursor;
mod dmat;
mod e57;
mod encoding;
mod error;
mod field;
mod format;
mod freesurfer;
mod geomview;
mod gifti;
mod gltf;
mod graph;
mod grouping;
mod instances;
mod las;
mod limits;
mod lines;
mod medit;
mod mesh_stream;
mod msh;
mod mtx;
mod npy;
mod numbers;
mod obj;
mod off;
mod original;
mod package;
mod pcd;
mod ply;
mod progress;
mod provenance;
mod read;
mod recipe;
mod region_field;
mod shape;
mod shape_file;
mod signal;
mod single;
mod sniff;
mod stl;
mod subset;
mod surface_values;
mod text;
mod texture;
mod threemf;
mod tokens;
mod transaction;
mod volume;
mod vtk_legacy;
mod vtk_xml;
mod write;
mod xml;

pub use atomic::{atomic_write, atomic_write_with, remove_temporaries};
pub use csv::read::{parse_csv_fields, read_csv_fields, read_csv_fields_with};
pub use csv::write::{csv_number, push_csv_row, write_csv_fields};
pub use dmat::read::{parse_dmat_field, read_dmat_field};
pub use error::{ReadError, WriteError};
pub use field::{Field, FieldValues, ValueType};
pub use format::Format;
pub use gifti::read::{parse_gifti_fields, read_gifti_fields, read_gifti_fields_with};
pub use gifti::write::{write_gifti_fields, write_gifti_fields_with};
pub use las::part::{CloudLevels, CloudPart, cloud_levels, read_cloud_part, read_cloud_part_with};
pub use las::stream::{LasLayout, LasReader, LasWriter};
pub use limits::{ReadLimits, free_memory};
pub use mesh_stream::{MeshReader, VertexEdit, rewrite_mesh};
pub use mtx::write::{MatrixValues, SparseRows, write_matrix_market, write_matrix_market_with};
pub use npy::read::{NpyArray, read_npy, read_npy_bytes, read_npy_with};
pub use npy::write::{ArrayValues, Compression, NpzWriter, write_npy, write_npz, write_sparse_npz};
pub use provenance::{Provenance, ProvenanceInput};
pub use read::{read_bytes, read_bytes_with, read_path, read_path_with};
pub use recipe::{Recipe, parse_recipe, read_recipe, recipe_to_text, write_recipe};
pub use region_field::region_field;
pub use shape::{ShapeFileError, ShapeKind};
pub use shape_file::{Direction, Edges, Precision, ShapeFile, ShapeParts};
pub use signal::{
    COORDS, DEGREE, NamedSignal, NamedSignalError, SignalSource, SignalValues, default_signal, file_normals,
    named_axis, named_signal, with_axis, written_signal,
};
pub use subset::Subset;
pub use surface_values::{parse_surface_values, read_surface_values};
pub use texture::{TextureError, texture_colors};
pub use transaction::Transaction;
pub use write::{WriteReport, write_bytes, write_bytes_with, write_path, write_path_with};
