//! The beginning of a job: its forecast, its folder.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::TilesError;
use crate::files::write_atomic;
use crate::job::folder::{WorkFolder, is_job_file};
use crate::job::forecast::Forecast;
use crate::job::inputs::plan_job;
use crate::job::plan::Plan;
use crate::job::tiling_job::TilingJob;
use crate::params::Params;

/// Estimates the cost of a job without starting it.
///
/// # Errors
/// [`TilesError`] if an input cannot be read, the inputs do not fit together, or the memory does not suffice.
pub fn forecast(inputs: &[PathBuf], params: &Params) -> Result<Forecast, TilesError> {
    Ok(plan_job(inputs, params)?.1)
}

impl TilingJob {
    /// Begins a job in `folder`, or continues the job of the folder if it has the same inputs and parameters.
    ///
    /// # Errors
    /// The errors of [`forecast`]; also if the folder has another job or cannot be written.
    pub fn begin(folder: &Path, inputs: &[PathBuf], params: &Params) -> Result<(Self, Forecast), TilesError> {
        let (mut plan, forecast) = plan_job(inputs, params)?;
        std::fs::create_dir_all(folder).map_err(TilesError::io(folder))?;
        let folder = WorkFolder::new(folder);
        let path = folder.plan();
        if path.exists() {
            plan.blocks_per_tile = blocks_per_tile_of_same(&Self::open(&folder.path)?.plan, &plan, &folder)?;
            return Ok((Self { folder, plan }, forecast));
        }
        // Neighbors of other points must not be taken for neighbors of these points. Tiles must not be replaced,
        // because they may be inputs.
        if let Some(name) = folder.file_names()?.iter().find(|name| is_job_file(name)) {
            return Err(TilesError::Input(format!(
                "{} belongs to an earlier job; move or delete such files, or choose another folder",
                folder.path.join(name).display()
            )));
        }
        let json =
            serde_json::to_vec_pretty(&plan).map_err(std::io::Error::from).map_err(TilesError::io(&path))?;
        write_atomic(&path, |out| out.write_all(&json).map_err(TilesError::io(&path)))?;
        Ok((Self { folder, plan }, forecast))
    }
}

/// Size of the tiles of the `existing` plan; an error if it has other results than `plan`, or tiles of another size
/// than requested.
fn blocks_per_tile_of_same(existing: &Plan, plan: &Plan, folder: &WorkFolder) -> Result<usize, TilesError> {
    if existing.shape.files != plan.shape.files
        || existing.params.result_params() != plan.params.result_params()
    {
        return Err(TilesError::Input(format!(
            "{} has another job, with other files or parameters; delete it or choose another folder",
            folder.path.display()
        )));
    }
    let is_same_size = plan.params.n_tiles.is_none() || plan.params.n_tiles == existing.params.n_tiles;
    if is_same_size || plan.blocks_per_tile == existing.blocks_per_tile {
        return Ok(existing.blocks_per_tile);
    }
    Err(TilesError::Input(format!(
        "{} has this job with tiles of another size; leave out the number of tiles, or delete the folder",
        folder.path.display()
    )))
}
