//! Compressed sparse rows (CSR), the common form of sparse matrices and neighbor lists.
//!
//! [`Pattern`] holds the positions of the entries, and [`CompressedRows`] a value for each. Both check their arrays
//! on construction and keep them private, so a product may index them without further checks.

mod build;
mod compressed_rows;
mod incidence;
mod pattern;
#[cfg(test)]
mod tests;

pub(crate) use build::{rows_at_a_time, try_visit_entries};
pub(crate) use compressed_rows::bytes;
pub(crate) use compressed_rows::subtract;
pub use compressed_rows::{CompressedRows, ScipyArrays, Value};
pub(crate) use incidence::incidence;
pub use pattern::Pattern;

use crate::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Error of building or converting compressed rows.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowsError {
    /// The list of offsets is empty.
    #[error("the list of offsets is empty; a matrix without rows has the single offset 0")]
    NoOffsets,
    /// The arrays have inconsistent lengths.
    #[error("offsets run from {first} to {last}, for {n_columns} columns and {n_values} values")]
    Lengths {
        /// First offset.
        first: usize,
        /// Last offset.
        last: usize,
        /// Number of columns given.
        n_columns: usize,
        /// Number of values given.
        n_values: usize,
    },
    /// An offset is smaller than the one before it.
    #[error("row {row} ends before it starts")]
    EndsBeforeStart {
        /// The row, from 0.
        row: usize,
    },
    /// A column is outside the matrix.
    #[error("row {row} names column {column} of {n_columns}")]
    NoColumn {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
        /// Number of columns.
        n_columns: usize,
    },
    /// Columns of a row are not strictly ascending.
    #[error(
        "row {row} names column {column} after one that is not smaller; sort its entries and sum those that repeat"
    )]
    NotRising {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
    },
    /// There are more entries than SciPy's 32-bit index can count.
    #[error("{nnz} entries in {n_rows} rows exceed a 32-bit index; use 64-bit indices")]
    TooManyEntries {
        /// Number of entries.
        nnz: usize,
        /// Number of rows.
        n_rows: usize,
    },
}

impl ClassifiedError for RowsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooManyEntries { .. } => ErrorKind::Memory,
            _ => ErrorKind::Input,
        }
    }
}
