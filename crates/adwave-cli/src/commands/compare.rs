//! `adwave compare`: the same task by adwave and by another method.

use crate::args::{FieldArgs, LevelArgs, ShapeArgs};
use crate::commands::transform::fresh;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{bands_params, number, print, schedule, table, write_shape};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::shape_input::{Input, load};
use crate::signal::{self, COORDS};
use adwave_baselines::compare::{Comparison, ComparisonInput, Method, Outcome, compare};
use adwave_io::{Field, FieldValues};
use clap::Args;
use clap::ValueEnum;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Methods:
  mht          smooth by manifold harmonics, half the gain at the same frequency
  taubin       smooth by the windowed sinc, half the gain at the same frequency
  lee          the saliency map of Lee, Varshney and Jacobs
  feature-map  critical points of a signal smoothed by heat [default signal: mean-curvature]
  sgwt         spectral graph wavelets of the same diffusion operator, as many bands, and back
  bilateral    denoise a mesh by bilateral normal filtering, its own defaults; adwave takes out four levels
  guided       the same by guided normal filtering
  dw, bdw      diffusion wavelets, biorthogonal ones (up to 6000 vertices), and back

Both results go to DIR as adwave.ply and METHOD.ply, the table as comparison.json.

Examples:
  adwave compare bunny.obj --with mht --harmonics 300 -o out
  adwave compare sample:creature --vertices 3000 --with dw -o out")]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The other method
    #[arg(long = "with", value_name = "METHOD", value_enum)]
    pub(crate) method: MethodArg,
    /// Folder that the files go to
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// mht: number of harmonics
    #[arg(long, value_name = "K", default_value = "200")]
    pub(crate) harmonics: NonZeroUsize,
}

/// `adwave_baselines::compare::Method` by its names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// Manifold harmonics
    Mht,
    /// Mesh saliency
    Lee,
    /// Critical points
    FeatureMap,
    /// Spectral graph wavelets
    Sgwt,
    /// Diffusion wavelets
    Dw,
    /// Biorthogonal diffusion wavelets
    Bdw,
    /// Windowed sinc
    Taubin,
    /// Bilateral normal filtering
    Bilateral,
    /// Guided normal filtering
    Guided,
}

/// The signal of a feature map, which takes one channel.
const CURVATURE: &str = "mean-curvature";

pub(crate) fn run(args: &CompareArgs, global: &Global<'_>) -> Result<(), CliError> {
    let params = bands_params(&args.levels)?;
    std::fs::create_dir_all(&args.output).map_err(|e| {
        CliError::Environment(format!("cannot make the folder {}: {e}", args.output.display()))
    })?;
    let method = args.method.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
    let field = match (args.method, args.field.name()) {
        (MethodArg::FeatureMap, COORDS) => CURVATURE,
        (_, field) => field,
    };
    let input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let signal = signal::load(global, &input, field, args.field.texture.as_deref())?;
    let start = Instant::now();
    let decomposer = prepare(global, &input.shape, &args.shape.operator_for(&args.levels)?)?;
    let prepare_seconds = Some(start.elapsed().as_secs_f64());
    let (schedule, why) = schedule(&args.levels, &decomposer, global)?;
    let comparison_input = ComparisonInput {
        shape: &input.shape,
        decomposer: &decomposer,
        prepare_seconds,
        schedule: &schedule,
        params: &params,
        signal: &signal.values,
        n_channels: signal.n_channels,
        n_harmonics: args.harmonics.get(),
    };
    let comparison = with_progress(global, "comparing", |progress| {
        compare(&comparison_input, args.method.into(), progress)
    })?;

    let shown = |value: Option<f64>| value.map_or("–".to_owned(), number);
    let mut text = format!(
        "{}: {} vertices, {field}\n{why}\n{}\n\n",
        input.name,
        input.shape.n_vertices(),
        comparison.task
    );
    text += &table(
        ["", "adwave", method.as_str()],
        comparison.rows.iter().map(|r| [r.quantity.clone(), shown(r.adwave), shown(r.other)]),
    );
    text += "\n";
    for (name, outcomes) in [("adwave", &comparison.adwave), (method.as_str(), &comparison.other)] {
        let path = args.output.join(format!("{name}.ply"));
        with_spinner(global, "writing", || write(global, &path, &input, field, outcomes))?;
        text += &format!("{}\n", path.display());
    }
    let json = report(&input, field, &method, &comparison);
    let path = args.output.join("comparison.json");
    std::fs::write(&path, format!("{json:#}\n"))
        .map_err(|e| CliError::Environment(format!("cannot write {}: {e}", path.display())))?;
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

/// The shape with the results as fields; coordinates that were smoothed become its points.
fn write(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    field: &str,
    outcomes: &[Outcome],
) -> Result<(), CliError> {
    let mut file = fresh(&input.file, path);
    for outcome in outcomes {
        let is_shape = field == COORDS && matches!(outcome.name.as_str(), "smoothed" | "coarse");
        if is_shape && !file.points().is_empty() {
            file.set_points(outcome.values.as_chunks().0.to_vec())?;
        } else {
            let values = FieldValues::F64(outcome.values.clone());
            file.add_vertex_field(Field::new(outcome.name.as_str(), outcome.n_channels, values))?;
        }
    }
    write_shape(global, &file, path).map(|_| ())
}

impl From<MethodArg> for Method {
    fn from(method: MethodArg) -> Self {
        match method {
            MethodArg::Mht => Self::Harmonics,
            MethodArg::Lee => Self::Lee,
            MethodArg::FeatureMap => Self::FeatureMap,
            MethodArg::Sgwt => Self::Sgwt,
            MethodArg::Dw => Self::DiffusionWavelets,
            MethodArg::Bdw => Self::Biorthogonal,
            MethodArg::Taubin => Self::Taubin,
            MethodArg::Bilateral => Self::Bilateral,
            MethodArg::Guided => Self::Guided,
        }
    }
}
