//! Gmsh MSH, versions 2 and 4, text and binary.
//!
//! The reader is our own: `mshio` (0.4) reads only version 4.1 without fields and stops at the first unknown section;
//! `gmsh-sys` needs the program itself.

pub(crate) mod elements;
pub(crate) mod fields;
pub(crate) mod input;
pub(crate) mod kinds;
pub(crate) mod nodes;
pub(crate) mod read;
pub(crate) mod write;
