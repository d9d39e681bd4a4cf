//! Sparse matrices to be written.

use crate::WriteError;
use crate::text::push_f32;
use crate::text::push_f64;

/// Borrowed sparse matrix in compressed rows: row `i` has the columns `indices[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct SparseRows<'a> {
    /// Number of columns.
    pub n_columns: usize,
    /// Start of each row, and the end of the last.
    pub offsets: &'a [usize],
    /// Column of each entry.
    pub indices: &'a [u32],
    /// Value of each entry.
    pub values: MatrixValues<'a>,
}

/// Borrowed values of a matrix.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // the names are the types
#[non_exhaustive]
pub enum MatrixValues<'a> {
    F32(&'a [f32]),
    F64(&'a [f64]),
}

impl MatrixValues<'_> {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// True if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes value `i` as text: the shortest decimal that reads back to the same value of its type.
    pub(crate) fn write_text(&self, i: usize, out: &mut Vec<u8>) {
        match self {
            Self::F32(v) => push_f32(out, v[i]),
            Self::F64(v) => push_f64(out, v[i]),
        }
    }
}

impl SparseRows<'_> {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Checks that the lists are consistent.
    pub(crate) fn check(&self) -> Result<(), WriteError> {
        let n = self.values.len();
        let is_sound = self.indices.len() == n
            && self.offsets.is_sorted()
            && self.offsets.first().is_none_or(|&first| first == 0)
            && self.offsets.last().copied().unwrap_or(0) == n;
        if is_sound {
            return Ok(());
        }
        let shape = vec![self.n_rows(), self.n_columns];
        Err(WriteError::ArrayShape { name: "of sparse rows".into(), found: n as u64, shape })
    }
}
