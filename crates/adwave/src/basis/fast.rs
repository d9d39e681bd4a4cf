//! All levels of the basis in one sweep over blocks of neighboring vertices.

use super::forecast::forecast;
use super::local_columns::{LANES, LocalColumns};
use super::pack::{PackedRows, pack};
use super::sweep::{BlockSweep, SweepControl};
use super::transpose::Transpose;
use super::{Basis, BasisError, BasisInfo, BasisParams, check_steps};
use crate::Progress;
use crate::operator::Diffusion;
use crate::rows::{CompressedRows, Pattern};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Blocks of a batch per thread. A batch is packed block by block and copied into the result once the number of
/// entries of all its blocks is known; it is small enough to stay in the cache.
const BLOCKS_A_THREAD: usize = 12;

/// Memory reserved for a level relative to its forecast. Pages that are not written cost nothing.
const SPARE: f64 = 1.25;

/// Working memory of a thread for one block.
#[derive(Debug)]
pub(super) struct BlockWorker {
    pub(super) columns: LocalColumns,
    lanes_first: Vec<f32>,
}

/// Free workers; each thread creates at most one.
#[derive(Debug)]
pub(super) struct WorkerPool {
    n_vertices: usize,
    free: Mutex<Vec<BlockWorker>>,
}

impl WorkerPool {
    pub(super) fn new(n_vertices: usize) -> Self {
        Self { n_vertices, free: Mutex::new(Vec::new()) }
    }

    pub(super) fn take(&self) -> BlockWorker {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| BlockWorker {
            columns: LocalColumns::new(self.n_vertices),
            lanes_first: Vec::new(),
        })
    }

    pub(super) fn give(&self, worker: BlockWorker) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(worker);
    }

    /// Bytes of all workers and of a batch, for levels with `nnz` entries.
    pub(super) fn bytes(n: usize, nnz: &[u64]) -> u64 {
        let threads = rayon::current_num_threads() as u64;
        let of_row = |nnz: u64| nnz / n.max(1) as u64 + 1;
        let widest = nnz.iter().map(|&nnz| of_row(nnz)).max().unwrap_or(0);
        // Three arrays of columns and one transposed, over about three times the vertices of a single row, each
        // with a local row of about ten entries.
        let worker = 5 * n as u64 + 3 * widest * (4 * 4 * LANES as u64 + 80);
        let packed: u64 = nnz.iter().map(|&nnz| 8 * LANES as u64 * of_row(nnz)).sum();
        threads * (worker + BLOCKS_A_THREAD as u64 * packed)
    }
}

/// Packed rows of one block, and the share of a row that each level dropped.
#[derive(Debug)]
struct LevelSlot {
    levels: Vec<PackedRows>,
    dropped: Vec<f64>,
}

/// Scaling functions Φ_1 … Φ_J for the steps of `params.schedule`, in single precision.
///
/// Rows of `Φ₁^{n_j}` with entries below ε dropped and the rest divided by their sum. Agrees with
/// [`basis_by_squaring`] to 1e-5 in every value and to 2 % in the number of entries; here entries are dropped once,
/// not again on every level. Each step is a product with Φ₁ᵀ over the reached vertices, so the cost is at most
/// O(n_J · entries of Φ_J); from 256 steps beyond the 64th on, a Chebyshev recurrence is used instead if the walk
/// is reversible. Works for every diffusion operator. The result has the same bits on any number of threads.
///
/// # Errors
/// [`BasisError::TooLarge`] before large memory is allocated; [`BasisError::EmptyRow`]; [`BasisError`] for an
/// invalid tolerance or if the call is cancelled.
///
/// [`basis_by_squaring`]: super::basis_by_squaring
///
/// ```
/// use adwave::basis::{BasisError, BasisParams, basis};
/// use adwave::{Progress, bands::Schedule, operator::Diffusion};
/// let walk = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.75, 0.25, 0.25, 0.75])?;
/// let params = BasisParams::new(Schedule::dyadic(3)?);
/// let basis_of_two = basis(&walk, &params, Progress::none())?;
/// assert_eq!(basis_of_two.scaling[2].get(0, 1), 0.46875); // (1 − 2⁻⁴)/2
/// let refused = basis(&walk, &params.with_memory_limit(10), Progress::none());
/// assert!(matches!(refused, Err(BasisError::TooLarge { limit: 10, .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn basis(
    diffusion: &Diffusion,
    params: &BasisParams,
    progress: Progress<'_>,
) -> Result<Basis, BasisError> {
    params.check()?;
    check_steps(diffusion)?;
    let n = diffusion.n_vertices();
    let n_blocks = n.div_ceil(LANES);
    progress.step(0, n_blocks as u64)?;
    let transpose = Transpose::new(diffusion);
    let walk = BlockSweep::new(diffusion, &transpose, params, progress);
    let workers = WorkerPool::new(n);
    let forecast = forecast::<f32>(&walk, &workers, 1)?;

    let n_levels = params.schedule.n_levels();
    let mut levels: Vec<Growing> = forecast.nnz.iter().map(|&nnz| Growing::new(n, nnz)).collect();
    let mut largest_dropped = vec![0.0_f64; n_levels];
    let batch = BLOCKS_A_THREAD * rayon::current_num_threads();
    let mut slots: Vec<LevelSlot> = (0..batch.min(n_blocks))
        .map(|_| LevelSlot {
            levels: (0..n_levels).map(|_| PackedRows::default()).collect(),
            dropped: vec![0.0; n_levels],
        })
        .collect();
    for start in (0..n_blocks).step_by(batch) {
        progress.step(start as u64, n_blocks as u64)?;
        let slots = &mut slots[..batch.min(n_blocks - start)];
        let outcomes: Vec<Result<(), BasisError>> = slots
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .map(|(k, slot)| walk_block(&walk, &workers, (start + k) * LANES, slot))
            .collect();
        outcomes.into_iter().collect::<Result<(), _>>()?;
        append(&mut levels, slots);
        for slot in slots {
            for (largest, &dropped) in largest_dropped.iter_mut().zip(&slot.dropped) {
                *largest = largest.max(dropped);
            }
        }
    }
    progress.step(n_blocks as u64, n_blocks as u64)?;
    let scaling: Vec<CompressedRows> = levels.into_iter().map(Growing::finish).collect();
    let info = BasisInfo {
        nnz: scaling.iter().map(|level| level.nnz() as u64).collect(),
        bytes: scaling.iter().map(CompressedRows::bytes).collect(),
        largest_dropped,
        forecast: forecast.bytes,
    };
    Ok(Basis { steps: params.steps(), scaling, info })
}

fn walk_block(
    walk: &BlockSweep<'_>,
    workers: &WorkerPool,
    first: usize,
    slot: &mut LevelSlot,
) -> Result<(), BasisError> {
    let end = (first + LANES).min(walk.diffusion.n_vertices());
    let tolerance = walk.params.drop_tolerance as f32;
    let mut worker = workers.take();
    let BlockWorker { columns, lanes_first } = &mut worker;
    let outcome = walk.sweep(columns, first, end, |level, columns, kept| {
        let n_lanes = end - first;
        let shares = kept.sums[..n_lanes].iter().zip(&kept.masses).map(|(sum, mass)| 1.0 - sum / mass);
        slot.dropped[level] = shares.fold(0.0, f64::max);
        pack(walk.arch, columns, n_lanes, tolerance, kept, lanes_first, &mut slot.levels[level]);
        SweepControl::GoOn
    });
    workers.give(worker);
    outcome
}

/// A level that grows block by block inside memory reserved at the start.
#[derive(Debug)]
struct Growing {
    offsets: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f32>,
}

impl Growing {
    fn new(n_rows: usize, nnz: u64) -> Self {
        let all = n_rows as u128 * n_rows as u128;
        let room = ((nnz as f64 * SPARE) as u128).min(all) as usize;
        let mut offsets = Vec::with_capacity(n_rows + 1);
        offsets.push(0);
        // The system provides zeroed memory of this size as pages that exist only once they are written.
        Self { offsets, columns: vec![0; room], values: vec![0.0; room] }
    }

    /// Returns room for `more` entries at the end.
    fn claim(&mut self, more: usize) -> (&mut [u32], &mut [f32]) {
        let start = self.offsets[self.offsets.len() - 1];
        let end = start + more;
        if self.columns.len() < end {
            // The forecast was too low; growing by large parts keeps the number of copies small.
            let room = end.max(self.columns.len() + self.columns.len() / 4);
            self.columns.resize(room, 0);
            self.values.resize(room, 0.0);
        }
        (&mut self.columns[start..end], &mut self.values[start..end])
    }

    fn finish(mut self) -> CompressedRows {
        let nnz = self.offsets[self.offsets.len() - 1];
        self.columns.truncate(nnz);
        self.columns.shrink_to_fit();
        self.values.truncate(nnz);
        self.values.shrink_to_fit();
        CompressedRows::new_unchecked(Pattern::new_unchecked(self.offsets, self.columns), self.values)
    }
}

/// Appends the packed rows of a batch to each level.
fn append(levels: &mut [Growing], slots: &[LevelSlot]) {
    let mut copies = Vec::with_capacity(levels.len() * slots.len());
    let mut counts = Vec::with_capacity(levels.len());
    for (level, growing) in levels.iter_mut().enumerate() {
        let packed = slots.iter().map(|slot| &slot.levels[level]);
        let more = packed.clone().map(PackedRows::nnz).sum();
        let mut ends = growing.offsets[growing.offsets.len() - 1];
        counts.push(
            packed
                .clone()
                .flat_map(|rows| &rows.counts)
                .map(|&count| {
                    ends += count as usize;
                    ends
                })
                .collect::<Vec<usize>>(),
        );
        let (mut columns, mut values) = growing.claim(more);
        for rows in packed {
            let (these, others) = columns.split_at_mut(rows.nnz());
            columns = others;
            let (values_here, values_after) = values.split_at_mut(rows.nnz());
            values = values_after;
            copies.push((rows, these, values_here));
        }
    }
    copies.into_par_iter().with_max_len(1).for_each(|(rows, columns, values)| {
        columns.copy_from_slice(&rows.columns[..columns.len()]);
        values.copy_from_slice(&rows.values[..values.len()]);
    });
    for (growing, ends) in levels.iter_mut().zip(counts) {
        growing.offsets.extend(ends);
    }
}
