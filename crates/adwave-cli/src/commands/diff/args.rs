//! The arguments of `adwave diff`.

use crate::args::{LevelArgs, ShapeArgs, any_length};
use adwave::region::Length;
use adwave_render::{Up, View};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
With the same faces vertex is compared with vertex: the difference is a vector, OTHER - SHAPE. Otherwise it is the distance from each
vertex of SHAPE to the closest point of OTHER, above 0 where OTHER lies outside; where that point lies on a border of OTHER, which
may go on beyond, there is no value. Bands of the difference say at which scale the two differ.

Output by extension:
  .html       a page: both shapes, the difference as a map, a table by level, a map of each band
  .ply .vtp   SHAPE with the fields difference, W1 ... WJ and the rest S_J

Examples:
  adwave diff before.ply after.ply                      a table by level, in model units
  adwave diff scan1.ply scan2.ply --align -o diff.html  two scans, brought together first
  adwave diff part.stl printed.ply --align --limit 5%    what lies farther is not compared
  adwave diff a.ply b.ply --lengths 1,2,5,10 -o diff.ply --json")]
pub(crate) struct DiffArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The other version: a file, '-', or sample:NAME
    #[arg(value_name = "OTHER")]
    pub(crate) other: String,
    /// Where the difference goes (.html, .ply or .vtp); without it a table is printed only
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Bring OTHER to SHAPE first, by the rigid motion that fits best where most of them is alike
    #[arg(long, help_heading = "Comparison")]
    pub(crate) align: bool,
    /// What is compared with what
    #[arg(long, value_name = "KIND", value_enum, default_value_t = ByArg::Auto, help_heading = "Comparison")]
    pub(crate) by: ByArg,
    /// Leave out closest points farther than this, in model units or in % of the diagonal
    #[arg(long, value_name = "L", value_parser = any_length, help_heading = "Comparison")]
    pub(crate) limit: Option<Length>,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// The side that is seen: front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Pictures"
    )]
    pub(crate) view: View,
    /// Which axis points up: x, y or z [default: guessed, as by render]
    #[arg(long, value_name = "AXIS", help_heading = "Pictures")]
    pub(crate) up: Option<Up>,
}

/// What is compared with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ByArg {
    /// Vertices where both have the same faces, else closest points
    Auto,
    /// Vertex with vertex, by their order
    Vertex,
    /// Each vertex with the closest point of the other shape
    Closest,
}
