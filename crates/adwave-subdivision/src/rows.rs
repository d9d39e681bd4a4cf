//! Sparse rows, and products with fields of several channels by chunks of rows.

use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of rows that a thread takes at a time; up to this number the calling thread works alone.
const AT_A_TIME: usize = 4096;

/// Number of rows of a sparse product that a thread computes at a time.
const PRODUCT_ROWS: usize = 2048;

/// Builder of sparse rows, one after another, with their entries in the order of the columns.
#[derive(Debug)]
pub(crate) struct RowBuilder {
    offsets: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl RowBuilder {
    /// Creates a builder without rows.
    pub(crate) fn new() -> Self {
        Self { offsets: vec![0], columns: Vec::new(), values: Vec::new() }
    }

    /// Adds a row; entries of one column are summed, and the entries are sorted.
    pub(crate) fn push_row(&mut self, entries: &mut Vec<Entry>) {
        entries.sort_unstable_by_key(|entry| entry.column);
        let first = self.columns.len();
        for entry in entries.iter() {
            let is_new = self.columns.len() == first;
            match self.values.last_mut() {
                Some(last) if !is_new && self.columns.last() == Some(&entry.column) => *last += entry.value,
                _ => self.push(entry.column, entry.value),
            }
        }
        self.end_row();
        entries.clear();
    }

    /// Adds an entry to the current row, to the right of all its entries.
    pub(crate) fn push(&mut self, column: u32, value: f64) {
        self.columns.push(column);
        self.values.push(value);
    }

    /// Ends the current row.
    pub(crate) fn end_row(&mut self) {
        self.offsets.push(self.columns.len());
    }

    /// Adds the rows of another builder.
    fn append(&mut self, rows: Self) {
        let first = self.columns.len();
        self.offsets.extend(rows.offsets[1..].iter().map(|end| first + end));
        self.columns.extend(rows.columns);
        self.values.extend(rows.values);
    }

    /// Returns the rows, with columns below `n_columns`.
    pub(crate) fn finish(self, n_columns: usize) -> CompressedRows<f64> {
        CompressedRows::new(self.offsets, self.columns, self.values, n_columns)
            .expect("the entries of each row were added in the order of their columns")
    }
}

/// Transpose of a matrix.
pub(crate) fn transpose(rows: &CompressedRows<f64>) -> CompressedRows<f64> {
    let n_columns = rows.n_columns();
    let mut offsets = vec![0_usize; n_columns + 1];
    for &c in rows.columns() {
        offsets[c as usize + 1] += 1;
    }
    for c in 0..n_columns {
        offsets[c + 1] += offsets[c];
    }
    let mut filled = offsets.clone();
    let (mut columns, mut values) = (vec![0; rows.nnz()], vec![0.0; rows.nnz()]);
    for i in 0..rows.n_rows() {
        let (row_columns, row_values) = rows.row(i);
        for (&c, &value) in row_columns.iter().zip(row_values) {
            let at = &mut filled[c as usize];
            (columns[*at], values[*at]) = (i as u32, value);
            *at += 1;
        }
    }
    RowBuilder { offsets, columns, values }.finish(rows.n_rows())
}

/// Square matrix with the given diagonal.
pub(crate) fn from_diagonal(values: &[f64]) -> CompressedRows<f64> {
    let n = values.len();
    let (offsets, columns) = ((0..=n).collect(), (0..n as u32).collect());
    RowBuilder { offsets, columns, values: values.to_vec() }.finish(n)
}

/// Product of two matrices.
pub(crate) fn product(
    left: &CompressedRows<f64>,
    right: &CompressedRows<f64>,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, Cancelled> {
    let n_columns = right.n_columns();
    let chunk = |chunk: usize| -> Result<RowBuilder, Cancelled> {
        progress.check()?;
        let (mut sums, mut is_used, mut used) = (vec![0.0; n_columns], vec![false; n_columns], Vec::new());
        let mut out = RowBuilder::new();
        for i in chunk * PRODUCT_ROWS..((chunk + 1) * PRODUCT_ROWS).min(left.n_rows()) {
            let (columns, values) = left.row(i);
            for (&k, value) in columns.iter().zip(values) {
                let (inner, weights) = right.row(k as usize);
                for (&j, weight) in inner.iter().zip(weights) {
                    if !std::mem::replace(&mut is_used[j as usize], true) {
                        used.push(j);
                    }
                    sums[j as usize] += value * weight;
                }
            }
            used.sort_unstable();
            for j in used.drain(..) {
                out.push(j, std::mem::take(&mut sums[j as usize]));
                is_used[j as usize] = false;
            }
            out.end_row();
        }
        Ok(out)
    };
    let n_chunks = left.n_rows().div_ceil(PRODUCT_ROWS);
    let parts: Result<Vec<RowBuilder>, Cancelled> = if n_chunks <= 1 {
        (0..n_chunks).map(chunk).collect()
    } else {
        (0..n_chunks).into_par_iter().map(chunk).collect()
    };
    let mut all = RowBuilder::new();
    parts?.into_iter().for_each(|part| all.append(part));
    Ok(all.finish(n_columns))
}

/// Returns a symmetric matrix without the entries that are at most `share` times the root of the product of both
/// diagonal entries.
pub(crate) fn without_small(matrix: &CompressedRows<f64>, share: f64) -> CompressedRows<f64> {
    let n = matrix.n_rows();
    let roots: Vec<f64> = (0..n).map(|i| matrix.get(i, i).max(0.0).sqrt()).collect();
    let mut rows = RowBuilder::new();
    for i in 0..n {
        let (columns, values) = matrix.row(i);
        for (&column, &value) in columns.iter().zip(values) {
            if column as usize == i || value.abs() > share * roots[i] * roots[column as usize] {
                rows.push(column, value);
            }
        }
        rows.end_row();
    }
    rows.finish(n)
}

/// Adds `sign` times the product of the matrix with `source` to `target`, both with `d` channels.
pub(crate) fn add_product(
    matrix: &CompressedRows<f64>,
    sign: f64,
    source: &[f64],
    target: &mut [f64],
    d: usize,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    visit_rows(target, d, progress, |first, rows| {
        if d == 1 {
            for (i, value) in (first..).zip(rows) {
                let (columns, values) = matrix.row(i);
                let product: f64 = columns.iter().zip(values).map(|(&c, w)| w * source[c as usize]).sum();
                *value += sign * product;
            }
            return;
        }
        for (i, row) in (first..).zip(rows.chunks_exact_mut(d)) {
            let (columns, values) = matrix.row(i);
            for (&column, weight) in columns.iter().zip(values) {
                let from = &source[column as usize * d..][..d];
                for (value, x) in row.iter_mut().zip(from) {
                    *value += sign * weight * x;
                }
            }
        }
    })
}

/// Entry of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) column: u32,
    pub(crate) value: f64,
}

/// Calls `work(first row, rows)` for chunks of the rows of `values`, `d` values each; stops if the call is cancelled.
/// The size of the chunks does not depend on the number of threads.
pub(crate) fn visit_rows(
    values: &mut [f64],
    d: usize,
    progress: Progress<'_>,
    work: impl Fn(usize, &mut [f64]) + Sync + Send,
) -> Result<(), Cancelled> {
    let size = AT_A_TIME * d.max(1);
    let asked = |(chunk, rows): (usize, &mut [f64])| {
        progress.check()?;
        work(chunk * AT_A_TIME, rows);
        Ok(())
    };
    if values.len() <= size {
        return values.chunks_mut(size).enumerate().try_for_each(asked);
    }
    values.par_chunks_mut(size).enumerate().try_for_each(asked)
}
