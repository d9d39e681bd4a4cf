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
//! | LAS, LAZ | yes | no | – |
//! | MatrixMarket (as a graph) | coordinates | yes | – |
//! | VTP | no | yes | – |
//! | NPY, NPZ (as arrays) | NPY | yes | – |
//!
//! All may be compressed by gzip.

// Headers are a few lines of text; `write!` into a string would bring an error that cannot happen.
#![allow(clippy::format_push_string, clippy::format_collect)]
// Counts are below 2^32 where they become signed.
#![allow(clippy::cast_possible_wrap)]

mod atomic;
mod columns_meaning;
mod columns_read;
mod columns_write;
mod csv_fields;
mod error;
mod field;
mod format;
mod gifti_read;
mod grouping;
mod las_fields;
mod las_read;
mod laz_check;
mod limits;
mod lines;
mod lzf;
mod mtx_read;
mod mtx_write;
mod npy_read;
mod npz_write;
mod obj_attributes;
mod obj_line;
mod obj_read;
mod obj_write;
mod off_read;
mod off_write;
mod original;
mod pcd_read;
mod pcd_write;
mod ply_body;
mod ply_header;
mod ply_read;
mod ply_update;
mod ply_write;
mod read;
mod recipe;
mod shape_file;
mod sniff;
mod stl_read;
mod stl_write;
mod text;
mod texture;
mod vtp_write;
mod write;

pub use atomic::{atomic_write, remove_temporaries};
pub use csv_fields::{parse_csv_fields, read_csv_fields};
pub use error::{ReadError, WriteError};
pub use field::{Field, FieldValues, ValueType};
pub use format::Format;
pub use gifti_read::read_gifti_fields;
pub use limits::ReadLimits;
pub use mtx_write::{CompressedRows, MatrixValues, write_matrix_market};
pub use npy_read::{NpyArray, read_npy, read_npy_bytes};
pub use npz_write::{ArrayValues, Compression, NpzWriter, write_npy, write_npz, write_sparse_npz};
pub use read::{read_bytes, read_path};
pub use recipe::{Levels, Recipe, parse_recipe, read_recipe, recipe_to_text, write_recipe};
pub use shape_file::{Direction, Edges, Precision, ShapeFile};
pub use texture::{TextureError, texture_colors};
pub use write::{WriteReport, write_bytes, write_path};
