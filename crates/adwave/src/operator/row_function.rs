//! An operator whose rows are a function, so that it stores none.

use super::diffusion::DiffusionError;
use super::interface::{Operator, RowWeights};
use crate::{Cancelled, Progress, parallel};
use std::fmt;
use std::sync::Arc;

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 2048;

/// Largest excess of a row's sum over ½ that counts as rounding.
const SUM_TOLERANCE: f64 = 1e-12;

/// Largest relative difference of `μ(x)Φ₁(x,y)` and `μ(y)Φ₁(y,x)` that counts as rounding.
const BALANCE_TOLERANCE: f64 = 1e-9;

/// A lazy walk whose rows are given by a function: `row(x)` yields the places y ≠ x that a step from x may reach, with
/// their probabilities, at most ½ together; the walk stays otherwise. Nothing is stored but the weights.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule, Transform};
/// use adwave::operator::{Operator, RowFunction};
/// use adwave::Progress;
/// // A grid of 8 × 5 cells; each step goes to one of the four sides with 1/8, and stays at the border.
/// let (width, height) = (8, 5);
/// let grid = RowFunction::new(width * height, move |cell| {
///     let (x, y) = (cell % width, cell / width);
///     let sides = [(x > 0).then(|| cell - 1), (x + 1 < width).then(|| cell + 1),
///         (y > 0).then(|| cell - width), (y + 1 < height).then(|| cell + width)];
///     sides.into_iter().flatten().map(|to| (to, 0.125))
/// })?;
/// assert!(grid.is_reversible());
/// let transform = Transform::from_operator(grid, &BandsParams::default())?;
/// let mut spot = vec![0.0; width * height];
/// spot[0] = 1.0;
/// let mut first = vec![0.0; width * height];
/// transform.wavelets_into(&spot, 1, &Schedule::dyadic(1)?, &mut [&mut first], Progress::none())?;
/// assert_eq!((first[0], first[1], first[width]), (0.25, -0.125, -0.125)); // two of the four sides are missing
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RowFunction<F> {
    n_rows: usize,
    row: Arc<F>,
    /// Flags of the places that are left out.
    masked: Option<Vec<bool>>,
    weights: Option<Vec<f64>>,
    is_reversible: bool,
    step_length: f64,
}

impl<F> fmt::Debug for RowFunction<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_rows, is_reversible, step_length, .. } = self;
        write!(
            f,
            "RowFunction {{ n_rows: {n_rows}, is_reversible: {is_reversible}, step_length: {step_length} }}"
        )
    }
}

impl<F, I> RowFunction<F>
where
    F: Fn(usize) -> I + Send + Sync,
    I: IntoIterator<Item = (usize, f64)>,
{
    /// The walk of `n_rows` rows, each of the same weight. The rows are checked, in O(entries · entries per row), and
    /// it is found whether the walk is reversible, that is, symmetric.
    ///
    /// # Errors
    /// [`DiffusionError`] if an entry is negative, not finite or beyond the rows, or a row leaves with more than ½.
    pub fn new(n_rows: usize, row: F) -> Result<Self, DiffusionError> {
        let row = Arc::new(row);
        Self { n_rows, row, masked: None, weights: None, is_reversible: false, step_length: 1.0 }
            .with_checked_rows()
    }

    /// This walk with the weights μ of its rows, of any sum, in whose inner product it may be reversible.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and [`DiffusionError::BadWeight`] unless there is a finite weight > 0 for each row.
    pub fn with_weights(self, weights: Vec<f64>) -> Result<Self, DiffusionError> {
        let (n_weights, n_rows) = (weights.len(), self.n_rows);
        if n_weights != n_rows {
            return Err(DiffusionError::RowCount { n_rows: n_weights, n_vertices: n_rows });
        }
        if let Some(row) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(DiffusionError::BadWeight { row, weight: weights[row] });
        }
        let total: f64 = weights.iter().sum();
        let weights = weights.into_iter().map(|w| w / total).collect();
        Self { weights: Some(weights), ..self }.with_checked_rows()
    }

    /// This walk with the root mean square length of a step, in model units; 1 otherwise.
    #[must_use]
    pub fn with_step_length(self, step_length: f64) -> Self {
        Self { step_length, ..self }
    }

    /// Checks the rows, and finds whether the walk is reversible.
    fn with_checked_rows(mut self) -> Result<Self, DiffusionError> {
        let n = self.n_rows;
        let parts = parallel::map_chunks(n, ROWS_AT_A_TIME, |rows| {
            let mut wrong = rows.clone().filter_map(|x| self.wrong_row(x));
            wrong.next().map_or(Ok(()), Err)
        });
        parts.into_iter().collect::<Result<(), _>>()?;
        let balanced = parallel::map_chunks(n, ROWS_AT_A_TIME, |mut rows| rows.all(|x| self.is_balanced(x)));
        self.is_reversible = !balanced.contains(&false);
        Ok(self)
    }

    fn wrong_row(&self, row: usize) -> Option<DiffusionError> {
        let mut moves = 0.0;
        for (column, value) in (self.row)(row) {
            if column >= self.n_rows || !(value.is_finite() && value >= 0.0) {
                return Some(DiffusionError::BadEntry { row, column, value });
            }
            moves += if column == row { 0.0 } else { value };
        }
        (moves > 0.5 + SUM_TOLERANCE).then_some(DiffusionError::NotLazy { row, moves })
    }

    /// Entries of a row that lead to another place and are not masked, and the factor that replaces the masked entries,
    /// so that the probability of moving does not change.
    fn steps(&self, x: usize) -> (f64, impl Iterator<Item = (usize, f64)>) {
        let is_out = move |y: usize| self.masked.as_ref().is_some_and(|masked| masked[x] || masked[y]);
        let mut factor = 1.0;
        if self.masked.is_some() {
            let (mut all, mut kept) = (0.0, 0.0);
            for (y, w) in (self.row)(x).into_iter().filter(|(y, _)| *y != x) {
                all += w;
                kept += if is_out(y) { 0.0 } else { w };
            }
            factor = if kept > 0.0 { all / kept } else { 0.0 };
        }
        (factor, (self.row)(x).into_iter().filter(move |&(y, _)| !is_out(y)))
    }

    fn row_weights(&self) -> RowWeights<'_> {
        self.weights.as_deref().map_or(RowWeights::Uniform, RowWeights::Each)
    }

    fn is_balanced(&self, x: usize) -> bool {
        let total = |from: usize, to: usize| -> f64 {
            let entries = (self.row)(from).into_iter().filter(|&(y, _)| y == to);
            self.row_weights().weight(from, self.n_rows) * entries.map(|(_, w)| w).sum::<f64>()
        };
        (self.row)(x).into_iter().all(|(y, _)| {
            let [there, back] = [total(x, y), total(y, x)];
            (there - back).abs() <= BALANCE_TOLERANCE * there.max(back)
        })
    }
}

impl<F, I> Operator for RowFunction<F>
where
    F: Fn(usize) -> I + Send + Sync + 'static,
    I: IntoIterator<Item = (usize, f64)>,
{
    fn n_rows(&self) -> usize {
        self.n_rows
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        parallel::try_visit_rows(out, n_channels, ROWS_AT_A_TIME, progress, |first, rows| {
            for (row, out) in (first..).zip(rows.chunks_exact_mut(n_channels)) {
                let here = &x[row * n_channels..][..n_channels];
                out.fill(0.0);
                let (factor, steps) = self.steps(row);
                for (column, w) in steps {
                    let there = &x[column * n_channels..][..n_channels];
                    for ((out, here), there) in out.iter_mut().zip(here).zip(there) {
                        *out += w * factor * (here - there);
                    }
                }
            }
        })
    }

    fn is_reversible(&self) -> bool {
        self.is_reversible
    }

    fn weights(&self) -> RowWeights<'_> {
        self.row_weights()
    }

    fn step_length(&self) -> f64 {
        self.step_length
    }

    /// The steps to masked places go to the others, as [`Diffusion::remove_masked`](super::Diffusion::remove_masked)
    /// does.
    fn masked(
        &self,
        masked: &[bool],
        squared_length: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        let n = self.n_rows;
        if masked.len() != n {
            return Err(DiffusionError::MaskLength { n_flags: masked.len(), n_vertices: n });
        }
        let before = self.masked.as_deref();
        let masked = masked.iter().enumerate().map(|(x, out)| *out || before.is_some_and(|flags| flags[x]));
        let (row, masked) = (Arc::clone(&self.row), Some(masked.collect()));
        let mut new = Self { n_rows: n, row, masked, weights: None, ..*self };
        // Of places without steps any weight > 0 is right: their values do not change.
        let weight = |x: usize| {
            let factor = new.steps(x).0;
            self.weights().weight(x, n) / if factor > 0.0 { factor } else { 1.0 }
        };
        let weights = parallel::try_collect(n, progress, weight)?;
        let total = parallel::try_sum(n, progress, |x| weights[x])?;
        let moving = parallel::try_sum(n, progress, |x| if new.steps(x).0 > 0.0 { weights[x] } else { 0.0 })?;
        let square = parallel::try_sum(n, progress, |x| {
            let (factor, steps) = new.steps(x);
            weights[x] * factor * steps.map(|(y, w)| w * squared_length(x, y)).sum::<f64>()
        })?;
        new.step_length = if moving > 0.0 { (square / moving).sqrt() } else { 0.0 };
        new.weights = Some(weights.into_iter().map(|w| w / total).collect());
        Ok(Some(Arc::new(new)))
    }
}
