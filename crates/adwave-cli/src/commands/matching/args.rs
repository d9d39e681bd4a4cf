//! The arguments of `adwave match`.

use crate::args::ShapeArgs;
use adwave_register::PairParams;
use adwave_render::{Up, View};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Features of both shapes on levels of the same widths, then the rigid motion that most of them agree on (RANSAC over those that
look alike), fitted closer by the surfaces (ICP), then every feature that has a fellow where that motion puts it. The confidence
of a pair is the chance that nothing would lie so near by accident. Both shapes in the same unit; --motion similarity finds the
scale too, and --motion none pairs by looks alone, for shapes that are bent.

Examples:
  adwave match scan1.ply scan2.ply                                  the motion, and pairs of features
  adwave match scan1.ply scan2.ply --picture matches.png            both side by side, lines between the pairs
  adwave match scan1.ply scan2.ply -o pairs.csv --moved scan1-on-2.ply
  adwave match bust.obj bust-in-inches.obj --motion similarity")]
pub(crate) struct MatchArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The other shape: a file, '-', or sample:NAME
    #[arg(value_name = "OTHER")]
    pub(crate) other: String,
    /// Where the pairs go (.csv or .json)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Where a picture of both, with lines between the pairs, goes (.png)
    #[arg(long, value_name = "OUT.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Where SHAPE goes after the motion, all else as its file has it
    #[arg(long, value_name = "OUT")]
    pub(crate) moved: Option<PathBuf>,
    /// What may bring one shape to the other
    #[arg(long, value_name = "KIND", value_enum, default_value_t = MotionArg::Rigid, help_heading = "Matching")]
    pub(crate) motion: MotionArg,
    /// How far apart the two of a pair may be after the motion, in σ
    #[arg(long, value_name = "S", default_value_t = PairParams::default().sigmas, help_heading = "Matching")]
    pub(crate) within: f64,
    /// How many times the mean response of its level a feature has
    #[arg(long, value_name = "T", default_value_t = 1.0, help_heading = "Matching")]
    pub(crate) theta: f64,
    /// With --motion none: a pair must be this much nearer than the second nearest
    #[arg(long, value_name = "R", default_value_t = 0.9, help_heading = "Matching")]
    pub(crate) ratio: f64,
    /// The side that is seen in the picture
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    pub(crate) view: View,
    /// Which axis of OTHER points up in the picture: x, y or z [default: guessed, as by render]
    #[arg(long, value_name = "AXIS", help_heading = "Picture")]
    pub(crate) up: Option<Up>,
}

/// What may bring one shape to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MotionArg {
    /// A rotation and a translation
    Rigid,
    /// And a change of size
    Similarity,
    /// Nothing: features are paired by their surroundings alone
    None,
}
