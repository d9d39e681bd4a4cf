//! The arguments of `adwave match`.

use crate::args::{ShapeArgs, count_from_one, file_name, number};
use adwave_register::PairParams;
use adwave_render::{Up, View};
use clap::{Args, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Usual number of points of a cloud that are searched for features.
const SEARCH_POINTS: NonZeroUsize = NonZeroUsize::new(50_000).unwrap();

#[derive(Debug, Args)]
#[command(after_help = "\
Features of both shapes are found on levels of the same widths. Motions that many of them agree on, and rotations about the
centers, are refined on the surfaces (ICP) and judged by their fit in both directions: the distances, and how the bands of one
shape correlate with those of the other. A motion is reported only if it is much better than the best motion of the mirror image,
which is searched in the same way. Motions that fit equally well, such as those between repeated windows, are listed, and share the
confidence.

Every feature is paired with one that lies where the motion puts it. The confidence of a pair is the probability that the true
motion brings its features within one sigma of each other. Both shapes must be in the same unit; --motion similarity finds the scale
too, and --motion none pairs features by similarity alone, for bent shapes.

Examples:
  adwave match scan1.ply scan2.ply                          the motion and pairs of features
  adwave match scan1.ply scan2.ply --picture matches.png    pairs joined by lines
  adwave match scan1.ply scan2.ply -o pairs.csv --moved scan1-on-2.ply
  adwave match bust.obj bust-in-inches.obj --motion similarity")]
pub(crate) struct MatchArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The other shape: a file, '-', or sample:NAME
    #[arg(value_name = "OTHER", value_parser = file_name())]
    pub(crate) other: String,
    /// File for the pairs (.csv or .json)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// File for a picture of both shapes with lines between the pairs (.png)
    #[arg(long, value_name = "OUT.png")]
    pub(crate) picture: Option<PathBuf>,
    /// File for SHAPE after the motion, with everything else in its file unchanged
    #[arg(long, value_name = "OUT")]
    pub(crate) moved: Option<PathBuf>,
    /// Kind of motion between the shapes
    #[arg(long, value_name = "KIND", value_enum, default_value_t = MotionArg::Rigid, help_heading = "Matching")]
    pub(crate) motion: MotionArg,
    /// Largest distance between the features of a pair after the motion, in σ
    #[arg(long, value_name = "S", value_parser = number, default_value_t = PairParams::default().sigmas, help_heading = "Matching")]
    pub(crate) within: f64,
    /// Take features whose response is at least T times the mean of their level [default: those that stand out from
    /// what triangles, sampling and noise can cause; 1 for a surface without an outside]
    #[arg(long, value_name = "T", value_parser = number, help_heading = "Matching")]
    pub(crate) theta: Option<f64>,
    /// Points of a cloud that are searched for features, evenly spread; the motion is refined on all
    #[arg(long, value_name = "N", value_parser = count_from_one, default_value_t = SEARCH_POINTS, help_heading = "Matching")]
    pub(crate) search_points: NonZeroUsize,
    /// With --motion none: largest ratio of the descriptor distance of a pair to that of the second nearest
    #[arg(long, value_name = "R", value_parser = number, default_value_t = 0.9, help_heading = "Matching")]
    pub(crate) ratio: f64,
    /// Side that the picture shows
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    pub(crate) view: View,
    /// Axis of OTHER that points up in the picture: x, y or z [default: guessed, as by render]
    #[arg(long, value_name = "AXIS", help_heading = "Picture")]
    pub(crate) up: Option<Up>,
}

/// Kind of motion between two shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MotionArg {
    /// A rotation and a translation
    Rigid,
    /// A rotation, a translation and a change of scale
    Similarity,
    /// None: features are paired by their surroundings alone
    None,
}
