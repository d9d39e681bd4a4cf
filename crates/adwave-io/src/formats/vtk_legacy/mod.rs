//! Legacy VTK, text and binary, versions 1 to 5.1: surfaces, unstructured grids and structured grids of all kinds;
//! written as binary PolyData of version 4.2, which all readers of the format support.
//!
//! The reader is our own: `vtkio` trusts the counts of a file when it allocates its arrays, and stops at unknown
//! content.

mod arrays;
mod cells;
pub(crate) mod read;
mod scanner;
pub(crate) mod write;
