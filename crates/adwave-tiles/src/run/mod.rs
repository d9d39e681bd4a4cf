//! A job from its inputs to its results: tasks one by one, or all that are missing.

mod summary;
mod tasks;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use adwave::Progress;
use adwave::pages::release_freed;

use crate::error::TilesError;
use crate::index::blocks::VERTICES_IN_A_BLOCK;
use crate::index::bounds_tree::BoundsTree;
use crate::job::plan::Plan;
use crate::job::status::Task;
use crate::job::tiling_job::TilingJob;
use crate::layout::RecordLayout;
use crate::stages::join::{MeshJoin, join_cloud};
pub use summary::Summary;

/// Runs one task, whether or not it has been done before. The task reads the work folder and writes one file there, so
/// that a process of its own can run it.
///
/// # Errors
/// [`TilesError`]; also if the task requires a stage that is not done.
pub fn run_task(job: &TilingJob, task: Task, progress: Progress<'_>) -> Result<(), TilesError> {
    let tile = match task {
        Task::Run(run) => return job.sort_run(run, progress),
        Task::Sort => return job.sort(progress),
        Task::Neighbors(tile) | Task::Bands(tile) | Task::Maps(tile) => tile,
    };
    let blocks = job.blocks()?;
    let n_tiles = job.plan.n_tiles(blocks.len());
    if tile >= n_tiles {
        return Err(TilesError::Input(format!(
            "the index of a tile must be in 0..={}, got {tile}",
            n_tiles.max(1) - 1
        )));
    }
    job.check_ready(task, n_tiles)?;
    if let Task::Neighbors(_) = task {
        return job.find_neighbors(&blocks, &BoundsTree::new(blocks.bounds.clone()), tile, progress);
    }
    let neighbor_index = job.neighbor_index(&blocks)?;
    if let Task::Maps(_) = task {
        return job.compute_maps(&blocks, &neighbor_index, tile, progress);
    }
    let rule = job.tile_rule(&blocks, &neighbor_index, progress.quiet())?;
    job.compute_bands(&blocks, &neighbor_index, &rule, tile, progress)
}

/// Runs all tasks that are not done. Reports progress in vertices, counting each vertex once per stage.
///
/// # Errors
/// [`TilesError`]. What is done stays, and the next call continues from there.
pub fn run(job: &TilingJob, progress: Progress<'_>) -> Result<Summary, TilesError> {
    let n = job.plan.shape.n_points;
    let total = n * (3 + u64::from(job.has_maps()));
    let report_sort = |done: u64, sort_total: u64| {
        // The sort itself checks for cancellation.
        let _ = progress.step(done * n / sort_total.max(1), total);
    };
    if !job.is_sorted() {
        job.sort(progress.quiet().with_report(&report_sort))?;
    }
    let blocks = job.blocks()?;
    let n_tiles = job.plan.n_tiles(blocks.len());
    let done = AtomicU64::new(n);
    let report_tile = |tile: usize| {
        let range = job.plan.blocks_of_tile(tile, blocks.len());
        let more = (range.len() * VERTICES_IN_A_BLOCK) as u64;
        progress.step((done.fetch_add(more, Ordering::Relaxed) + more).min(total), total)
    };
    let run_stage = |task: fn(usize) -> Task, run: &(dyn Fn(usize) -> Result<(), TilesError> + Sync)| {
        visit_tiles(job, n_tiles, |tile| {
            if !job.is_done(task(tile)) {
                run(tile)?;
            }
            Ok(report_tile(tile)?)
        })
    };
    let quiet = progress.quiet();
    let tree = BoundsTree::new(blocks.bounds.clone());
    run_stage(Task::Neighbors, &|tile| job.find_neighbors(&blocks, &tree, tile, quiet))?;
    drop(tree);
    release_freed();
    let neighbor_index = job.neighbor_index(&blocks)?;
    let rule = job.tile_rule(&blocks, &neighbor_index, quiet)?;
    run_stage(Task::Bands, &|tile| job.compute_bands(&blocks, &neighbor_index, &rule, tile, quiet))?;
    if job.has_maps() {
        run_stage(Task::Maps, &|tile| job.compute_maps(&blocks, &neighbor_index, tile, quiet))?;
    }
    job.summary(&blocks, &neighbor_index)
}

/// Calls `visit` for all tiles on the workers of the job. After an error, workers stop when their tile is done.
fn visit_tiles(
    job: &TilingJob,
    n_tiles: usize,
    visit: impl Fn(usize) -> Result<(), TilesError> + Sync,
) -> Result<(), TilesError> {
    let (next, first_error) = (AtomicUsize::new(0), Mutex::new(None));
    let work = || loop {
        let tile = next.fetch_add(1, Ordering::Relaxed);
        if tile >= n_tiles {
            return;
        }
        if let Err(error) = visit(tile) {
            next.store(n_tiles, Ordering::Relaxed);
            first_error.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(error);
            return;
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..job.plan.params.n_workers.min(n_tiles) {
            scope.spawn(work);
        }
        work();
    });
    first_error.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).map_or(Ok(()), Err)
}

/// Writes all tiles to one file: a cloud in the order of the curve, a mesh in its own order and format.
///
/// # Errors
/// [`TilesError`] if a tile is missing or the file cannot be written.
pub fn join(job: &TilingJob, path: &Path, progress: Progress<'_>) -> Result<(), TilesError> {
    let tiles: Vec<PathBuf> = (0..job.n_tiles()?).map(|tile| job.tile(tile)).collect();
    let Plan { shape, params, .. } = &job.plan;
    // The memory of the tiles goes back to the system, since the join takes half of what the job may use.
    release_freed();
    match shape.layout {
        RecordLayout::Las(_) => join_cloud(shape, params, &tiles, path, progress),
        RecordLayout::Mesh(_) => {
            job.folder.remove_join_parts()?;
            let memory = params.memory as usize / 2;
            MeshJoin { shape, params, tiles: &tiles, folder: &job.folder.path, memory }.write(path, progress)
        }
    }
}
