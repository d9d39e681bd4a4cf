//! Algorithm 1 of the paper, sparse squaring: the reference for the fast method, with which it shares no code.

use super::{Basis, BasisError, BasisInfo, BasisParams, check_steps};
use crate::operator::Diffusion;
use crate::rows::CompressedRows;
use crate::{Cancelled, Progress};
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of rows that a thread multiplies at a time; results do not depend on it.
const ROWS_AT_A_TIME: usize = 256;

/// Scaling functions Φ_1 … Φ_J by the literal Algorithm 1, in double precision: `Φ_j = [Φ_{j−1}Φ_{j−1}]_{r,ε}`.
///
/// Entries of each product below ε are dropped and its rows divided by their sums before it is squared again. Φ_1
/// is the diffusion operator without its zero entries. Products are computed row by row (Gustavson). The work per
/// level is about four times that of [`basis`](super::basis), which agrees to 1e-5. The printed loop starts at j =
/// 1, which would give I; here it starts at 2.
///
/// # Errors
/// [`BasisError::NotDyadic`] for any other schedule; [`BasisError::TooLarge`] as soon as the matrices exceed the
/// limit; otherwise as for [`basis`](super::basis).
pub fn basis_by_squaring(
    diffusion: &Diffusion,
    params: &BasisParams,
    progress: Progress<'_>,
) -> Result<Basis<f64>, BasisError> {
    params.check()?;
    check_steps(diffusion)?;
    let steps = params.steps();
    if let Some(j) = (0..steps.len()).find(|&j| steps[j] != 1 << j) {
        return Err(BasisError::NotDyadic { level: j + 1, steps: steps[j] });
    }
    let n_levels = steps.len();
    let too_large = |needed: u64| BasisError::TooLarge {
        n_levels,
        n_vertices: diffusion.n_vertices(),
        needed,
        limit: params.memory_limit,
    };
    progress.step(0, n_levels as u64)?;
    let mut info = BasisInfo::default();
    let mut scaling: Vec<CompressedRows<f64>> = Vec::with_capacity(n_levels);
    let mut bytes = 0;
    // Algorithm 1: Φ_1 = [T]_r, then Φ_j = [Φ_{j−1}Φ_{j−1}]_{r,ε}
    for &steps in &steps {
        let (level, dropped) = match scaling.last() {
            None => (first_level(diffusion, progress)?, 0.0),
            Some(before) => {
                let room = params.memory_limit.saturating_sub(bytes);
                match square(before, steps, params.drop_tolerance, room, progress)? {
                    ProductOutcome::Complete(product, dropped) => (product, dropped),
                    ProductOutcome::TooLarge(more) => return Err(too_large(bytes + more)),
                }
            }
        };
        bytes += level.bytes();
        if bytes > params.memory_limit {
            return Err(too_large(bytes));
        }
        info.nnz.push(level.nnz() as u64);
        info.bytes.push(level.bytes());
        info.largest_dropped.push(dropped);
        scaling.push(level);
        progress.step(scaling.len() as u64, n_levels as u64)?;
    }
    Ok(Basis { steps, scaling, info })
}

/// Φ_1 with its diagonal and without zeros (Algorithm 1, line 1).
fn first_level(diffusion: &Diffusion, progress: Progress<'_>) -> Result<CompressedRows<f64>, Cancelled> {
    let matrix = diffusion.to_rows(progress)?;
    let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, values: &mut Vec<f64>| {
        let (all, weights) = matrix.row(x);
        for (&y, &w) in all.iter().zip(weights).filter(|(_, w)| **w > 0.0) {
            columns.push(y);
            values.push(w);
        }
    };
    CompressedRows::from_rows(matrix.n_rows(), ROWS_AT_A_TIME, progress, || (), row)
}

/// Result of a product.
enum ProductOutcome {
    /// The matrix, and the largest dropped share of a row.
    Complete(CompressedRows<f64>, f64),
    /// The product exceeds the limit; holds the number of bytes reached.
    TooLarge(u64),
}

/// The product `[AA]_{r,ε}` (Algorithm 1, lines 3 and 4).
///
/// Row x of AA is `Σ_z A(x,z)·(row z of A)`, accumulated in a vector over all vertices (`gustavson1978`).
fn square(
    matrix: &CompressedRows<f64>,
    steps: u64,
    tolerance: f64,
    room: u64,
    progress: Progress<'_>,
) -> Result<ProductOutcome, BasisError> {
    let n = matrix.n_rows();
    let empty_row = AtomicU64::new(u64::MAX);
    let largest_dropped = AtomicU64::new(0);
    let reached = AtomicU64::new(0);
    let row = |(sums, touched): &mut (Vec<f64>, Vec<u32>),
               x: usize,
               columns: &mut Vec<u32>,
               values: &mut Vec<f64>| {
        if reached.load(Ordering::Relaxed) > room {
            return;
        }
        let (through, first) = matrix.row(x);
        for (&z, &a) in through.iter().zip(first) {
            let (ends, second) = matrix.row(z as usize);
            for (&y, &b) in ends.iter().zip(second) {
                if sums[y as usize] == 0.0 {
                    touched.push(y);
                }
                sums[y as usize] += a * b; // Φ_j = Φ_{j−1}Φ_{j−1} (eq. 6)
            }
        }
        touched.sort_unstable();
        touched.dedup(); // a sum that is still 0 after underflow is met again
        let start = values.len();
        let (mut kept, mut all) = (0.0, 0.0_f64);
        for y in touched.drain(..) {
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
        // [·]_r: Σ_y Φ_j(x,y) = 1 (eq. 7)
        for value in &mut values[start..] {
            *value /= kept;
        }
        reached.fetch_add(12 * (values.len() - start) as u64, Ordering::Relaxed);
        // The bit patterns of non-negative numbers have the order of the numbers.
        largest_dropped.fetch_max((1.0 - kept / all).max(0.0).to_bits(), Ordering::Relaxed);
    };
    let scratch = || (vec![0.0_f64; n], Vec::new());
    let squared = CompressedRows::from_rows(n, ROWS_AT_A_TIME, progress, scratch, row)?;
    let reached = reached.into_inner();
    match empty_row.into_inner() {
        u64::MAX if reached > room => Ok(ProductOutcome::TooLarge(reached)),
        u64::MAX => Ok(ProductOutcome::Complete(squared, f64::from_bits(largest_dropped.into_inner()))),
        row => Err(BasisError::EmptyRow { row: row as usize, steps, tolerance }),
    }
}
