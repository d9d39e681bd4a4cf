//! Readers and writers.
//!
//! [`read_path`] and [`read_bytes`] find the format from the content first and from the name second, and give a
//! [`ShapeFile`]: points, faces, edges and every attribute as a named [`Field`].

mod error;
mod field;
mod format;
mod grouping;
mod limits;
mod obj_attributes;
mod obj_line;
mod obj_read;
mod original;
mod pcd_read;
mod ply_body;
mod ply_header;
mod ply_read;
mod read;
mod shape_file;
mod sniff;
mod stl_read;
mod text;

pub use error::{ReadError, WriteError};
pub use field::{Field, FieldValues, ValueType};
pub use format::Format;
pub use limits::ReadLimits;
pub use read::{read_bytes, read_path};
pub use shape_file::{Direction, Edges, Precision, ShapeFile};
