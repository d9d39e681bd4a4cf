//! `adwave rebase`: detail put onto a base that was edited elsewhere.

use super::moved_shape::MovedShape;
use crate::args::{BaseWidthArgs, ShapeArgs, file_name};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, number, output_format, percent_of};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::shape::{ShapeSource, load_shape, load_source};
use adwave::operator::OperatorTask;
use adwave_deform::{base_points, with_base};
use clap::{ArgGroup, Args};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("step").required(true).args(["base", "write_base"])),
    after_help = "\
The base is the shape without its detail: all its vertices, smoothed to the width of --width. Write it, bend or sculpt it in any
program that keeps the number and the order of the vertices, and put the detail back: each detail turns with its
surroundings from the old base to the new one. The unchanged base gives the shape back. The base of another pose with the same
faces works as well. Use the same --width for both steps.

Examples:
  adwave rebase scan.ply --write-base base.obj            1. write the base
  adwave rebase scan.ply --base bent.obj -o posed.ply     2. base.obj was edited as bent.obj
  adwave rebase scan.ply --write-base base.obj --width 4%     a smoother base: more rides along"
)]
pub(crate) struct RebaseArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Edited base: a file with as many vertices in the same order
    #[arg(long, value_name = "FILE", value_parser = file_name(), requires = "output")]
    pub(crate) base: Option<String>,
    /// File for the base of the shape, to edit it elsewhere
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    pub(crate) write_base: Option<PathBuf>,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) width: BaseWidthArgs,
}

pub(crate) fn run(args: &RebaseArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.width.check()?;
    let path = args.write_base.as_ref().or(args.output.as_ref());
    let Some(path) = path else { unreachable!("one of them is required") };
    output_format(path)?;
    check_writable(path)?;
    let input = load_shape(&args.shape, global)?;
    input.check_lengths(&args.width.given_lengths())?;
    let base = match &args.base {
        Some(name) => Some(load_source(&ShapeSource::new(name), global)?),
        None => None,
    };
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    let schedule = args.width.resolve(&decomposer)?;
    let sigma = schedule.sigma(decomposer.operator().step_length()).last().copied().unwrap_or_default();
    let points = with_progress(global, "splitting", |progress| match &base {
        Some(base) => {
            let points = base.shape.points().unwrap_or_default();
            with_base(&decomposer, &schedule, points, progress)
        }
        None => base_points(&decomposer, &schedule, progress),
    });
    let points = points.map_err(|error| match (&base, error) {
        (Some(base), error) => super::moved_shape::name_error(&base.name, error),
        (None, error) => error.into(),
    })?;
    let what = if base.is_some() { "detail put onto" } else { "base:" };
    let onto = base.as_ref().map_or_else(String::new, |base| format!(" {}", base.name));
    let text = format!(
        "{}: {what}{onto} σ {}, {} % of the diagonal\n",
        input.name,
        number(sigma),
        percent_of(sigma, decomposer.extent())
    );
    let report = json!({"sigma": sigma, "base": args.base, "operator": decomposer.operator_kind().name()});
    MovedShape { input, decomposer: &decomposer, points, text, report }.write(path, global)
}
