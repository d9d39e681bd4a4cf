//! The paper's Algorithm 1: sparse squaring.

use super::fast::Workers;
use super::forecast::forecast;
use super::rows::CompressedRows;
use super::sparse_accumulator::SparseAccumulator;
use super::sweep::Walk;
use super::{Basis, BasisError, BasisInfo, BasisParams, transpose::Transpose};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};
use std::sync::atomic::{AtomicU64, Ordering};

/// Φ_1 … Φ_J by Algorithm 1 to the letter, in double precision: `Φ_j = [Φ_{j−1}Φ_{j−1}]_{r,ε}`.
///
/// Each product's entries below ε are dropped and its rows divided by their sums before it is squared again. Φ_1 itself
/// is the walk, without its zero entries. Products are Gustavson's, row by row. About four times the work per level;
/// [`basis`](super::basis) gives the same to 1e-5, much faster. The printed loop starts at j = 1, where it would give I; it starts
/// at 2 here.
///
/// # Errors
/// [`BasisError::NotDyadic`] for any other schedule; otherwise as [`basis`](super::basis).
pub fn basis_by_squaring(
    diffusion: &Diffusion,
    params: &BasisParams,
    progress: Progress<'_>,
) -> Result<Basis<f64>, BasisError> {
    params.check()?;
    let steps = params.steps();
    if let Some(j) = (0..steps.len()).find(|&j| steps[j] != 1 << j) {
        return Err(BasisError::NotDyadic { level: j + 1, steps: steps[j] });
    }
    let n_levels = steps.len();
    progress.step(0, n_levels as u64)?;
    let needed = {
        let transpose = Transpose::new(diffusion);
        let walk = Walk::new(diffusion, &transpose, params, progress);
        // A level lies in memory twice while its parts are put together; to count all of them twice is on the safe side.
        forecast::<f64>(&walk, &Workers::new(diffusion.n_vertices()), 2)?.bytes
    };
    let mut info = BasisInfo { forecast: needed, ..BasisInfo::default() };
    let mut scaling = vec![first_level(diffusion)];
    info.largest_dropped.push(0.0);
    for j in 1..n_levels {
        progress.step(j as u64, n_levels as u64)?;
        let (squared, dropped) = square(&scaling[j - 1], steps[j], params.drop_tolerance, progress)?;
        scaling.push(squared);
        info.largest_dropped.push(dropped);
    }
    progress.step(n_levels as u64, n_levels as u64)?;
    info.nnz = scaling.iter().map(|level| level.nnz() as u64).collect();
    info.bytes = scaling.iter().map(CompressedRows::bytes).collect();
    Ok(Basis { steps, scaling, info })
}

/// Φ₁ with its diagonal.
fn first_level(diffusion: &Diffusion) -> CompressedRows<f64> {
    CompressedRows::from_rows(
        diffusion.n_vertices(),
        || (),
        |(), x, columns, values| {
            let (others, weights) = diffusion.row(x);
            let before = others.partition_point(|&y| (y as usize) < x);
            let entries = others.iter().copied().zip(weights.iter().copied());
            let row = entries
                .clone()
                .take(before)
                .chain([(x as u32, diffusion.diagonal(x))])
                .chain(entries.skip(before));
            for (y, w) in row.filter(|e| e.1 > 0.0) {
                columns.push(y);
                values.push(w);
            }
        },
    )
}

/// `[AA]_{r,ε}` and the largest share of a row that was dropped.
fn square(
    matrix: &CompressedRows<f64>,
    steps: u64,
    tolerance: f64,
    progress: Progress<'_>,
) -> Result<(CompressedRows<f64>, f64), BasisError> {
    let n = matrix.n_rows();
    let empty_row = AtomicU64::new(u64::MAX);
    let largest_dropped = AtomicU64::new(0);
    let squared = CompressedRows::from_rows(
        n,
        || (vec![0.0_f64; n], SparseAccumulator::new(n), Vec::new()),
        |(sums, marks, found), x, columns, values| {
            if progress.is_cancelled() {
                return;
            }
            let (through, first) = matrix.row(x);
            for (&z, &a) in through.iter().zip(first) {
                let (ends, second) = matrix.row(z as usize);
                for (&y, &b) in ends.iter().zip(second) {
                    let sum = &mut sums[y as usize];
                    if *sum == 0.0 {
                        marks.insert(y);
                    }
                    *sum += a * b;
                }
            }
            found.clear();
            marks.drain_sorted(found);
            let start = values.len();
            let (mut kept, mut all) = (0.0, 0.0);
            for &y in &*found {
                let value = std::mem::take(&mut sums[y as usize]);
                all += value;
                if value >= tolerance && value > 0.0 {
                    kept += value;
                    columns.push(y);
                    values.push(value);
                }
            }
            if values.len() == start {
                empty_row.fetch_min(x as u64, Ordering::Relaxed);
                return;
            }
            for value in &mut values[start..] {
                *value /= kept;
            }
            // Bits of non-negative numbers are ordered as the numbers are.
            largest_dropped.fetch_max((1.0 - kept / all).max(0.0).to_bits(), Ordering::Relaxed);
        },
    );
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    match empty_row.into_inner() {
        u64::MAX => Ok((squared, f64::from_bits(largest_dropped.into_inner()))),
        row => Err(BasisError::EmptyRow { row: row as usize, steps, tolerance }),
    }
}
