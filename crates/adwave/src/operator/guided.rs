//! Walks that are led by what their sites carry: they keep to neighbors that are alike, and so respect creases and steps.

use super::{Diffusion, LocalOperator, Semigroup};
use crate::rows::{CompressedRows, try_for_entries};
use crate::shape::{Adjacency, squared_distance};
use crate::{Cancelled, Progress, parallel};

/// As many entries at most are looked at for a median.
const SAMPLED_ENTRIES: usize = 1 << 16;

/// Share of the mean square of a guide below which a squared difference counts as none: what rounding may make of values that are alike.
const LEAST_DIFFERENCE: f64 = 1e-10;

/// Where the sites of a walk are, how much each counts, and which are next to which.
pub(crate) struct Sites<'a> {
    pub(crate) neighbors: &'a Adjacency,
    /// In any unit of length, squares of which neither overflow nor vanish.
    pub(crate) positions: &'a [[f64; 3]],
    /// ≥ 0.
    pub(crate) areas: &'a [f64],
}

/// One step of the lazy walk `Φ₁ = ½I + ½[w]_r` with `w(x,y) = A(y)·exp(−d²/2d̄²)`, d the distance of the sites and d̄ its median over
/// neighbors. The step length is in units of the positions. O(entries).
///
/// Sites none of whose neighbors has an area stay where they are. `typical` is d̄² (see [`typical_square`]).
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn site_diffusion(
    sites: &Sites<'_>,
    typical: f64,
    progress: Progress<'_>,
) -> Result<Diffusion, Cancelled> {
    let &Sites { neighbors, positions, areas } = sites;
    let squared = |x: usize, y: usize| squared_distance(&positions[x], &positions[y]);
    let sharpness = sharpness(typical);
    let at = |x: usize, k: usize| neighbors.of(x)[k] as usize;
    let (rows, per_row) =
        weighted_rows(neighbors, |x, k| areas[at(x, k)], |x, k| sharpness * squared(x, at(x, k)), progress)?;
    diffusion(rows, &per_row, areas, squared, progress)
}

/// The median of `‖v_x − v_y‖²` over neighbors.
pub(crate) fn typical_square(neighbors: &Adjacency, vectors: &[[f64; 3]]) -> f64 {
    median(neighbors, |x, y| squared_distance(&vectors[x], &vectors[y]))
}

impl Diffusion {
    /// The walk that keeps to neighbors with like values of a guide, one vector for each vertex:
    /// `Φ₁ = ½I + ½[w]_r` with `w(x,y) = Φ(x,y)·exp(−‖g_x − g_y‖²/2s²)`, Φ the steps of this operator and s `reach` times the root of the
    /// median of `‖g_x − g_y‖²` over neighbors. An infinite `reach` leaves the guide out. `squared_length(x, y)` is the squared
    /// length of a step in model units. O(entries).
    ///
    /// Weights are ≥ 0 and rows sum to 1; of a reversible operator the result is reversible, with `π′(x) ∝ π(x)·Σ_y w(x,y)`.
    ///
    /// Of heat on a surface ([`Semigroup::Heat`]) the entries are `w(x,y)` themselves, as conductances are what a guide lowers
    /// (`perona1990`): what does not flow stays, π is as before.
    ///
    /// ```
    /// use adwave::{Progress, operator::Diffusion};
    /// let path = Diffusion::from_rows(
    ///     &[0, 2, 5, 8, 10],
    ///     &[0, 1, 0, 1, 2, 1, 2, 3, 2, 3],
    ///     &[0.5, 0.5, 0.25, 0.5, 0.25, 0.25, 0.5, 0.25, 0.5, 0.5],
    /// )?;
    /// let guide = [0.0, 0.1, 9.0, 9.1].map(|v| [v, 0.0, 0.0]); // a step in the middle
    /// let led = path.guided(&guide, 0.5, |_, _| 1.0, Progress::none())?;
    /// assert!(led.row(1).1[0] > 0.49); // to the one that is alike
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Cancelled`].
    ///
    /// # Panics
    /// When there is not one vector for each vertex.
    pub fn guided(
        &self,
        guide: &[[f64; 3]],
        reach: f64,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let typical = self.typical_difference(guide, progress)?;
        self.guided_within(guide, reach * reach * typical, squared_length, progress)
    }

    /// The median of `‖g_x − g_y‖²` over neighbors.
    pub(crate) fn typical_difference(
        &self,
        guide: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let n = self.n_vertices();
        assert_eq!(guide.len(), n, "a vector for each vertex");
        let square: f64 = parallel::try_sum(n, progress, |x| squared_distance(&guide[x], &[0.0; 3]))?;
        // Where most neighbors are alike any difference is a step, however little rounding has made of it.
        let least = LEAST_DIFFERENCE * square / n.max(1) as f64;
        Ok(typical_square(self.neighbors(), guide).max(least))
    }

    /// [`guided`](Self::guided) by `scale`, the s² of its formula.
    pub(crate) fn guided_within(
        &self,
        guide: &[[f64; 3]],
        scale: f64,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        assert_eq!(guide.len(), self.n_vertices(), "a vector for each vertex");
        let neighbors = self.neighbors();
        let squared = |x: usize, y: usize| squared_distance(&guide[x], &guide[y]);
        let sharpness = if scale.is_finite() { sharpness(scale) } else { 0.0 };
        let values = self.weights();
        if let Semigroup::Heat { .. } = self.semigroup() {
            let factor = |x: usize, y: usize| (-sharpness * squared(x, y)).exp();
            return self.damped(factor, squared_length, progress);
        }
        let (rows, per_row) = weighted_rows(
            neighbors,
            |x, k| values[neighbors.range(x).start + k],
            |x, k| sharpness * squared(x, neighbors.of(x)[k] as usize),
            progress,
        )?;
        diffusion(rows, &per_row, self.stationary(), squared_length, progress)
    }

    /// Heat whose entries off the diagonal are multiplied by `factor(x, y)`, symmetric and in [0, 1].
    fn damped(
        &self,
        factor: impl Fn(usize, usize) -> f64 + Sync + Send,
        squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let (neighbors, pi) = (self.neighbors(), self.stationary());
        let mut values = self.weights().to_vec();
        // The mean square length of a step, before and after.
        let mut per_row = vec![[0.0; 2]; self.n_vertices()];
        try_for_entries(neighbors, &mut values, &mut per_row, progress, |range, mut values, per_row| {
            for (x, squares) in range.zip(per_row) {
                let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.of(x).len());
                values = after;
                for (w, &y) in row.iter_mut().zip(neighbors.of(x)) {
                    let square = pi[x] * squared_length(x, y as usize);
                    squares[0] += *w * square;
                    *w *= factor(x, y as usize);
                    squares[1] += *w * square;
                }
            }
        })?;
        let [before, after] = [0, 1].map(|k| parallel::try_sum(per_row.len(), progress, |x| per_row[x][k]));
        let (before, after) = (before?, after?);
        let step_length = if before > 0.0 { self.step_length() * (after / before).sqrt() } else { 0.0 };
        Self::of_heat(neighbors.clone(), values, pi.to_vec(), step_length, self.semigroup(), progress)
    }
}

/// Rows, and of each the logarithm of the factor that it is divided by and its sum.
type WeightedRows = (CompressedRows<f64>, Vec<(f64, f64)>);

/// Rows of `base(x, k)·exp(−exponent(x, k))` for the k-th neighbor of x, and of each row the logarithm of the factor that it is
/// divided by and its sum.
fn weighted_rows(
    neighbors: &Adjacency,
    base: impl Fn(usize, usize) -> f64 + Sync + Send,
    exponent: impl Fn(usize, usize) -> f64 + Sync + Send,
    progress: Progress<'_>,
) -> Result<WeightedRows, Cancelled> {
    let mut values = crate::pages::zeros(neighbors.nnz());
    let mut per_row = vec![(0.0, 0.0); neighbors.n_rows()];
    try_for_entries(neighbors, &mut values, &mut per_row, progress, |range, mut values, per_row| {
        for (x, kept) in range.zip(per_row) {
            let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.of(x).len());
            values = after;
            *kept = fill_row(row, |k| base(x, k), |k| exponent(x, k));
        }
    })?;
    Ok((CompressedRows::trusted(neighbors.clone(), values), per_row))
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

/// `1/2m` of a median m, 0 where that is 0: all is alike then.
pub(super) fn sharpness(median: f64) -> f64 {
    if median > 0.0 { 0.5 / median } else { 0.0 }
}

/// Fills a row by `base(k)·exp(−exponent(k))`, divided by its largest exponential so that it cannot underflow: the logarithm of that
/// factor, and the row's sum.
fn fill_row(row: &mut [f64], base: impl Fn(usize) -> f64, exponent: impl Fn(usize) -> f64) -> (f64, f64) {
    let mut least = f64::INFINITY;
    for (k, value) in row.iter_mut().enumerate() {
        *value = exponent(k);
        if base(k) > 0.0 {
            least = least.min(*value);
        }
    }
    if least.is_infinite() {
        row.fill(0.0);
        return (0.0, 0.0);
    }
    let mut sum = 0.0;
    for (k, value) in row.iter_mut().enumerate() {
        *value = base(k) * (least - *value).min(0.0).exp();
        sum += *value;
    }
    (-least, sum)
}

/// The median of a number for each entry, from about [`SAMPLED_ENTRIES`] of them where there are more; 0 without entries.
fn median(neighbors: &Adjacency, number: impl Fn(usize, usize) -> f64) -> f64 {
    let rows_apart = (neighbors.nnz() / SAMPLED_ENTRIES).max(1);
    let mut numbers: Vec<f64> = (0..neighbors.n_rows())
        .step_by(rows_apart)
        .flat_map(|x| neighbors.of(x).iter().map(move |&y| (x, y as usize)))
        .map(|(x, y)| number(x, y))
        .collect();
    if numbers.is_empty() {
        return 0.0;
    }
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}
