//! The diffusion Φ₁: one step of the lazy walk.

use super::LocalOperator;
use crate::shape::Adjacency;
use rayon::prelude::*;
use thiserror::Error;

/// How far the sum of a given row may be from 1 and still be taken as rounding.
const ROW_SUM_TOLERANCE: f64 = 1e-12;

/// Why a matrix is no diffusion.
#[derive(Debug, Error, PartialEq)]
pub enum DiffusionError {
    /// An entry is negative, NaN or infinite.
    #[error("entry ({row}, {column}) of the walk is {value}; probabilities are finite and at least 0")]
    BadEntry {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A row is not a probability distribution.
    #[error("row {row} of the walk sums to {sum}, not to 1; divide it by its sum")]
    RowSum {
        /// The row.
        row: usize,
        /// Its sum.
        sum: f64,
    },
    /// The compressed rows do not fit together.
    #[error("the compressed rows of the walk do not fit together: {0}")]
    Layout(String),
}

/// One step of the lazy walk, `Φ₁ = [T]_r = ½I + ½Q`, as its off-diagonal entries; the diagonal is what is missing from 1.
///
/// Rows sum to 1 by construction and all entries are ≥ 0. A reversible Φ₁ is similar to a symmetric matrix and, being
/// lazy, has its eigenvalues in [0, 1].
#[derive(Clone, Debug)]
pub struct Diffusion {
    neighbours: Adjacency,
    weights: Vec<f64>,
    stationary: Vec<f64>,
    step_length: f64,
    is_reversible: bool,
}

impl Diffusion {
    /// Φ₁ of a local operator (eq. 4–5): `Φ₁(x,y) = T(x,y) / 2Σ_z T(x,z)`, `Φ₁(x,x) = ½`; an identity row where T has an
    /// empty one. O(entries).
    ///
    /// # Panics
    /// When the rows of the operator do not fit together, which those of [`local_operator`](super::local_operator) do.
    pub fn new(operator: LocalOperator) -> Self {
        let LocalOperator { neighbours, values, log_factor, areas, mean_square, is_reversible, .. } =
            operator;
        let n = neighbours.n_vertices();
        // Products index by these without looking again.
        assert!(
            neighbours.offsets[0] == 0
                && neighbours.offsets.is_sorted()
                && neighbours.offsets[n] == neighbours.neighbours.len()
                && values.len() == neighbours.neighbours.len()
                && neighbours.neighbours.iter().all(|&y| (y as usize) < n),
            "the neighbours of a local operator are vertices of it, one value each"
        );
        let mut weights = values;
        let row_sum: Vec<f64> = (0..n)
            .into_par_iter()
            .with_min_len(4096)
            .map(|x| weights[neighbours.offsets[x]..neighbours.offsets[x + 1]].iter().sum())
            .collect();
        for x in 0..n {
            if row_sum[x] > 0.0 {
                for w in &mut weights[neighbours.offsets[x]..neighbours.offsets[x + 1]] {
                    *w /= 2.0 * row_sum[x];
                }
            }
        }
        // π(x) ∝ A(x)·Σ_z A(z)k(x,z), in logarithms: where distances differ much the kernel itself underflows.
        let log_pi = |x: usize| areas[x].ln() + log_factor[x] + row_sum[x].ln();
        let top = crate::parallel::max(n, f64::NEG_INFINITY, log_pi);
        let mut stationary: Vec<f64> = if top.is_finite() {
            (0..n).into_par_iter().with_min_len(4096).map(|x| (log_pi(x) - top).exp()).collect()
        } else {
            vec![1.0; n] // nothing moves: every law is stationary, the uniform one as good as any
        };
        let total = crate::parallel::sum(n, |x| stationary[x]);
        for p in &mut stationary {
            *p /= total;
        }
        let step_square = crate::parallel::sum(n, |x| stationary[x] * 0.5 * mean_square[x]);
        Self { neighbours, weights, stationary, step_length: step_square.sqrt(), is_reversible }
    }

    /// A walk given by its own matrix: compressed rows with or without their diagonal, every row summing to 1.
    ///
    /// The law π is taken as uniform and a step as of length 1; the walk counts as not reversible, so that no method
    /// relies on a real spectrum.
    ///
    /// # Errors
    /// [`DiffusionError`] when the rows do not fit together, an entry is negative or not finite, or a row does not sum to
    /// 1 within 1e-12.
    ///
    /// ```
    /// use adwave::operator::{Diffusion, DiffusionError};
    /// let walk = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.25, 0.75])?;
    /// assert_eq!(walk.diagonal(1), 0.75);
    /// let wrong = Diffusion::from_rows(&[0, 1, 2], &[1, 0], &[1.0, 0.5]);
    /// assert_eq!(wrong.unwrap_err(), DiffusionError::RowSum { row: 1, sum: 0.5 });
    /// # Ok::<(), DiffusionError>(())
    /// ```
    pub fn from_rows(offsets: &[usize], columns: &[u32], values: &[f64]) -> Result<Self, DiffusionError> {
        let layout = |what: String| Err(DiffusionError::Layout(what));
        let Some(n) = offsets.len().checked_sub(1) else { return layout("there are no offsets".into()) };
        if offsets[0] != 0 || offsets[n] != columns.len() || columns.len() != values.len() {
            return layout(format!(
                "offsets run from {} to {}, for {} columns and {} values",
                offsets[0],
                offsets[n],
                columns.len(),
                values.len()
            ));
        }
        if let Some(row) = (0..n).find(|&row| offsets[row] > offsets[row + 1]) {
            return layout(format!("row {row} ends before it starts"));
        }
        let mut neighbours = Adjacency { offsets: vec![0], neighbours: Vec::new() };
        let mut weights = Vec::new();
        for row in 0..n {
            let mut entries = Vec::new();
            for k in offsets[row]..offsets[row + 1] {
                let (column, value) = (columns[k] as usize, values[k]);
                if column >= n {
                    return layout(format!("row {row} names column {column} of {n}"));
                }
                if !(value.is_finite() && value >= 0.0) {
                    return Err(DiffusionError::BadEntry { row, column, value });
                }
                entries.push((columns[k], value));
            }
            let sum: f64 = entries.iter().map(|e| e.1).sum();
            if (sum - 1.0).abs() > ROW_SUM_TOLERANCE {
                return Err(DiffusionError::RowSum { row, sum });
            }
            entries.sort_by_key(|e| e.0);
            for (column, value) in entries.into_iter().filter(|e| e.0 as usize != row) {
                let fresh = neighbours.neighbours.len() == neighbours.offsets[row]
                    || neighbours.neighbours.last() != Some(&column);
                if fresh {
                    neighbours.neighbours.push(column);
                    weights.push(value);
                } else if let Some(last) = weights.last_mut() {
                    *last += value;
                }
            }
            neighbours.offsets.push(neighbours.neighbours.len());
        }
        let stationary = vec![1.0 / n.max(1) as f64; n];
        Ok(Self { neighbours, weights, stationary, step_length: 1.0, is_reversible: false })
    }

    /// The same walk without some vertices: their rows become identity rows, no other row steps to them, and each row is
    /// divided by what it kept, so that as much probability moves as before. `squared_length(x, y)` is the squared length
    /// of a step in model units. O(entries).
    ///
    /// A reversible walk stays so, with `π′(x) ∝ π(x)·(part of the row's steps that is kept)`: `π(x)Φ₁(x,y)` is as before.
    ///
    /// # Panics
    /// When there is not one flag a vertex.
    #[must_use]
    pub fn restricted(&self, masked: &[bool], squared_length: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let n = self.n_vertices();
        assert_eq!(masked.len(), n, "one flag a vertex");
        let mut neighbours = Adjacency { offsets: vec![0], neighbours: Vec::new() };
        let (mut weights, mut stationary) = (Vec::new(), Vec::with_capacity(n));
        for x in 0..n {
            let start = weights.len();
            let (columns, values) = self.row(x);
            let all: f64 = values.iter().sum();
            if !masked[x] {
                for (&y, &w) in columns.iter().zip(values).filter(|(y, _)| !masked[**y as usize]) {
                    neighbours.neighbours.push(y);
                    weights.push(w);
                }
            }
            let kept: f64 = weights[start..].iter().sum();
            if kept > 0.0 {
                weights[start..].iter_mut().for_each(|w| *w *= all / kept);
            }
            stationary.push(if all > 0.0 { self.stationary[x] * (kept / all) } else { 0.0 });
            neighbours.offsets.push(neighbours.neighbours.len());
        }
        let total = crate::parallel::sum(n, |x| stationary[x]);
        if total > 0.0 {
            for p in &mut stationary {
                *p /= total;
            }
        } else {
            stationary.fill(1.0 / n.max(1) as f64);
        }
        let mut walk =
            Self { neighbours, weights, stationary, step_length: 0.0, is_reversible: self.is_reversible };
        let step_square = crate::parallel::sum(n, |x| {
            let (columns, values) = walk.row(x);
            let square: f64 =
                columns.iter().zip(values).map(|(&y, w)| w * squared_length(x, y as usize)).sum();
            walk.stationary[x] * square
        });
        walk.step_length = step_square.sqrt();
        walk
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.neighbours.n_vertices()
    }

    /// Number of entries, the diagonal included.
    pub fn nnz(&self) -> usize {
        self.weights.len() + self.n_vertices()
    }

    /// Which off-diagonal entries there are.
    pub fn neighbours(&self) -> &Adjacency {
        &self.neighbours
    }

    /// The off-diagonal entries, in the order of [`neighbours`](Self::neighbours).
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The off-diagonal entries of row `x`: columns by rising index, and values.
    pub fn row(&self, x: usize) -> (&[u32], &[f64]) {
        let range = self.neighbours.offsets[x]..self.neighbours.offsets[x + 1];
        (&self.neighbours.neighbours[range.clone()], &self.weights[range])
    }

    /// `Φ₁(x,x)`: what the off-diagonal entries leave of 1.
    pub fn diagonal(&self, x: usize) -> f64 {
        1.0 - self.row(x).1.iter().sum::<f64>()
    }

    /// The stationary law π over all vertices, ≥ 0, Σπ = 1: `π(x) ∝ A(x)·Σ_z A(z)k(x,z)`. With several components it
    /// weighs them by that formula. For a directed cloud it is a weight by the same formula and not stationary.
    pub fn stationary(&self) -> &[f64] {
        &self.stationary
    }

    /// `s`, the root of the mean square length of a step `Σ_x π(x) Σ_y Φ₁(x,y)‖x−y‖²`, in model units; in hops on a graph.
    pub fn step_length(&self) -> f64 {
        self.step_length
    }

    /// Bytes of memory that the walk takes.
    pub fn bytes(&self) -> u64 {
        let index = size_of::<usize>() * self.neighbours.offsets.len();
        (index + 4 * self.neighbours.neighbours.len() + 8 * (self.weights.len() + self.stationary.len()))
            as u64
    }

    /// Whether `π(x)Φ₁(x,y) = π(y)Φ₁(y,x)`, so that the spectrum is real and in [0, 1].
    pub fn is_reversible(&self) -> bool {
        self.is_reversible
    }
}
