//! Symmetric sparse matrices in compressed rows.

use super::LinalgError;
use adwave::rows::CompressedRows;
use rayon::prelude::*;

/// Number of rows per task of a thread.
const ROWS_AT_A_TIME: usize = 2048;

/// Symmetric matrix with both halves stored. The columns of each row are in ascending order, and the diagonal is always
/// present.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    rows: CompressedRows<f64>,
}

impl SymmetricMatrix {
    /// Builds the matrix of `n` rows with `Σ value` at `(row, column)` and `(column, row)`. Each entry off the diagonal
    /// is given once, in either half; repeated entries are summed. O(entries · log).
    ///
    /// # Errors
    /// [`LinalgError::OutOfRange`], [`LinalgError::NotFinite`].
    ///
    /// ```
    /// use adwave_baselines::linalg::SymmetricMatrix;
    /// let path = SymmetricMatrix::from_halves(2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0)])?;
    /// assert_eq!(path.product(&[3.0, 1.0]), [2.0, -2.0]);
    /// # Ok::<(), adwave_baselines::linalg::LinalgError>(())
    /// ```
    pub fn from_halves(n: usize, entries: &[(u32, u32, f64)]) -> Result<Self, LinalgError> {
        let mut all = Vec::with_capacity(2 * entries.len() + n);
        for &(row, column, value) in entries {
            let (r, c) = (row as usize, column as usize);
            if r >= n || c >= n {
                return Err(LinalgError::OutOfRange { row: r, column: c, n });
            }
            if !value.is_finite() {
                return Err(LinalgError::NotFinite { row: r, column: c, value });
            }
            all.push((row, column, value));
            if row != column {
                all.push((column, row, value));
            }
        }
        all.extend((0..n as u32).map(|x| (x, x, 0.0)));
        // The sort is stable, so that both halves sum in the same order and are bit-identical.
        all.par_sort_by_key(|e| (e.0, e.1));
        let Ok(rows) = CompressedRows::from_sorted(n, n, all) else {
            unreachable!("the entries have been checked and sorted")
        };
        Ok(Self { rows })
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.rows.n_rows()
    }

    /// Number of stored entries: both halves and the diagonal.
    pub fn nnz(&self) -> usize {
        self.rows.nnz()
    }

    /// Returns the columns of row `x`, in ascending order, and their values.
    pub fn row(&self, x: usize) -> (&[u32], &[f64]) {
        self.rows.row(x)
    }

    /// Entry at (`x`, `y`); 0 if none is stored.
    pub fn get(&self, x: usize, y: usize) -> f64 {
        self.rows.get(x, y)
    }

    /// Diagonal of the matrix.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.n()).map(|x| self.get(x, x)).collect()
    }

    /// Computes `y = A x`. O(entries).
    pub fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        self.product_into(x, &mut y, 1);
        y
    }

    /// Computes `y = A x` for `n_channels` channels, n × n_channels, row-major. O(entries × channels).
    ///
    /// # Panics
    /// Unless `x` and `y` are both n × n_channels.
    pub fn product_into(&self, x: &[f64], y: &mut [f64], n_channels: usize) {
        assert_eq!(x.len(), self.n() * n_channels, "x is n × n_channels");
        assert_eq!(y.len(), x.len(), "y is as long as x");
        match n_channels {
            0 => {}
            1 => self.product_fixed::<1>(x, y),
            3 => self.product_fixed::<3>(x, y),
            8 => self.product_fixed::<8>(x, y),
            d => y.par_chunks_mut(ROWS_AT_A_TIME * d).enumerate().for_each(|(chunk, rows)| {
                for (r, out) in rows.chunks_exact_mut(d).enumerate() {
                    out.fill(0.0);
                    let (columns, values) = self.row(chunk * ROWS_AT_A_TIME + r);
                    for (&column, &a) in columns.iter().zip(values) {
                        for (out, &x) in out.iter_mut().zip(&x[column as usize * d..][..d]) {
                            *out += a * x;
                        }
                    }
                }
            }),
        }
    }

    fn product_fixed<const D: usize>(&self, x: &[f64], y: &mut [f64]) {
        let x = x.as_chunks::<D>().0;
        y.as_chunks_mut::<D>().0.par_chunks_mut(ROWS_AT_A_TIME).enumerate().for_each(|(chunk, rows)| {
            for (r, out) in rows.iter_mut().enumerate() {
                let (columns, values) = self.row(chunk * ROWS_AT_A_TIME + r);
                *out = [0.0; D];
                for (&column, &a) in columns.iter().zip(values) {
                    let x = &x[column as usize];
                    for c in 0..D {
                        out[c] += a * x[c];
                    }
                }
            }
        });
    }

    /// Computes `D A D` for the diagonal matrix D of `scale`. O(entries).
    ///
    /// # Panics
    /// Unless there is one factor per row.
    #[must_use]
    pub fn scale_symmetrically(&self, scale: &[f64]) -> Self {
        assert_eq!(scale.len(), self.n(), "scale has one factor per row");
        let mut scaled = self.clone();
        let values = scaled.rows.values_mut();
        for x in 0..self.n() {
            for k in self.rows.pattern().range(x) {
                // Grouped so that both halves round equally.
                values[k] *= scale[x] * scale[self.rows.columns()[k] as usize];
            }
        }
        scaled
    }

    /// Computes `A + D` for the diagonal matrix D of `diagonal`. O(entries).
    ///
    /// # Panics
    /// Unless there is one value per row.
    #[must_use]
    pub fn add_diagonal(&self, diagonal: &[f64]) -> Self {
        assert_eq!(diagonal.len(), self.n(), "diagonal has one value per row");
        let mut sum = self.clone();
        for (x, &d) in diagonal.iter().enumerate() {
            let start = self.rows.offsets()[x];
            let k = self.row(x).0.binary_search(&(x as u32)).expect("the diagonal is stored");
            sum.rows.values_mut()[start + k] += d;
        }
        sum
    }

    /// Finds the connected component of each row, by its nonzero entries, and the number of components.
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut label = vec![u32::MAX; self.n()];
        let (mut stack, mut count) = (Vec::new(), 0);
        for start in 0..self.n() {
            if label[start] != u32::MAX {
                continue;
            }
            label[start] = count;
            stack.push(start);
            while let Some(x) = stack.pop() {
                let (columns, values) = self.row(x);
                for (&y, &a) in columns.iter().zip(values) {
                    if a != 0.0 && label[y as usize] == u32::MAX {
                        label[y as usize] = count;
                        stack.push(y as usize);
                    }
                }
            }
            count += 1;
        }
        (label, count as usize)
    }

    /// Returns the submatrix of the rows and columns `kept` (ascending). O(entries).
    pub(crate) fn submatrix(&self, kept: &[u32]) -> Self {
        let mut place = vec![u32::MAX; self.n()];
        for (new, &old) in kept.iter().enumerate() {
            place[old as usize] = new as u32;
        }
        let entries = kept.iter().zip(0..).flat_map(|(&old, new)| {
            let (columns, values) = self.row(old as usize);
            let renamed = columns.iter().map(|&column| place[column as usize]).zip(values);
            renamed
                .filter(|&(column, _)| column != u32::MAX)
                .map(move |(column, &value)| (new, column, value))
        });
        let Ok(rows) = CompressedRows::from_sorted(kept.len(), kept.len(), entries) else {
            unreachable!("rows and columns stay in ascending order")
        };
        Self { rows }
    }

    /// Converts the matrix to a dense one, column-major.
    pub(crate) fn to_dense(&self) -> Vec<f64> {
        let n = self.n();
        let mut dense = vec![0.0; n * n];
        for x in 0..n {
            let (columns, values) = self.row(x);
            for (&y, &a) in columns.iter().zip(values) {
                dense[x * n + y as usize] = a;
            }
        }
        dense
    }
}
