//! `adwave tiles` and `adwave tile`: clouds and meshes that are larger than memory.

mod args;

use crate::commands::denoise;
use crate::commands::features::{output_kind, write_features};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, note, number, print, table};
use crate::progress::with_progress;
use adwave::pages::keep_freed;
use adwave::{ClassifiedError, ErrorKind};
use adwave_tiles::{
    Forecast, LevelSummary, Status, Summary, Task, TilesError, TilingJob, forecast, is_mesh, join, run_task,
};
use args::JobKind;
pub(crate) use args::{TileArgs, TilesArgs};
use serde_json::json;
use std::path::Path;

fn failed(error: &TilesError) -> CliError {
    match error {
        // As all commands have it: a file that is not there is a wrong argument.
        TilesError::Read(_) if error.kind() == ErrorKind::Machine => CliError::Input(error.to_string()),
        _ => CliError::of(error),
    }
}

/// Whether the output is one file; a folder otherwise.
fn is_joined(args: &TilesArgs) -> Result<bool, CliError> {
    let ends = |path: &Path, endings: &[&str]| {
        path.extension().is_some_and(|e| endings.iter().any(|ending| e.eq_ignore_ascii_case(ending)))
    };
    let wrong = |what: &str| Err(CliError::Input(format!("{}: {what}", args.output.display())));
    let has_ending = args.output.extension().is_some() && !args.output.is_dir();
    match args.files.iter().find(|file| is_mesh(file)) {
        Some(mesh) => {
            let ending = mesh.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            match ends(&args.output, &[&ending]) {
                true => Ok(true),
                false if args.plan_only && !has_ending => Ok(false),
                false => wrong(&format!("a mesh comes out in its own format; give a .{ending}")),
            }
        }
        None if ends(&args.output, &["las", "laz"]) => Ok(true),
        None if has_ending => wrong("give a .las or .laz, or a folder"),
        None => Ok(false),
    }
}

pub(crate) fn run(args: &TilesArgs, global: &Global<'_>) -> Result<(), CliError> {
    let params = args.params();
    if args.forecast {
        let forecast = forecast(&args.files, &params).map_err(|e| failed(&e))?;
        return print(global, &format!("{}\n", format_forecast(&forecast)), &json!(forecast));
    }
    let wants_fields =
        !(params.magnitudes.is_empty() && params.vectors.is_empty() && params.saliency.is_none());
    let moves = args.noise.denoise || params.gains.iter().any(|&gain| gain != 1.0);
    if !moves && !wants_fields && args.features.is_none() {
        return Err(CliError::Input(
            "say what is wanted: --gains, --magnitudes, --vectors, --saliency, --features or --denoise"
                .into(),
        ));
    }
    let joined = is_joined(args)?;
    if joined {
        check_writable(&args.output)?;
    }
    let features = match &args.features {
        Some(path) => {
            let kind = output_kind(path)?;
            check_writable(path)?;
            Some((path, kind))
        }
        None => None,
    };
    let folder = match &args.work {
        Some(folder) => folder.clone(),
        None if joined => {
            let mut name = args.output.clone().into_os_string();
            name.push(".work");
            name.into()
        }
        None => args.output.clone(),
    };
    if !joined && folder != args.output {
        return Err(CliError::Input("--work is for results in one file; tiles stay in their folder".into()));
    }
    let (job, forecast) = TilingJob::begin(&folder, &args.files, &params).map_err(|e| failed(&e))?;
    note(global, &format_forecast(&forecast));
    if args.plan_only {
        return print(
            global,
            &format!("{}\n", folder.join("plan.json").display()),
            &json!({ "folder": folder, "forecast": forecast }),
        );
    }
    if params.memory >= MUCH {
        keep_freed(); // each tile wants as much as the one before
    }
    let summary = match with_progress(global, "tiles", |progress| adwave_tiles::run(&job, progress)) {
        Ok(summary) => summary,
        Err(error) => {
            // With such an input there is nothing to go on with.
            if joined && !args.keep_work && error.kind() == ErrorKind::Input && !job.is_sorted() {
                let _ = job.clean();
                let _ = std::fs::remove_dir(&folder);
            }
            return Err(failed(&error));
        }
    };
    let n_features = match features {
        Some((path, kind)) => {
            let features = job.features().map_err(|e| failed(&e))?;
            write_features(path, kind, &features, params.levels, global)?;
            Some(features.len())
        }
        None => None,
    };
    if joined {
        with_progress(global, "joining", |progress| join(&job, &args.output, progress))
            .map_err(|e| failed(&e))?;
    }
    if !args.keep_work {
        if joined {
            job.remove_tiles().map_err(|e| failed(&e))?;
        }
        job.clean().map_err(|e| failed(&e))?;
        if joined {
            // Whatever else is there stays.
            let _ = std::fs::remove_dir(&folder);
        }
    }
    print_summary(global, args, &summary, n_features)
}

/// Bytes of memory from which on what is kept of freed memory is little beside the rest, a tenth at most.
const MUCH: u64 = 1 << 30;

/// A forecast in words.
fn format_forecast(forecast: &Forecast) -> String {
    let Forecast { n_points, n_tiles, points_per_tile, rings, share, memory, disk, .. } = forecast;
    let tiles = if *n_tiles == 1 {
        "one tile".to_owned()
    } else {
        format!(
            "{n_tiles} tiles of {points_per_tile} points, {rings} rings around each ({share:.2} times its points)"
        )
    };
    format!(
        "{n_points} points in {tiles}; about {:.1} GB of memory, up to {:.1} GB of temporary files",
        *memory as f64 / 1e9,
        *disk as f64 / 1e9
    )
}

fn print_summary(
    global: &Global<'_>,
    args: &TilesArgs,
    summary: &Summary,
    n_features: Option<usize>,
) -> Result<(), CliError> {
    let (what, length) = match summary.n_faces {
        0 => ("points".to_owned(), "distance to a neighbor"),
        n => (format!("vertices of {n} faces"), "length of edges"),
    };
    let mut text = format!(
        "{} {what} at {} positions, {} tiles; mean {length} {}\n",
        summary.n_points,
        summary.n_vertices,
        summary.n_tiles,
        number(summary.mean_length)
    );
    if let Some(noise) = &summary.noise {
        denoise::describe(&mut text, noise, summary.n_faces > 0);
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
        text += &format!("{n} feature{}: {}\n", if n == 1 { "" } else { "s" }, path.display());
    }
    text += &format!("{}\n", args.output.display());
    print(global, &text, &json!({ "summary": summary, "output": args.output, "features": n_features }))
}

fn status_in_words(status: &Status) -> String {
    let Status { n_runs, runs_done, n_tiles, neighbors_done, bands_done, .. } = status;
    let where_asked = |is_asked: bool, what: &str, n: usize| {
        if is_asked { format!("{what} of {n}, ") } else { String::new() }
    };
    let orientation = where_asked(status.has_orientation, "orientation", status.orientation_done);
    let maps = where_asked(status.has_maps, "maps", status.maps_done);
    match n_tiles {
        Some(n) => {
            let text = format!(
                "{n} tiles: neighbors of {neighbors_done}, {orientation}bands of {bands_done}, {maps}"
            );
            format!("{}\n", text.trim_end_matches(", "))
        }
        None if *n_runs > 0 => format!("not sorted; {runs_done} of {n_runs} runs\n"),
        None => "not sorted\n".to_owned(),
    }
}

pub(crate) fn run_tile(args: &TileArgs, global: &Global<'_>) -> Result<(), CliError> {
    let job = TilingJob::open(&args.folder).map_err(|e| failed(&e))?;
    let task = match args.job {
        JobKind::Status => {
            let status = job.status().map_err(|e| failed(&e))?;
            return print(global, &status_in_words(&status), &json!(status));
        }
        JobKind::Run => Task::Run(args.index),
        JobKind::Sort => Task::Sort,
        JobKind::Neighbors => Task::Neighbors(args.index),
        JobKind::Orientation => Task::Orientation(args.index),
        JobKind::Bands => Task::Bands(args.index),
        JobKind::Maps => Task::Maps(args.index),
    };
    if !(args.if_missing && job.is_done(task)) {
        with_progress(global, "working", |progress| run_task(&job, task, progress))
            .map_err(|e| failed(&e))?;
    }
    if let Task::Run(_) = task {
        let n_runs = job.n_runs();
        return print(global, &format!("done; {n_runs} runs\n"), &json!({ "job": task, "n_runs": n_runs }));
    }
    let n_tiles = job.n_tiles().map_err(|e| failed(&e))?;
    let is_last = matches!(task, Task::Maps(_)) || (matches!(task, Task::Bands(_)) && !job.has_maps());
    let path = is_last.then(|| job.tile(args.index));
    let text = match &path {
        Some(path) => format!("{}\n", path.display()),
        None => format!("done; {n_tiles} tiles\n"),
    };
    print(global, &text, &json!({ "job": task, "n_tiles": n_tiles, "path": path }))
}
