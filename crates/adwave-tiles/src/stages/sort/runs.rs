//! Sorted runs: parts of the input that are sorted in memory and written to a file each.

use std::io::Write;
use std::path::{Path, PathBuf};

use adwave::Progress;
use rayon::prelude::*;

use super::curve::{CurveKey, RecordOrder};
use crate::error::TilesError;
use crate::files::{NumberedName, write_unsynced};
use crate::layout::RecordLayout;
use crate::sources::input_shape::InputShape;

/// File of a sorted run, by the index of its first point in the input. Its name and length determine its points,
/// whatever the length of other runs.
pub(crate) const RUN_NAME: NumberedName = NumberedName { prefix: "run-", n_digits: 10, suffix: ".bin" };

/// Records that are read from an input at a time.
pub(crate) const RECORDS_AT_A_TIME: usize = 1 << 19;

/// Number of workers that can each sort a run, even if the memory alone would allow fewer runs.
const MAX_SORTERS: u64 = 8;

/// Number of records of a run whose sort takes half of `memory` bytes.
pub(crate) fn records_per_run(shape: &InputShape, memory: u64) -> usize {
    // A record and its sorted copy, and its key twice, since the sort is out of place.
    let key_bytes = match shape.layout {
        RecordLayout::Las(_) => size_of::<(CurveKey<[i32; 3]>, u32)>(),
        RecordLayout::Mesh(_) => size_of::<(CurveKey<[i64; 3]>, u32)>(),
    };
    let per_record = 2 * shape.layout.record_bytes() + 2 * key_bytes;
    let n_fitting = (memory as usize / 2 / per_record).clamp(RECORDS_AT_A_TIME, u32::MAX as usize / 2);
    n_fitting.min((shape.n_points.div_ceil(MAX_SORTERS) as usize).max(RECORDS_AT_A_TIME))
}

/// Points of a run of a cloud.
pub(crate) struct RunPoints {
    pub(crate) first: u64,
    pub(crate) n: usize,
}

impl RunPoints {
    pub(crate) fn new(run: usize, run_length: usize, n_points: u64) -> Self {
        let first = run as u64 * run_length as u64;
        Self { first, n: n_points.saturating_sub(first).min(run_length as u64) as usize }
    }
}

/// Sorts records and writes them as the run that begins at point `first`.
pub(crate) fn write_run(
    records: &[u8],
    order: impl RecordOrder,
    folder: &Path,
    first: u64,
    progress: Progress<'_>,
) -> Result<PathBuf, TilesError> {
    let record_bytes = order.record_bytes();
    let key = |(i, record): (usize, &[u8])| (order.key(record), i as u32);
    let mut sorted: Vec<(CurveKey<_>, u32)> =
        records.par_chunks_exact(record_bytes).enumerate().map(key).collect();
    progress.check()?;
    // The indices are distinct, so that nothing ties and points at one position keep the order of the input.
    sorted.par_sort_unstable();
    progress.check()?;
    let path = RUN_NAME.path(folder, first);
    // Runs need not be synced: after a power failure the merge detects a wrong order or number of records.
    write_unsynced(&path, |out| {
        sorted
            .iter()
            .try_for_each(|&(_, i)| out.write_all(&records[i as usize * record_bytes..][..record_bytes]))
    })?;
    Ok(path)
}
