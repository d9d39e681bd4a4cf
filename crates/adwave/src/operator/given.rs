//! The diffusion operator of a given walk, a row-stochastic matrix with its diagonal.

use super::diffusion::{normalize_sum, wrong_row};
use super::{Diffusion, DiffusionError, Semigroup};
use crate::rows::{CompressedRows, rows_at_a_time};
use crate::{Cancelled, Progress, parallel};

/// Largest difference of a row's sum from 1 that counts as rounding: hubs sum hundreds of thousands of entries.
const ROW_SUM_TOLERANCE: f64 = 1e-9;

/// Largest logarithm of `π(x)P(x,y)/π(y)P(y,x)` that counts as rounding.
const BALANCE_TOLERANCE: f64 = 1e-9;

/// Rows that a thread checks at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

impl Diffusion {
    /// Diffusion operator of a given walk P, n_vertices × n_vertices, with its diagonal, each row summing to 1
    /// (within 1e-9; the diagonal takes up the rest). O(entries · log(entries per row)).
    ///
    /// A step of the walk is a step of the bands. If P is reversible, `π(x)P(x,y) = π(y)P(y,x)`, its spectrum is real
    /// and one recurrence gives all levels: with [`Semigroup::Steps`] if every row stays with probability ½ or more,
    /// else with [`Semigroup::PlainSteps`], for which Φ₁ is stored as ½I + ½P. If P is not reversible, bands are
    /// computed power by power, for whole steps only.
    ///
    /// On each component the weight of π is proportional to its number of vertices; π is uniform if P is not
    /// reversible. The step length is the root mean square number of hops.
    ///
    /// # Errors
    /// [`DiffusionError`] if the matrix is not square, an entry is negative or not finite, a row does not sum to 1, or
    /// the call is cancelled.
    ///
    /// ```
    /// use adwave::{Progress, operator::{Diffusion, Semigroup}, rows::CompressedRows};
    /// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
    /// let walk = Diffusion::from_walk(&swap, Progress::none())?;
    /// assert!(walk.is_reversible());
    /// assert_eq!((walk.semigroup(), walk.step_length()), (Semigroup::PlainSteps, 1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_walk(walk: &CompressedRows<f64>, progress: Progress<'_>) -> Result<Self, DiffusionError> {
        let n = walk.n_rows();
        let wrong = parallel::try_map_chunks(
            n,
            ROWS_AT_A_TIME,
            progress,
            || (),
            |(), mut rows| {
                rows.find_map(|x| {
                    let (columns, values) = walk.row(x);
                    match columns.last() {
                        Some(&y) if y as usize >= n => {
                            Some(DiffusionError::RowCount { n_rows: n, n_vertices: y as usize + 1 })
                        }
                        _ => wrong_row(x, columns, values, ROW_SUM_TOLERANCE),
                    }
                })
            },
        )?;
        if let Some(error) = wrong.into_iter().flatten().next() {
            return Err(error);
        }
        let pi = balanced_distribution(walk, progress)?;
        let moves = |x: usize| {
            let (columns, values) = walk.row(x);
            columns.iter().zip(values).filter(|(y, _)| **y as usize != x).map(|(_, w)| w).sum::<f64>()
        };
        let most = parallel::max(n, 0.0, moves);
        // Rounding of the entries may lift the sum of a lazy row above ½.
        let is_lazy = most <= 0.5 * (1.0 + 4.0 * f64::EPSILON);
        let (factor, semigroup) = match (&pi, is_lazy) {
            (None, _) | (Some(_), true) => (1.0, Semigroup::Steps),
            (Some(_), false) => (0.5, Semigroup::PlainSteps),
        };
        let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
            let (others, values) = walk.row(x);
            for (&y, &w) in others.iter().zip(values) {
                if y as usize != x && w > 0.0 {
                    columns.push(y);
                    weights.push(factor * w);
                }
            }
        };
        let rows = CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?;
        let is_reversible = pi.is_some();
        let stationary = pi.unwrap_or_else(|| vec![1.0 / n.max(1) as f64; n]);
        let square = parallel::try_sum(n, progress, |x| stationary[x] * moves(x))?;
        Ok(Self::from_given(rows, stationary, square.sqrt(), is_reversible, semigroup))
    }
}

/// Distribution π with `π(x)P(x,y) = π(y)P(y,x)` for all x and y, whose weight on each component is proportional to the
/// number of its vertices; `None` if there is none.
fn balanced_distribution(
    walk: &CompressedRows<f64>,
    progress: Progress<'_>,
) -> Result<Option<Vec<f64>>, Cancelled> {
    let n = walk.n_rows();
    let mut log_pi = vec![f64::NAN; n];
    let mut members: Vec<u32> = Vec::with_capacity(n);
    for start in 0..n {
        if !log_pi[start].is_nan() {
            continue;
        }
        let first = members.len();
        members.push(start as u32);
        log_pi[start] = 0.0;
        let mut read = first;
        while let Some(&x) = members.get(read) {
            read += 1;
            if read.is_multiple_of(ROWS_AT_A_TIME) {
                progress.check()?;
            }
            let (columns, values) = walk.row(x as usize);
            for (&y, &w) in columns.iter().zip(values).filter(|(_, w)| **w > 0.0) {
                if log_pi[y as usize].is_nan() {
                    let back = walk.get(y as usize, x as usize);
                    if back == 0.0 {
                        return Ok(None);
                    }
                    log_pi[y as usize] = log_pi[x as usize] + w.ln() - back.ln();
                    members.push(y);
                }
            }
        }
        let component = &members[first..];
        let top = component.iter().map(|&x| log_pi[x as usize]).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = component.iter().map(|&x| (log_pi[x as usize] - top).exp()).sum();
        let shift = (component.len() as f64 / sum).ln() - top;
        for &x in component {
            log_pi[x as usize] += shift;
        }
    }
    let unbalanced = parallel::try_map_chunks(
        n,
        ROWS_AT_A_TIME,
        progress,
        || (),
        |(), mut rows| {
            rows.any(|x| {
                let (columns, values) = walk.row(x);
                columns.iter().zip(values).filter(|(_, w)| **w > 0.0).any(|(&y, w)| {
                    let back = walk.get(y as usize, x);
                    let off = log_pi[x] + w.ln() - log_pi[y as usize] - back.ln();
                    off.abs() > BALANCE_TOLERANCE || back == 0.0
                })
            })
        },
    )?;
    if unbalanced.contains(&true) {
        return Ok(None);
    }
    normalize_sum(log_pi.into_iter().map(f64::exp).collect(), progress).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[f64]]) -> CompressedRows<f64> {
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in rows {
            for (y, &w) in row.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                columns.push(y as u32);
                values.push(w);
            }
            offsets.push(columns.len());
        }
        CompressedRows::new(offsets, columns, values, rows.len()).unwrap()
    }

    #[test]
    fn a_reversible_walk_is_found_with_its_distribution_and_a_cycle_that_turns_is_not() {
        let star = matrix(&[&[0.0, 0.5, 0.5], &[1.0, 0.0, 0.0], &[1.0, 0.0, 0.0]]);
        let walk = Diffusion::from_walk(&star, Progress::none()).unwrap();
        assert!(walk.is_reversible());
        let pi = walk.stationary();
        for (found, exact) in pi.iter().zip([0.5, 0.25, 0.25]) {
            assert!((found - exact).abs() < 1e-15, "{pi:?}");
        }
        let turning = matrix(&[&[0.0, 0.7, 0.3], &[0.3, 0.0, 0.7], &[0.7, 0.3, 0.0]]);
        let walk = Diffusion::from_walk(&turning, Progress::none()).unwrap();
        assert!(!walk.is_reversible());
        assert_eq!(walk.semigroup(), Semigroup::Steps);
        let one_way = matrix(&[&[0.5, 0.5], &[0.0, 1.0]]);
        assert!(!Diffusion::from_walk(&one_way, Progress::none()).unwrap().is_reversible());
    }

    #[test]
    fn a_lazy_walk_keeps_its_diagonal() {
        let walk = Diffusion::from_walk(&matrix(&[&[0.75, 0.25], &[0.5, 0.5]]), Progress::none()).unwrap();
        assert_eq!((walk.semigroup(), walk.diagonal(0)), (Semigroup::Steps, 0.75));
        assert!(walk.is_reversible() && !walk.stays_half());
    }

    #[test]
    fn wrong_matrices_are_refused() {
        let cases: [&[&[f64]]; 3] =
            [&[&[0.5, 0.4], &[0.0, 1.0]], &[&[1.5, -0.5], &[0.0, 1.0]], &[&[f64::NAN, 1.0], &[0.0, 1.0]]];
        for rows in cases {
            assert!(Diffusion::from_walk(&matrix(rows), Progress::none()).is_err(), "{rows:?}");
        }
        let wide = CompressedRows::new(vec![0, 1], vec![3], vec![1.0], 4).unwrap();
        let error = Diffusion::from_walk(&wide, Progress::none()).unwrap_err();
        assert_eq!(error, DiffusionError::RowCount { n_rows: 1, n_vertices: 4 });
    }
}
