//! Construction of rows chunk by chunk on all threads, and parallel access to their values.

use super::{CompressedRows, Pattern};
use crate::parallel;
use crate::{Cancelled, Progress};
use std::ops::Range;

/// Number of rows that a thread builds at a time if rows are short; results do not depend on it.
pub(crate) fn rows_at_a_time(n_rows: usize) -> usize {
    if n_rows < 1 << 16 { 256 } else { 2048 }
}

/// The rows of a chunk, before their final position is known.
struct RowChunk<V> {
    counts: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<V>,
}

impl<V: Copy + Default + Send + Sync> CompressedRows<V> {
    /// Builds the rows `0..n_rows`; `row(scratch, x, columns, values)` appends the entries of row `x` with
    /// ascending columns, one value per column (for a pattern, columns only).
    ///
    /// The matrix is in memory twice while its chunks are concatenated.
    pub(crate) fn from_rows<S>(
        n_rows: usize,
        at_a_time: usize,
        progress: Progress<'_>,
        scratch: impl Fn() -> S + Sync + Send,
        row: impl Fn(&mut S, usize, &mut Vec<u32>, &mut Vec<V>) + Sync + Send,
    ) -> Result<Self, Cancelled> {
        let chunks = parallel::try_map_chunks(n_rows, at_a_time, progress, scratch, |scratch, range| {
            let mut chunk =
                RowChunk { counts: Vec::with_capacity(range.len()), columns: Vec::new(), values: Vec::new() };
            for x in range {
                let start = chunk.columns.len();
                row(scratch, x, &mut chunk.columns, &mut chunk.values);
                chunk.counts.push((chunk.columns.len() - start) as u32);
            }
            chunk
        })?;
        let nnz = chunks.iter().map(|chunk| chunk.columns.len()).sum();
        let mut offsets: Vec<usize> = vec![0; n_rows + 1];
        let mut columns: Vec<u32> = crate::pages::zeros(nnz);
        // A pattern has no values, and a vector of zero-sized values has no bytes.
        let mut values: Vec<V> = crate::pages::zeros(nnz);
        let (mut free_ends, mut free_columns, mut free_values) =
            (&mut offsets[1..], columns.as_mut_slice(), values.as_mut_slice());
        let mut places = Vec::with_capacity(chunks.len());
        let mut start = 0;
        for chunk in chunks {
            let (ends, after) = std::mem::take(&mut free_ends).split_at_mut(chunk.counts.len());
            free_ends = after;
            let (columns, after) = std::mem::take(&mut free_columns).split_at_mut(chunk.columns.len());
            free_columns = after;
            let (values, after) = std::mem::take(&mut free_values).split_at_mut(chunk.columns.len());
            free_values = after;
            start += columns.len();
            places.push((chunk, start - columns.len(), ends, columns, values));
        }
        parallel::try_each(places, n_rows, progress, |(chunk, start, ends, columns, values)| {
            let mut end = start;
            for (slot, count) in ends.iter_mut().zip(&chunk.counts) {
                end += *count as usize;
                *slot = end;
            }
            columns.copy_from_slice(&chunk.columns);
            values[..chunk.values.len()].copy_from_slice(&chunk.values);
            Ok(())
        })?;
        Ok(Self::new_unchecked(Pattern::new_unchecked(offsets, columns), values))
    }
}

/// Calls `work(rows, values, per_row)` for chunks of the rows of `pattern`, with the values of their entries and
/// one datum per row.
pub(crate) fn try_visit_entries<V: Send, R: Send>(
    pattern: &Pattern,
    values: &mut [V],
    per_row: &mut [R],
    progress: Progress<'_>,
    work: impl Fn(Range<usize>, &mut [V], &mut [R]) + Sync + Send,
) -> Result<(), Cancelled> {
    let n = pattern.n_rows();
    let at_a_time = rows_at_a_time(n);
    let (mut values, mut per_row) = (values, per_row);
    let mut chunks = Vec::with_capacity(n.div_ceil(at_a_time));
    for first in (0..n).step_by(at_a_time) {
        let end = (first + at_a_time).min(n);
        let n_entries = pattern.offsets()[end] - pattern.offsets()[first];
        let (these, after) = std::mem::take(&mut values).split_at_mut(n_entries);
        values = after;
        let (rows, after) = std::mem::take(&mut per_row).split_at_mut(end - first);
        per_row = after;
        chunks.push((first..end, these, rows));
    }
    parallel::try_each(chunks, n, progress, |(range, values, rows)| {
        work(range, values, rows);
        Ok(())
    })
}
