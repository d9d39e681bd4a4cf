//! Inverse incidence lists: the triangles at each vertex, the members of each class, the transpose of a matrix.

use super::Pattern;
use crate::parallel::{self, SERIAL};
use crate::{Cancelled, Progress};

/// Number of items between two checks for cancellation.
const ITEMS_AT_A_TIME: usize = 1 << 14;

/// Maximal number of threads; more would mostly read names that belong to others.
const MAX_PARTS: usize = 8;

/// For each of `n_rows` rows, the items of `0..n_items` that name it, in ascending order; an item that names a row
/// twice appears twice. Names of rows that do not exist are skipped. O(names).
///
/// Each thread owns some rows and reads all names, so no two threads write to the same place.
pub(crate) fn incidence<'a>(
    n_rows: usize,
    n_items: usize,
    progress: Progress<'_>,
    names: impl Fn(usize) -> &'a [u32] + Sync + Send,
) -> Result<Pattern, Cancelled> {
    let n_parts = if n_items <= SERIAL { 1 } else { rayon::current_num_threads().min(MAX_PARTS) };
    let rows_a_part = n_rows.div_ceil(n_parts).max(1);
    let mut offsets = vec![0_usize; n_rows + 1];
    let counting: Vec<(usize, &mut [usize])> =
        offsets[1..].chunks_mut(rows_a_part).enumerate().map(|(k, part)| (k * rows_a_part, part)).collect();
    parallel::try_each(counting, n_items, progress, |(first, counts)| {
        visit(first, counts.len(), n_items, progress, &names, |row, _| counts[row] += 1)
    })?;
    for x in 0..n_rows {
        offsets[x + 1] += offsets[x];
    }
    progress.check()?;
    let mut items: Vec<u32> = crate::pages::zeros(offsets[n_rows]);
    let mut rest = items.as_mut_slice();
    let mut filling: Vec<(usize, &mut [u32])> = Vec::with_capacity(n_parts);
    for first in (0..n_rows).step_by(rows_a_part) {
        let end = (first + rows_a_part).min(n_rows);
        let (part, after) = std::mem::take(&mut rest).split_at_mut(offsets[end] - offsets[first]);
        filling.push((first, part));
        rest = after;
    }
    parallel::try_each(filling, n_items, progress, |(first, part)| {
        let starts = &offsets[first..(first + rows_a_part).min(n_rows)];
        let mut next: Vec<usize> = starts.iter().map(|start| start - starts[0]).collect();
        visit(first, starts.len(), n_items, progress, &names, |row, item| {
            part[next[row]] = item;
            next[row] += 1;
        })
    })?;
    Ok(Pattern::new_unchecked(offsets, items))
}

/// Calls `hit(row − first, item)` for each name of one of the `n` rows from `first` on.
fn visit<'a>(
    first: usize,
    n: usize,
    n_items: usize,
    progress: Progress<'_>,
    names: &impl Fn(usize) -> &'a [u32],
    mut hit: impl FnMut(usize, u32),
) -> Result<(), Cancelled> {
    for start in (0..n_items).step_by(ITEMS_AT_A_TIME) {
        progress.check()?;
        for item in start..(start + ITEMS_AT_A_TIME).min(n_items) {
            for &row in names(item) {
                // For a row before the first one the difference wraps around to a large number.
                let local = (row as usize).wrapping_sub(first);
                if local < n {
                    hit(local, item as u32);
                }
            }
        }
    }
    Ok(())
}
