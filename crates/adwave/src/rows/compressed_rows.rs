//! Sparse matrices in compressed-row form.

use super::{Pattern, RowsError, rows_at_a_time};
use crate::parallel;
use crate::{Cancelled, Progress};

/// Rows that a thread changes at a time.
const ROWS_OF_BLOCK: usize = 1 << 10;

/// Type of a stored value: `f32` for a basis, `f64` for operators and for the reference basis.
pub trait Value: Copy + Default + Send + Sync + PartialEq + Into<f64> {
    /// The stored value nearest to `value`.
    fn from_f64(value: f64) -> Self;
}

impl Value for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Value for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// A sparse matrix in compressed rows: the entries of row `x` are at `offsets[x]..offsets[x + 1]`, with strictly
/// ascending columns below [`n_columns`](Self::n_columns).
///
/// The arrays are those of SciPy's `csr_matrix` (`indptr`, `indices`, `data`).
///
/// ```
/// use adwave::rows::CompressedRows;
/// let matrix = CompressedRows::new(vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0], 2)?;
/// assert_eq!((matrix.get(0, 1), matrix.get(1, 0)), (2.0, 0.0));
/// let (indptr, indices, data) = matrix.into_scipy()?;
/// assert_eq!((indptr, indices, data), (vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0]));
/// # Ok::<(), adwave::rows::RowsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompressedRows<V = f32> {
    pattern: Pattern,
    values: Vec<V>,
    n_columns: usize,
}

/// Arrays `indptr`, `indices` and `data` of SciPy's `csr_matrix`, with indices of type `I`.
pub type ScipyArrays<I, V> = (Vec<I>, Vec<I>, Vec<V>);

impl<V> CompressedRows<V> {
    /// Builds a matrix with `n_columns` columns from its arrays. O(entries).
    ///
    /// # Errors
    /// [`RowsError`] if the arrays are inconsistent or the columns of a row are not ascending.
    pub fn new(
        offsets: Vec<usize>,
        columns: Vec<u32>,
        values: Vec<V>,
        n_columns: usize,
    ) -> Result<Self, RowsError> {
        let pattern = Pattern::with_values(offsets, columns, n_columns, values.len())?;
        for row in 0..pattern.n_rows() {
            if let Some(pair) = pattern.row(row).windows(2).find(|pair| pair[0] >= pair[1]) {
                return Err(RowsError::NotRising { row, column: pair[1] as usize });
            }
        }
        Ok(Self { pattern, values, n_columns })
    }

    /// Wraps the pattern of a square matrix with one value per entry (or none, for a pattern alone), without checks.
    pub(crate) fn new_unchecked(pattern: Pattern, values: Vec<V>) -> Self {
        debug_assert_eq!(values.len(), pattern.nnz());
        let n_columns = pattern.n_rows();
        Self { pattern, values, n_columns }
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.pattern.n_rows()
    }

    /// Number of columns.
    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.pattern.nnz()
    }

    /// Size of the three arrays in bytes.
    pub fn bytes(&self) -> u64 {
        bytes::<V>(self.n_rows(), self.nnz() as u64)
    }

    /// Pattern of the entries.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Start of each row and the end of the last one: n_rows + 1 numbers.
    pub fn offsets(&self) -> &[usize] {
        self.pattern.offsets()
    }

    /// Columns, row after row.
    pub fn columns(&self) -> &[u32] {
        self.pattern.columns()
    }

    /// Value of each entry.
    pub fn values(&self) -> &[V] {
        &self.values
    }

    /// Value of each entry, mutable.
    pub fn values_mut(&mut self) -> &mut [V] {
        &mut self.values
    }

    /// Calls `work(x, columns, values)` for each row `x`, on all threads.
    ///
    /// ```
    /// use adwave::rows::CompressedRows;
    /// let mut rows = CompressedRows::new(vec![0, 1, 3], vec![1, 0, 1], vec![2.0, 3.0, 4.0], 2)?;
    /// rows.visit_rows_mut(|x, _, values| values.iter_mut().for_each(|v| *v += 10.0 * x as f64));
    /// assert_eq!(rows.values(), [2.0, 13.0, 14.0]);
    /// # Ok::<(), adwave::rows::RowsError>(())
    /// ```
    pub fn visit_rows_mut(&mut self, work: impl Fn(usize, &[u32], &mut [V]) + Sync + Send)
    where
        V: Send,
    {
        let (pattern, n_rows) = (&self.pattern, self.pattern.n_rows());
        let (mut blocks, mut rest) = (Vec::new(), &mut self.values[..]);
        for first in (0..n_rows).step_by(ROWS_OF_BLOCK) {
            let rows = first..(first + ROWS_OF_BLOCK).min(n_rows);
            let n_entries = pattern.offsets()[rows.end] - pattern.offsets()[first];
            let (block, after) = std::mem::take(&mut rest).split_at_mut(n_entries);
            blocks.push((rows, block));
            rest = after;
        }
        let visited = parallel::try_each(blocks, n_rows, Progress::none(), |(rows, mut rest)| {
            for x in rows {
                let (values, after) = rest.split_at_mut(pattern.row(x).len());
                work(x, pattern.row(x), values);
                rest = after;
            }
            Ok(())
        });
        parallel::expect_not_cancelled(visited);
    }

    /// Columns and values of row `x`.
    #[inline]
    pub fn row(&self, x: usize) -> (&[u32], &[V]) {
        let range = self.pattern.range(x);
        (&self.pattern.columns()[range.clone()], &self.values[range])
    }

    /// The pattern and the values.
    pub fn into_parts(self) -> (Pattern, Vec<V>) {
        (self.pattern, self.values)
    }

    /// Arrays `indptr`, `indices` and `data` of SciPy's `csr_matrix`, with its usual index type. Indices and values
    /// keep their memory; only `indptr`, one number per row, may be copied. O(entries).
    ///
    /// # Errors
    /// [`RowsError::TooManyEntries`] beyond 2³¹ − 1 entries or rows; use [`into_scipy_wide`](Self::into_scipy_wide)
    /// then.
    pub fn into_scipy(self) -> Result<ScipyArrays<i32, V>, RowsError> {
        let (nnz, n_rows) = (self.nnz(), self.n_rows());
        if nnz.max(n_rows) > i32::MAX as usize || self.columns().iter().any(|&y| y > i32::MAX as u32) {
            return Err(RowsError::TooManyEntries { nnz, n_rows });
        }
        let (offsets, columns) = self.pattern.into_parts();
        let indptr = offsets.into_iter().map(|offset| offset as i32).collect();
        Ok((indptr, columns.into_iter().map(|y| y as i32).collect(), self.values))
    }

    /// [`into_scipy`](Self::into_scipy) with 64-bit indices, for matrices of any size. O(entries).
    pub fn into_scipy_wide(self) -> ScipyArrays<i64, V> {
        let (offsets, columns) = self.pattern.into_parts();
        let indptr = offsets.into_iter().map(|offset| offset as i64).collect();
        (indptr, columns.into_iter().map(i64::from).collect(), self.values)
    }
}

impl CompressedRows<f64> {
    /// Builds a matrix from entries `value` at `(row, column)`, in ascending order of rows and then columns; repeated
    /// entries are summed in their order. O(entries).
    ///
    /// # Errors
    /// [`RowsError`] for an entry outside the matrix or out of order.
    ///
    /// ```
    /// use adwave::rows::CompressedRows;
    /// let matrix = CompressedRows::from_sorted(2, 2, [(0, 1, 1.0), (0, 1, 0.5), (1, 0, 2.0)])?;
    /// assert_eq!(matrix.row(0), ([1].as_slice(), [1.5].as_slice()));
    /// # Ok::<(), adwave::rows::RowsError>(())
    /// ```
    pub fn from_sorted(
        n_rows: usize,
        n_columns: usize,
        entries: impl IntoIterator<Item = (u32, u32, f64)>,
    ) -> Result<Self, RowsError> {
        let (mut offsets, mut columns, mut values) = (vec![0_usize; n_rows + 1], Vec::new(), Vec::new());
        let mut last: Option<(u32, u32)> = None;
        for (row, column, value) in entries {
            if let (Some(sum), true) = (values.last_mut(), last == Some((row, column))) {
                *sum += value;
                continue;
            }
            let (r, c) = (row as usize, column as usize);
            if r >= n_rows || c >= n_columns {
                return Err(RowsError::NoColumn { row: r, column: c, n_columns });
            }
            if last.is_some_and(|last| last > (row, column)) {
                return Err(RowsError::NotRising { row: r, column: c });
            }
            columns.push(column);
            values.push(value);
            offsets[r + 1] += 1;
            last = Some((row, column));
        }
        // The zeros of a matrix without entries are not touched, so that they take no memory.
        let n_summed = if columns.is_empty() { 0 } else { n_rows };
        for x in 0..n_summed {
            offsets[x + 1] += offsets[x];
        }
        Ok(Self { pattern: Pattern::new_unchecked(offsets, columns), values, n_columns })
    }
}

impl<V: Value> CompressedRows<V> {
    /// The identity matrix with `n_rows` rows.
    pub fn identity(n_rows: usize) -> Self {
        let pattern = Pattern::new_unchecked((0..=n_rows).collect(), (0..n_rows as u32).collect());
        Self::new_unchecked(pattern, vec![V::from_f64(1.0); n_rows])
    }

    /// Entry at row `x` and column `y`; 0 if none is stored. O(log entries of the row).
    pub fn get(&self, x: usize, y: usize) -> V {
        let (columns, values) = self.row(x);
        columns.binary_search(&(y as u32)).map_or(V::default(), |at| values[at])
    }

    /// The difference `self − other`; its pattern is the union of both.
    pub(crate) fn minus(&self, other: &Self, progress: Progress<'_>) -> Result<Self, Cancelled> {
        Self::from_rows(
            self.n_rows(),
            256,
            progress,
            || (),
            |(), x, columns, values| {
                let (fine, coarse) = (self.row(x).into(), other.row(x).into());
                subtract(fine, coarse, columns, values);
            },
        )
    }

    /// The matrix whose row and column `new_of[x]` are row and column `x` of this one. O(nnz log(nnz / rows)).
    ///
    /// # Panics
    /// If `new_of` is not a permutation of the rows.
    #[must_use]
    pub fn permute(&self, new_of: &[u32]) -> Self {
        assert_eq!(new_of.len(), self.n_rows(), "one new number for each row");
        let mut old_of = vec![u32::MAX; new_of.len()];
        for (&new, old) in new_of.iter().zip(0..) {
            assert!(old_of[new as usize] == u32::MAX, "row {new} would come from two rows");
            old_of[new as usize] = old;
        }
        let (n, at_a_time) = (self.n_rows(), rows_at_a_time(self.n_rows()));
        let row = |entries: &mut Vec<(u32, V)>, x: usize, columns: &mut Vec<u32>, values: &mut Vec<V>| {
            let (old_columns, old_values) = self.row(old_of[x] as usize);
            entries.clear();
            entries.extend(old_columns.iter().map(|&y| new_of[y as usize]).zip(old_values.iter().copied()));
            entries.sort_unstable_by_key(|e| e.0);
            columns.extend(entries.iter().map(|e| e.0));
            values.extend(entries.iter().map(|e| e.1));
        };
        parallel::expect_not_cancelled(Self::from_rows(n, at_a_time, Progress::none(), Vec::new, row))
    }
}

/// Bytes of a matrix with `n_rows` rows and `nnz` entries.
pub(crate) fn bytes<V>(n_rows: usize, nnz: u64) -> u64 {
    nnz * (size_of::<u32>() + size_of::<V>()) as u64 + (n_rows as u64 + 1) * size_of::<usize>() as u64
}

/// Entries of a sparse row.
#[derive(Clone, Copy)]
pub(crate) struct RowView<'a, V> {
    /// Columns, ascending.
    pub(crate) columns: &'a [u32],
    pub(crate) values: &'a [V],
}

impl<'a, V> From<(&'a [u32], &'a [V])> for RowView<'a, V> {
    fn from(row: (&'a [u32], &'a [V])) -> Self {
        Self { columns: row.0, values: row.1 }
    }
}

/// Appends the entries of the sparse row `fine − coarse`, each rounded once. For rows that sum to 1 the result sums
/// to 0: `Σ_y Ψ_j(x,y) = 0` (eq. 9).
pub(crate) fn subtract<V: Value>(
    fine: RowView<'_, V>,
    coarse: RowView<'_, V>,
    columns: &mut Vec<u32>,
    values: &mut Vec<V>,
) {
    let (mut i, mut k) = (0, 0);
    while i < fine.columns.len() || k < coarse.columns.len() {
        // A finished row counts as positioned after every column.
        let (a, b) = (fine.columns.get(i), coarse.columns.get(k));
        let Some(column) = a.into_iter().chain(b).copied().min() else { break };
        let mut value = 0.0;
        if a == Some(&column) {
            value += fine.values[i].into();
            i += 1;
        }
        if b == Some(&column) {
            value -= coarse.values[k].into();
            k += 1;
        }
        columns.push(column);
        values.push(V::from_f64(value));
    }
}
