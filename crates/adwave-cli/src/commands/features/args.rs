//! The arguments of `adwave features`.

use crate::args::{BorderArgs, DetectArgs, FieldArgs, LevelArgs, ShapeArgs};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension; without it the features are printed:
  .csv .json  vertex, x, y, z, level, sigma, response, strength, sign, channel
  .ply .vtp   a sphere of radius sigma for each feature, with these as fields and colors by level

Examples:
  adwave features bunny.obj
  adwave features bunny.obj -o features.csv --theta 1.8     weaker ones too, knees and elbows
  adwave features scan.pcd -o features.ply --best 50 --refine
  adwave features sample:plane --field mean-curvature --response literal --edge-ratio 10 --border 1

'adwave match' pairs the features of two shapes.")]
pub(crate) struct FeaturesArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the features go (.csv, .json, .ply or .vtp)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) detect: DetectArgs,
    #[command(flatten)]
    pub(crate) border: BorderArgs,
    /// Write a descriptor of each feature's surroundings too (.csv and .json)
    #[arg(long, help_heading = "Features")]
    pub(crate) descriptors: bool,
}
