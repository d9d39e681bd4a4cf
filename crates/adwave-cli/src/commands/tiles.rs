//! `adwave tiles` and `adwave tile`: clouds and meshes that are larger than memory.

use crate::args::size;
use crate::commands::features::{output_kind, write_features};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{available_memory, check_writable, note, number, print, table};
use crate::progress::with_progress;
use adwave::features::FeatureParams;
use adwave::pages::keep_freed;
use adwave::{ClassifiedError, ErrorKind};
use adwave_tiles::{
    Forecast, Job, LevelSummary, MapKind, MapWeights, Params, Status, Summary, TilesError, Work, forecast,
    is_mesh, join, run_job,
};
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
The points of all files are sorted along one curve and cut into tiles that fit into memory. Around each tile lie as many rings of
neighbours as its bands see, so that all ways to cut give the same bytes; results come in the order of the curve, with all that the
points had. A mesh comes out as one file of its own format, in its own order, with all that it had; its neighbours are those of its faces.
A run that was ended goes on where it was when the same command is given again. See docs/SCALE.md.

Examples:
  adwave tiles flight-*.laz -o smooth.laz --gains 0,0,0.5,1,1,1,1,1
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --memory 4G
  adwave tiles flight-*.laz -o map.laz --saliency --features features.csv
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --forecast
  adwave tiles scan.ply -o smooth.ply --gains 0,0.5,1,1,1,1,1,1 --magnitudes 3,6 --memory 1G
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --plan-only, then on any machine that sees the folder:
  adwave tile tiles/ sort; adwave tile tiles/ neighbours 0; adwave tile tiles/ bands 0")]
pub(crate) struct TilesArgs {
    /// LAS or LAZ files of one point format and scale, folders of such (tiles, an EPT), or one PLY or OBJ with faces
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// A folder for the tiles, or a .las or .laz for all of them in one; of a mesh, a file of its format
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
    /// Number of dyadic levels [default: as many as there are gains, else 8]
    #[arg(long, value_name = "J", help_heading = "Bands")]
    levels: Option<usize>,
    /// A gain for each band, from fine to coarse: 0 drops it, 1 keeps it, 2 doubles it
    #[arg(
        long,
        value_name = "G,G,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Bands"
    )]
    gains: Vec<f64>,
    /// Bands, from 1, whose length |W_j| each point gets as a field wavelet_j, in model units (an OBJ holds none)
    #[arg(long, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    magnitudes: Vec<usize>,
    /// Bands, from 1, that each point gets as fields wavelet_j_x, wavelet_j_y and wavelet_j_z, in model units (an OBJ holds none)
    #[arg(long, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    vectors: Vec<usize>,
    /// A field saliency: a map without a sign, the lengths |W_j| of all levels weighed by KIND
    #[arg(
        long,
        value_name = "KIND",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "entropy",
        help_heading = "Bands"
    )]
    saliency: Option<KindArg>,
    /// How many of the finest levels the map skips [default: 0, with another weighting than entropy 2]
    #[arg(long, value_name = "N", requires = "saliency", help_heading = "Bands")]
    skip: Option<usize>,
    /// Where the features of all tiles go (.csv, .json, or spheres as .ply and others)
    #[arg(long, value_name = "FILE", help_heading = "Bands")]
    features: Option<PathBuf>,
    /// How many times the mean response of its level a feature has
    #[arg(long, value_name = "T", requires = "features", default_value_t = FeatureParams::default().theta, help_heading = "Bands")]
    theta: f64,
    /// How many nearest neighbours a step of the walk takes in, in clouds
    #[arg(long, value_name = "K", default_value_t = Params::default().neighbours, help_heading = "Bands")]
    neighbours: usize,
    /// Relative error of the bands
    #[arg(long, value_name = "E", default_value_t = Params::default().accuracy, help_heading = "Bands")]
    accuracy: f64,
    /// Memory that may be used [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Work")]
    memory: Option<u64>,
    /// Number of tiles [default: as few as the memory allows]
    #[arg(long, value_name = "N", help_heading = "Work")]
    tiles: Option<usize>,
    /// Tiles that are worked on at a time, each with its part of the memory
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Work")]
    workers: usize,
    /// Folder for temporary files [default: the folder of the tiles, or OUT.work beside a file]
    #[arg(long, value_name = "FOLDER", help_heading = "Work")]
    work: Option<PathBuf>,
    /// Say what it will take, and do nothing
    #[arg(long, help_heading = "Work")]
    forecast: bool,
    /// Write the plan, for 'adwave tile'
    #[arg(long, conflicts_with = "forecast", help_heading = "Work")]
    plan_only: bool,
    /// Keep the temporary files
    #[arg(long, help_heading = "Work")]
    keep_work: bool,
}

/// How the levels of the map are weighed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum KindArg {
    /// 1/mean by how unevenly the level is spread
    Entropy,
    /// (max − mean)² (eq. 17)
    Paper,
    /// 1/mean, so that every level counts alike
    Normalised,
    /// 1
    None,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Jobs of one kind may run in any order, at the same time and on several machines; runs come before the sort, which does those that are
missing, all neighbours after it, all bands after all neighbours, and, where there is a map or features, all maps after all bands. 'status' says how many there are of each. A job that is done twice gives the same file again. 'adwave tiles' with the same arguments does what is left and joins.

Examples:
  adwave tile tiles/ status
  adwave tile tiles/ run 2
  adwave tile tiles/ sort
  adwave tile tiles/ neighbours 3
  adwave tile tiles/ bands 3
  adwave tile tiles/ maps 3")]
pub(crate) struct TileArgs {
    /// The folder of 'adwave tiles --plan-only'
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// What to do
    #[arg(value_name = "JOB", value_enum)]
    job: JobKind,
    /// Which run or tile, from 0
    #[arg(value_name = "INDEX", default_value = "0")]
    index: usize,
    /// Do nothing where it is done already
    #[arg(long)]
    if_missing: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum JobKind {
    /// Nothing; say what is done, and how many jobs there are
    Status,
    /// Some points of a cloud in the order of the curve, for the sort, which does those that are missing
    Run,
    /// All points in the order of the curve, and the faces of a mesh to its tiles, once
    Sort,
    /// The neighbours of the points of a tile
    Neighbours,
    /// The bands of a tile, and its points as they come out
    Bands,
    /// The saliency map and the features of a tile, where they were asked for
    Maps,
}

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
    let params = params(args);
    if args.forecast {
        let forecast = forecast(&args.files, &params).map_err(|e| failed(&e))?;
        return print(global, &format!("{}\n", told(&forecast)), &json!(forecast));
    }
    let wants_fields =
        !(params.magnitudes.is_empty() && params.vectors.is_empty() && params.saliency.is_none());
    if params.gains.iter().all(|&gain| gain == 1.0) && !wants_fields && args.features.is_none() {
        return Err(CliError::Input(
            "say what is wanted: --gains, --magnitudes, --vectors, --saliency or --features".into(),
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
    let (work, forecast) = Work::begin(&folder, &args.files, &params).map_err(|e| failed(&e))?;
    note(global, &told(&forecast));
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
    let summary = match with_progress(global, "tiles", |progress| adwave_tiles::run(&work, progress)) {
        Ok(summary) => summary,
        Err(error) => {
            // With such an input there is nothing to go on with.
            if joined && !args.keep_work && error.kind() == ErrorKind::Input && !work.is_sorted() {
                let _ = work.clean();
                let _ = std::fs::remove_dir(&folder);
            }
            return Err(failed(&error));
        }
    };
    let n_features = match features {
        Some((path, kind)) => {
            let features = work.features().map_err(|e| failed(&e))?;
            write_features(path, kind, &features, params.levels, global)?;
            Some(features.len())
        }
        None => None,
    };
    if joined {
        with_progress(global, "joining", |progress| join(&work, &args.output, progress))
            .map_err(|e| failed(&e))?;
    }
    if !args.keep_work {
        if joined {
            work.remove_tiles().map_err(|e| failed(&e))?;
        }
        work.clean().map_err(|e| failed(&e))?;
        if joined {
            // Whatever else is there stays.
            let _ = std::fs::remove_dir(&folder);
        }
    }
    said(global, args, &summary, n_features)
}

/// Bytes of memory from which on what is kept of freed memory is little beside the rest, a tenth at most.
const MUCH: u64 = 1 << 30;

fn params(args: &TilesArgs) -> Params {
    /// Where the system does not say what is free.
    const UNKNOWN: u64 = 8 << 30;
    let levels = match args.gains.len() {
        0 => Params::default().levels,
        n => n,
    };
    let mut params = Params::default();
    params.levels = args.levels.unwrap_or(levels);
    params.gains.clone_from(&args.gains);
    params.magnitudes.clone_from(&args.magnitudes);
    params.vectors.clone_from(&args.vectors);
    params.saliency = args.saliency.map(|kind| {
        // As 'adwave saliency' has it.
        const SKIPPED: usize = 2;
        let (kind, skip) = match kind {
            KindArg::Entropy => (MapKind::Entropy, 0),
            KindArg::Paper => (MapKind::PerLevel, SKIPPED),
            KindArg::Normalised => (MapKind::Normalised, SKIPPED),
            KindArg::None => (MapKind::Uniform, SKIPPED),
        };
        MapWeights { kind, skip: args.skip.unwrap_or(skip) }
    });
    params.theta = args.features.as_ref().map(|_| args.theta);
    params.neighbours = args.neighbours;
    params.accuracy = args.accuracy;
    params.n_tiles = args.tiles;
    params.memory = args.memory.unwrap_or_else(|| available_memory().unwrap_or(UNKNOWN) / 2);
    params.n_workers = args.workers;
    params
}

/// A forecast in words.
fn told(forecast: &Forecast) -> String {
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

fn said(
    global: &Global<'_>,
    args: &TilesArgs,
    summary: &Summary,
    n_features: Option<usize>,
) -> Result<(), CliError> {
    let (what, length) = match summary.n_faces {
        0 => ("points".to_owned(), "distance to a neighbour"),
        n => (format!("vertices of {n} faces"), "length of edges"),
    };
    let mut text = format!(
        "{} {what} at {} positions, {} tiles; mean {length} {}\n",
        summary.n_points,
        summary.n_vertices,
        summary.n_tiles,
        number(summary.mean_length)
    );
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
    let Status { n_runs, runs_done, n_tiles, neighbours_done, bands_done, has_maps, maps_done } = status;
    let maps = if *has_maps { format!(", maps of {maps_done}") } else { String::new() };
    match n_tiles {
        Some(n) => format!("{n} tiles: neighbours of {neighbours_done}, bands of {bands_done}{maps}\n"),
        None if *n_runs > 0 => format!("not sorted; {runs_done} of {n_runs} runs\n"),
        None => "not sorted\n".to_owned(),
    }
}

pub(crate) fn run_tile(args: &TileArgs, global: &Global<'_>) -> Result<(), CliError> {
    let work = Work::open(&args.folder).map_err(|e| failed(&e))?;
    let job = match args.job {
        JobKind::Status => {
            let status = work.status().map_err(|e| failed(&e))?;
            return print(global, &status_in_words(&status), &json!(status));
        }
        JobKind::Run => Job::Run(args.index),
        JobKind::Sort => Job::Sort,
        JobKind::Neighbours => Job::Neighbours(args.index),
        JobKind::Bands => Job::Bands(args.index),
        JobKind::Maps => Job::Maps(args.index),
    };
    if !(args.if_missing && work.is_done(job)) {
        with_progress(global, "working", |progress| run_job(&work, job, progress)).map_err(|e| failed(&e))?;
    }
    if let Job::Run(_) = job {
        let n_runs = work.n_runs();
        return print(global, &format!("done; {n_runs} runs\n"), &json!({ "job": job, "n_runs": n_runs }));
    }
    let n_tiles = work.n_tiles().map_err(|e| failed(&e))?;
    let is_last = matches!(job, Job::Maps(_)) || (matches!(job, Job::Bands(_)) && !work.has_maps());
    let path = is_last.then(|| work.tile(args.index));
    let text = match &path {
        Some(path) => format!("{}\n", path.display()),
        None => format!("done; {n_tiles} tiles\n"),
    };
    print(global, &text, &json!({ "job": job, "n_tiles": n_tiles, "path": path }))
}
