//! `adwave tiles` and `adwave tile`: clouds and meshes that are larger than memory.

mod args;
mod run_lock;

use crate::error::CliError;
use crate::global::{Global, HeapUse};
use crate::output::denoising::{SamplingUnit, describe_denoising};
use crate::output::features_file::{FeatureList, FeaturesFile};
use crate::output::progress::with_progress;
use crate::output::{bytes_text, check_writable, count, has_extension, note, number, print, table};
use adwave::{ClassifiedError, ErrorKind};
use adwave_io::{CoordinateSystem, LasReader};
use adwave_tiles::{
    Forecast, LevelSummary, Params, Status, Summary, Task, TilesError, TilingJob, forecast, is_mesh, join,
    run_task,
};
use args::JobKind;
pub(crate) use args::{TileArgs, TilesArgs};
use run_lock::RunLock;
use serde_json::json;
use std::path::{Path, PathBuf};

fn classify(error: &TilesError) -> CliError {
    match error {
        // As in all commands, a file that is missing is a wrong argument.
        TilesError::Read(_) if error.kind() == ErrorKind::Machine => CliError::Input(error.to_string()),
        _ => CliError::classify(error),
    }
}

/// True if the output is one file instead of a folder.
fn is_joined(args: &TilesArgs) -> Result<bool, CliError> {
    let wrong = |what: &str| Err(CliError::Input(format!("{}: {what}", args.output.display())));
    let has_ending = args.output.extension().is_some() && !args.output.is_dir();
    match args.files.iter().find(|file| is_mesh(file)) {
        Some(mesh) => {
            let ending = mesh.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            match has_extension(&args.output, &[&ending]) {
                true => Ok(true),
                false if args.plan_only && !has_ending => Ok(false),
                false => wrong(&format!("a mesh is written in its own format; give a .{ending} file")),
            }
        }
        None if has_extension(&args.output, &["las", "laz"]) => Ok(true),
        None if has_ending => wrong("give a .las or .laz file, or a folder"),
        None => Ok(false),
    }
}

/// Files of a run and where its work is kept.
struct TilesJob<'a> {
    params: Params,
    /// True if the output is one file.
    is_joined: bool,
    features: Option<(&'a Path, FeaturesFile)>,
    folder: PathBuf,
}

/// Refuses options that apply to nothing in this run.
fn check_options(args: &TilesArgs, global: &Global<'_>) -> Result<(), CliError> {
    if global.has_max_input {
        return Err(CliError::Input(
            "--max-input applies to commands that hold a shape in memory, and tiles hold a part of it; give --memory"
                .to_owned(),
        ));
    }
    if args.files.iter().any(|file| is_mesh(file)) {
        global
            .given
            .refuse(&["--neighbors"], "applies to clouds; the neighbors of a mesh are those of its faces")?;
        global.given.refuse(&["--all-points"], "applies to LAS and LAZ, whose points have flags")?;
        global
            .given
            .refuse(&["--allow-degrees"], "applies to LAS and LAZ, which state their coordinate system")?;
    } else {
        global
            .given
            .refuse(&["--border"], "applies to meshes; points of a cloud move along their normals")?;
        global.given.refuse(&["--shared-noise"], "applies to meshes")?;
        check_lengths(args, global)?;
    }
    Ok(())
}

/// Refuses lengths in model units if coordinates are degrees, in which a length means nothing.
fn check_lengths(args: &TilesArgs, global: &Global<'_>) -> Result<(), CliError> {
    // Errors of the file itself are reported when the job is planned.
    let Some(noise) = args.noise.noise_sigma else { return Ok(()) };
    let system = args.files.first().and_then(|file| LasReader::open(file).ok()?.coordinate_system());
    match system.filter(CoordinateSystem::is_geographic) {
        Some(system) if !args.noise.allow_degrees => Err(CliError::Input(format!(
            "--noise-sigma needs coordinates in a unit of length, but those of {} are degrees ({}), got {noise}; project the \
             files to meters, or give --allow-degrees to take lengths as they are",
            args.files[0].display(),
            system.name
        ))),
        Some(_) => Ok(()),
        None => global.given.refuse(
            &["--allow-degrees"],
            &format!(
                "applies to files whose coordinates are degrees, and {} states none",
                args.files[0].display()
            ),
        ),
    }
}

/// Prints a note if a cloud has normals, which are not used here: other commands separate close sheets by them.
fn note_normals(args: &TilesArgs, global: &Global<'_>) {
    const NORMALS: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];
    let Some(reader) = args.files.first().and_then(|file| LasReader::open(file).ok()) else { return };
    if NORMALS.iter().any(|names| names.iter().all(|name| reader.column(name).is_some())) {
        let text = format!(
            "the normals of {} are not used in tiles: surfaces closer to each other than their points are not told apart",
            args.files[0].display()
        );
        note(global, &text);
    }
}

/// Prints a note if the number of tiles differs from the requested number.
fn note_other_number(args: &TilesArgs, forecast: &Forecast, global: &Global<'_>) {
    let Some(asked) = args.tiles.filter(|asked| *asked != forecast.n_tiles) else { return };
    let text = format!(
        "{} instead of {asked}, since a tile consists of whole blocks of points",
        count(forecast.n_tiles, "tile", "tiles")
    );
    note(global, &text);
}

pub(crate) fn run(args: &TilesArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_options(args, global)?;
    if args.forecast {
        let forecast = forecast(&args.files, &args.to_params()?).map_err(|e| classify(&e))?;
        return print(global, &format!("{}\n", format_forecast(&forecast)), &json!(forecast));
    }
    let job = resolve(args)?;
    let lock = RunLock::acquire(&job.folder, &args.output)?;
    let is_new = !job.folder.join("plan.json").exists();
    let (work, forecast) =
        TilingJob::begin(&job.folder, &args.files, &job.params).map_err(|e| classify(&e))?;
    note(global, &format_forecast(&forecast));
    note_other_number(args, &forecast, global);
    note_normals(args, global);
    if args.plan_only {
        return print(
            global,
            &format!("{}\n", job.folder.join("plan.json").display()),
            &json!({ "folder": job.folder, "forecast": forecast }),
        );
    }
    let done = process(&job, &work, global).and_then(|summary| {
        note_left_out(args, &summary, global)?;
        let n_features = write(args, &job, &work, global)?;
        Ok((summary, n_features))
    });
    let (summary, n_features) = done.inspect_err(|error| {
        // Nobody can continue a run with such an input, and its folder would stand in the way of the next.
        if is_new && !args.keep_work && matches!(error, CliError::Input(_)) {
            let _ = work.remove_tiles();
            let _ = work.clean();
        }
    })?;
    drop(lock);
    if job.is_joined && !args.keep_work {
        // The folder stays if it holds anything else.
        let _ = std::fs::remove_dir(&job.folder);
    }
    print_summary(global, args, &summary, n_features)
}

fn resolve(args: &TilesArgs) -> Result<TilesJob<'_>, CliError> {
    let params = args.to_params()?;
    let has_fields =
        !(params.magnitudes.is_empty() && params.vectors.is_empty() && params.saliency.is_none());
    let moves = args.noise.denoise || params.gains.iter().any(|&gain| gain != 1.0);
    if !moves && !has_fields && args.features.is_none() {
        return Err(CliError::Input(
            "nothing to compute; give --gains, --magnitudes, --vectors, --saliency, --features or --denoise"
                .into(),
        ));
    }
    let is_joined = is_joined(args)?;
    if is_joined {
        check_writable(&args.output)?;
    }
    let features = match &args.features {
        Some(path) => {
            let kind = FeaturesFile::from_path(path)?;
            check_writable(path)?;
            Some((path.as_path(), kind))
        }
        None => None,
    };
    let folder = match &args.work {
        Some(folder) => folder.clone(),
        None if is_joined => {
            let mut name = args.output.clone().into_os_string();
            name.push(".work");
            name.into()
        }
        None => args.output.clone(),
    };
    if !is_joined && folder != args.output {
        return Err(CliError::Input(
            "--work applies to results in one file; tiles stay in their folder".into(),
        ));
    }
    Ok(TilesJob { params, is_joined, features, folder })
}

/// Memory limit in bytes from which the freed memory that is kept is small: at most a tenth of the limit.
const LARGE_MEMORY: u64 = 1 << 30;

fn process(job: &TilesJob<'_>, work: &TilingJob, global: &Global<'_>) -> Result<Summary, CliError> {
    if job.params.memory >= LARGE_MEMORY {
        global.tune_heap(HeapUse::ReuseAll); // each tile needs as much as the one before
    }
    with_progress(global, "tiles", |progress| adwave_tiles::run(work, progress)).map_err(|e| classify(&e))
}

/// Writes the features and the joined file, and removes the temporary files. Returns the number of features, if they
/// were asked for.
fn write(
    args: &TilesArgs,
    job: &TilesJob<'_>,
    work: &TilingJob,
    global: &Global<'_>,
) -> Result<Option<usize>, CliError> {
    let n_features = match job.features {
        Some((path, kind)) => {
            let features = work.features().map_err(|e| classify(&e))?;
            let n_levels = job.params.levels;
            FeatureList { features: &features, descriptors: &[], n_levels }.write(path, kind, global)?;
            if !work.is_mesh() {
                note(
                    global,
                    "features of a cloud in tiles are not tested against the drawing of its points and noise",
                );
            }
            Some(features.len())
        }
        None => None,
    };
    if job.is_joined {
        with_progress(global, "joining", |progress| join(work, &args.output, progress))
            .map_err(|e| classify(&e))?;
    }
    if !args.keep_work {
        if job.is_joined {
            work.remove_tiles().map_err(|e| classify(&e))?;
        }
        work.clean().map_err(|e| classify(&e))?;
    }
    Ok(n_features)
}

/// A forecast in words.
fn format_forecast(forecast: &Forecast) -> String {
    let Forecast { n_points, n_tiles, points_per_tile, rings, share, memory, disk, .. } = forecast;
    let tiles = if *n_tiles == 1 {
        "one tile".to_owned()
    } else {
        format!(
            "{n_tiles} tiles of {points_per_tile} points, with halos of {rings} rings ({share:.2} times the points)"
        )
    };
    format!(
        "{} in {tiles}; about {} of memory, up to {} of temporary files",
        count(*n_points, "point", "points"),
        bytes_text(*memory as f64),
        bytes_text(*disk as f64)
    )
}

/// Prints notes on points that take no part.
fn note_left_out(args: &TilesArgs, summary: &Summary, global: &Global<'_>) -> Result<(), CliError> {
    let Summary { n_points, n_unselected, n_flagged, n_placeholders, n_strays, .. } = *summary;
    let selection = args.selection.to_selection()?;
    let mut reasons = selection.describe().join(" and ");
    if n_flagged > 0 {
        let without = format!(
            "without {} flagged as withheld or classified as noise (7, 18), which --all-points includes",
            count(n_flagged, "point", "points")
        );
        reasons = if reasons.is_empty() { without } else { format!("{reasons}, {without}") };
    }
    if !reasons.is_empty() {
        let n = n_points - n_unselected - n_flagged;
        note(
            global,
            &format!("{n} of {n_points} vertices take part: {reasons}; the others keep their values"),
        );
    }
    if n_placeholders > 0 {
        let found = count(n_placeholders, "placeholder", "placeholders");
        note(global, &format!("{found} without a real position; they take no part and keep their values"));
    }
    if n_strays > 0 {
        let found = count(n_strays, "point", "points");
        note(global, &format!("{found} far from all others; they take no part and keep their values"));
    }
    Ok(())
}

fn print_summary(
    global: &Global<'_>,
    args: &TilesArgs,
    summary: &Summary,
    n_features: Option<usize>,
) -> Result<(), CliError> {
    let (what, length) = match summary.n_faces {
        0 => (count(summary.n_points, "point", "points"), "distance to a neighbor"),
        n => {
            let vertices = count(summary.n_points, "vertex", "vertices");
            (format!("{vertices} of {}", count(n, "face", "faces")), "length of edges")
        }
    };
    let mut text = format!(
        "{what} at {}, {}; mean {length} {}\n",
        count(summary.n_vertices, "position", "positions"),
        count(summary.n_tiles, "tile", "tiles"),
        number(summary.mean_length)
    );
    if let Some(noise) = &summary.noise {
        let unit =
            if summary.n_faces > 0 { SamplingUnit::MeanEdges } else { SamplingUnit::NeighborDistances };
        describe_denoising(&mut text, noise, unit);
    }
    let [rms, most] = summary.moved;
    if most > 0.0 {
        text += &format!("moved by {} (rms), at most {}\n", number(rms), number(most));
    }
    if !summary.levels.is_empty() {
        let has_map = args.saliency.is_some();
        let row = |level: &LevelSummary| {
            let alpha = if has_map { number(level.alpha) } else { String::new() };
            let LevelSummary { level, sigma, mean, rms, most, .. } = *level;
            [format!("|W_{level}|"), number(sigma), number(mean), number(rms), number(most), alpha]
        };
        let alpha = if has_map { "in the map" } else { "" };
        text += &table(["band", "sigma", "mean", "rms", "most", alpha], summary.levels.iter().map(row));
    }
    if let (Some(n), Some(path)) = (n_features, &args.features) {
        text += &format!("{}: {}\n", count(n, "feature", "features"), path.display());
    }
    text += &format!("{}\n", args.output.display());
    print(global, &text, &json!({ "summary": summary, "output": args.output, "features": n_features }))
}

fn format_status(status: &Status) -> String {
    let Status { n_runs, runs_done, n_tiles, neighbors_done, bands_done, .. } = status;
    let if_asked = |is_asked: bool, what: &str, n: usize| {
        if is_asked { format!("{what} of {n}, ") } else { String::new() }
    };
    let maps = if_asked(status.has_maps, "maps", status.maps_done);
    match n_tiles {
        Some(n) => {
            let text = format!(
                "{}: neighbors of {neighbors_done}, bands of {bands_done}, {maps}",
                count(*n, "tile", "tiles")
            );
            format!("{}\n", text.trim_end_matches(", "))
        }
        None if *n_runs > 0 => format!("not sorted; {runs_done} of {}\n", count(*n_runs, "run", "runs")),
        None => "not sorted\n".to_owned(),
    }
}

pub(crate) fn run_tile(args: &TileArgs, global: &Global<'_>) -> Result<(), CliError> {
    let work = TilingJob::open(&args.folder).map_err(|e| classify(&e))?;
    let job = match args.job {
        JobKind::Status => {
            let status = work.status().map_err(|e| classify(&e))?;
            return print(global, &format_status(&status), &json!(status));
        }
        JobKind::Run => Task::Run(args.index),
        JobKind::Sort => Task::Sort,
        JobKind::Neighbors => Task::Neighbors(args.index),
        JobKind::Bands => Task::Bands(args.index),
        JobKind::Maps => Task::Maps(args.index),
    };
    if !(args.if_missing && work.is_done(job)) {
        with_progress(global, "working", |progress| run_task(&work, job, progress))
            .map_err(|e| classify(&e))?;
    }
    if let Task::Run(_) = job {
        let n_runs = work.n_runs();
        return print(
            global,
            &format!("done; {}\n", count(n_runs, "run", "runs")),
            &json!({ "job": job, "n_runs": n_runs }),
        );
    }
    let n_tiles = work.n_tiles().map_err(|e| classify(&e))?;
    let is_last = matches!(job, Task::Maps(_)) || (matches!(job, Task::Bands(_)) && !work.has_maps());
    let path = is_last.then(|| work.tile(args.index));
    let text = match &path {
        Some(path) => format!("{}\n", path.display()),
        None => format!("done; {}\n", count(n_tiles, "tile", "tiles")),
    };
    print(global, &text, &json!({ "job": job, "n_tiles": n_tiles, "path": path }))
}
