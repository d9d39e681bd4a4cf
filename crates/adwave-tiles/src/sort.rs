//! All points along one Hilbert curve: runs that fit into memory, merged.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::shape::{HILBERT_BITS, hilbert};
use rayon::prelude::*;

use crate::blocks::TableBuilder;
use crate::files::{write_unflushed, write_whole};
use crate::layout::{Layout, Lengths, Steps, coordinates, whole};
use crate::plan::Plan;
use crate::{TilesError, cloud, mesh, names};

/// Place along the curve, then position, so that equal positions are neighbors and nothing else is a tie.
pub(crate) type Key<P> = (u64, P);

/// How records lie along the curve.
pub(crate) trait Order: Copy + Sync {
    /// What says exactly where a point is.
    type Position: Copy + Ord + Send + Sync;
    /// Bytes of a record.
    fn record_bytes(self) -> usize;
    fn key(self, record: &[u8]) -> Key<Self::Position>;
}

/// The curve through the cells of a box.
#[derive(Clone, Copy)]
struct Curve {
    lo: [f64; 3],
    scale: f64,
}

impl Curve {
    fn of((lo, hi): ([f64; 3], [f64; 3])) -> Self {
        let extent = (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max);
        let cells = f64::from((1_u32 << HILBERT_BITS) - 1);
        Self { lo, scale: if extent > 0.0 { cells / extent } else { 0.0 } }
    }

    fn place(&self, point: [f64; 3]) -> u64 {
        let most = f64::from((1_u32 << HILBERT_BITS) - 1);
        // Beside the box that a header gives everything is on its side: casts saturate at 0.
        let cell = |c: usize| ((point[c] - self.lo[c]) * self.scale).min(most) as u32;
        hilbert([cell(0), cell(1), cell(2)])
    }
}

/// Records of LAS, by their whole coordinates.
#[derive(Clone, Copy)]
struct WholeOrder {
    curve: Curve,
    record_bytes: usize,
}

impl Order for WholeOrder {
    type Position = [i32; 3];

    fn record_bytes(self) -> usize {
        self.record_bytes
    }

    fn key(self, record: &[u8]) -> Key<[i32; 3]> {
        let whole = whole(record);
        (self.curve.place(whole.map(f64::from)), whole)
    }
}

/// Records of vertices, by their coordinates.
#[derive(Clone, Copy)]
struct VertexOrder {
    curve: Curve,
}

impl Order for VertexOrder {
    type Position = [i64; 3];

    fn record_bytes(self) -> usize {
        Lengths::RECORD_BYTES
    }

    fn key(self, record: &[u8]) -> Key<[i64; 3]> {
        let position = coordinates(record);
        // Whole numbers in the order of the coordinates.
        let rank = |c: f64| {
            let bits = c.to_bits().cast_signed();
            bits ^ (((bits >> 63).cast_unsigned()) >> 1).cast_signed()
        };
        (self.curve.place(position), position.map(rank))
    }
}

/// Records that are read from an input at a time.
pub(crate) const AT_A_TIME: usize = 1 << 19;

/// Records of a run, so that sorting them takes half of the memory.
pub(crate) fn records_of_a_run(plan: &Plan) -> usize {
    // A record, its key twice (sorting in parts) and its copy in order.
    let key_bytes = match plan.layout {
        Layout::Las(_) => size_of::<(Key<[i32; 3]>, u32)>(),
        Layout::Mesh(_) => size_of::<(Key<[i64; 3]>, u32)>(),
    };
    let per_record = 2 * plan.layout.record_bytes() + 2 * key_bytes;
    let fits = (plan.params.memory as usize / 2 / per_record).clamp(AT_A_TIME, u32::MAX as usize / 2);
    // Several, so that as many workers can sort.
    fits.min((plan.n_points.div_ceil(MOST_SORTERS) as usize).max(AT_A_TIME))
}

/// Workers that may each sort a run of their own, where memory alone would allow fewer runs.
const MOST_SORTERS: u64 = 8;

/// Appends at most so many of the next records of all inputs; how many, which is 0 only at the end.
pub(crate) type NextRecords<'a> = dyn FnMut(usize, &mut Vec<u8>) -> Result<usize, TilesError> + 'a;

/// Sorts the points of all inputs into `records`, with the table of their blocks, written last; by runs of at most `most` records,
/// which has no bearing on the result.
pub(crate) fn sort(
    plan: &Plan,
    folder: &Path,
    most: usize,
    files: (&Path, &Path),
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let curve = Curve::of(plan.bounds);
    let sorting = Sorting { plan, folder, most, progress };
    match plan.layout {
        Layout::Las(steps) => {
            // Where all runs are there, nothing else looks at the inputs.
            cloud::check(&plan.inputs)?;
            let order = WholeOrder { curve, record_bytes: steps.record_bytes };
            let runs = 0..n_runs(plan, most);
            let runs = runs.map(|run| sorting.cloud_run(order, steps, run)).collect::<Result<Vec<_>, _>>()?;
            sorting.merge(order, &runs, files)
        }
        Layout::Mesh(_) => {
            let order = VertexOrder { curve };
            let runs = sorting.runs(order, &mut mesh::records(&plan.inputs)?)?;
            sorting.merge(order, &runs, files)
        }
    }
}

/// How many runs of at most `most` records the points of a cloud are; the vertices of a mesh are not found without reading all before.
pub(crate) fn n_runs(plan: &Plan, most: usize) -> usize {
    match plan.layout {
        Layout::Las(_) => plan.n_points.div_ceil(most as u64) as usize,
        Layout::Mesh(_) => 0,
    }
}

/// Sorts one run of a cloud: the `run`-th `most` points of the inputs.
pub(crate) fn sort_run(
    plan: &Plan,
    folder: &Path,
    most: usize,
    run: usize,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let Layout::Las(steps) = plan.layout else { return Ok(()) };
    let order = WholeOrder { curve: Curve::of(plan.bounds), record_bytes: steps.record_bytes };
    Sorting { plan, folder, most, progress }.cloud_run(order, steps, run).map(|_| ())
}

/// Whether the run of a cloud is there, whole.
pub(crate) fn has_run(plan: &Plan, folder: &Path, most: usize, run: usize) -> bool {
    let (first, n) = points_of_run(plan, most, run);
    let n_bytes = (n * plan.layout.record_bytes()) as u64;
    names::run(folder, first).metadata().is_ok_and(|file| file.len() == n_bytes)
}

/// The first point of a run of a cloud, and how many.
fn points_of_run(plan: &Plan, most: usize, run: usize) -> (u64, usize) {
    let first = run as u64 * most as u64;
    (first, plan.n_points.saturating_sub(first).min(most as u64) as usize)
}

struct Sorting<'a> {
    plan: &'a Plan,
    folder: &'a Path,
    most: usize,
    progress: Progress<'a>,
}

impl Sorting<'_> {
    /// All runs as `records`, with the table of their blocks.
    fn merge(
        &self,
        order: impl Order,
        runs: &[PathBuf],
        (records, table): (&Path, &Path),
    ) -> Result<(), TilesError> {
        let Self { plan, folder, progress, .. } = *self;
        let mut builder = TableBuilder::new(plan.layout);
        let portion = portion(plan.params.memory, runs.len());
        let n_merged = write_whole(records, |out| {
            merge(runs, order, portion, |record, n| {
                if n % (1 << 20) == 0 {
                    progress.step(plan.n_points + n, 2 * plan.n_points)?;
                }
                builder.add(record);
                out.write_all(record).map_err(TilesError::io(records))
            })
        })?;
        if n_merged != plan.n_points {
            return Err(TilesError::Input(format!(
                "{} of {} points came back from the sorted runs in {}; check the disk and begin anew",
                n_merged,
                plan.n_points,
                folder.display()
            )));
        }
        builder.write(table)
    }

    /// A sorted run of a cloud, unless it is there already.
    fn cloud_run(&self, order: WholeOrder, steps: Steps, run: usize) -> Result<PathBuf, TilesError> {
        let Self { plan, folder, most, progress, .. } = *self;
        let (first, n) = points_of_run(plan, most, run);
        if has_run(plan, folder, most, run) {
            return Ok(names::run(folder, first));
        }
        let mut next = cloud::records(&plan.inputs, steps, first);
        let (mut held, mut n_read) = (Vec::with_capacity(n * order.record_bytes), 0);
        while n_read < n {
            progress.step(first + n_read as u64, 2 * plan.n_points)?;
            match next(AT_A_TIME.min(n - n_read), &mut held)? {
                0 => return Err(fewer(first + n_read as u64, plan)),
                more => n_read += more,
            }
        }
        write_run(&held, order, folder, first, progress)
    }

    /// Sorted runs of all records.
    fn runs(&self, order: impl Order, next: &mut NextRecords<'_>) -> Result<Vec<PathBuf>, TilesError> {
        let Self { plan, folder, most, progress, .. } = *self;
        let bytes = order.record_bytes();
        let (mut runs, mut held, mut n_read) = (Vec::new(), Vec::new(), 0);
        loop {
            progress.step(n_read, 2 * plan.n_points)?;
            let n = next(AT_A_TIME.min(most - held.len() / bytes), &mut held)?;
            n_read += n as u64;
            if held.len() / bytes >= most || n == 0 && !held.is_empty() {
                let first = n_read - (held.len() / bytes) as u64;
                runs.push(write_run(&held, order, folder, first, progress)?);
                held.clear();
            }
            if n == 0 {
                break;
            }
        }
        if n_read != plan.n_points {
            return Err(fewer(n_read, plan));
        }
        Ok(runs)
    }
}

fn fewer(n_read: u64, plan: &Plan) -> TilesError {
    TilesError::Input(format!(
        "the inputs have {n_read} points and their headers promise {}; get unbroken files",
        plan.n_points
    ))
}

fn write_run(
    held: &[u8],
    order: impl Order,
    folder: &Path,
    first: u64,
    progress: Progress<'_>,
) -> Result<PathBuf, TilesError> {
    let bytes = order.record_bytes();
    let key = |(i, record): (usize, &[u8])| (order.key(record), i as u32);
    let mut sorted: Vec<(Key<_>, u32)> = held.par_chunks_exact(bytes).enumerate().map(key).collect();
    progress.check()?;
    // Numbers are all different: nothing is a tie, and points at one position keep the order of the inputs.
    sorted.par_sort_unstable();
    progress.check()?;
    let path = names::run(folder, first);
    // Whole under its name, but not flushed to the disk: where the machine fails, the order and number of what is merged tell.
    write_unflushed(&path, |out| {
        sorted.iter().try_for_each(|&(_, i)| out.write_all(&held[i as usize * bytes..][..bytes]))
    })?;
    Ok(path)
}

/// A sorted run, and its records that are in memory.
struct Run<'a, P> {
    file: File,
    path: &'a Path,
    records: Vec<u8>,
    keys: Vec<Key<P>>,
    /// The record that is next.
    next: usize,
}

impl<'a, P: Copy + Send> Run<'a, P> {
    fn open(path: &'a Path) -> Result<Self, TilesError> {
        let file = File::open(path).map_err(TilesError::io(path))?;
        Ok(Self { file, path, records: Vec::new(), keys: Vec::new(), next: 0 })
    }

    /// The key of the next record; `None` at the end.
    fn key(&mut self, order: impl Order<Position = P>, portion: usize) -> Result<Option<Key<P>>, TilesError> {
        if self.next == self.keys.len() {
            let bytes = order.record_bytes();
            self.records.clear();
            let most = (portion / bytes).max(1) * bytes;
            let mut next = (&self.file).take(most as u64);
            next.read_to_end(&mut self.records).map_err(TilesError::io(self.path))?;
            let records = self.records.par_chunks_exact(bytes);
            records.map(|record| order.key(record)).collect_into_vec(&mut self.keys);
            self.next = 0;
        }
        Ok(self.keys.get(self.next).copied())
    }
}

/// Bytes of each run that are read, or written, at a time: as many as this, and fewer where so many runs would take much memory.
const AT_ONCE: usize = 1 << 22;
const FEWEST_AT_ONCE: usize = 1 << 16;

/// Bytes of each of some runs that are read at a time, so that with their keys they take less than half of the memory.
fn portion(memory: u64, n_runs: usize) -> usize {
    (memory as usize / 4 / n_runs.max(1)).clamp(FEWEST_AT_ONCE, AT_ONCE)
}

/// All records of the runs in their order; of equal positions those of earlier runs first. Gives their number.
fn merge(
    paths: &[PathBuf],
    order: impl Order,
    portion: usize,
    mut each: impl FnMut(&[u8], u64) -> Result<(), TilesError>,
) -> Result<u64, TilesError> {
    let bytes = order.record_bytes();
    let mut runs = paths.iter().map(|path| Run::open(path)).collect::<Result<Vec<_>, _>>()?;
    let mut heads = BinaryHeap::with_capacity(paths.len());
    for (i, run) in runs.iter_mut().enumerate() {
        heads.extend(run.key(order, portion)?.map(|key| Reverse((key, i))));
    }
    let (mut n, mut last) = (0, None);
    while let Some(mut head) = heads.peek_mut() {
        let Reverse((key, i)) = *head;
        let run = &mut runs[i];
        if last.is_some_and(|last| last > key) {
            return Err(TilesError::broken(run.path, "it is not sorted"));
        }
        last = Some(key);
        each(&run.records[run.next * bytes..][..bytes], n)?;
        n += 1;
        run.next += 1;
        if let Some(key) = run.key(order, portion)? {
            *head = Reverse((key, i));
        } else {
            PeekMut::pop(head);
        }
    }
    Ok(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_runs_share_the_memory() {
        assert_eq!(portion(4 << 30, 6), AT_ONCE);
        assert_eq!(portion(1 << 30, 1000), (1 << 28) / 1000);
        assert_eq!(portion(0, 0), FEWEST_AT_ONCE);
    }

    #[test]
    fn runs_are_merged_by_any_portion_and_a_cut_one_is_counted() {
        let order = WholeOrder { curve: Curve { lo: [0.0; 3], scale: 1.0 }, record_bytes: 12 };
        let folder = tempfile::tempdir().unwrap();
        let paths = [folder.path().join("a"), folder.path().join("b")];
        let record = |x: i32| [x, 0, 0].iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>();
        let mut sorted: Vec<i32> = (0..100).collect();
        sorted.sort_by_key(|&x| order.key(&record(x)));
        for (k, path) in paths.iter().enumerate() {
            let own = sorted.iter().skip(k).step_by(2);
            std::fs::write(path, own.flat_map(|&x| record(x)).collect::<Vec<u8>>()).unwrap();
        }
        let merged = |portion| {
            let mut all = Vec::new();
            let n = merge(&paths, order, portion, |record, _| {
                all.push(whole(record)[0]);
                Ok(())
            });
            assert_eq!(n.unwrap(), all.len() as u64);
            all
        };
        for portion in [1, 30, 1 << 20] {
            assert_eq!(merged(portion), sorted, "{portion}");
        }
        File::options().write(true).open(&paths[1]).unwrap().set_len(50 * 12 - 1).unwrap();
        assert_eq!(merged(30).len(), 99);
        // Of a machine that failed.
        std::fs::write(&paths[1], [0; 50 * 12]).unwrap();
        std::fs::write(&paths[0], [record(9), record(3)].concat()).unwrap();
        let error = merge(&paths, order, 30, |_, _| Ok(())).unwrap_err().to_string();
        assert!(error.contains("it is not sorted"), "{error}");
    }
}
