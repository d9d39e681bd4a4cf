//! One step of the diffusion operator applied to a block of channels.

use super::kernel::{InstructionSet, RowProduct, apply_rows};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::parallel::try_visit_rows;
use crate::{Cancelled, Progress};

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 2048;

/// Applies `y = Φ₁ x` to `n_channels` channels at once; `x` and `y` are n_vertices × n_channels, row-major.
/// O(entries × channels).
///
/// Computed as `y = x + Σ w·(x_neighbor − x)`, so a constant signal stays exactly constant.
///
/// # Panics
/// Unless `x` and `y` are both n_vertices × n_channels.
///
/// ```
/// use adwave::{operator::Diffusion, sparse::apply};
/// let walk = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.25, 0.75]).unwrap();
/// let mut y = [0.0; 2];
/// apply(&walk, &[0.0, 8.0], &mut y, 1);
/// assert_eq!(y, [4.0, 6.0]);
/// ```
pub fn apply(diffusion: &Diffusion, x: &[f64], y: &mut [f64], n_channels: usize) {
    let done = try_apply(diffusion, x, y, n_channels, Progress::none());
    debug_assert!(done.is_ok(), "nobody can stop this");
}

/// [`apply`]; stops if the call is cancelled.
pub(crate) fn try_apply(
    diffusion: &Diffusion,
    x: &[f64],
    y: &mut [f64],
    n_channels: usize,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    assert_eq!(x.len(), diffusion.n_vertices() * n_channels, "x is n_vertices × n_channels");
    assert_eq!(y.len(), x.len(), "y is as long as x");
    match n_channels {
        0 => Ok(()),
        1 => apply_fixed::<1>(diffusion, x, y, progress),
        2 => apply_fixed::<2>(diffusion, x, y, progress),
        3 => apply_fixed::<3>(diffusion, x, y, progress),
        4 => apply_fixed::<4>(diffusion, x, y, progress),
        d => try_visit_rows(y, d, ROWS_AT_A_TIME, progress, |first, rows| {
            for (row, out) in (first..).zip(rows.chunks_exact_mut(d)) {
                let (columns, weights) = diffusion.row(row);
                let here = &x[row * d..][..d];
                out.copy_from_slice(here);
                for (&column, &w) in columns.iter().zip(weights) {
                    for ((out, &there), &here) in out.iter_mut().zip(&x[column as usize * d..][..d]).zip(here)
                    {
                        *out += w * (there - here);
                    }
                }
            }
        }),
    }
}

fn apply_fixed<const D: usize>(
    diffusion: &Diffusion,
    x: &[f64],
    y: &mut [f64],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let target = InstructionSet::detect();
    let neighbors = diffusion.neighbors();
    try_visit_rows(y, D, ROWS_AT_A_TIME, progress, |first, out| {
        let rows = RowProduct {
            offsets: neighbors.offsets(),
            columns: neighbors.columns(),
            weights: diffusion.weights(),
            first,
            x,
        };
        apply_rows::<D>(target, &rows, out);
    })
}

/// A copy of `values` in large pages, made by all threads.
pub(crate) fn copied(
    values: &[f64],
    n_channels: usize,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let mut copy: Vec<f64> = zeros(values.len());
    try_visit_rows(&mut copy, n_channels.max(1), 1 << 12, progress, |first, copy| {
        copy.copy_from_slice(&values[first * n_channels..][..copy.len()]);
    })?;
    Ok(copy)
}
