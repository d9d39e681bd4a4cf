//! `adwave morph`: two shapes with the same faces, blended band by band.

use super::moved_shape::MovedShape;
use crate::args::{ShapeArgs, count as parse_count, file_name, number};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, count, output_format};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::shape::{ShapeSource, load_shape, load_source};
use adwave::bands::Schedule;
use adwave::operator::OperatorTask;
use adwave_deform::morph;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
SHAPE and OTHER must have the same vertices and faces in the same order. Bases are blended along straight lines, detail turns
from both to the blend. Shares below 0 or above 1 exaggerate.

Examples:
  adwave morph calm.obj smile.obj -o half.obj --share 0.5
  adwave morph calm.obj smile.obj -o mixed.obj --share 0 --band-shares 1,1,0.5   new fine detail")]
pub(crate) struct MorphArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Other shape: a file, '-', or sample:NAME
    #[arg(value_name = "OTHER", value_parser = file_name())]
    pub(crate) other: String,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Share of OTHER in the base, and in all bands without one of their own
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true)]
    pub(crate) share: f64,
    /// Shares of OTHER in the bands, from the finest on
    #[arg(long, value_name = "T,T,…", value_parser = number, value_delimiter = ',', allow_negative_numbers = true)]
    pub(crate) band_shares: Option<Vec<f64>>,
    /// Number of levels [default: as by 'adwave filter']
    #[arg(long, short = 'j', value_name = "J", value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) levels: Option<usize>,
}

pub(crate) fn run(args: &MorphArgs, global: &Global<'_>) -> Result<(), CliError> {
    output_format(&args.output)?;
    check_writable(&args.output)?;
    let input = load_shape(&args.shape, global)?;
    // Both lose the same points, so that they stay alike.
    let (part, selection) = (args.shape.part.to_part(), Some(&args.shape.selection));
    let source = ShapeSource { kind: args.shape.kind, part, selection, ..ShapeSource::new(&args.other) };
    let other = load_source(&source, global)?;
    let operator = operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?;
    let (a, b) = (prepare(global, &input, &operator)?, prepare(global, &other, &operator)?);
    let schedule = match args.levels {
        Some(levels) => Schedule::dyadic(levels)?,
        None => a.default_schedule().schedule,
    };
    let n_levels = schedule.n_levels();
    let given = args.band_shares.as_deref().unwrap_or_default();
    if given.len() > n_levels {
        return Err(CliError::Input(format!(
            "--band-shares must have at most {}, one per band, got {}",
            count(n_levels, "number", "numbers"),
            given.len()
        )));
    }
    let shares: Vec<f64> = (0..=n_levels).map(|j| given.get(j).copied().unwrap_or(args.share)).collect();
    let points = with_progress(global, "splitting", |progress| morph(&a, &b, &schedule, &shares, progress))?;
    let levels = count(n_levels, "level", "levels");
    let text = format!("{} → {}: {levels}, share {} of the base\n", input.name, other.name, args.share);
    let report = json!({"other": other.name, "shares": shares});
    MovedShape { input, decomposer: &a, points, text, report }.write(&args.output, global)
}
