//! `adwave compare`: one task by adwave and by another method.

use crate::args::{LevelArgs, ShapeArgs, SignalArgs, count_from_one, parse_named};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::ValuesFile;
use crate::output::{clone_for_output, make_folder, number, print, table, write_file, write_shape};
use crate::resolve::applicable::article;
use crate::resolve::levels::{check_levels, resolve_levels};
use crate::resolve::operator::{operator_for_levels, prepare, prepare_for_signal};
use crate::resolve::shape::{Input, load_shape, move_points};
use crate::resolve::signal::{COORDS, Signal, load_signal};
use adwave::bands::Schedule;
use adwave::mask::missing;
use adwave::{Decomposer, LevelSpec, ResolvedLevels};
use adwave_baselines::compare::{Comparison, ComparisonInput, Method, Outcome, Row, compare};
use adwave_baselines::grid_smoothing::{GridPlaces, starlet_widths};
use adwave_io::{Field, FieldValues, GridLayout, MovedNormals};
use clap::Args;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Methods:
  mht          smoothing by manifold harmonics, with the gain 1/2 at the same frequency
  taubin       smoothing by the windowed sinc, with the gain 1/2 at the same frequency
  lee          saliency map of Lee, Varshney and Jacobs
  feature-map  critical points of a signal smoothed by heat [default signal: mean-curvature]
  sgwt         spectral graph wavelets of the same diffusion operator, as many bands, with
               reconstruction
  bilateral    denoising of a mesh by bilateral normal filtering with its own defaults; adwave
               drops four levels
  guided       denoising of a mesh by guided normal filtering; adwave drops four levels
  subdivision  wavelets by lifting on levels of the mesh: compaction, and dependence on the place
  dw, bdw      diffusion wavelets and biorthogonal ones (up to 6000 vertices), with reconstruction
  gaussian     bands of an image or a volume by sampled Gaussians of the same widths, as
               gaussian_filter of SciPy
  starlet      bands of an image or a volume by the isotropic undecimated wavelet of the B3 spline
               [default levels: its widths]

The results are DIR/adwave.ply and DIR/METHOD.ply, the table is DIR/comparison.json. Bands and rest of an image are the channels
of .tif, of a volume the frames of .nii.gz, of a sequence the columns of .npy.

Examples:
  adwave compare bunny.obj --with mht --harmonics 300 -o out
  adwave compare sample:creature --vertices 3000 --with dw -o out
  adwave compare volume.nii.gz --with gaussian --fwhm 4,8,16 -o out")]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Other method
    #[arg(long = "with", value_name = "METHOD", value_parser = parse_named::<Method>())]
    pub(crate) method: Method,
    /// Folder for the files
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// mht: number of harmonics
    #[arg(long, value_name = "K", value_parser = count_from_one, default_value = "200")]
    pub(crate) harmonics: NonZeroUsize,
}

/// Default signal of a feature map, which needs one channel.
const CURVATURE: &str = "mean-curvature";

pub(crate) fn run(args: &CompareArgs, global: &Global<'_>) -> Result<(), CliError> {
    if args.method != Method::Harmonics {
        global.given.refuse(&["--harmonics"], "applies to --with mht")?;
    }
    let params = check_levels(&args.levels)?;
    make_folder(&args.output)?;
    let method = args.method.name();
    let input = load_shape(&args.shape, global)?;
    check_kind(&input, args.method)?;
    let field = match (args.method, args.signal.name_on(&input.file)) {
        (Method::FeatureMap, COORDS) => CURVATURE,
        (_, name) => name,
    };
    input.check_lengths(&args.levels.given_lengths())?;
    let signal = load_signal(global, &input, field, args.signal.texture.as_deref())?;
    let start = Instant::now();
    let operator = operator_for_levels(&args.shape.operator, &args.levels)?;
    let is_grid = args.method.takes_grids();
    let decomposer = if is_grid {
        prepare_for_signal(global, &input, &operator, &signal, field)?
    } else {
        prepare(global, &input, &operator)?
    };
    let prepare_seconds = Some(start.elapsed().as_secs_f64());
    let kept = if is_grid { known_places(&input, &signal) } else { None };
    let places = input.file.grid().map(|layout| {
        let GridLayout { sizes, spacings, .. } = layout;
        GridPlaces { sizes, spacings, kept: kept.as_deref() }
    });
    let mut levels = resolve_levels(&args.levels, &decomposer, global)?;
    if let (Method::Starlet, Some(places)) = (args.method, &places) {
        levels = starlet_levels(&args.levels.to_spec(), places, &decomposer, levels)?;
    }
    let subject = ComparisonInput {
        shape: &input.shape,
        grid: places,
        decomposer: &decomposer,
        prepare_seconds,
        schedule: &levels.schedule,
        params: &params,
        signal: &signal.values,
        n_channels: signal.n_channels,
        n_harmonics: args.harmonics.get(),
    };
    let comparison = with_progress(global, "comparing", |progress| compare(&subject, args.method, progress))?;

    let ending = match input.kind_name() {
        "image" => "tif",
        "volume" => "nii.gz",
        "sequence" => "npy",
        _ => "ply",
    };
    let mut text = format!(
        "{}: {}, {field}\n{}\n{}\n\n",
        input.name,
        input.count_rows(),
        levels.reason,
        comparison.task
    );
    text += &quantity_table(&comparison.rows, method);
    text += &level_table(&comparison.rows, method);
    text += "\n";
    for (name, outcomes) in [("adwave", &comparison.adwave), (method, &comparison.other)] {
        let path = args.output.join(format!("{name}.{ending}"));
        write(global, &path, &input, field, outcomes)?;
        text += &format!("{}\n", path.display());
    }
    let mut json = report(&input, field, method, &comparison);
    json["output"] = json!(args.output.display().to_string());
    let path = args.output.join("comparison.json");
    write_file(global, &path, format!("{json:#}\n").as_bytes())?;
    text += &path.display().to_string();
    print(global, &text, &json)
}

/// A row for each quantity that is not measured by level.
fn quantity_table(rows: &[Row], method: &str) -> String {
    let shown = |value: Option<f64>| value.map_or("–".to_owned(), number);
    let rows = rows.iter().filter(|row| row.level.is_none());
    table(["", "adwave", method], rows.map(|row| [row.quantity.clone(), shown(row.adwave), shown(row.other)]))
}

/// A row for each level, and for each quantity a column by method, or a single one if they agree everywhere; empty if
/// nothing was measured by level.
fn level_table(rows: &[Row], method: &str) -> String {
    let by_level: Vec<&[Row]> =
        rows.chunk_by(|a, b| a.level == b.level).filter(|rows| rows[0].level.is_some()).collect();
    let Some(first) = by_level.first() else { return String::new() };
    let mut head = vec!["level".to_owned()];
    let mut columns: Vec<Vec<Option<f64>>> = Vec::new();
    for (k, row) in first.iter().enumerate() {
        let column = |value: fn(&Row) -> Option<f64>| by_level.iter().map(|rows| value(&rows[k])).collect();
        let [own, other]: [Vec<Option<f64>>; 2] = [column(|row| row.adwave), column(|row| row.other)];
        let is_one = own == other || own.iter().all(Option::is_none);
        head.push(row.quantity.clone());
        if !is_one {
            head.push(method.to_owned());
            columns.push(own);
        }
        columns.push(other);
    }
    let cells = |(k, rows): (usize, &&[Row])| {
        let values = columns.iter().map(|column| column[k].map_or("–".to_owned(), number));
        rows[0].level.map(|level| level.to_string()).into_iter().chain(values).collect::<Vec<String>>()
    };
    format!("\n{}", table(head, by_level.iter().enumerate().map(cells)))
}

/// Refuses a method of shapes for an image or a volume, and the other way round.
fn check_kind(input: &Input, method: Method) -> Result<(), CliError> {
    if input.file.grid().is_some() == method.takes_grids() {
        return Ok(());
    }
    let (takes, others) = if method.takes_grids() {
        ("images and volumes", "mht and the other methods take shapes")
    } else {
        ("shapes", "gaussian and starlet take images and volumes")
    };
    let (name, kind, method) = (&input.name, input.kind_name(), method.name());
    Err(CliError::Input(format!(
        "--with {method} takes {takes}, and {name} is {} {kind}; {others}",
        article(kind)
    )))
}

/// Flags of the places of an image or a volume that take part and have a value; `None` if all do.
fn known_places(input: &Input, signal: &Signal) -> Option<Vec<bool>> {
    let kept = input.file.grid()?.kept.as_deref();
    let missing = missing(&signal.values, signal.n_channels);
    let is_known =
        |x: usize| kept.is_none_or(|kept| kept[x]) && missing.as_ref().is_none_or(|missing| !missing[x]);
    let known: Vec<bool> = (0..input.shape.n_vertices()).map(is_known).collect();
    known.contains(&false).then_some(known)
}

/// Levels with the widths of the starlet, unless widths or steps are asked for: as many as are asked for, or as reach the
/// usual width.
fn starlet_levels(
    spec: &LevelSpec,
    places: &GridPlaces<'_>,
    decomposer: &Decomposer,
    usual: ResolvedLevels,
) -> Result<ResolvedLevels, CliError> {
    let widest = *usual.schedule.sigma(decomposer.operator().step_length()).last().expect("a level");
    let n_levels = match spec {
        LevelSpec::Dyadic(n_levels) => *n_levels,
        LevelSpec::Default => {
            let widths = starlet_widths(places, usual.schedule.n_levels());
            widths.iter().filter(|width| **width <= widest).count().max(1)
        }
        _ => return Ok(usual),
    };
    let widths = starlet_widths(places, n_levels);
    let schedule = Schedule::lengths(&widths, decomposer.operator().step_length())?;
    Ok(ResolvedLevels { schedule, reason: format!("{n_levels} levels with the widths of the starlet") })
}

fn report(input: &Input, field: &str, method: &str, comparison: &Comparison) -> Value {
    let row =
        |r: &Row| json!({"quantity": r.quantity, "level": r.level, "adwave": r.adwave, "other": r.other});
    json!({
        "shape": input.name,
        "vertices": input.shape.n_vertices(),
        "field": field,
        "with": method,
        "task": comparison.task,
        "rows": comparison.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// Writes the shape with the results as fields, or an image or a volume with a channel for each result; smoothed
/// coordinates become the points of the shape.
fn write(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    field: &str,
    outcomes: &[Outcome],
) -> Result<(), CliError> {
    if let Some(kind) = ValuesFile::choose(path, &input.file).filter(|_| input.file.grid().is_some()) {
        let field = |outcome: &Outcome| {
            let values = FieldValues::F64(outcome.values.clone());
            Field::new(outcome.name.as_str(), outcome.n_channels, values)
        };
        let fields: Vec<Field> = outcomes.iter().map(field).collect();
        return kind.write(global, path, &fields, &input.file);
    }
    let mut file = clone_for_output(&input.file, path);
    for outcome in outcomes {
        let is_shape = field == COORDS && matches!(outcome.name.as_str(), "smoothed" | "coarse" | "kept");
        if is_shape && !file.points().is_empty() {
            let points = outcome.values.as_chunks().0.to_vec();
            move_points(&mut file, points, MovedNormals::Follow, global)?;
        } else {
            let values = FieldValues::F64(outcome.values.clone());
            file.add_vertex_field(Field::new(outcome.name.as_str(), outcome.n_channels, values))?;
        }
    }
    write_shape(global, &file, path).map(|_| ())
}
