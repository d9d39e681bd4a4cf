//! Walks guided by data at their sites: they favor similar neighbors and so respect creases and jumps.

use super::{Diffusion, LocalOperator, Semigroup};
use crate::rows::{CompressedRows, try_visit_entries};
use crate::shape::{Adjacency, squared_distance};
use crate::{Cancelled, Progress, parallel};

/// Number of entries sampled for a median.
const SAMPLED_ENTRIES: usize = 1 << 16;

/// Squared difference, relative to the mean square of a guide, that counts as zero because rounding may cause it.
const LEAST_DIFFERENCE: f64 = 1e-10;

/// Sites of a walk: positions, areas and neighbors.
pub(crate) struct Sites<'a> {
    pub(crate) neighbors: &'a Adjacency,
    /// Positions, in a unit of length whose squares neither overflow nor underflow.
    pub(crate) positions: &'a [[f64; 3]],
    /// Areas, ≥ 0.
    pub(crate) areas: &'a [f64],
}

/// One step of the lazy walk `Φ₁ = ½I + ½[w]_r` with `w(x,y) = A(y)·exp(−d²/2d̄²)`, where d is the distance of the
/// sites and d̄ its median over neighbors. The step length is in units of the positions. O(entries).
///
/// A site without a neighbor of positive area stays where it is. `typical` is d̄² (see [`typical_square`]).
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub(crate) fn site_diffusion(
    sites: &Sites<'_>,
    typical: f64,
    progress: Progress<'_>,
) -> Result<Diffusion, Cancelled> {
    let &Sites { neighbors, positions, areas } = sites;
    let squared = |x: usize, y: usize| squared_distance(&positions[x], &positions[y]);
    let sharpness = sharpness(typical);
    let fill = |x: usize, row: &mut [f64]| {
        for (w, &y) in row.iter_mut().zip(neighbors.row(x)) {
            *w = areas[y as usize];
        }
    };
    let exponent = |x: usize, k: usize| sharpness * squared(x, neighbors.row(x)[k] as usize);
    let mut rows = CompressedRows::new_unchecked(neighbors.clone(), crate::pages::zeros(neighbors.nnz()));
    let per_row = weigh_rows(&mut rows, fill, exponent, progress)?;
    diffusion(rows, &per_row, areas, squared, progress)
}

/// Median of `‖v_x − v_y‖²` over neighbors.
pub(crate) fn typical_square(neighbors: &Adjacency, vectors: &[[f64; 3]]) -> f64 {
    median(neighbors, |x, k| squared_distance(&vectors[x], &vectors[neighbors.row(x)[k] as usize]))
}

impl Diffusion {
    /// Weighs the walk by a guide, one vector per vertex, so that it favors neighbors with similar values:
    /// `Φ₁ = ½I + ½[w]_r` with `w(x,y) = Φ(x,y)·exp(−‖g_x − g_y‖²/2s²)`, where Φ are the steps of this operator and
    /// s is `reach` times the square root of the median of `‖g_x − g_y‖²` over neighbors. An infinite `reach`
    /// ignores the guide. `squared_length(x, y)` is the squared length of a step in model units. O(entries).
    ///
    /// Weights are ≥ 0 and rows sum to 1. A reversible operator gives a reversible result, with
    /// `π′(x) ∝ π(x)·Σ_y w(x,y)`.
    ///
    /// For heat on a surface ([`Semigroup::Heat`]) the entries are `w(x,y)` themselves, because a guide reduces
    /// conductances (`perona1990`): heat that does not flow stays, and π does not change.
    ///
    /// ```
    /// use adwave::{Progress, operator::Diffusion};
    /// let path = Diffusion::from_rows(
    ///     &[0, 2, 5, 8, 10],
    ///     &[0, 1, 0, 1, 2, 1, 2, 3, 2, 3],
    ///     &[0.5, 0.5, 0.25, 0.5, 0.25, 0.25, 0.5, 0.25, 0.5, 0.5],
    /// )?;
    /// let guide = [0.0, 0.1, 9.0, 9.1].map(|v| [v, 0.0, 0.0]); // a step in the middle
    /// let led = path.weigh_by_guide(&guide, 0.5, |_, _| 1.0, Progress::none())?;
    /// assert!(led.row(1).1[0] > 0.49); // to the one that is alike
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    ///
    /// # Panics
    /// Unless there is one vector per vertex.
    pub fn weigh_by_guide(
        &self,
        guide: &[[f64; 3]],
        reach: f64,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let typical = typical_difference(self.neighbors(), guide, progress)?;
        self.clone().weigh_by_guide_within(guide, reach * reach * typical, squared_length, progress)
    }

    /// [`weigh_by_guide`](Self::weigh_by_guide) with `scale`, the s² of its formula, in the memory of this operator.
    pub(crate) fn weigh_by_guide_within(
        self,
        guide: &[[f64; 3]],
        scale: f64,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        assert_eq!(guide.len(), self.n_vertices(), "a vector for each vertex");
        let neighbors = self.neighbors().clone();
        self.weigh_by_squares(squared_differences(&neighbors, guide), scale, squared_length, progress)
    }

    /// [`weigh_by_guide`](Self::weigh_by_guide) with the squared differences of the guide, `squared(x, k)` for the k-th
    /// neighbor of x, and with `scale`, the s² of its formula. The entries stay in their places and in their memory.
    pub(crate) fn weigh_by_squares(
        self,
        squared: impl Fn(usize, usize) -> f64 + Sync + Send,
        scale: f64,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let sharpness = if scale.is_finite() { sharpness(scale) } else { 0.0 };
        if let Semigroup::Heat { .. } = self.semigroup() {
            let factor = |x: usize, k: usize| (-sharpness * squared(x, k)).exp();
            return self.damp_rows(factor, squared_length, progress);
        }
        let (mut rows, measure) = self.into_rows_and_measure();
        let per_row = weigh_rows(&mut rows, |_, _| (), |x, k| sharpness * squared(x, k), progress)?;
        diffusion(rows, &per_row, &measure, squared_length, progress)
    }

    /// Heat with the off-diagonal entries multiplied by `factor(x, k)`, which is symmetric and in [0, 1].
    fn damp_rows(
        self,
        factor: impl Fn(usize, usize) -> f64 + Sync + Send,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let (step_length, semigroup) = (self.step_length(), self.semigroup());
        let (rows, pi) = self.into_rows_and_measure();
        let (neighbors, mut values) = rows.into_parts();
        // Mean square length of a step, before and after.
        let mut per_row = vec![[0.0; 2]; pi.len()];
        try_visit_entries(&neighbors, &mut values, &mut per_row, progress, |range, mut values, per_row| {
            for (x, squares) in range.zip(per_row) {
                let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.row(x).len());
                values = after;
                for (k, (w, &y)) in row.iter_mut().zip(neighbors.row(x)).enumerate() {
                    let square = pi[x] * squared_length(x, y as usize);
                    squares[0] += *w * square;
                    *w *= factor(x, k);
                    squares[1] += *w * square;
                }
            }
        })?;
        let [before, after] = [0, 1].map(|k| parallel::try_sum(per_row.len(), progress, |x| per_row[x][k]));
        let (before, after) = (before?, after?);
        let step_length = if before > 0.0 { step_length * (after / before).sqrt() } else { 0.0 };
        Self::from_heat_weights(neighbors, values, pi, step_length, semigroup, progress)
    }
}

/// Median of `‖g_x − g_y‖²` over neighbors.
pub(crate) fn typical_difference(
    neighbors: &Adjacency,
    guide: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    assert_eq!(guide.len(), neighbors.n_rows(), "a vector for each vertex");
    let square = |x: usize| squared_distance(&guide[x], &[0.0; 3]);
    typical_difference_of(neighbors, squared_differences(neighbors, guide), square, progress)
}

/// Median of the squared differences of a guide over neighbors, `squared(x, k)` for the k-th of vertex x; `square(x)`
/// is the squared size of the guide.
pub(crate) fn typical_difference_of(
    neighbors: &Adjacency,
    squared: impl Fn(usize, usize) -> f64 + Sync + Send,
    square: impl Fn(usize) -> f64 + Sync + Send,
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let n = neighbors.n_rows();
    let sum: f64 = parallel::try_sum(n, progress, square)?;
    // If most neighbors are equal, any difference would be a jump, even one that rounding caused.
    let least = LEAST_DIFFERENCE * sum / n.max(1) as f64;
    Ok(median(neighbors, squared).max(least))
}

/// The squared difference of a guide from vertex x to its k-th neighbor.
fn squared_differences(
    neighbors: &Adjacency,
    guide: &[[f64; 3]],
) -> impl Fn(usize, usize) -> f64 + Sync + Send {
    |x, k| squared_distance(&guide[x], &guide[neighbors.row(x)[k] as usize])
}

/// Multiplies the entries of the k-th neighbor of x by `exp(−exponent(x, k))`; `fill(x, row)` may write them before.
/// Returns for each row the logarithm of its divisor and its sum.
fn weigh_rows(
    rows: &mut CompressedRows<f64>,
    fill: impl Fn(usize, &mut [f64]) + Sync + Send,
    exponent: impl Fn(usize, usize) -> f64 + Sync + Send,
    progress: Progress<'_>,
) -> Result<Vec<(f64, f64)>, Cancelled> {
    let neighbors = rows.pattern().clone();
    let mut per_row = vec![(0.0, 0.0); neighbors.n_rows()];
    try_visit_entries(
        &neighbors,
        rows.values_mut(),
        &mut per_row,
        progress,
        |range, mut values, per_row| {
            let mut exponents = Vec::new();
            for (x, kept) in range.zip(per_row) {
                let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.row(x).len());
                values = after;
                fill(x, row);
                exponents.clear();
                exponents.extend((0..row.len()).map(|k| exponent(x, k)));
                *kept = weigh_row(row, &exponents);
            }
        },
    )?;
    Ok(per_row)
}

/// The lazy walk of rows whose weights times `measure` are symmetric.
fn diffusion(
    rows: CompressedRows<f64>,
    per_row: &[(f64, f64)],
    measure: &[f64],
    squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
    progress: Progress<'_>,
) -> Result<Diffusion, Cancelled> {
    let n = rows.n_rows();
    let mean_square = parallel::try_collect(n, progress, |x| {
        let (columns, weights) = rows.row(x);
        let square: f64 = columns.iter().zip(weights).map(|(&y, w)| w * squared_length(x, y as usize)).sum();
        if per_row[x].1 > 0.0 { square / per_row[x].1 } else { 0.0 }
    })?;
    let operator = LocalOperator {
        rows,
        log_factor: parallel::try_collect(n, progress, |x| per_row[x].0)?,
        areas: measure.to_vec(),
        measure: None,
        mean_square,
        mean_length: 1.0, // not asked for, nor the width
        width: 1.0,
        is_reversible: true,
    };
    Diffusion::new(operator, progress)
}

/// The factor `1/2m` of a median m; 0 if m is 0, where all values are equal.
pub(super) fn sharpness(median: f64) -> f64 {
    if median > 0.0 { 0.5 / median } else { 0.0 }
}

/// Multiplies a row by `exp(−exponents[k])`, divided by the largest of these factors so that it cannot underflow;
/// returns the logarithm of that divisor and the row's sum.
fn weigh_row(row: &mut [f64], exponents: &[f64]) -> (f64, f64) {
    let used = row.iter().zip(exponents).filter(|(w, _)| **w > 0.0);
    let least = used.fold(f64::INFINITY, |least, (_, e)| least.min(*e));
    if least.is_infinite() {
        row.fill(0.0);
        return (0.0, 0.0);
    }
    let mut sum = 0.0;
    for (w, e) in row.iter_mut().zip(exponents) {
        *w *= (least - e).min(0.0).exp();
        sum += *w;
    }
    (-least, sum)
}

/// Median of a number per entry, `number(x, k)` for the k-th of row x, from a sample of about [`SAMPLED_ENTRIES`]
/// entries; 0 without entries.
fn median(neighbors: &Adjacency, number: impl Fn(usize, usize) -> f64) -> f64 {
    let rows_apart = (neighbors.nnz() / SAMPLED_ENTRIES).max(1);
    let mut numbers: Vec<f64> = (0..neighbors.n_rows())
        .step_by(rows_apart)
        .flat_map(|x| (0..neighbors.row(x).len()).map(move |k| (x, k)))
        .map(|(x, k)| number(x, k))
        .collect();
    if numbers.is_empty() {
        return 0.0;
    }
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}
