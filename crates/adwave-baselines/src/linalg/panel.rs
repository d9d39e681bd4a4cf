//! Tall dense matrices, one vector per column, and their products in chunks of rows.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Number of rows per chunk; partial products are summed in the order of the chunks.
const ROWS_AT_A_TIME: usize = 4096;

/// Matrix of columns of length `n`, column-major.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) n: usize,
    pub(super) values: Vec<f64>,
}

impl Panel {
    pub(super) fn new(n: usize) -> Self {
        Self { n, values: Vec::new() }
    }

    pub(super) fn n_columns(&self) -> usize {
        self.values.len() / self.n.max(1)
    }

    pub(super) fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.n..][..self.n]
    }

    pub(super) fn columns(&self, range: std::ops::Range<usize>) -> &[f64] {
        &self.values[range.start * self.n..range.end * self.n]
    }

    pub(super) fn truncate(&mut self, n_columns: usize) {
        self.values.truncate(n_columns * self.n);
    }
}

/// Computes `AᵀB`, column-major, for `a` and `b` with columns of length `n`.
pub(crate) fn gram(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let (p, q) = (a.len() / n.max(1), b.len() / n.max(1));
    let mut sum = vec![0.0; p * q];
    if p * q == 0 {
        return sum;
    }
    let (a, b) = (MatRef::from_column_major_slice(a, n, p), MatRef::from_column_major_slice(b, n, q));
    let parts: Vec<Vec<f64>> = (0..n.div_ceil(ROWS_AT_A_TIME))
        .into_par_iter()
        .map(|piece| {
            let start = piece * ROWS_AT_A_TIME;
            let rows = ROWS_AT_A_TIME.min(n - start);
            let mut part = vec![0.0; p * q];
            matmul(
                MatMut::from_column_major_slice_mut(&mut part, p, q),
                Accum::Replace,
                a.subrows(start, rows).transpose(),
                b.subrows(start, rows),
                1.0,
                Par::Seq,
            );
            part
        })
        .collect();
    for part in parts {
        for (s, value) in sum.iter_mut().zip(part) {
            *s += value;
        }
    }
    sum
}

/// Computes `B += factor · A C`, where `c` is column-major with as many rows as A has columns.
pub(crate) fn add_product(n: usize, b: &mut [f64], factor: f64, a: &[f64], c: &[f64]) {
    let (p, q) = (a.len() / n.max(1), b.len() / n.max(1));
    debug_assert_eq!(c.len(), p * q);
    if p * q == 0 {
        return;
    }
    let a = MatRef::from_column_major_slice(a, n, p);
    let c = MatRef::from_column_major_slice(c, p, q);
    let mut pieces = Vec::with_capacity(n.div_ceil(ROWS_AT_A_TIME));
    let mut rest = MatMut::from_column_major_slice_mut(b, n, q);
    while rest.nrows() > ROWS_AT_A_TIME {
        let (piece, after) = rest.split_at_row_mut(ROWS_AT_A_TIME);
        pieces.push(piece);
        rest = after;
    }
    pieces.push(rest);
    pieces.into_par_iter().enumerate().for_each(|(piece, out)| {
        let rows = out.nrows();
        matmul(out, Accum::Add, a.subrows(piece * ROWS_AT_A_TIME, rows), c, factor, Par::Seq);
    });
}

/// Euclidean norm, bit-identical on any number of threads.
pub(super) fn norm(x: &[f64]) -> f64 {
    x.par_chunks(ROWS_AT_A_TIME)
        .map(|c| c.iter().map(|v| v * v).sum::<f64>())
        .collect::<Vec<_>>()
        .iter()
        .sum::<f64>()
        .sqrt()
}
