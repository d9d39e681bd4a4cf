//! Sparse rows, and products with fields of several channels by chunks of rows.

use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of rows up to which the calling thread works alone, and number that a thread takes at a time.
const AT_A_TIME: usize = 4096;

/// Number of rows of a sparse product that a thread computes at a time.
const PRODUCT_ROWS: usize = 2048;

/// Sparse rows with their entries in the order of the columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct SparseRows {
    pub(crate) offsets: Vec<u32>,
    pub(crate) columns: Vec<u32>,
    pub(crate) values: Vec<f64>,
}

impl SparseRows {
    /// No rows.
    pub(crate) fn new() -> Self {
        Self { offsets: vec![0], ..Self::default() }
    }

    /// Adds a row; entries of one column are summed, and the entries are sorted.
    pub(crate) fn push_row(&mut self, entries: &mut Vec<Entry>) {
        entries.sort_unstable_by_key(|entry| entry.column);
        for entry in entries.iter() {
            let is_new = self.columns.len() == self.offsets[self.n_rows()] as usize;
            match self.values.last_mut() {
                Some(last) if !is_new && self.columns.last() == Some(&entry.column) => *last += entry.value,
                _ => {
                    self.columns.push(entry.column);
                    self.values.push(entry.value);
                }
            }
        }
        self.offsets.push(self.columns.len() as u32);
        entries.clear();
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Columns and values of a row.
    pub(crate) fn row(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[i] as usize..self.offsets[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    /// The transpose, with `n_columns` rows.
    pub(crate) fn transpose(&self, n_columns: usize) -> Self {
        let mut offsets = vec![0_u32; n_columns + 1];
        for &c in &self.columns {
            offsets[c as usize + 1] += 1;
        }
        for c in 0..n_columns {
            offsets[c + 1] += offsets[c];
        }
        let mut filled = offsets.clone();
        let (mut columns, mut values) = (vec![0; self.columns.len()], vec![0.0; self.values.len()]);
        for i in 0..self.n_rows() {
            let (row_columns, row_values) = self.row(i);
            for (&c, &value) in row_columns.iter().zip(row_values) {
                let at = &mut filled[c as usize];
                (columns[*at as usize], values[*at as usize]) = (i as u32, value);
                *at += 1;
            }
        }
        Self { offsets, columns, values }
    }

    /// The identity with the given diagonal.
    pub(crate) fn from_diagonal(values: &[f64]) -> Self {
        let n = values.len() as u32;
        Self { offsets: (0..=n).collect(), columns: (0..n).collect(), values: values.to_vec() }
    }

    /// Entry on the diagonal of a row.
    pub(crate) fn diagonal(&self, i: usize) -> f64 {
        let (columns, values) = self.row(i);
        columns.binary_search(&(i as u32)).map_or(0.0, |k| values[k])
    }

    /// Product with rows of `n_columns` columns.
    pub(crate) fn product(
        &self,
        other: &Self,
        n_columns: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let chunk = |chunk: usize| -> Result<Self, Cancelled> {
            progress.check()?;
            let (mut sums, mut is_used, mut used) =
                (vec![0.0; n_columns], vec![false; n_columns], Vec::new());
            let mut out = Self::new();
            for i in chunk * PRODUCT_ROWS..((chunk + 1) * PRODUCT_ROWS).min(self.n_rows()) {
                let (columns, values) = self.row(i);
                for (&k, value) in columns.iter().zip(values) {
                    let (inner, weights) = other.row(k as usize);
                    for (&j, weight) in inner.iter().zip(weights) {
                        if !std::mem::replace(&mut is_used[j as usize], true) {
                            used.push(j);
                        }
                        sums[j as usize] += value * weight;
                    }
                }
                used.sort_unstable();
                for j in used.drain(..) {
                    out.columns.push(j);
                    out.values.push(std::mem::take(&mut sums[j as usize]));
                    is_used[j as usize] = false;
                }
                out.offsets.push(out.columns.len() as u32);
            }
            Ok(out)
        };
        let n_chunks = self.n_rows().div_ceil(PRODUCT_ROWS);
        let parts: Result<Vec<Self>, Cancelled> = if n_chunks <= 1 {
            (0..n_chunks).map(chunk).collect()
        } else {
            (0..n_chunks).into_par_iter().map(chunk).collect()
        };
        let mut all = Self::new();
        for part in parts? {
            let first = all.columns.len() as u32;
            all.offsets.extend(part.offsets[1..].iter().map(|end| first + end));
            all.columns.extend(part.columns);
            all.values.extend(part.values);
        }
        Ok(all)
    }

    /// These rows of a symmetric matrix without entries below a share of the root of both diagonal entries.
    pub(crate) fn without_small(&self, share: f64) -> Self {
        let roots: Vec<f64> = (0..self.n_rows()).map(|i| self.diagonal(i).max(0.0).sqrt()).collect();
        let mut rows = Self::new();
        for i in 0..self.n_rows() {
            let (columns, values) = self.row(i);
            for (&column, &value) in columns.iter().zip(values) {
                if column as usize == i || value.abs() > share * roots[i] * roots[column as usize] {
                    rows.columns.push(column);
                    rows.values.push(value);
                }
            }
            rows.offsets.push(rows.columns.len() as u32);
        }
        rows
    }

    /// Adds `sign` times the product with `source` to `target`, both with `d` channels.
    pub(crate) fn add_product(
        &self,
        sign: f64,
        source: &[f64],
        target: &mut [f64],
        d: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        visit_rows(target, d, progress, |first, rows| {
            if d == 1 {
                for (i, value) in (first..).zip(rows) {
                    let (columns, values) = self.row(i);
                    let product: f64 = columns.iter().zip(values).map(|(&c, w)| w * source[c as usize]).sum();
                    *value += sign * product;
                }
                return;
            }
            for (i, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                let (columns, values) = self.row(i);
                for (&column, weight) in columns.iter().zip(values) {
                    let from = &source[column as usize * d..][..d];
                    for (value, x) in row.iter_mut().zip(from) {
                        *value += sign * weight * x;
                    }
                }
            }
        })
    }
}

/// An entry of a row that is being built.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) column: u32,
    pub(crate) value: f64,
}

/// Calls `work(first row, rows)` for chunks of the rows of `values`, `d` values each, whose size does not depend on the number
/// of threads; stops if the call is cancelled.
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
