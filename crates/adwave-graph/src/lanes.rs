//! Products of a matrix with rows of 1 to 32 lanes.

use crate::lane_rows::LaneNumber;
use adwave::pages::prefetch;
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Largest number of channels of a block.
pub(crate) const MAX_LANES: usize = 32;

/// Rows that a thread processes at a time.
pub(crate) const ROWS_AT_A_TIME: usize = 512;

/// Number of rows from which threads share the work.
pub(crate) const SERIAL: usize = 2048;

/// Number of entries by which rows of lanes are prefetched. Neighbors are scattered over memory, which no hardware
/// prefetcher follows. 32 to 128 entries are equally good; they shorten products of 32 lanes by a third.
const AHEAD: usize = 64;

/// Number of lanes for `width` channels.
pub(crate) fn lanes(width: usize) -> usize {
    match width {
        0 | 1 => 1,
        2..=4 => 4,
        5..=8 => 8,
        9..=16 => 16,
        _ => MAX_LANES,
    }
}

/// Computes `out = rows·now` for `lanes` lanes; both are n × lanes. Sums are in double precision. The bits do not
/// depend on the number of threads.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub(crate) fn multiply<T: LaneNumber>(
    rows: &CompressedRows<f64>,
    lanes: usize,
    now: &[T],
    out: &mut [T],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    match lanes {
        1 => multiply_fixed::<T, 1>(rows, now, out, progress),
        4 => multiply_fixed::<T, 4>(rows, now, out, progress),
        8 => multiply_fixed::<T, 8>(rows, now, out, progress),
        16 => multiply_fixed::<T, 16>(rows, now, out, progress),
        MAX_LANES => multiply_fixed::<T, MAX_LANES>(rows, now, out, progress),
        _ => unreachable!("a block has 1, 4, 8, 16 or 32 lanes, not {lanes}"),
    }
}

fn multiply_fixed<T: LaneNumber, const L: usize>(
    rows: &CompressedRows<f64>,
    now: &[T],
    out: &mut [T],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    progress.check()?;
    let (now, out) = (now.as_chunks::<L>().0, out.as_chunks_mut::<L>().0);
    assert!(
        now.len() == rows.n_rows() && out.len() == rows.n_rows(),
        "a row of lanes for each row of the matrix"
    );
    let arch = Arch::new();
    if out.len() <= SERIAL {
        arch.dispatch(RowsProduct { rows, now, first: 0, out });
        return Ok(());
    }
    out.par_chunks_mut(ROWS_AT_A_TIME).enumerate().try_for_each(|(chunk, out)| {
        progress.check()?;
        arch.dispatch(RowsProduct { rows, now, first: chunk * ROWS_AT_A_TIME, out });
        Ok(())
    })
}

/// Some consecutive rows of a product.
struct RowsProduct<'a, T, const L: usize> {
    rows: &'a CompressedRows<f64>,
    now: &'a [[T; L]],
    first: usize,
    out: &'a mut [[T; L]],
}

impl<T: LaneNumber, const L: usize> NullaryFnOnce for RowsProduct<'_, T, L> {
    type Output = ();

    #[expect(
        clippy::inline_always,
        reason = "the instructions of the dispatch apply to what is inlined into it"
    )]
    #[inline(always)]
    fn call(self) {
        let Self { rows, now, first, out } = self;
        for (x, out) in (first..).zip(out) {
            let (columns, weights) = rows.row(x);
            let later = rows.offsets()[x] + AHEAD;
            let mut sum = [0.0; L];
            for (e, (&y, &w)) in columns.iter().zip(weights).enumerate() {
                if let Some(&column) = rows.columns().get(later + e) {
                    prefetch(now, column as usize);
                }
                let there = &now[y as usize];
                for c in 0..L {
                    sum[c] += w * there[c].widened();
                }
            }
            for (out, v) in out.iter_mut().zip(sum) {
                *out = T::rounded(v);
            }
        }
    }
}
