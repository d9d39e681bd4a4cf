//! Readers and writers.
//!
//! [`read_path`] and [`read_bytes`] find the format from the content first and from the name second, and give a
//! [`ShapeFile`]: points, faces, edges and every attribute as a named [`Field`]. [`write_path`] and [`write_bytes`]
//! write it; in the format that it came from nothing is lost but what was changed, in another format a
//! [`WriteReport`] names what did not fit.
//!
//! | format | read | write | keeps the original |
//! |---|---|---|---|
//! | OBJ | yes | yes | all text |
//! | PLY text, binary in both byte orders | yes | yes | header, elements, properties |
//! | OFF, COFF, NOFF, STOFF, … | text | yes | all text |
//! | STL text, binary | yes | yes | header, normals, attributes |
//! | XYZ, TXT, PTS, PWN, CSV | yes | yes | all text |
//! | PCD text, binary, compressed | yes | text, binary | text; view point and image size |
//! | LAS, LAZ | yes | yes | header, records, what no field shows |
//! | MatrixMarket (as a graph) | coordinates | yes | – |
//! | GIFTI | yes | yes, in 32-bit floats | metadata, encodings, all other text |
//! | VTP | no | yes | – |
//! | NPY, NPZ (as arrays) | NPY | yes | – |
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
//! | `original` | the bytes of a text that is written again with other coordinates |
//! | `ply`, `obj`, `off`, `stl`, `columns`, `pcd`, `las`, `mtx`, `gifti`, `vtp` | a folder per format: `read`, `write`, and what only this format needs |
//! | `npy`, `csv` | arrays and tables as fields, and written |
//! | `subset` | a file with fewer vertices |
//! | `signal` | signals by name: fields, what the shape gives itself, other files |
//! | `texture` | colours of pictures at vertices |
//! | `recipe` | edits as TOML |
//! | `region_field` | fields that a region may name |
//! | `atomic` | files replaced as a whole |
//! | `progress` | how far reading and writing are, and whether to stop |
//! | `text`, `lines` | numbers, words and lines of text formats |

// Headers are a few lines of text; `write!` into a string would bring an error that cannot happen.
#![allow(clippy::format_push_string, clippy::format_collect)]
// Counts are below 2^32 where they become signed.
#![allow(clippy::cast_possible_wrap)]

mod atomic;
mod columns;
mod csv;
mod error;
mod field;
mod format;
mod gifti;
mod grouping;
mod las;
mod limits;
mod lines;
mod mtx;
mod npy;
mod obj;
mod off;
mod original;
mod pcd;
mod ply;
mod progress;
mod read;
mod recipe;
mod region_field;
mod shape;
mod shape_file;
mod signal;
mod sniff;
mod stl;
mod subset;
mod text;
mod texture;
mod vtp;
mod write;

pub use atomic::{atomic_write, atomic_write_with, remove_temporaries};
pub use csv::read::{parse_csv_fields, read_csv_fields, read_csv_fields_with};
pub use csv::write::{csv_number, push_csv_row, write_csv_fields};
pub use error::{ReadError, WriteError};
pub use field::{Field, FieldValues, ValueType};
pub use format::Format;
pub use gifti::read::{parse_gifti_fields, read_gifti_fields, read_gifti_fields_with};
pub use gifti::write::{write_gifti_fields, write_gifti_fields_with};
pub use limits::ReadLimits;
pub use mtx::write::{MatrixValues, SparseRows, write_matrix_market, write_matrix_market_with};
pub use npy::read::{NpyArray, read_npy, read_npy_bytes, read_npy_with};
pub use npy::write::{ArrayValues, Compression, NpzWriter, write_npy, write_npz, write_sparse_npz};
pub use read::{read_bytes, read_bytes_with, read_path, read_path_with};
pub use recipe::{Levels, Recipe, parse_recipe, read_recipe, recipe_to_text, write_recipe};
pub use region_field::region_field;
pub use shape::{ShapeFileError, ShapeKind};
pub use shape_file::{Direction, Edges, Precision, ShapeFile, ShapeParts};
pub use signal::{
    COORDS, DEGREE, NamedSignal, NamedSignalError, SignalSource, SignalValues, default_signal, file_normals,
    named_axis, named_signal, with_axis, written_signal,
};
pub use subset::Subset;
pub use texture::{TextureError, texture_colors};
pub use write::{WriteReport, write_bytes, write_bytes_with, write_path, write_path_with};
