//! The arguments of `adwave features`.

use crate::args::{BorderMaskArgs, DetectArgs, GivenWalkArgs, LevelArgs, ShapeArgs, SignalArgs};
use crate::commands::analysis::AnalysisArgs;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension; without it the features are printed:
  .csv .json  vertex, x, y, z, level, sigma, response, strength, sign, channel
  .ply .vtp   a sphere of radius sigma for each feature, with these as fields and colors by level

Examples:
  adwave features bunny.obj
  adwave features bunny.obj -o features.csv --theta 1.8     weaker ones too, such as knees
  adwave features scan.pcd -o features.ply --best 50 --refine
  adwave features sample:plane --signal mean-curvature --response literal \\
    --edge-ratio 10 --mask-border 1

'adwave match' pairs the features of two shapes.")]
pub(crate) struct FeaturesArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the features (.csv, .json, .ply or .vtp)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) detect: DetectArgs,
    #[command(flatten)]
    pub(crate) border: BorderMaskArgs,
    /// Write a descriptor of each feature's surroundings too (.csv and .json)
    #[arg(long, help_heading = "Features")]
    pub(crate) descriptors: bool,
}

impl FeaturesArgs {
    pub(super) fn analysis(&self) -> AnalysisArgs<'_> {
        AnalysisArgs {
            shape: &self.shape,
            signal: &self.signal,
            levels: &self.levels,
            is_of_paper: false,
            extent: None,
            walk: Some(&self.walk),
        }
    }
}
