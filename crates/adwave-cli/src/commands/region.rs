//! `adwave region`: the weights of regions, to inspect them before an edit.

use crate::args::{ShapeArgs, region, regions_help};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::{ValuesFile, holds_fields, unsuitable_format, write_field};
use crate::output::{bounds_json, bounds_text, check_writable, count, note, number, print};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::region::{WEIGHT, note_region, region_weights, union_of_regions};
use crate::resolve::shape::{Input, load_shape, row_words};
use adwave::Decomposer;
use adwave::operator::OperatorTask;
use adwave::region::{FarPoint, Region};
use adwave::shape::bounding_box;
use adwave_io::{Field, FieldValues};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = concat!(regions_help!(), "
Output by extension:
  .ply .vtp        the shape with the field weight
  .npy .csv .gii   the weights alone, one number per vertex

These are the weights that 'adwave filter' uses for the same regions and options of the diffusion operator. In a file that this
command wrote, the region field:name=weight reads them back.

Examples:
  adwave region bust.obj --region 'ball:vertex=120,radius=10%'
  adwave region bust.obj --region 'ball:point=0 1 0,radius=12%' \\
    --region 'vertices:indices=7,radius=5%' -o mask.ply
  adwave region brain.gii --region 'half-space:point=0 0 0,normal=0 0 1' -o upper.func.gii
  adwave render bust.obj --region 'ball:vertex=120,radius=10%' --focus vertex=120 -o mask.png"))]
pub(crate) struct RegionArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Region; several are joined by "or" (see above)
    #[arg(long, value_name = "REGION", value_parser = region, required = true)]
    pub(crate) region: Vec<Region>,
    /// File for the weights (.ply, .glb, .vtp, .las, .npy, .csv, .gii and others); without it they are only summarized
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
}

pub(crate) fn run(args: &RegionArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(path) = &args.output {
        check(path)?;
    }
    let input = load_shape(&args.shape, global)?;
    let region = union_of_regions(&args.region);
    if region.fields().is_empty() {
        let applies = "applies to regions of a field that is computed, such as field:name=saliency";
        global.given.refuse(&["--operator", "--density-invariant", "--keep-creases"], applies)?;
    }
    let operator = operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?;
    let decomposer = prepare(global, &input, &operator)?;
    let weights = with_progress(global, "measuring", |progress| {
        region_weights(&region, &input, &decomposer, progress)
    })?;
    note_region(&region, &input.file, &decomposer, global)?;
    let coverage = Coverage::new(&weights, &input, &decomposer);
    let [one, many] = input.row_words();
    if coverage.n_inside == 0 {
        note(global, &format!("no {one} is in the region; try a larger radius or another place"));
    }
    let mut text = format!("{}: {}\n", input.name, count(weights.len(), one, many));
    coverage.describe(&mut text, [one, many], decomposer.extent());
    let json = json!({
        "shape": input.name,
        "output": args.output.as_ref().map(|path| path.display().to_string()),
        row_words(&input.file)[1]: weights.len(),
        "region": region,
        "weight_above_0": coverage.n_inside,
        "weight_1": coverage.n_full,
        "area_share": coverage.area_share,
        "weighted_area_share": coverage.weighted_area_share,
        "bounding_box": bounds_json(coverage.bounds),
        "points_off_the_shape": far_json(&region, &decomposer, global)?,
    });
    if let Some(path) = &args.output {
        write(global, path, input, weights)?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(global, &text, &json)
}

/// Points of the region that lie off the shape.
fn far_json(region: &Region, decomposer: &Decomposer, global: &Global<'_>) -> Result<Value, CliError> {
    let far =
        region.far_points(decomposer.metric(), global.progress()).map_err(|e| CliError::classify(&e))?;
    let row = |p: &FarPoint| json!({"point": p.point, "nearest": p.nearest, "distance": p.distance});
    Ok(far.iter().map(row).collect())
}

fn check(path: &Path) -> Result<(), CliError> {
    if ValuesFile::from_path(path).is_none() && !holds_fields(path) {
        return Err(unsuitable_format(path, "weights are", &[".npy", ".csv", ".gii"]));
    }
    check_writable(path)
}

fn write(global: &Global<'_>, path: &Path, mut input: Input, weights: Vec<f64>) -> Result<(), CliError> {
    let field = Field::new(WEIGHT, 1, FieldValues::F64(weights));
    write_field(global, path, ValuesFile::choose(path, &input.file), &mut input.file, field)
}

/// Part of a shape that a region covers.
struct Coverage {
    /// Vertices whose weight is above 0.
    n_inside: usize,
    /// Vertices whose weight is 1.
    n_full: usize,
    /// Share of the area in which the weight is above 0; none on a graph.
    area_share: Option<f64>,
    /// Share of the area, each vertex counted by its weight; none on a graph.
    weighted_area_share: Option<f64>,
    /// Bounding box of the vertices whose weight is above 0.
    bounds: Option<([f64; 3], [f64; 3])>,
}

impl Coverage {
    fn new(weights: &[f64], input: &Input, decomposer: &Decomposer) -> Self {
        let points = input.shape.points().unwrap_or_default();
        let inside: Vec<[f64; 3]> =
            points.iter().zip(weights).filter(|(_, r)| **r > 0.0).map(|(p, _)| *p).collect();
        let areas = decomposer.areas();
        let share = |of: &dyn Fn(f64) -> f64| {
            let part: f64 = areas.iter().zip(weights).map(|(area, r)| area * of(*r)).sum();
            let share = part / areas.iter().sum::<f64>();
            Some(share).filter(|share| share.is_finite() && !points.is_empty())
        };
        Self {
            n_inside: weights.iter().filter(|r| **r > 0.0).count(),
            n_full: weights.iter().filter(|r| **r == 1.0).count(),
            area_share: share(&|r| f64::from(r > 0.0)),
            weighted_area_share: share(&|r| r),
            bounds: bounding_box(&inside),
        }
    }

    fn describe(&self, text: &mut String, [one, many]: [&str; 2], diagonal: f64) {
        let _ = writeln!(text, "  weight above 0   {}", count(self.n_inside, one, many));
        let _ = writeln!(text, "  weight 1         {}", count(self.n_full, one, many));
        if let (Some(all), Some(weighted)) = (self.area_share, self.weighted_area_share) {
            let (all, weighted) = (number(100.0 * all), number(100.0 * weighted));
            let _ =
                writeln!(text, "  area             {all} % of the area of the shape, {weighted} % by weight");
        }
        if let Some(bounds) = self.bounds {
            let _ = writeln!(text, "  bounding box     {}", bounds_text(&bounds, diagonal));
        }
    }
}
