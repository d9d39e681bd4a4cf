//! The XML formats of VTK: PolyData (VTP), UnstructuredGrid (VTU), ImageData (VTI), RectilinearGrid (VTR) and
//! StructuredGrid (VTS), as written by ParaView.
//!
//! The reader is our own: `vtkio` trusts the counts of a file when it allocates its arrays, panics on some truncated
//! files, and copies each array three times.

mod array;
mod blocks;
mod document;
mod grid;
pub(crate) mod read;
pub(crate) mod write;
