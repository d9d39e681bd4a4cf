//! `adwave transfer`: detail carried onto another mesh of the same surface.

use super::moved_shape::MovedShape;
use crate::args::{ShapeArgs, file_name, length, region, regions_help};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, count, note, number, output_format, percent_of};
use crate::resolve::operator::{operator_with_default, prepare};
use crate::resolve::region::{region_weights, union_of_regions};
use crate::resolve::shape::{GivenLength, ShapeSource, load_shape, load_source};
use adwave::operator::OperatorKind;
use adwave::region::{Length, Region};
use adwave_deform::transfer;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = concat!("\
Both shapes are smoothed to the same width. Each vertex of SHAPE keeps its place on its own smooth base and takes the detail of
FROM at the nearest place there. The two must lie in the same place; 'adwave match' aligns them. A vertex farther than the
width from FROM's base keeps its own detail.

", regions_help!(), "
Examples:
  adwave transfer low.obj --from scan.ply -o detailed.obj
  adwave transfer low.obj --from scan.ply -o face.obj --region 'ball:vertex=120,radius=20%'"))]
pub(crate) struct TransferArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Shape whose detail is taken: a file, '-', or sample:NAME
    #[arg(long, value_name = "FROM", value_parser = file_name())]
    pub(crate) from: String,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Width σ below which detail is taken, in model units or in % of the diagonal of SHAPE
    #[arg(long, value_name = "L", value_parser = length, allow_negative_numbers = true, default_value = "2%")]
    pub(crate) width: Length,
    /// Region that takes the detail; several are joined by "or" (see above) [default: everywhere]
    #[arg(long, value_name = "REGION", value_parser = region)]
    pub(crate) region: Vec<Region>,
}

pub(crate) fn run(args: &TransferArgs, global: &Global<'_>) -> Result<(), CliError> {
    output_format(&args.output)?;
    check_writable(&args.output)?;
    let input = load_shape(&args.shape, global)?;
    input.check_lengths(&[GivenLength { option: "--width", length: args.width }])?;
    let from = load_source(&ShapeSource::new(&args.from), global)?;
    let operator = operator_with_default(&args.shape.operator, OperatorKind::Surface)?;
    let decomposer = prepare(global, &input, &operator)?;
    let source = prepare(global, &from, &operator)?;
    let weights = match &args.region[..] {
        [] => None,
        regions => {
            let progress = global.progress();
            Some(region_weights(&union_of_regions(regions), &input, &decomposer, progress)?)
        }
    };
    let width = args.width.to_model_units(decomposer.extent());
    let found = with_progress(global, "splitting", |progress| {
        transfer(&source, &decomposer, Some(width), weights.as_deref(), progress)
    })?;
    if found.n_far > 0 {
        let vertices = count(found.n_far, "vertex is", "vertices are");
        note(global, &format!("{vertices} farther than the width from {} and kept as before", from.name));
    }
    let extent = decomposer.extent();
    let text = format!(
        "{}: detail of {} below σ {}, {} % of the diagonal; their bases are at most {} apart ({} %)\n",
        input.name,
        from.name,
        number(found.width),
        percent_of(found.width, extent),
        number(found.largest_gap),
        percent_of(found.largest_gap, extent)
    );
    let report = json!({
        "from": from.name, "sigma": found.width, "largest_gap": found.largest_gap, "far_vertices": found.n_far,
    });
    MovedShape { input, decomposer: &decomposer, points: found.points, text, report }
        .write(&args.output, global)
}
