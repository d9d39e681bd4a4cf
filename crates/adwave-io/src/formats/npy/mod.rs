//! NumPy arrays: `.npy` read and written, `.npz` written.

pub(crate) mod read;
pub(crate) mod write;
