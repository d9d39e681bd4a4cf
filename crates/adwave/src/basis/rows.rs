//! Sparse matrices by compressed rows, the form in which a basis is stored.

use rayon::prelude::*;

/// A stored value: `f32` for the basis, `f64` for the reference.
pub trait Value: Copy + Default + Send + Sync + PartialEq + Into<f64> {
    /// The nearest stored value.
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

/// A square sparse matrix: the entries of row `x` are at `offsets[x]..offsets[x + 1]`, by rising column, each once.
///
/// The arrays are those of SciPy's `csr_matrix` (`indptr`, `indices`, `data`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompressedRows<V = f32> {
    /// Where each row starts, and the end of the last: one more than there are rows.
    pub offsets: Vec<usize>,
    /// The columns, row after row.
    pub columns: Vec<u32>,
    /// The value of each entry.
    pub values: Vec<V>,
}

/// Rows that a thread treats at a time; no result depends on it.
pub(super) const ROWS_AT_A_TIME: usize = 256;

impl<V: Value> CompressedRows<V> {
    /// The identity of `n_rows` rows.
    pub fn identity(n_rows: usize) -> Self {
        Self {
            offsets: (0..=n_rows).collect(),
            columns: (0..n_rows as u32).collect(),
            values: vec![V::from_f64(1.0); n_rows],
        }
    }

    /// Number of rows, which is the number of columns.
    pub fn n_rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.columns.len()
    }

    /// Size of the three arrays in bytes.
    pub fn bytes(&self) -> u64 {
        bytes::<V>(self.n_rows(), self.nnz() as u64)
    }

    /// Columns and values of row `x`.
    pub fn row(&self, x: usize) -> (&[u32], &[V]) {
        let range = self.offsets[x]..self.offsets[x + 1];
        (&self.columns[range.clone()], &self.values[range])
    }

    /// The entry of row `x` and column `y`, 0 where none is stored. O(log entries of the row).
    pub fn get(&self, x: usize, y: usize) -> V {
        let (columns, values) = self.row(x);
        columns.binary_search(&(y as u32)).map_or(V::default(), |at| values[at])
    }

    /// Builds the rows `0..n_rows` in parallel; `row(scratch, x, columns, values)` appends the entries of row `x`.
    ///
    /// The matrix lies in memory twice while its parts are put together.
    pub(super) fn from_rows<S>(
        n_rows: usize,
        scratch: impl Fn() -> S + Sync + Send,
        row: impl Fn(&mut S, usize, &mut Vec<u32>, &mut Vec<V>) + Sync + Send,
    ) -> Self {
        let parts: Vec<(Vec<usize>, Vec<u32>, Vec<V>)> = (0..n_rows.div_ceil(ROWS_AT_A_TIME))
            .into_par_iter()
            .map_init(scratch, |scratch, part| {
                let (mut ends, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
                for x in part * ROWS_AT_A_TIME..((part + 1) * ROWS_AT_A_TIME).min(n_rows) {
                    row(scratch, x, &mut columns, &mut values);
                    ends.push(columns.len());
                }
                (ends, columns, values)
            })
            .collect();
        let nnz = parts.iter().map(|(_, columns, _)| columns.len()).sum();
        let mut matrix = Self {
            offsets: Vec::with_capacity(n_rows + 1),
            columns: Vec::with_capacity(nnz),
            values: Vec::with_capacity(nnz),
        };
        matrix.offsets.push(0);
        for (ends, columns, values) in parts {
            let start = matrix.columns.len();
            matrix.offsets.extend(ends.into_iter().map(|end| start + end));
            matrix.columns.extend_from_slice(&columns);
            matrix.values.extend_from_slice(&values);
        }
        matrix
    }

    /// `self − other`, entry by entry: the pattern is the union of both.
    pub(super) fn minus(&self, other: &Self) -> Self {
        Self::from_rows(
            self.n_rows(),
            || (),
            |(), x, columns, values| subtract(self.row(x), other.row(x), columns, values),
        )
    }

    /// The matrix whose row and column `new_of[x]` are row and column `x` of this one. O(nnz log(nnz / rows)).
    ///
    /// # Panics
    /// When `new_of` is no permutation of the rows.
    #[must_use]
    pub fn permuted(&self, new_of: &[u32]) -> Self {
        assert_eq!(new_of.len(), self.n_rows(), "one new number for each row");
        let mut old_of = vec![u32::MAX; new_of.len()];
        for (&new, old) in new_of.iter().zip(0..) {
            assert!(old_of[new as usize] == u32::MAX, "row {new} would come from two rows");
            old_of[new as usize] = old;
        }
        Self::from_rows(self.n_rows(), Vec::new, |entries: &mut Vec<(u32, V)>, x, columns, values| {
            let (old_columns, old_values) = self.row(old_of[x] as usize);
            entries.clear();
            entries.extend(old_columns.iter().map(|&y| new_of[y as usize]).zip(old_values.iter().copied()));
            entries.sort_unstable_by_key(|e| e.0);
            columns.extend(entries.iter().map(|e| e.0));
            values.extend(entries.iter().map(|e| e.1));
        })
    }
}

/// Bytes of a matrix of `n_rows` rows and `nnz` entries.
pub(super) fn bytes<V>(n_rows: usize, nnz: u64) -> u64 {
    nnz * (size_of::<u32>() + size_of::<V>()) as u64 + (n_rows as u64 + 1) * size_of::<usize>() as u64
}

/// Appends the entries of the sparse row `fine − coarse`; where both have an entry the difference is rounded once.
pub(super) fn subtract<V: Value>(
    fine: (&[u32], &[V]),
    coarse: (&[u32], &[V]),
    columns: &mut Vec<u32>,
    values: &mut Vec<V>,
) {
    let (mut i, mut k) = (0, 0);
    while i < fine.0.len() || k < coarse.0.len() {
        // A finished row counts as standing beyond every column.
        let (a, b) = (fine.0.get(i), coarse.0.get(k));
        let column = a.into_iter().chain(b).copied().min().expect("one of the two rows goes on");
        let mut value = 0.0;
        if a == Some(&column) {
            value += fine.1[i].into();
            i += 1;
        }
        if b == Some(&column) {
            value -= coarse.1[k].into();
            k += 1;
        }
        columns.push(column);
        values.push(V::from_f64(value));
    }
}
