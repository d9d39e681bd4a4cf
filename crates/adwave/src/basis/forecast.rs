//! Forecast of the memory of a basis, from a few of its blocks, before it is allocated.

use super::fast::WorkerPool;
use super::local_columns::LANES;
use super::sweep::{BlockSweep, SweepControl};
use super::{BasisError, transpose::Transpose};
use crate::rows::{Value, bytes};
use rayon::prelude::*;

/// Number of sampled blocks, spread evenly. On a mesh one block in a hundred predicts the size to within a few
/// percent.
const SAMPLES: usize = 12;

/// Expected size of a basis.
#[derive(Clone, Debug)]
pub(super) struct Forecast {
    /// Number of entries of each level.
    pub(super) nnz: Vec<u64>,
    /// Bytes of all levels together, including working memory.
    pub(super) bytes: u64,
}

/// Forecasts a basis with values of type `V`, of which `copies` are in memory at once.
///
/// # Errors
/// [`BasisError::TooLarge`] if it exceeds the limit; or if the call is cancelled.
pub(super) fn forecast<V: Value>(
    walk: &BlockSweep<'_>,
    workers: &WorkerPool,
    copies: u64,
) -> Result<Forecast, BasisError> {
    let n = walk.diffusion.n_vertices();
    let steps = &walk.steps;
    let limit = walk.params.memory_limit;
    let n_blocks = n.div_ceil(LANES);
    let samples = n_blocks.min(SAMPLES);
    let of_block: Vec<Result<Vec<u64>, BasisError>> = (0..samples)
        .into_par_iter()
        .map(|sample| {
            let first = (sample * n_blocks / samples) * LANES;
            let end = (first + LANES).min(n);
            let scale = n as f64 / (end - first) as f64;
            let mut nnz = Vec::with_capacity(steps.len());
            let mut worker = workers.take();
            walk.sweep(&mut worker.columns, first, end, |level, _, kept| {
                nnz.truncate(level);
                let counted: u64 = kept.counts.iter().map(|&count| u64::from(count)).sum();
                nnz.push((counted as f64 * scale) as u64);
                // At twice the limit, the size of the remaining levels is extrapolated instead of computed.
                let so_far: u64 = nnz.iter().map(|&nnz| bytes::<V>(n, nnz)).sum();
                if so_far / 2 > limit { SweepControl::Stop } else { SweepControl::GoOn }
            })?;
            workers.give(worker);
            // On a surface, a walk of twice as many steps reaches twice as many vertices.
            for level in nnz.len()..steps.len() {
                let grown = nnz[level - 1] as f64 * steps[level] as f64 / steps[level - 1] as f64;
                nnz.push(grown.min(n as f64 * n as f64) as u64);
            }
            Ok(nnz)
        })
        .collect();
    let of_block: Vec<Vec<u64>> = of_block.into_iter().collect::<Result<_, _>>()?;
    let nnz: Vec<u64> = (0..steps.len())
        .map(|level| of_block.iter().map(|nnz| nnz[level]).sum::<u64>() / samples.max(1) as u64)
        .collect();
    let stored: u64 = nnz.iter().map(|&nnz| bytes::<V>(n, nnz)).sum();
    let work = Transpose::bytes(n, walk.diffusion.nnz()) + WorkerPool::bytes(n, &nnz);
    let needed = stored.saturating_mul(copies).saturating_add(work);
    if needed > limit {
        return Err(BasisError::TooLarge { n_levels: steps.len(), n_vertices: n, needed, limit });
    }
    Ok(Forecast { nnz, bytes: needed })
}
