//! Gmsh MSH, versions 2 and 4, text and binary.
//!
//! An own reader: `mshio` (0.4) reads version 4.1 alone and no fields, and stops at the first section that it does not know;
//! `gmsh-sys` needs the program itself.

pub(crate) mod elements;
pub(crate) mod fields;
pub(crate) mod input;
pub(crate) mod kinds;
pub(crate) mod nodes;
pub(crate) mod read;
pub(crate) mod write;
