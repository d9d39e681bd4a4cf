//! All points along one Hilbert curve: runs that fit into memory, merged.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::shape::{HILBERT_BITS, hilbert};
use adwave_io::LasReader;
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::TableBuilder;
use crate::files::write_whole;
use crate::layout::{set_whole, whole};
use crate::plan::{Input, Plan};

/// Place along the curve, then position, so that equal positions are neighbours and nothing else is a tie.
type Key = (u64, [i32; 3]);

/// The curve through the cells of a box.
#[derive(Clone, Copy)]
struct Curve {
    lo: [i32; 3],
    scale: f64,
}

impl Curve {
    fn of((lo, hi): ([i32; 3], [i32; 3])) -> Self {
        let extent = (0..3).map(|c| f64::from(hi[c]) - f64::from(lo[c])).fold(0.0, f64::max);
        let cells = f64::from((1_u32 << HILBERT_BITS) - 1);
        Self { lo, scale: if extent > 0.0 { cells / extent } else { 0.0 } }
    }

    fn key(&self, whole: [i32; 3]) -> Key {
        let most = f64::from((1_u32 << HILBERT_BITS) - 1);
        // Beside the box that a header gives everything is on its side: casts saturate at 0.
        let cell = |c: usize| ((f64::from(whole[c]) - f64::from(self.lo[c])) * self.scale).min(most) as u32;
        (hilbert([cell(0), cell(1), cell(2)]), whole)
    }
}

/// Records that are read from an input at a time.
const AT_A_TIME: usize = 1 << 19;

/// Records of a run, so that sorting them takes half of the memory.
pub(crate) fn records_of_a_run(plan: &Plan) -> usize {
    // A record, its key twice (sorting in parts) and its copy in order.
    let per_record = 2 * plan.layout.record_bytes + 2 * size_of::<(Key, u32)>();
    (plan.params.memory as usize / 2 / per_record).clamp(AT_A_TIME, u32::MAX as usize / 2)
}

/// Sorts the points of all inputs into `records`, with the table of their blocks, written last; by runs of at most `most` records,
/// which has no bearing on the result.
pub(crate) fn sort(
    plan: &Plan,
    folder: &Path,
    most: usize,
    (records, table): (&Path, &Path),
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let curve = Curve::of(plan.cells);
    let bytes = plan.layout.record_bytes;
    let mut runs = Vec::new();
    let mut held: Vec<u8> = Vec::new();
    let mut n_read = 0;
    for input in &plan.inputs {
        let mut reader = open(input)?;
        loop {
            progress.step(n_read, 2 * plan.n_points)?;
            let start = held.len();
            let n = reader.read(AT_A_TIME.min(most - start / bytes), &mut held)?;
            if n == 0 {
                break;
            }
            n_read += n as u64;
            shift(&mut held[start..], bytes, input)?;
            if held.len() / bytes >= most {
                runs.push(write_run(&held, curve, bytes, folder, runs.len(), progress)?);
                held.clear();
            }
        }
    }
    if n_read != plan.n_points {
        return Err(TilesError::Input(format!(
            "the inputs have {n_read} points and their headers promise {}; get unbroken files",
            plan.n_points
        )));
    }
    if !held.is_empty() {
        runs.push(write_run(&held, curve, bytes, folder, runs.len(), progress)?);
    }
    drop(held);
    let mut builder = TableBuilder::new(plan.layout);
    let portion = portion(plan.params.memory, runs.len());
    let n_merged = write_whole(records, |out| {
        merge(&runs, curve, bytes, portion, |key, record, n| {
            if n % (1 << 20) == 0 {
                progress.step(plan.n_points + n, 2 * plan.n_points)?;
            }
            builder.add(key.1);
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
    for run in runs {
        std::fs::remove_file(&run).map_err(TilesError::io(&run))?;
    }
    builder.write(table)
}

/// Opens an input and asks whether it is still the same.
fn open(input: &Input) -> Result<LasReader, TilesError> {
    let reader = LasReader::open(&input.path)?;
    let bytes = std::fs::metadata(&input.path).map_err(TilesError::io(&input.path))?.len();
    if bytes != input.bytes || reader.layout().n_points != input.n_points {
        return Err(TilesError::Input(format!(
            "{} has changed since the work began; delete the folder and begin anew",
            input.path.display()
        )));
    }
    Ok(reader)
}

/// Coordinates as steps from the offset that all inputs share.
fn shift(records: &mut [u8], bytes: usize, input: &Input) -> Result<(), TilesError> {
    if input.shift == [0; 3] {
        return Ok(());
    }
    let shifted = |record: &mut [u8]| {
        let own = whole(record);
        let mut moved = [0; 3];
        for c in 0..3 {
            moved[c] = i32::try_from(i64::from(own[c]) + input.shift[c]).ok()?;
        }
        set_whole(record, moved);
        Some(())
    };
    if records.par_chunks_exact_mut(bytes).any(|record| shifted(record).is_none()) {
        return Err(TilesError::Input(format!(
            "{}: its points are too far from those of the first file for coordinates of 32 bits; split the work",
            input.path.display()
        )));
    }
    Ok(())
}

fn write_run(
    held: &[u8],
    curve: Curve,
    bytes: usize,
    folder: &Path,
    run: usize,
    progress: Progress<'_>,
) -> Result<PathBuf, TilesError> {
    let key = |(i, record): (usize, &[u8])| (curve.key(whole(record)), i as u32);
    let mut order: Vec<(Key, u32)> = held.par_chunks_exact(bytes).enumerate().map(key).collect();
    progress.check()?;
    // Numbers are all different: nothing is a tie, and points at one position keep the order of the inputs.
    order.par_sort_unstable();
    progress.check()?;
    let path = folder.join(format!("run-{run:04}.bin"));
    // Not flushed to the disk: nobody goes on from a run.
    let write = || {
        let mut out = BufWriter::with_capacity(AT_ONCE, File::create(&path)?);
        order.iter().try_for_each(|&(_, i)| out.write_all(&held[i as usize * bytes..][..bytes]))?;
        out.flush()
    };
    write().map_err(TilesError::io(&path))?;
    Ok(path)
}

/// A sorted run, and its records that are in memory.
struct Run<'a> {
    file: File,
    path: &'a Path,
    records: Vec<u8>,
    keys: Vec<Key>,
    /// The record that is next.
    next: usize,
}

impl<'a> Run<'a> {
    fn open(path: &'a Path) -> Result<Self, TilesError> {
        let file = File::open(path).map_err(TilesError::io(path))?;
        Ok(Self { file, path, records: Vec::new(), keys: Vec::new(), next: 0 })
    }

    /// The key of the next record; `None` at the end.
    fn key(&mut self, curve: Curve, bytes: usize, portion: usize) -> Result<Option<Key>, TilesError> {
        if self.next == self.keys.len() {
            self.records.clear();
            let most = (portion / bytes).max(1) * bytes;
            let mut next = (&self.file).take(most as u64);
            next.read_to_end(&mut self.records).map_err(TilesError::io(self.path))?;
            let records = self.records.par_chunks_exact(bytes);
            records.map(|record| curve.key(whole(record))).collect_into_vec(&mut self.keys);
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
    curve: Curve,
    bytes: usize,
    portion: usize,
    mut each: impl FnMut(Key, &[u8], u64) -> Result<(), TilesError>,
) -> Result<u64, TilesError> {
    let mut runs = paths.iter().map(|path| Run::open(path)).collect::<Result<Vec<_>, _>>()?;
    let mut heads = BinaryHeap::with_capacity(paths.len());
    for (i, run) in runs.iter_mut().enumerate() {
        heads.extend(run.key(curve, bytes, portion)?.map(|key| Reverse((key, i))));
    }
    let mut n = 0;
    while let Some(mut head) = heads.peek_mut() {
        let Reverse((key, i)) = *head;
        let run = &mut runs[i];
        each(key, &run.records[run.next * bytes..][..bytes], n)?;
        n += 1;
        run.next += 1;
        if let Some(key) = run.key(curve, bytes, portion)? {
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
        let curve = Curve { lo: [0; 3], scale: 1.0 };
        let folder = tempfile::tempdir().unwrap();
        let paths = [folder.path().join("a"), folder.path().join("b")];
        let record = |x: i32| [x, 0, 0].iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>();
        let mut order: Vec<i32> = (0..100).collect();
        order.sort_by_key(|&x| curve.key([x, 0, 0]));
        for (k, path) in paths.iter().enumerate() {
            let own = order.iter().skip(k).step_by(2);
            std::fs::write(path, own.flat_map(|&x| record(x)).collect::<Vec<u8>>()).unwrap();
        }
        let merged = |portion| {
            let mut all = Vec::new();
            let n = merge(&paths, curve, 12, portion, |key, _, _| {
                all.push(key.1[0]);
                Ok(())
            });
            assert_eq!(n.unwrap(), all.len() as u64);
            all
        };
        for portion in [1, 30, 1 << 20] {
            assert_eq!(merged(portion), order, "{portion}");
        }
        File::options().write(true).open(&paths[1]).unwrap().set_len(50 * 12 - 1).unwrap();
        assert_eq!(merged(30).len(), 99);
    }
}
