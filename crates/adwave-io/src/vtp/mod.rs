//! VTK XML PolyData, written only.

pub(crate) mod write;
