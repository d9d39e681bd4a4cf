//! The diffusion operator Φ₁: one step of a lazy random walk.

use super::LocalOperator;
use crate::rows::{CompressedRows, Pattern, RowsError, rows_at_a_time, try_visit_entries};
use crate::shape::Adjacency;
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress, parallel};
use thiserror::Error;

/// Largest difference of a row's sum from 1 that counts as rounding.
const ROW_SUM_TOLERANCE: f64 = 1e-12;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 13;

/// Error of building a diffusion operator from a matrix.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DiffusionError {
    /// An entry is negative, NaN or infinite.
    #[error(
        "entry ({row}, {column}) of the diffusion operator is {value}; probabilities are finite and at least 0"
    )]
    BadEntry {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A row does not sum to 1.
    #[error("row {row} of the diffusion operator sums to {sum}, not to 1; divide it by its sum")]
    RowSum {
        /// The row.
        row: usize,
        /// Sum of the row.
        sum: f64,
    },
    /// The compressed rows are inconsistent.
    #[error("the compressed rows of the diffusion operator are inconsistent: {0}")]
    Layout(#[from] RowsError),
    /// The lists of rows, columns and values have different lengths.
    #[error(
        "the lists of rows, columns and values must have one entry each per matrix entry, got {n_rows}, {n_columns} and {n_values}"
    )]
    Lengths {
        /// Number of rows.
        n_rows: usize,
        /// Number of columns.
        n_columns: usize,
        /// Number of values.
        n_values: usize,
    },
    /// The number of flags does not match the number of vertices.
    #[error("there must be one mask flag per vertex, got {n_flags} for {n_vertices} vertices")]
    MaskLength {
        /// Number of flags.
        n_flags: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The matrix has another number of rows than the shape has vertices.
    #[error("a walk has one row per vertex, got {n_rows} rows for {n_vertices} vertices")]
    RowCount {
        /// Number of rows.
        n_rows: usize,
        /// Number of vertices of the shape.
        n_vertices: usize,
    },
    /// A row leaves with a probability above ½.
    #[error(
        "row {row} of the operator leaves with probability {moves}, and at most 1/2 is allowed; halve the entries, so that the walk stays half of the time"
    )]
    NotLazy {
        /// The row.
        row: usize,
        /// Sum of the row without its diagonal.
        moves: f64,
    },
    /// The weight of a row is not positive.
    #[error("row {row} of the operator has the weight {weight}; weights are finite and above 0")]
    BadWeight {
        /// The row.
        row: usize,
        /// The weight.
        weight: f64,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for DiffusionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Layout(rows) => rows.kind(),
            Self::Cancelled(cancelled) => cancelled.kind(),
            _ => ErrorKind::Input,
        }
    }
}

/// Meaning of n steps, for whole or fractional n.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Semigroup {
    /// The power `Φ₁ⁿ`: n steps of the walk (eq. 6).
    #[default]
    Steps,
    /// The power `Qⁿ`, `Q = 2Φ₁ − I`: n steps of a walk that need not stay where it is. Its eigenvalues are in
    /// [−1, 1], so n must be whole.
    PlainSteps,
    /// The exponential `exp(−n·rate·(U + dispersion·U²))`, `U = I − Φ₁`: heat after n times the time of a step. Without
    /// dispersion it is a walk that takes steps of Φ₁ at random times, `rate` per step on average.
    Heat {
        /// Mean number of steps of Φ₁ per step.
        rate: f64,
        /// Dispersion of short waves that is made up for, ≥ 0: on a map of a sphere; elsewhere 0.
        dispersion: f64,
    },
}

/// One step of a lazy random walk, `Φ₁ = [T]_r = ½I + ½Q` (eq. 4), n_vertices × n_vertices. Only off-diagonal
/// entries are stored; the diagonal makes each row sum to 1.
///
/// All entries are ≥ 0. A reversible Φ₁ is similar to a symmetric matrix and, being lazy, has its eigenvalues in
/// [0, 1].
#[derive(Clone, Debug)]
pub struct Diffusion {
    rows: CompressedRows<f64>,
    stationary: Vec<f64>,
    step_length: f64,
    is_reversible: bool,
    semigroup: Semigroup,
    /// True if every row stays with probability ½ or has no other entries.
    stays_half: bool,
}

impl Diffusion {
    /// Diffusion operator of a local operator (eq. 4): `Φ₁(x,y) = T(x,y) / 2Σ_z T(x,z)`, `Φ₁(x,x) = ½`; an identity
    /// row where the row of T is empty. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(operator: LocalOperator, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let LocalOperator { rows, log_factor, areas, measure, mean_square, is_reversible, .. } = operator;
        let areas = measure.unwrap_or(areas);
        let n = rows.n_rows();
        let (pattern, mut weights) = rows.into_parts();
        let mut row_sum = vec![0.0; n];
        try_visit_entries(&pattern, &mut weights, &mut row_sum, progress, |range, mut weights, row_sum| {
            for (x, sum) in range.zip(row_sum) {
                let (row, after) = std::mem::take(&mut weights).split_at_mut(pattern.row(x).len());
                weights = after;
                *sum = row.iter().sum();
                if *sum > 0.0 {
                    // Φ₁ = [T]_r (eq. 4): φ_{1,x} = T(x,·)/‖T(x,·)‖₁ (eq. 5), with ‖T(x,·)‖₁ = 2Σ_{y≠x} T(x,y),
                    // because T(x,x) is half of it.
                    for w in row {
                        *w /= 2.0 * *sum;
                    }
                }
            }
        })?;
        // lim Φ₁ⁿ(z,x) = π(x) ∝ A(x)·Σ_z A(z)k(x,z) instead of the constant 1/A(M) (eq. 10), in logarithms, because
        // the kernel underflows if distances differ much.
        let log_pi: Vec<f64> =
            parallel::try_collect(n, progress, |x| areas[x].ln() + log_factor[x] + row_sum[x].ln())?;
        let top = parallel::max(n, f64::NEG_INFINITY, |x| log_pi[x]);
        let weight = |x: usize| (log_pi[x] - top).exp();
        let stationary = if top.is_finite() {
            normalize_sum(parallel::try_collect(n, progress, weight)?, progress)?
        } else {
            vec![1.0 / n.max(1) as f64; n] // nothing moves: every distribution is stationary
        };
        let step_square = parallel::try_sum(n, progress, |x| stationary[x] * 0.5 * mean_square[x])?;
        let rows = CompressedRows::new_unchecked(pattern, weights);
        Ok(Self {
            rows,
            stationary,
            step_length: step_square.sqrt(),
            is_reversible,
            semigroup: Semigroup::Steps,
            stays_half: true,
        })
    }

    /// Diffusion operator from its own matrix: compressed rows with or without a diagonal, each row summing to 1.
    ///
    /// The stationary distribution π is set to uniform and the step length to 1; the operator counts as not
    /// reversible, so that no method relies on a real spectrum. Entries of a row may be in any order and repeated.
    /// O(entries).
    ///
    /// # Errors
    /// [`DiffusionError`] if the rows are inconsistent, an entry is negative or not finite, or the sum of a row
    /// differs from 1 by more than 1e-12.
    ///
    /// ```
    /// use adwave::operator::{Diffusion, DiffusionError};
    /// let phi = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.25, 0.75])?;
    /// assert_eq!(phi.diagonal(1), 0.75);
    /// let wrong = Diffusion::from_rows(&[0, 1, 2], &[1, 0], &[1.0, 0.5]);
    /// assert_eq!(wrong.unwrap_err(), DiffusionError::RowSum { row: 1, sum: 0.5 });
    /// # Ok::<(), DiffusionError>(())
    /// ```
    pub fn from_rows(offsets: &[usize], columns: &[u32], values: &[f64]) -> Result<Self, DiffusionError> {
        let Some(n) = offsets.len().checked_sub(1) else { return Err(RowsError::NoOffsets.into()) };
        let pattern = Pattern::with_values(offsets.to_vec(), columns.to_vec(), n, values.len())?;
        let wrong = parallel::map_chunks(n, VERTICES_AT_A_TIME, |mut range| {
            range.find_map(|row| {
                wrong_row(row, pattern.row(row), &values[pattern.range(row)], ROW_SUM_TOLERANCE)
            })
        });
        if let Some(error) = wrong.into_iter().flatten().next() {
            return Err(error);
        }
        let row = |entries: &mut Vec<(u32, f64)>,
                   x: usize,
                   columns: &mut Vec<u32>,
                   weights: &mut Vec<f64>| {
            entries.clear();
            entries.extend(pattern.row(x).iter().copied().zip(values[pattern.range(x)].iter().copied()));
            entries.sort_by_key(|e| e.0);
            let start = columns.len();
            for &(column, value) in entries.iter().filter(|e| e.0 as usize != x) {
                match weights.last_mut() {
                    Some(last) if columns.len() > start && columns.last() == Some(&column) => *last += value,
                    _ => {
                        columns.push(column);
                        weights.push(value);
                    }
                }
            }
        };
        let rows = CompressedRows::from_rows(n, rows_at_a_time(n), Progress::none(), Vec::new, row)?;
        let stationary = vec![1.0 / n.max(1) as f64; n];
        Ok(Self::from_given(rows, stationary, 1.0, false, Semigroup::Steps))
    }

    /// [`from_rows`](Self::from_rows) from three lists in any order: entry `e` is `values[e]` at
    /// `(rows[e], columns[e])`. O(entries).
    ///
    /// # Errors
    /// As for [`from_rows`](Self::from_rows), and [`DiffusionError::Lengths`] if the lists have different lengths.
    ///
    /// ```
    /// use adwave::operator::Diffusion;
    /// let phi = Diffusion::from_columns(2, &[1, 0, 0, 1], &[1, 0, 1, 0], &[0.75, 0.5, 0.5, 0.25])?;
    /// assert_eq!(phi.row(1), ([0].as_slice(), [0.25].as_slice()));
    /// # Ok::<(), adwave::operator::DiffusionError>(())
    /// ```
    pub fn from_columns(
        n_vertices: usize,
        rows: &[u32],
        columns: &[u32],
        values: &[f64],
    ) -> Result<Self, DiffusionError> {
        let (n_rows, n_columns, n_values) = (rows.len(), columns.len(), values.len());
        if n_rows != n_columns || n_columns != n_values {
            return Err(DiffusionError::Lengths { n_rows, n_columns, n_values });
        }
        let mut offsets = vec![0_usize; n_vertices + 1];
        for (&row, &column) in rows.iter().zip(columns) {
            let Some(count) = offsets.get_mut(row as usize + 1) else {
                let (row, column) = (row as usize, column as usize);
                return Err(RowsError::NoColumn { row, column, n_columns: n_vertices }.into());
            };
            *count += 1;
        }
        for x in 0..n_vertices {
            offsets[x + 1] += offsets[x];
        }
        let (mut next, mut entries) = (offsets.clone(), vec![(0_u32, 0.0); n_rows]);
        for ((&row, &column), &value) in rows.iter().zip(columns).zip(values) {
            entries[next[row as usize]] = (column, value);
            next[row as usize] += 1;
        }
        let (columns, values): (Vec<u32>, Vec<f64>) = entries.into_iter().unzip();
        Self::from_rows(&offsets, &columns, &values)
    }

    /// Diffusion without the masked vertices: their rows become identity rows, no other row steps to them, and each
    /// row is divided by the sum of its remaining steps, so that the same probability moves as before.
    /// `squared_length(x, y)` is the squared length of a step in model units. O(entries).
    ///
    /// A reversible operator stays reversible, with `π′(x) ∝ π(x)·(remaining part of the row's steps)`;
    /// `π(x)Φ₁(x,y)` does not change.
    ///
    /// # Errors
    /// [`DiffusionError::MaskLength`] unless there is one flag per vertex; or if the call is cancelled.
    pub fn remove_masked(
        &self,
        masked: &[bool],
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, DiffusionError> {
        let n = self.n_vertices();
        if masked.len() != n {
            return Err(DiffusionError::MaskLength { n_flags: masked.len(), n_vertices: n });
        }
        if let Semigroup::Heat { .. } = self.semigroup {
            return Ok(self.heat_restricted(masked, progress)?);
        }
        let kept_entries = |x: usize| {
            let (columns, values) = self.row(x);
            let entries = columns.iter().copied().zip(values.iter().copied());
            entries.filter(move |&(y, _)| !masked[x] && !masked[y as usize])
        };
        // Sum of the steps of a row, and of those that remain.
        let sums =
            |x: usize| (self.row(x).1.iter().sum::<f64>(), kept_entries(x).map(|(_, w)| w).sum::<f64>());
        let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
            let (all, kept) = sums(x);
            for (y, w) in kept_entries(x) {
                columns.push(y);
                weights.push(if kept > 0.0 { w * (all / kept) } else { w });
            }
        };
        let rows = CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?;
        let stationary = parallel::try_collect(n, progress, |x| {
            let (all, kept) = sums(x);
            if all > 0.0 { self.stationary[x] * (kept / all) } else { 0.0 }
        })?;
        let stationary = normalize_sum(stationary, progress)?;
        let step_square = parallel::try_sum(n, progress, |x| {
            let (columns, values) = rows.row(x);
            let square: f64 =
                columns.iter().zip(values).map(|(&y, w)| w * squared_length(x, y as usize)).sum();
            stationary[x] * square
        })?;
        let per_step = if self.semigroup == Semigroup::PlainSteps { 2.0 } else { 1.0 };
        Ok(Self {
            rows,
            stationary,
            step_length: (per_step * step_square).sqrt(),
            is_reversible: self.is_reversible,
            semigroup: self.semigroup,
            stays_half: self.stays_half,
        })
    }

    /// Heat that does not flow into or out of masked vertices: the remaining part has a natural boundary.
    fn heat_restricted(&self, masked: &[bool], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = self.n_vertices();
        let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
            let (others, values) = self.row(x);
            let kept = others.iter().zip(values).filter(|(y, _)| !masked[x] && !masked[**y as usize]);
            for (&y, &w) in kept {
                columns.push(y);
                weights.push(w);
            }
        };
        let (pattern, weights) =
            CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?.into_parts();
        let mass = parallel::try_collect(n, progress, |x| if masked[x] { 0.0 } else { self.stationary[x] })?;
        Self::from_heat_weights(pattern, weights, mass, self.step_length, self.semigroup, progress)
    }

    /// Heat on the places with a label alone, numbered in their order. Nothing flows between different labels.
    pub(crate) fn divided(&self, labels: &[Option<u32>], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let places: Vec<u32> = (0..labels.len() as u32).filter(|&x| labels[x as usize].is_some()).collect();
        let mut number = vec![0; labels.len()];
        for (k, &x) in (0..).zip(&places) {
            number[x as usize] = k;
        }
        let n = places.len();
        let row = |(): &mut (), k: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
            let x = places[k] as usize;
            let (others, values) = self.row(x);
            let kept = others.iter().zip(values).filter(|(y, _)| labels[**y as usize] == labels[x]);
            for (&y, &w) in kept {
                columns.push(number[y as usize]);
                weights.push(w);
            }
        };
        let (pattern, weights) =
            CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?.into_parts();
        let mass = parallel::try_collect(n, progress, |k| self.stationary[places[k] as usize])?;
        Self::from_heat_weights(pattern, weights, mass, self.step_length, self.semigroup, progress)
    }

    /// Heat operator from the off-diagonal entries of Φ₁ and a weight per vertex to which the stationary
    /// distribution is proportional.
    pub(crate) fn from_heat_weights(
        pattern: Pattern,
        weights: Vec<f64>,
        mass: Vec<f64>,
        step_length: f64,
        semigroup: Semigroup,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let rows = CompressedRows::new_unchecked(pattern, weights);
        let stationary = normalize_sum(mass, progress)?;
        Ok(Self { rows, stationary, step_length, is_reversible: true, semigroup, stays_half: false })
    }

    /// Operator from the checked off-diagonal entries of Φ₁, with its known properties.
    pub(super) fn from_given(
        rows: CompressedRows<f64>,
        stationary: Vec<f64>,
        step_length: f64,
        is_reversible: bool,
        semigroup: Semigroup,
    ) -> Self {
        let moves = |x: usize| rows.row(x).1.iter().sum::<f64>();
        let stays_half = (0..rows.n_rows()).all(|x| rows.row(x).0.is_empty() || moves(x) == 0.5);
        Self { rows, stationary, step_length, is_reversible, semigroup, stays_half }
    }

    /// Lazy walk to each neighbor with the same probability: `Φ₁(x,y) = 1/(2·n_x)` for the n_x neighbors y of x. It is
    /// reversible if the neighbors are symmetric, as those of a domain are. The step length is in hops. O(entries).
    pub(crate) fn from_neighbor_lists(
        neighbors: &Adjacency,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = neighbors.n_rows();
        let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
            let others = neighbors.row(x);
            columns.extend_from_slice(others);
            weights.resize(columns.len(), 0.5 / others.len() as f64);
        };
        let rows = CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?;
        let total = neighbors.nnz().max(1) as f64;
        let stationary = parallel::try_collect(n, progress, |x| neighbors.row(x).len() as f64 / total)?;
        Ok(Self::from_given(rows, stationary, 0.5_f64.sqrt(), true, Semigroup::Steps))
    }

    /// Φ₁ as a matrix with its diagonal, n_vertices × n_vertices, with ascending columns;
    /// [`CompressedRows::into_scipy`] converts it to SciPy arrays. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    ///
    /// ```
    /// use adwave::{Progress, operator::Diffusion};
    /// let phi = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.25, 0.75])?;
    /// let (indptr, indices, data) = phi.to_rows(Progress::none())?.into_scipy()?;
    /// assert_eq!((indptr, indices, data), (vec![0, 2, 4], vec![0, 1, 0, 1], vec![0.5, 0.5, 0.25, 0.75]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_rows(&self, progress: Progress<'_>) -> Result<CompressedRows<f64>, Cancelled> {
        let n = self.n_vertices();
        let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, values: &mut Vec<f64>| {
            let (others, weights) = self.row(x);
            let before = others.partition_point(|&y| (y as usize) < x);
            columns.extend_from_slice(&others[..before]);
            columns.push(x as u32);
            columns.extend_from_slice(&others[before..]);
            values.extend_from_slice(&weights[..before]);
            values.push(self.diagonal(x));
            values.extend_from_slice(&weights[before..]);
        };
        CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.rows.n_rows()
    }

    /// Number of entries, including the diagonal.
    pub fn nnz(&self) -> usize {
        self.rows.nnz() + self.n_vertices()
    }

    /// Pattern of the off-diagonal entries.
    pub fn neighbors(&self) -> &Adjacency {
        self.rows.pattern()
    }

    /// The off-diagonal entries and the stationary distribution.
    pub(super) fn into_rows_and_measure(self) -> (CompressedRows<f64>, Vec<f64>) {
        (self.rows, self.stationary)
    }

    /// Off-diagonal entries, in the order of [`neighbors`](Self::neighbors).
    pub fn weights(&self) -> &[f64] {
        self.rows.values()
    }

    /// Off-diagonal entries of row `x`: ascending columns, and values.
    #[inline]
    pub fn row(&self, x: usize) -> (&[u32], &[f64]) {
        self.rows.row(x)
    }

    /// Diagonal entry `Φ₁(x,x)`, which is 1 minus the off-diagonal entries.
    pub fn diagonal(&self, x: usize) -> f64 {
        1.0 - self.row(x).1.iter().sum::<f64>()
    }

    /// True if every row stays with probability ½ or has no other entries, which products make use of.
    pub(crate) fn stays_half(&self) -> bool {
        self.stays_half
    }

    /// Meaning of n steps.
    pub fn semigroup(&self) -> Semigroup {
        self.semigroup
    }

    /// Stationary distribution π over all vertices, ≥ 0 with sum 1: `π(x) ∝ A(x)·Σ_z A(z)k(x,z)`. Rows of Φ₁ⁿ
    /// converge to it; it equals the paper's constant 1/A(M) (eq. 10) only if all rows of T have the same weight.
    /// The formula also sets the weights of several components. For a directed cloud it is a weight by the same
    /// formula and not stationary.
    pub fn stationary(&self) -> &[f64] {
        &self.stationary
    }

    /// Root mean square length s of a step, from `s² = Σ_x π(x) Σ_y Φ₁(x,y)‖x−y‖²`, in model units; in hops on a
    /// graph.
    pub fn step_length(&self) -> f64 {
        self.step_length
    }

    /// Bytes of memory of the operator.
    pub fn bytes(&self) -> u64 {
        self.rows.bytes() + size_of_val(self.stationary.as_slice()) as u64
    }

    /// True if `π(x)Φ₁(x,y) = π(y)Φ₁(y,x)`, so that the spectrum is real and in [0, 1].
    pub fn is_reversible(&self) -> bool {
        self.is_reversible
    }
}

/// First error in a row of a diffusion operator.
pub(super) fn wrong_row(
    row: usize,
    columns: &[u32],
    values: &[f64],
    tolerance: f64,
) -> Option<DiffusionError> {
    let is_wrong = |value: &f64| !(value.is_finite() && *value >= 0.0);
    if let Some(at) = values.iter().position(is_wrong) {
        return Some(DiffusionError::BadEntry { row, column: columns[at] as usize, value: values[at] });
    }
    let sum: f64 = values.iter().sum();
    ((sum - 1.0).abs() > tolerance).then_some(DiffusionError::RowSum { row, sum })
}

/// Distribution proportional to `weights` ≥ 0; uniform if all of them are 0.
pub(super) fn normalize_sum(mut weights: Vec<f64>, progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
    let n = weights.len();
    let total = parallel::try_sum(n, progress, |x| weights[x])?;
    parallel::try_visit_rows(&mut weights, 1, VERTICES_AT_A_TIME, progress, |_, rows| {
        for p in rows {
            *p = if total > 0.0 { *p / total } else { 1.0 / n as f64 };
        }
    })?;
    Ok(weights)
}
