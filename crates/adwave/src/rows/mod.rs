//! Compressed sparse rows (CSR): the one form in which sparse matrices and lists of neighbors are stored.
//!
//! [`Pattern`] says which entries there are, [`CompressedRows`] has a value for each. Both check their arrays when they are
//! built and keep them private, so that a product may index by them without looking again.

mod build;
mod compressed_rows;
mod incidence;
mod pattern;
#[cfg(test)]
mod tests;

pub(crate) use build::{rows_at_a_time, try_for_entries};
pub(crate) use compressed_rows::bytes;
pub(crate) use compressed_rows::subtract;
pub use compressed_rows::{CompressedRows, ScipyArrays, Value};
pub(crate) use incidence::incidence;
pub use pattern::Pattern;

use crate::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Why some arrays are no compressed rows, or compressed rows do not fit where they should go.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RowsError {
    /// Not even the start of the first row is given.
    #[error("there are no offsets; a matrix without rows has the one offset 0")]
    NoOffsets,
    /// The arrays are of lengths that do not belong together.
    #[error("offsets run from {first} to {last}, for {n_columns} columns and {n_values} values")]
    Lengths {
        /// First offset.
        first: usize,
        /// Last offset.
        last: usize,
        /// How many columns are given.
        n_columns: usize,
        /// How many values are given.
        n_values: usize,
    },
    /// An offset is smaller than the one before it.
    #[error("row {row} ends before it starts")]
    EndsBeforeStart {
        /// The row, from 0.
        row: usize,
    },
    /// A column that the matrix does not have.
    #[error("row {row} names column {column} of {n_columns}")]
    NoColumn {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
        /// Number of columns.
        n_columns: usize,
    },
    /// Columns of a row do not rise, or one stands twice.
    #[error(
        "row {row} names column {column} after one that is not smaller; sort its entries and sum those that repeat"
    )]
    NotRising {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
    },
    /// More entries than an index of SciPy's 32-bit form can count.
    #[error(
        "{nnz} entries in {n_rows} rows are more than a 32-bit index can count; take the form of 64-bit indices"
    )]
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
