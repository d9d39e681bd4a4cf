//! The tasks of a job and which of them are done.

use adwave::Progress;
use serde::{Deserialize, Serialize};

use crate::error::TilesError;
use crate::job::tiling_job::TilingJob;
use crate::stages::sort::{Sorter, records_per_run};

/// A task of a job. A process can run it on its own. Tasks of one stage may run in any order and at the same time;
/// running a task again gives the same file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Task {
    /// Sorts one run of a cloud, by its index. The sort does this for runs that are missing.
    Run(usize),
    /// Sorts all points and distributes the faces of a mesh to the tiles.
    Sort,
    /// Finds the neighbors of the vertices of a tile. Requires the sort.
    Neighbors(usize),
    /// Computes the bands of a tile, or denoises its positions. Requires the neighbors of all tiles.
    Bands(usize),
    /// Computes the saliency map and the features of a tile. Requires the bands of all tiles.
    Maps(usize),
}

/// The numbers of tasks of a job, and how many of them are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Status {
    /// Number of runs that a cloud is sorted in; 0 for a mesh.
    pub n_runs: usize,
    /// Number of runs that are sorted.
    pub runs_done: usize,
    /// Number of tiles; `None` before the sort.
    pub n_tiles: Option<usize>,
    /// Number of tiles whose neighbors are found.
    pub neighbors_done: usize,
    /// Number of tiles whose bands are computed, or whose positions are denoised.
    pub bands_done: usize,
    /// True if the job has a maps stage.
    pub has_maps: bool,
    /// Number of tiles whose maps are computed.
    pub maps_done: usize,
}

impl Status {
    /// Returns true if the results of all tiles are there.
    pub(crate) fn is_finished(&self) -> bool {
        self.n_tiles == Some(if self.has_maps { self.maps_done } else { self.bands_done })
    }
}

impl TilingJob {
    pub(crate) fn sorter<'a>(&'a self, run_length: usize, progress: Progress<'a>) -> Sorter<'a> {
        let (shape, params) = (&self.plan.shape, &self.plan.params);
        Sorter { shape, params, folder: &self.folder.path, run_length, progress }
    }

    pub(crate) fn default_run_length(&self) -> usize {
        records_per_run(&self.plan.shape, self.plan.params.memory)
    }

    /// Number of runs that a cloud is sorted in, each of which can be a task; 0 for a mesh.
    pub fn n_runs(&self) -> usize {
        self.sorter(self.default_run_length(), Progress::none()).n_runs()
    }

    /// Returns true if a task is done, that is, if its file exists.
    pub fn is_done(&self, task: Task) -> bool {
        let folder = &self.folder;
        match task {
            Task::Run(run) => {
                self.is_sorted() || self.sorter(self.default_run_length(), Progress::none()).has_run(run)
            }
            Task::Sort => self.is_sorted(),
            Task::Neighbors(tile) => folder.neighbors(tile).exists(),
            Task::Bands(tile) if self.has_maps() => {
                let paths = [folder.block_sums(tile), folder.rows_before_maps(tile), folder.band_norms(tile)];
                paths.iter().all(|path| path.exists())
            }
            Task::Bands(tile) => folder.block_sums(tile).exists() && self.tile(tile).exists(),
            Task::Maps(tile) => self.tile(tile).exists() && folder.features(tile).exists(),
        }
    }

    /// Checks that the stage that a task requires is done for all tiles.
    pub(crate) fn check_ready(&self, task: Task, n_tiles: usize) -> Result<(), TilesError> {
        type TileTask = fn(usize) -> Task;
        let (required, name): (TileTask, _) = match task {
            Task::Bands(_) => (Task::Neighbors, "neighbors"),
            Task::Maps(_) => (Task::Bands, "bands"),
            Task::Run(_) | Task::Sort | Task::Neighbors(_) => return Ok(()),
        };
        match (0..n_tiles).find(|&tile| !self.is_done(required(tile))) {
            Some(tile) => Err(TilesError::Input(format!(
                "the {name} of tile {tile} must be computed first; the job in {} has not done so",
                self.folder.path.display()
            ))),
            None => Ok(()),
        }
    }

    /// The numbers of tasks that are done.
    ///
    /// # Errors
    /// If the sorted points cannot be read.
    pub fn status(&self) -> Result<Status, TilesError> {
        let (n_runs, n_tiles) = (self.n_runs(), if self.is_sorted() { Some(self.n_tiles()?) } else { None });
        let count = |n: usize, task: fn(usize) -> Task| (0..n).filter(|&i| self.is_done(task(i))).count();
        let count_tiles = |task| count(n_tiles.unwrap_or(0), task);
        Ok(Status {
            n_runs,
            runs_done: count(n_runs, Task::Run),
            n_tiles,
            neighbors_done: count_tiles(Task::Neighbors),
            bands_done: count_tiles(Task::Bands),
            has_maps: self.has_maps(),
            maps_done: if self.has_maps() { count_tiles(Task::Maps) } else { 0 },
        })
    }
}
