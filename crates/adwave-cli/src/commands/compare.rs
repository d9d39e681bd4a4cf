//! `adwave compare`: one task by adwave and by another method.

use crate::args::{LevelArgs, ShapeArgs, SignalArgs, count_from_one, parse_named};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{clone_for_output, count, make_folder, number, print, table, write_file, write_shape};
use crate::resolve::levels::{check_levels, resolve_levels};
use crate::resolve::operator::{operator_for_levels, prepare};
use crate::resolve::shape::{Input, load_shape, move_points};
use crate::resolve::signal::{COORDS, load_signal};
use adwave_baselines::compare::{Comparison, ComparisonInput, Method, Outcome, compare};
use adwave_io::{Field, FieldValues, MovedNormals};
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
  sgwt         spectral graph wavelets of the same diffusion operator, as many bands, with reconstruction
  bilateral    denoising of a mesh by bilateral normal filtering with its own defaults; adwave drops four levels
  guided       denoising of a mesh by guided normal filtering; adwave drops four levels
  subdivision  wavelets by lifting on levels of the mesh: compaction, and dependence on the place
  dw, bdw      diffusion wavelets and biorthogonal ones (up to 6000 vertices), with reconstruction

The results are DIR/adwave.ply and DIR/METHOD.ply, the table is DIR/comparison.json.

Examples:
  adwave compare bunny.obj --with mht --harmonics 300 -o out
  adwave compare sample:creature --vertices 3000 --with dw -o out")]
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
    let field = match (args.method, args.signal.name_on(&input.file)) {
        (Method::FeatureMap, COORDS) => CURVATURE,
        (_, name) => name,
    };
    input.check_lengths(&args.levels.given_lengths())?;
    let signal = load_signal(global, &input, field, args.signal.texture.as_deref())?;
    let start = Instant::now();
    let operator = operator_for_levels(&args.shape.operator, &args.levels)?;
    let decomposer = prepare(global, &input, &operator)?;
    let prepare_seconds = Some(start.elapsed().as_secs_f64());
    let levels = resolve_levels(&args.levels, &decomposer, global)?;
    let subject = ComparisonInput {
        shape: &input.shape,
        decomposer: &decomposer,
        prepare_seconds,
        schedule: &levels.schedule,
        params: &params,
        signal: &signal.values,
        n_channels: signal.n_channels,
        n_harmonics: args.harmonics.get(),
    };
    let comparison = with_progress(global, "comparing", |progress| compare(&subject, args.method, progress))?;

    let shown = |value: Option<f64>| value.map_or("–".to_owned(), number);
    let mut text = format!(
        "{}: {}, {field}\n{}\n{}\n\n",
        input.name,
        count(input.shape.n_vertices(), "vertex", "vertices"),
        levels.reason,
        comparison.task
    );
    text += &table(
        ["", "adwave", method],
        comparison.rows.iter().map(|r| [r.quantity.clone(), shown(r.adwave), shown(r.other)]),
    );
    text += "\n";
    for (name, outcomes) in [("adwave", &comparison.adwave), (method, &comparison.other)] {
        let path = args.output.join(format!("{name}.ply"));
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

fn report(input: &Input, field: &str, method: &str, comparison: &Comparison) -> Value {
    let row = |r: &adwave_baselines::compare::Row| json!({"quantity": r.quantity, "adwave": r.adwave, "other": r.other});
    json!({
        "shape": input.name,
        "vertices": input.shape.n_vertices(),
        "field": field,
        "with": method,
        "task": comparison.task,
        "rows": comparison.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// Writes the shape with the results as fields; smoothed coordinates become its points.
fn write(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    field: &str,
    outcomes: &[Outcome],
) -> Result<(), CliError> {
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
