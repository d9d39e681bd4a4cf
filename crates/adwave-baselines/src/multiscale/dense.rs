//! Dense matrices, column-major, and their rank-revealing factorization.

use super::MultiscaleError;
use crate::linalg::{LinalgError, add_product, gram};
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{MatMut, MatRef, Par};

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dense {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) values: Vec<f64>,
}

impl Dense {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    pub(super) fn identity(n: usize) -> Self {
        let mut one = Self::zeros(n, n);
        for i in 0..n {
            *one.get_mut(i, i) = 1.0;
        }
        one
    }

    pub(super) fn get(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.rows + i]
    }

    pub(super) fn get_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.values[j * self.rows + i]
    }

    pub(super) fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..][..self.rows]
    }

    /// Computes `self · other`.
    pub(super) fn multiply(&self, other: &Self) -> Self {
        let mut product = Self::zeros(self.rows, other.columns);
        add_product(self.rows, &mut product.values, 1.0, &self.values, &other.values);
        product
    }

    /// Computes `selfᵀ · other`.
    pub(super) fn transpose_multiply(&self, other: &Self) -> Self {
        Self {
            rows: self.columns,
            columns: other.columns,
            values: gram(self.rows, &self.values, &other.values),
        }
    }

    /// Computes `self · x`.
    pub(super) fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.rows];
        add_product(self.rows, &mut y, 1.0, &self.values, x);
        y
    }

    /// Computes `selfᵀ · x`.
    pub(super) fn apply_transposed(&self, x: &[f64]) -> Vec<f64> {
        gram(self.rows, &self.values, x)
    }

    /// Scales every column that is not 0 to length 1.
    pub(super) fn normalize_columns(&mut self) {
        for column in self.values.chunks_exact_mut(self.rows.max(1)) {
            let length = column.iter().map(|v| v * v).sum::<f64>().sqrt();
            if length > 0.0 {
                for v in column {
                    *v /= length;
                }
            }
        }
    }

    /// Largest entry of `|selfᵀ·other − I|`.
    pub(super) fn defect(&self, other: &Self) -> f64 {
        let product = self.transpose_multiply(other);
        let entry = |i: usize, j: usize| (product.get(i, j) - f64::from(u8::from(i == j))).abs();
        (0..product.columns)
            .flat_map(|j| (0..product.rows).map(move |i| (i, j)))
            .map(|(i, j)| entry(i, j))
            .fold(0.0, f64::max)
    }
}

/// Factorization `A P = Q R`, truncated at a precision.
pub(super) struct RankRevealing {
    /// Orthonormal basis of the chosen columns.
    pub(super) q: Dense,
    /// Orthonormal basis of the orthogonal complement of the chosen columns.
    pub(super) complement: Dense,
    /// Upper triangular factor; the chosen columns of A are `q r`.
    pub(super) r: Dense,
    /// Chosen columns of A, in the order of the columns of R.
    pub(super) chosen: Vec<usize>,
}

/// Computes the QR factorization with column pivoting, stopped when the remainder of every column is below `precision`.
/// O(n³).
pub(super) fn rank_revealing(a: &Dense, precision: f64) -> Result<RankRevealing, MultiscaleError> {
    let n = a.rows;
    if a.values.iter().any(|v| !v.is_finite()) {
        return Err(LinalgError::DenseEigen { n }.into());
    }
    let qr = MatRef::from_column_major_slice(&a.values, n, a.columns).col_piv_qr();
    let full_r = qr.thin_R();
    let rank = (0..n.min(a.columns)).take_while(|&k| full_r[(k, k)].abs() > precision).count().max(1).min(n);
    let full_q = qr.compute_Q();
    let columns = |range: std::ops::Range<usize>| Dense {
        rows: n,
        columns: range.len(),
        values: range.flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| full_q[(i, j)]).collect(),
    };
    let mut r = Dense::zeros(rank, rank);
    for j in 0..rank {
        for i in 0..=j {
            *r.get_mut(i, j) = full_r[(i, j)];
        }
    }
    let chosen = qr.P().arrays().0[..rank].to_vec();
    Ok(RankRevealing { q: columns(0..rank), complement: columns(rank..n), r, chosen })
}

/// Computes `Q R^(−T)`, whose columns are dual to those of `Q R`.
pub(super) fn dual(q: &Dense, r: &Dense) -> Dense {
    // R⁻¹ Qᵀ, transposed afterwards.
    let mut x = Dense::zeros(q.columns, q.rows);
    for j in 0..q.rows {
        for i in 0..q.columns {
            *x.get_mut(i, j) = q.get(j, i);
        }
    }
    solve_upper_triangular_in_place(
        MatRef::from_column_major_slice(&r.values, r.rows, r.columns),
        MatMut::from_column_major_slice_mut(&mut x.values, q.columns, q.rows),
        Par::Seq,
    );
    let mut dual = Dense::zeros(q.rows, q.columns);
    for j in 0..q.rows {
        for i in 0..q.columns {
            *dual.get_mut(j, i) = x.get(i, j);
        }
    }
    dual
}
