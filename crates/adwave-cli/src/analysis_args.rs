//! The flags of `saliency`, `features` and `evaluate`.

use crate::args::{LevelArgs, ShapeArgs};
use adwave::features::{FeatureParams, Refinement, Response, ThresholdScope};
use adwave::saliency::{SaliencyParams, Weighting};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// The signal that is analysed.
#[derive(Debug, Args)]
pub(crate) struct FieldArgs {
    /// The signal: coords, normals, mean-curvature, gaussian-curvature, shape-index, density, degree (of a graph), luminance, lightness,
    /// texture, texture-luminance, texture-lightness, a field of the file, or FILE.npy, FILE.csv or FILE.csv:COLUMN, FILE.gii or FILE.gii:NAME
    #[arg(long, value_name = "NAME", default_value = "coords", help_heading = "Signal")]
    pub(crate) field: String,
    /// The picture of the texture [default: the one that the OBJ's materials name]
    #[arg(long, value_name = "FILE", help_heading = "Signal")]
    pub(crate) texture: Option<PathBuf>,
}

/// What is left out near a border.
#[derive(Debug, Args)]
pub(crate) struct BorderArgs {
    /// Leave out what lies within so many σ of a border or of what is masked: features, and of a map each level, which
    /// fades in between S·σ and 2·S·σ; coordinates need 1
    #[arg(long = "border", value_name = "S", allow_negative_numbers = true, help_heading = "Border")]
    pub(crate) sigmas: Option<f64>,
}

/// How the levels are put together to a map.
#[derive(Debug, Args)]
pub(crate) struct MapArgs {
    /// How many of the finest levels are left out
    #[arg(long, value_name = "N", default_value_t = 2, help_heading = "Map")]
    pub(crate) skip: usize,
    /// How the levels are weighed
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Map")]
    pub(crate) weighting: WeightingArg,
}

impl MapArgs {
    pub(crate) fn params(&self, border: &BorderArgs) -> SaliencyParams {
        let weighting = match self.weighting {
            WeightingArg::Level => Weighting::PerLevel,
            WeightingArg::Printed => Weighting::AsPrinted,
            WeightingArg::Normalised => Weighting::Normalised,
            WeightingArg::Ranks => Weighting::Ranks,
            WeightingArg::None => Weighting::Uniform,
        };
        SaliencyParams { skip: self.skip, weighting, border_sigmas: border.sigmas }
    }
}

/// `adwave::saliency::Weighting` by its names here.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum WeightingArg {
    /// (max − mean)², one number a level
    #[default]
    Level,
    /// (max − |W|)² at each vertex, as eq. 17 is printed
    Printed,
    /// 1/mean, so that every level counts alike
    Normalised,
    /// Ranks in place of values
    Ranks,
    /// 1
    None,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension:
  .ply .vtp   the shape with the fields saliency and color
  .npy        the map, one number a vertex; with --per-level one row a vertex: the map, then each level

Where the signal is NaN, vertices are left out of the walk and the map is NaN.

Examples:
  adwave saliency bunny.obj -o map.ply
  adwave saliency scan.pcd -o map.vtp --field mean-curvature --color-map magma
  adwave saliency face-scan.ply -o map.ply --border 1
  adwave saliency cow.obj -o map.ply --field texture-lightness --texture cow.png
  adwave saliency pial.gii.gz -o map.vtp --field sulc.gii.gz")]
pub(crate) struct SaliencyArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the map goes (.ply, .vtp or .npy)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) map: MapArgs,
    #[command(flatten)]
    pub(crate) border: BorderArgs,
    /// Write what each level adds too, as the fields saliency3, saliency4 …
    #[arg(long, help_heading = "Map")]
    pub(crate) per_level: bool,
    /// The colours: viridis, magma, inferno, plasma, cividis, turbo, cool, warm, grey, coolwarm, red-blue or spectral
    #[arg(long, alias = "colormap", value_name = "NAME", default_value = "viridis", help_heading = "Map")]
    pub(crate) color_map: String,
    /// The last colour stands for this percentile of the map and all above
    #[arg(long, value_name = "P", default_value_t = 99.0, help_heading = "Map")]
    pub(crate) color_top: f64,
}

/// What counts as a feature.
#[derive(Debug, Args)]
pub(crate) struct DetectArgs {
    /// How many times the mean response of its level a feature has
    #[arg(
        long,
        value_name = "T",
        default_value_t = 2.4,
        allow_negative_numbers = true,
        help_heading = "Features"
    )]
    pub(crate) theta: f64,
    /// The response that is compared in place and scale
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Features")]
    pub(crate) response: ResponseArg,
    /// Take the mean in the threshold over each connected component
    #[arg(long, help_heading = "Features")]
    pub(crate) per_component: bool,
    /// Place features between vertices and levels, by fitting a quadric and a parabola
    #[arg(long, help_heading = "Features")]
    pub(crate) refine: bool,
    /// Reject edges: the largest ratio of the response's principal curvatures (SIFT takes 10)
    #[arg(long, value_name = "R", allow_negative_numbers = true, help_heading = "Features")]
    pub(crate) edge_ratio: Option<f64>,
    /// Keep only so many, the strong ones well spread
    #[arg(long, value_name = "N", help_heading = "Features")]
    pub(crate) best: Option<usize>,
}

impl DetectArgs {
    pub(crate) fn params(&self, border: &BorderArgs) -> FeatureParams {
        FeatureParams {
            theta: self.theta,
            response: match self.response {
                ResponseArg::Normalised => Response::Normalised,
                ResponseArg::Literal => Response::Literal,
                ResponseArg::Channels => Response::Channels,
                ResponseArg::Sigma => Response::Sigma,
            },
            scope: if self.per_component { ThresholdScope::Component } else { ThresholdScope::Shape },
            refinement: if self.refine { Refinement::Quadratic } else { Refinement::Off },
            max_edge_ratio: self.edge_ratio,
            border_sigmas: border.sigmas,
            best: self.best,
        }
    }
}

/// `adwave::features::Response` by its names here.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum ResponseArg {
    /// Each level by its own mean
    #[default]
    Normalised,
    /// W itself, as printed; finds the size of a scalar's bumps
    Literal,
    /// Every channel by itself
    Channels,
    /// W by σ of its level
    Sigma,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension; without it the features are printed:
  .csv .json  vertex, x, y, z, level, sigma, response, strength, sign, channel
  .ply .vtp   a sphere of radius sigma for each feature, with these as fields and colours by level

Examples:
  adwave features bunny.obj
  adwave features bunny.obj -o features.csv --theta 1.8     weaker ones too, knees and elbows
  adwave features scan.pcd -o features.ply --best 50 --refine
  adwave features sample:plane --field mean-curvature --response literal --edge-ratio 10 --border 1
  adwave features a.obj --match b.obj -o pairs.json")]
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
    /// Find the features of this shape too, by the same flags, and pair those that look alike
    #[arg(long = "match", value_name = "SHAPE", help_heading = "Features")]
    pub(crate) other: Option<String>,
    /// A pair must be this much nearer than the second nearest
    #[arg(long, value_name = "R", default_value_t = 0.9, help_heading = "Features", requires = "other")]
    pub(crate) match_ratio: f64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Without --against: which share of the features is found again, level by level, after noise along the normals, rotation,
scaling and resampling. With --against: how well the saliency map, maps that are given, and the distance from the centre
agree with a field of looks (fixation seconds): area under the ROC curve, normalised scanpath saliency, correlation, and
correlation without what both share with the distance from the centre.

Examples:
  adwave evaluate bunny.obj --percent 10,30,50
  adwave evaluate bunny.ply --against gaze --levels 8
  adwave evaluate bunny.ply --against gaze --map other.npy")]
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
    #[arg(long, value_name = "S", default_value_t = 1.0, help_heading = "Repeatability")]
    pub(crate) within: f64,
    /// The field of looks, named as for --field
    #[arg(long, value_name = "NAME", help_heading = "Agreement")]
    pub(crate) against: Option<String>,
    /// A vertex was looked at when its look is above this
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
