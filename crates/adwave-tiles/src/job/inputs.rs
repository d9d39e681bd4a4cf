//! From the inputs of a job to its plan.

use std::path::{Path, PathBuf};

use crate::error::TilesError;
use crate::job::folder::WorkFolder;
use crate::job::forecast::{Forecast, Tiling, choose_tiling};
use crate::job::plan::Plan;
use crate::job::tiling_job::TilingJob;
use crate::layout::MAX_POINTS;
use crate::params::Params;
use crate::sources::input_shape::input_error;
use crate::sources::mesh::is_mesh;
use crate::sources::record_marker::RecordMarker;
use crate::sources::{cloud, mesh};

/// Plans a job on `inputs`.
pub(crate) fn plan_job(inputs: &[PathBuf], params: &Params) -> Result<(Plan, Forecast), TilesError> {
    params.check()?;
    let files = list_files(inputs)?;
    let shape = if files.iter().any(|path| is_mesh(path)) {
        Some(mesh::read_header(&files, params)?)
    } else {
        cloud::read_headers(&files)?
    };
    let Some(shape) = shape else {
        return Err(TilesError::Input(
            "there must be at least one input; give one or several LAS or LAZ files, or a mesh".into(),
        ));
    };
    if shape.n_points == 0 {
        return Err(TilesError::Input("the inputs have no points; give other files".into()));
    }
    if shape.n_points > MAX_POINTS {
        return Err(TilesError::Input(format!(
            "a job can have at most {MAX_POINTS} points, since vertices are indexed by 32-bit numbers, got {}; split the inputs",
            shape.n_points
        )));
    }
    // A selection that does not fit the inputs is refused before anything is written.
    RecordMarker::new(&shape, params)?;
    let Tiling { blocks_per_tile, forecast } = choose_tiling(&shape, params)?;
    Ok((Plan { shape, params: params.clone(), blocks_per_tile }, forecast))
}

/// Lists the files that the inputs stand for: for a folder the LAS and LAZ files in it, by name; for an EPT (its
/// folder, or the `ept.json` in it) its data files.
fn list_files(inputs: &[PathBuf]) -> Result<Vec<PathBuf>, TilesError> {
    const EPT: &str = "ept.json";
    let mut files = Vec::new();
    for input in inputs {
        let ept_data = |folder: &Path| folder.join("ept-data");
        let folder = match input.parent() {
            Some(parent) if input.file_name().is_some_and(|name| name == EPT) => ept_data(parent),
            _ if input.join(EPT).exists() => ept_data(input),
            _ if input.is_dir() => input.clone(),
            _ => {
                files.push(input.clone());
                continue;
            }
        };
        let work_folder = WorkFolder::new(&folder);
        if work_folder.plan().exists() && !TilingJob::open(&folder)?.status()?.is_finished() {
            return Err(input_error(&folder, "some tiles of this job are not done; finish it first"));
        }
        let mut names = work_folder.file_names()?;
        names.retain(|name| {
            let extension = Path::new(name).extension().unwrap_or_default();
            extension.eq_ignore_ascii_case("las") || extension.eq_ignore_ascii_case("laz")
        });
        if names.is_empty() {
            return Err(input_error(&folder, "there is no .las or .laz file in this folder; name the files"));
        }
        names.sort();
        files.extend(names.iter().map(|name| folder.join(name)));
    }
    Ok(files)
}
