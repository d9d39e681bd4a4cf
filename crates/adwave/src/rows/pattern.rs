//! Pattern of the entries of a sparse matrix, or neighbor lists.

use super::{CompressedRows, RowsError, incidence, rows_at_a_time};
use crate::{Cancelled, Progress};
use std::ops::Range;
use std::sync::Arc;

/// Positions of the entries of a sparse matrix: row `x` has the columns `columns[offsets[x]..offsets[x + 1]]`.
///
/// As a graph, the columns of row `x` are the neighbors of `x`. Copies share the two arrays.
///
/// ```
/// use adwave::rows::{Pattern, RowsError};
/// let path = Pattern::new(vec![0, 1, 3, 4], vec![1, 0, 2, 1], 3)?;
/// assert_eq!((path.n_rows(), path.nnz(), path.row(1)), (3, 4, [0, 2].as_slice()));
/// let wrong = Pattern::new(vec![0, 1], vec![7], 3).unwrap_err();
/// assert_eq!(wrong, RowsError::NoColumn { row: 0, column: 7, n_columns: 3 });
/// # Ok::<(), RowsError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    offsets: Arc<Vec<usize>>,
    columns: Arc<Vec<u32>>,
}

impl Default for Pattern {
    fn default() -> Self {
        Self::empty(0)
    }
}

impl Pattern {
    /// Builds rows from the start of each (and the end of the last) and their columns, all below `n_columns`.
    /// O(entries).
    ///
    /// # Errors
    /// [`RowsError`] if the arrays are inconsistent.
    pub fn new(offsets: Vec<usize>, columns: Vec<u32>, n_columns: usize) -> Result<Self, RowsError> {
        let n_values = columns.len();
        Self::with_values(offsets, columns, n_columns, n_values)
    }

    /// [`new`](Self::new), which also checks that there is one of `n_values` values per entry.
    pub(crate) fn with_values(
        offsets: Vec<usize>,
        columns: Vec<u32>,
        n_columns: usize,
        n_values: usize,
    ) -> Result<Self, RowsError> {
        let (Some(&first), Some(&last)) = (offsets.first(), offsets.last()) else {
            return Err(RowsError::NoOffsets);
        };
        if first != 0 || last != columns.len() || columns.len() != n_values {
            return Err(RowsError::Lengths { first, last, n_columns: columns.len(), n_values });
        }
        if let Some(row) = offsets.windows(2).position(|pair| pair[0] > pair[1]) {
            return Err(RowsError::EndsBeforeStart { row });
        }
        if let Some(at) = columns.iter().position(|&y| y as usize >= n_columns) {
            let row = offsets.partition_point(|&start| start <= at) - 1;
            return Err(RowsError::NoColumn { row, column: columns[at] as usize, n_columns });
        }
        Ok(Self::new_unchecked(offsets, columns))
    }

    /// Wraps rows that are known to be consistent.
    pub(crate) fn new_unchecked(offsets: Vec<usize>, columns: Vec<u32>) -> Self {
        debug_assert!(offsets[0] == 0 && offsets[offsets.len() - 1] == columns.len());
        Self { offsets: Arc::new(offsets), columns: Arc::new(columns) }
    }

    /// A pattern of `n_rows` empty rows.
    pub fn empty(n_rows: usize) -> Self {
        Self::new_unchecked(vec![0; n_rows + 1], Vec::new())
    }

    /// Builds the rows `0..n_rows`; `row(scratch, x, columns)` appends the columns of row `x`.
    pub(crate) fn from_rows<S>(
        n_rows: usize,
        progress: Progress<'_>,
        scratch: impl Fn() -> S + Sync + Send,
        row: impl Fn(&mut S, usize, &mut Vec<u32>) + Sync + Send,
    ) -> Result<Self, Cancelled> {
        let row = |scratch: &mut S, x, columns: &mut Vec<u32>, _: &mut Vec<()>| row(scratch, x, columns);
        CompressedRows::<()>::from_rows(n_rows, rows_at_a_time(n_rows), progress, scratch, row)
            .map(|rows| rows.into_parts().0)
    }

    /// Builds neighbor lists; `row(scratch, x, out)` appends the neighbors of `x` in any order and with
    /// repetitions. They are sorted, and `x` itself is removed.
    pub(crate) fn from_neighbors<S>(
        n_vertices: usize,
        progress: Progress<'_>,
        scratch: impl Fn() -> S + Sync + Send,
        row: impl Fn(&mut S, usize, &mut Vec<u32>) + Sync + Send,
    ) -> Result<Self, Cancelled> {
        let scratch = || (scratch(), Vec::new());
        Self::from_rows(n_vertices, progress, scratch, |(scratch, found), x, columns| {
            found.clear();
            row(scratch, x, found);
            found.sort_unstable();
            found.dedup();
            columns.extend(found.iter().copied().filter(|&y| y as usize != x));
        })
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Number of entries.
    pub fn nnz(&self) -> usize {
        self.columns.len()
    }

    /// Bytes of memory of the two arrays.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.offsets.as_slice()) + size_of_val(self.columns.as_slice())) as u64
    }

    /// Columns of row `x`; in a graph, the neighbors of `x`.
    #[inline]
    pub fn row(&self, x: usize) -> &[u32] {
        &self.columns[self.range(x)]
    }

    /// Range of the entries of row `x` among all entries.
    #[inline]
    pub fn range(&self, x: usize) -> Range<usize> {
        self.offsets[x]..self.offsets[x + 1]
    }

    /// Start of each row and the end of the last one: n_rows + 1 numbers.
    pub fn offsets(&self) -> &[usize] {
        &self.offsets
    }

    /// Columns, row after row.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Offsets and columns; copied if another pattern shares them.
    pub fn into_parts(self) -> (Vec<usize>, Vec<u32>) {
        (Arc::unwrap_or_clone(self.offsets), Arc::unwrap_or_clone(self.columns))
    }

    /// The lists without masked vertices, whose lists become empty and which no other list contains. Vertices
    /// without a flag stay.
    pub(crate) fn remove_masked(&self, masked: &[bool], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let is_masked = |x: usize| masked.get(x).copied().unwrap_or(false);
        Self::from_rows(
            self.n_rows(),
            progress,
            || (),
            |(), x, columns| {
                if !is_masked(x) {
                    columns.extend(self.row(x).iter().filter(|&&y| !is_masked(y as usize)));
                }
            },
        )
    }

    /// Symmetric closure of neighbor lists: `y` is a neighbor of `x` if either list contains the other.
    pub(crate) fn union_with_transpose(&self, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = self.n_rows();
        let transpose = incidence(n, n, progress, |x| self.row(x))?;
        Self::from_neighbors(
            n,
            progress,
            || (),
            |(), x, out| {
                out.extend_from_slice(self.row(x));
                out.extend_from_slice(transpose.row(x));
            },
        )
    }
}
