//! The arguments of `adwave evaluate`.

use crate::args::{BorderMaskArgs, DetectArgs, LevelArgs, MapArgs, ShapeArgs, SignalArgs, number, seed};
use adwave::measure::RepeatabilityParams;
use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
Without --fixations the report gives the share of features that are found again, level by level, after noise along the normals,
rotation, scaling, subdivision into four times the faces, and on other vertices and triangles of the same surface. With
--operator surface --response sigma most features are found again; with the walk few are. With --fixations the report compares
the saliency map, further maps, and the distance from the center with a field of fixations (seconds): area under the ROC
curve, normalized scanpath saliency, correlation, and partial correlation given the distance from the center.

Examples:
  adwave evaluate bunny.obj --percent 10,30,50
  adwave evaluate bunny.ply --fixations gaze --levels 8
  adwave evaluate bunny.ply --fixations gaze --map other.npy")]
pub(crate) struct EvaluateArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) detect: DetectArgs,
    #[command(flatten)]
    pub(crate) map: MapArgs,
    #[command(flatten)]
    pub(crate) border: BorderMaskArgs,
    /// Standard deviations of the noise in % of the mean edge
    #[arg(
        long = "percent",
        value_parser = number,
        value_name = "P,P,…",
        value_delimiter = ',',
        default_value = "10,20,30,40,50",
        allow_negative_numbers = true,
        help_heading = "Repeatability"
    )]
    pub(crate) percents: Vec<f64>,
    /// Number of times that each random change is made
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 3, help_heading = "Repeatability")]
    pub(crate) runs: u64,
    /// Largest distance between a feature and its counterpart, in its σ
    #[arg(long, value_name = "S", value_parser = number, default_value_t = RepeatabilityParams::default().sigmas, help_heading = "Repeatability")]
    pub(crate) within: f64,
    /// Field of fixations, in seconds, named as for --signal
    #[arg(long, alias = "against", value_name = "NAME", help_heading = "Agreement")]
    pub(crate) fixations: Option<String>,
    /// Fixation above which a vertex counts as looked at
    #[arg(
        long,
        value_parser = number,
        value_name = "T",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Agreement"
    )]
    pub(crate) threshold: f64,
    /// Further map to compare, named as for --signal; may be given several times
    #[arg(long = "map", value_name = "NAME", help_heading = "Agreement")]
    pub(crate) maps: Vec<String>,
}
