//! The arguments of `adwave evaluate`.

use crate::args::{BorderArgs, DetectArgs, FieldArgs, LevelArgs, MapArgs, ShapeArgs};
use adwave::measure::RepeatabilityParams;
use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
Without --fixations: which share of the features is found again, level by level, after noise along the normals, rotation,
scaling, four times the faces, and on other vertices with other triangles of the same surface; with --operator surface --response
sigma most are, by the walk few. With --fixations: how well the saliency map, maps that are given, and the distance from the center
agree with a field of fixations (seconds): area under the ROC curve, normalized scanpath saliency, correlation, and
correlation without what both share with the distance from the center.

Examples:
  adwave evaluate bunny.obj --percent 10,30,50
  adwave evaluate bunny.ply --fixations gaze --levels 8
  adwave evaluate bunny.ply --fixations gaze --map other.npy")]
pub(crate) struct EvaluateArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) detect: DetectArgs,
    #[command(flatten)]
    pub(crate) map: MapArgs,
    #[command(flatten)]
    pub(crate) border: BorderArgs,
    /// Standard deviations of the noise in % of the mean edge
    #[arg(
        long = "percent",
        value_name = "P,P,…",
        value_delimiter = ',',
        default_value = "10,20,30,40,50",
        allow_negative_numbers = true,
        help_heading = "Repeatability"
    )]
    pub(crate) percents: Vec<f64>,
    /// How many times each random change is made
    #[arg(long, value_name = "N", default_value_t = 3, help_heading = "Repeatability")]
    pub(crate) runs: u64,
    /// How far off a feature may be and still be found again, in its σ
    #[arg(long, value_name = "S", default_value_t = RepeatabilityParams::default().sigmas, help_heading = "Repeatability")]
    pub(crate) within: f64,
    /// The field of fixations, in seconds, named as for --field
    #[arg(long, alias = "against", value_name = "NAME", help_heading = "Agreement")]
    pub(crate) fixations: Option<String>,
    /// A vertex was looked at when its fixation is above this
    #[arg(
        long,
        value_name = "T",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Agreement"
    )]
    pub(crate) threshold: f64,
    /// Further maps to compare, named as for --field
    #[arg(long = "map", value_name = "NAME", help_heading = "Agreement")]
    pub(crate) maps: Vec<String>,
}
