//! Inverse incidence lists: the triangles at each vertex, the members of each class, the transpose of a matrix.

use super::Pattern;
use crate::pages::zeros;
use crate::parallel::{self, SERIAL};
use crate::{Cancelled, Progress};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Number of items between two checks for cancellation.
const ITEMS_AT_A_TIME: usize = 1 << 14;

/// Number of rows that a thread numbers at a time.
const ROWS_AT_A_TIME: usize = 1 << 14;

/// Maximal number of parts, each with a count for every row.
const MAX_PARTS: usize = 8;

/// For each of `n_rows` rows, the items of `0..n_items` that name it, in ascending order; an item that names a row
/// twice appears twice. Names of rows that do not exist are skipped. O(names).
///
/// Each thread counts and places the names of a part of the items; its places start after the counts of the parts
/// before it. The number of parts does not change the result.
pub(crate) fn incidence<'a>(
    n_rows: usize,
    n_items: usize,
    progress: Progress<'_>,
    names: impl Fn(usize) -> &'a [u32] + Sync + Send,
) -> Result<Pattern, Cancelled> {
    let n_parts = if n_items <= SERIAL { 1 } else { rayon::current_num_threads().min(MAX_PARTS) };
    let part_of = |part: usize| part * n_items / n_parts..(part + 1) * n_items / n_parts;
    let mut next: Vec<Vec<u32>> = (0..n_parts).map(|_| zeros(n_rows)).collect();
    let counting: Vec<_> = next.iter_mut().enumerate().collect();
    parallel::try_each(counting, n_items, progress, |(part, counts)| {
        visit(part_of(part), progress, &names, |row, _| {
            if let Some(count) = counts.get_mut(row) {
                *count += 1;
            }
        })
    })?;
    let mut offsets: Vec<usize> = zeros(n_rows + 1);
    let count = |x: usize| next.iter().map(|counts| counts[x] as usize).sum::<usize>();
    let ends = parallel::try_map_rows(&mut offsets[1..], 1, ROWS_AT_A_TIME, progress, |first, ends| {
        let mut end = 0;
        for (x, slot) in (first..).zip(ends) {
            end += count(x);
            *slot = end;
        }
        end
    })?;
    let starts: Vec<usize> =
        ends.iter().scan(0, |sum, end| Some(std::mem::replace(sum, *sum + end))).collect();
    parallel::try_visit_rows(&mut offsets[1..], 1, ROWS_AT_A_TIME, progress, |first, ends| {
        for end in ends {
            *end += starts[first / ROWS_AT_A_TIME];
        }
    })?;
    // What each part has counted becomes the place of its first name in the row.
    let mut before: Vec<u32> = zeros(n_rows);
    for counts in &mut next {
        let rows: Vec<_> = counts.chunks_mut(ROWS_AT_A_TIME).zip(before.chunks_mut(ROWS_AT_A_TIME)).collect();
        parallel::try_each(rows, n_rows, progress, |(counts, before)| {
            for (count, before) in counts.iter_mut().zip(before) {
                *before += std::mem::replace(count, *before);
            }
            Ok(())
        })?;
    }
    let items: Vec<AtomicU32> = unwritten(offsets[n_rows]);
    let filling: Vec<_> = next.iter_mut().enumerate().collect();
    parallel::try_each(filling, n_items, progress, |(part, next)| {
        visit(part_of(part), progress, &names, |row, item| {
            if let Some(next) = next.get_mut(row) {
                items[offsets[row] + *next as usize].store(item, Ordering::Relaxed);
                *next += 1;
            }
        })
    })?;
    let items = items.into_iter().map(AtomicU32::into_inner).collect();
    Ok(Pattern::new_unchecked(offsets, items))
}

/// Values that other threads will write.
fn unwritten(n: usize) -> Vec<AtomicU32> {
    zeros::<u32>(n).into_iter().map(AtomicU32::new).collect()
}

/// Calls `hit(row, item)` for each name of some items.
fn visit<'a>(
    items: Range<usize>,
    progress: Progress<'_>,
    names: &impl Fn(usize) -> &'a [u32],
    mut hit: impl FnMut(usize, u32),
) -> Result<(), Cancelled> {
    for start in items.clone().step_by(ITEMS_AT_A_TIME) {
        progress.check()?;
        for item in start..(start + ITEMS_AT_A_TIME).min(items.end) {
            for &row in names(item) {
                hit(row as usize, item as u32);
            }
        }
    }
    Ok(())
}
