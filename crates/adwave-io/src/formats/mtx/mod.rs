//! MatrixMarket coordinate matrices: read as graphs, written from graphs and from sparse matrices.

pub(crate) mod read;
pub(crate) mod write;
