//! NumPy arrays: `.npy` read and written, whole or by columns, `.npz` written.
//!
//! Library: `zip` for the archive; the header of an array is read here. `npyz` (0.9) reads values one after another and
//! into the type of the file alone (`<i8` and `|u1` not as numbers), with a parser generator for a header of one line.

pub(crate) mod columns;
#[cfg(feature = "grid")]
pub(crate) mod grid;
pub(crate) mod read;
pub(crate) mod write;
