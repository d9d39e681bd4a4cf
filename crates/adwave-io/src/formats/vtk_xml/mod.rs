//! The XML formats of VTK: PolyData (VTP), UnstructuredGrid (VTU), ImageData (VTI), RectilinearGrid (VTR) and
//! StructuredGrid (VTS), as ParaView writes them.
//!
//! An own reader: `vtkio` trusts the counts of a file when it makes room for its arrays, panics on some that are cut, and copies each array
//! three times.

mod array;
mod blocks;
mod document;
mod grid;
pub(crate) mod read;
pub(crate) mod write;
