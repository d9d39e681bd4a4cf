//! Legacy VTK, text and binary, versions 1 to 5.1: surfaces, unstructured grids and grids of all kinds; written as binary
//! PolyData of version 4.2, which everything that reads the format knows.
//!
//! An own reader: `vtkio` trusts the counts of a file when it makes room for its arrays, and stops at what it does not know.

mod arrays;
mod cells;
pub(crate) mod read;
mod scanner;
pub(crate) mod write;
