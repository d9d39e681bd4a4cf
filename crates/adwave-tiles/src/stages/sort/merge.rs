//! The merge of sorted runs.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::curve::{CurveKey, RecordOrder};
use crate::error::TilesError;

/// A sorted run, with a buffer of its next records.
struct SortedRun<'a, P> {
    file: File,
    path: &'a Path,
    records: Vec<u8>,
    keys: Vec<CurveKey<P>>,
    /// Index of the next record in the buffer.
    next: usize,
}

impl<'a, P: Copy + Send> SortedRun<'a, P> {
    fn open(path: &'a Path) -> Result<Self, TilesError> {
        let file = File::open(path).map_err(TilesError::io(path))?;
        Ok(Self { file, path, records: Vec::new(), keys: Vec::new(), next: 0 })
    }

    /// Key of the next record; `None` at the end. An empty buffer is filled by about `n_bytes` bytes.
    fn next_key(
        &mut self,
        order: impl RecordOrder<Position = P>,
        n_bytes: usize,
    ) -> Result<Option<CurveKey<P>>, TilesError> {
        if self.next == self.keys.len() {
            let record_bytes = order.record_bytes();
            self.records.clear();
            let limit = (n_bytes / record_bytes).max(1) * record_bytes;
            let mut part = (&self.file).take(limit as u64);
            part.read_to_end(&mut self.records).map_err(TilesError::io(self.path))?;
            let records = self.records.par_chunks_exact(record_bytes);
            records.map(|record| order.key(record)).collect_into_vec(&mut self.keys);
            self.next = 0;
        }
        Ok(self.keys.get(self.next).copied())
    }
}

/// Largest and smallest number of bytes that are read from a run at a time.
const MAX_READ: usize = 1 << 22;
const MIN_READ: usize = 1 << 16;

/// Number of bytes to read from each run at a time, so that all buffers with their keys take less than half of `memory`
/// bytes.
pub(crate) fn bytes_per_read(memory: u64, n_runs: usize) -> usize {
    (memory as usize / 4 / n_runs.max(1)).clamp(MIN_READ, MAX_READ)
}

/// Calls `visit(record, index)` for all records of the runs in order. Records with equal positions come in the order of
/// the runs. Returns their number.
pub(crate) fn merge_runs(
    paths: &[PathBuf],
    order: impl RecordOrder,
    n_bytes: usize,
    mut visit: impl FnMut(&[u8], u64) -> Result<(), TilesError>,
) -> Result<u64, TilesError> {
    let record_bytes = order.record_bytes();
    let mut runs = paths.iter().map(|path| SortedRun::open(path)).collect::<Result<Vec<_>, _>>()?;
    let mut heads = BinaryHeap::with_capacity(paths.len());
    for (i, run) in runs.iter_mut().enumerate() {
        heads.extend(run.next_key(order, n_bytes)?.map(|key| Reverse((key, i))));
    }
    let (mut n, mut last) = (0, None);
    while let Some(mut head) = heads.peek_mut() {
        let Reverse((key, i)) = *head;
        let run = &mut runs[i];
        if last.is_some_and(|last| last > key) {
            return Err(TilesError::broken(run.path, "it is not sorted"));
        }
        last = Some(key);
        visit(&run.records[run.next * record_bytes..][..record_bytes], n)?;
        n += 1;
        run.next += 1;
        if let Some(key) = run.next_key(order, n_bytes)? {
            *head = Reverse((key, i));
        } else {
            PeekMut::pop(head);
        }
    }
    Ok(n)
}

#[cfg(test)]
mod tests {
    use super::super::curve::{HilbertCurve, LasOrder};
    use super::*;
    use crate::layout::quantized_xyz;

    #[test]
    fn many_runs_share_the_memory() {
        assert_eq!(bytes_per_read(4 << 30, 6), MAX_READ);
        assert_eq!(bytes_per_read(1 << 30, 1000), (1 << 28) / 1000);
        assert_eq!(bytes_per_read(0, 0), MIN_READ);
    }

    #[test]
    fn reads_of_any_length_merge_alike_and_a_truncated_run_is_counted() {
        let order = LasOrder { curve: HilbertCurve { min: [0.0; 3], scale: 1.0 }, record_bytes: 12 };
        let folder = tempfile::tempdir().unwrap();
        let paths = [folder.path().join("a"), folder.path().join("b")];
        let record = |x: i32| [x, 0, 0].iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>();
        let mut sorted: Vec<i32> = (0..100).collect();
        sorted.sort_by_key(|&x| order.key(&record(x)));
        for (k, path) in paths.iter().enumerate() {
            let half = sorted.iter().skip(k).step_by(2);
            std::fs::write(path, half.flat_map(|&x| record(x)).collect::<Vec<u8>>()).unwrap();
        }
        let merge = |n_bytes| {
            let mut all = Vec::new();
            let n = merge_runs(&paths, order, n_bytes, |record, _| {
                all.push(quantized_xyz(record)[0]);
                Ok(())
            });
            assert_eq!(n.unwrap(), all.len() as u64);
            all
        };
        for n_bytes in [1, 30, 1 << 20] {
            assert_eq!(merge(n_bytes), sorted, "{n_bytes}");
        }
        File::options().write(true).open(&paths[1]).unwrap().set_len(50 * 12 - 1).unwrap();
        assert_eq!(merge(30).len(), 99);
        // As after a power failure.
        std::fs::write(&paths[1], [0; 50 * 12]).unwrap();
        std::fs::write(&paths[0], [record(9), record(3)].concat()).unwrap();
        let error = merge_runs(&paths, order, 30, |_, _| Ok(())).unwrap_err().to_string();
        assert!(error.contains("it is not sorted"), "{error}");
    }
}
