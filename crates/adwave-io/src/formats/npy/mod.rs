//! NumPy arrays: `.npy` read and written, `.npz` written.
//!
//! Library: `zip` for the archive; the header of an array is read here.

pub(crate) mod read;
pub(crate) mod write;
