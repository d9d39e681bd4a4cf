//! `adwave region`: the weights of regions, to see and to use before anything is edited by them.

use crate::args::ShapeArgs;
use crate::error::CliError;
use crate::field_file::{FieldFile, holds_fields, no_fields, write_field};
use crate::global::Global;
use crate::output::{bounds_json, bounds_text, check_writable, note, number, print};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::region::{joined, region, regions_help, weights};
use crate::shape_input::{Input, load};
use adwave::Decomposer;
use adwave::region::Region;
use adwave::shape::bounding_box;
use adwave_io::{Field, FieldValues};
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The name of the weights as a field.
pub(crate) const WEIGHT: &str = "weight";

#[derive(Debug, Args)]
#[command(after_help = concat!(regions_help!(), "
Output by extension:
  .ply .vtp        the shape with the field weight
  .npy .csv .gii   the weights alone, one number per vertex

The weights are those that 'adwave filter' takes with the same regions and options of the diffusion operator. Of files that
this writes they come back as a region: field:name=weight.

Examples:
  adwave region bust.obj --region 'ball:vertex=120,radius=10%'
  adwave region bust.obj --region 'ball:point=0 1 0,radius=12%' --region 'vertices:indices=7,radius=5%' -o mask.ply
  adwave region brain.gii --region 'half-space:point=0 0 0,normal=0 0 1' -o upper.func.gii
  adwave render bust.obj --region 'ball:vertex=120,radius=10%' --focus vertex=120 -o mask.png"))]
pub(crate) struct RegionArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where; several are joined by "or" (see below)
    #[arg(long, value_name = "REGION", value_parser = region, required = true)]
    pub(crate) region: Vec<Region>,
    /// Where the weights go (.ply, .glb, .vtp, .las, .npy, .csv, .gii and others); without it they are only counted
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
}

pub(crate) fn run(args: &RegionArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(path) = &args.output {
        check(path)?;
    }
    let input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let decomposer = prepare(global, &input.shape, &args.shape.operator()?)?;
    let region = joined(&args.region);
    let weights =
        with_progress(global, "measuring", |progress| weights(&region, &input, &decomposer, progress))?;
    let covered = Covered::new(&weights, &input, &decomposer);
    if covered.n_inside == 0 {
        note(global, "no vertex is in the region; a larger radius or another place reaches some");
    }
    let mut text = format!("{}: {} vertices\n", input.name, weights.len());
    covered.describe(&mut text, decomposer.diagonal());
    let json = json!({
        "shape": input.name,
        "output": args.output.as_ref().map(|path| path.display().to_string()),
        "vertices": weights.len(),
        "region": region,
        "weight_above_0": covered.n_inside,
        "weight_1": covered.n_full,
        "area_share": covered.area_share,
        "weighted_area_share": covered.weighted_area_share,
        "bounding_box": bounds_json(covered.bounds),
    });
    if let Some(path) = &args.output {
        with_spinner(global, "writing", || write(global, path, input, weights))?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(global, &text, &json)
}

fn check(path: &Path) -> Result<(), CliError> {
    if FieldFile::of(path).is_none() && !holds_fields(path) {
        return Err(no_fields(path, "weights are", &[".npy", ".csv", ".gii"]));
    }
    check_writable(path)
}

fn write(global: &Global<'_>, path: &Path, mut input: Input, weights: Vec<f64>) -> Result<(), CliError> {
    let field = Field::new(WEIGHT, 1, FieldValues::F64(weights));
    write_field(global, path, FieldFile::of(path), &mut input.file, field)
}

/// What of a shape a region covers.
struct Covered {
    /// Vertices whose weight is above 0.
    n_inside: usize,
    /// Vertices whose weight is 1.
    n_full: usize,
    /// The part of the area where the weight is above 0; none of a graph.
    area_share: Option<f64>,
    /// The same with each vertex counted by its weight.
    weighted_area_share: Option<f64>,
    /// Of the vertices whose weight is above 0.
    bounds: Option<([f64; 3], [f64; 3])>,
}

impl Covered {
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

    fn describe(&self, text: &mut String, diagonal: f64) {
        let _ = writeln!(text, "  weight above 0   {} vertices", self.n_inside);
        let _ = writeln!(text, "  weight 1         {} vertices", self.n_full);
        if let (Some(all), Some(weighted)) = (self.area_share, self.weighted_area_share) {
            let (all, weighted) = (number(100.0 * all), number(100.0 * weighted));
            let _ = writeln!(text, "  area             {all} % of the shape's, {weighted} % by weight");
        }
        if let Some(bounds) = self.bounds {
            let _ = writeln!(text, "  bounding box     {}", bounds_text(bounds, diagonal));
        }
    }
}
