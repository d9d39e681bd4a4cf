//! The arguments of `adwave deform`.

use super::motion::{MotionText, matrix, target, translation, turn};
use crate::args::{BaseWidthArgs, ShapeArgs, length, region, regions_help};
use adwave::region::{Length, Region};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = concat!("\
The coarse base of the shape bends as little as possible and the detail rides along in turning frames. Vertices of a region
count where its weight is above 0. With several --move, give as many motions of one kind; the first goes with the first.

", regions_help!(), "
Examples:
  adwave deform bust.obj -o nod.obj --fix 'half-space:point=0 0.4 0,normal=0 -1 0' \\
    --move 'half-space:point=0 1.6 0,normal=0 1 0' --turn x,20
  adwave deform cat.ply -o up.ply --fix 'ball:vertex=7,radius=10%' \\
    --move 'ball:vertex=1972,radius=5%' --by 0,0,0.3
  adwave deform cat.ply -o posed.ply --recipe pose.toml
  adwave deform cat.ply -o between.ply --recipe pose.toml --recipe leap.toml --shares 0.5,0.5
  adwave deform cat.ply -o two.ply --move vertices:indices=1972 --to 0,1,2 \\
    --move vertices:indices=1500 --to 0,1,3"))]
pub(crate) struct DeformArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Region that stays where it is; several are joined by "or" [default: nothing stays]
    #[arg(long, value_name = "REGION", value_parser = region, help_heading = "Handles")]
    pub(crate) fix: Vec<Region>,
    /// Region that moves as a whole: a handle
    #[arg(long = "move", value_name = "REGION", value_parser = region, required_unless_present = "recipe", help_heading = "Handles")]
    pub(crate) handles: Vec<Region>,
    /// Move the handle by a vector in model units
    #[arg(long, value_name = "X,Y,Z", value_parser = translation, allow_hyphen_values = true, help_heading = "Handles", conflicts_with_all = ["to", "turn", "matrix"])]
    pub(crate) by: Vec<MotionText>,
    /// Move the handle's center to a point
    #[arg(long, value_name = "X,Y,Z", value_parser = target, allow_hyphen_values = true, help_heading = "Handles", conflicts_with_all = ["turn", "matrix"])]
    pub(crate) to: Vec<MotionText>,
    /// Turn the handle about an axis (x, y, z or a vector) by degrees, through its center or a point
    #[arg(long, value_name = "AXIS,ANGLE[,X,Y,Z]", value_parser = turn, allow_hyphen_values = true, help_heading = "Handles", conflicts_with = "matrix")]
    pub(crate) turn: Vec<MotionText>,
    /// Move the handle by the 4 × 4 matrix in a text file: 16 numbers by rows, the last row 0 0 0 1
    #[arg(long, value_name = "FILE", value_parser = matrix, help_heading = "Handles")]
    pub(crate) matrix: Vec<MotionText>,
    /// Take handles, width, stiffness and lengths from the [pose] of a recipe; its layers are left to 'adwave filter
    /// --recipe'. Several with --shares give a blend of their poses
    #[arg(long, value_name = "FILE", help_heading = "Handles", conflicts_with_all = ["fix", "handles", "by", "to", "turn", "matrix", "stiffness", "width", "keep_lengths"])]
    pub(crate) recipe: Vec<PathBuf>,
    /// Share of each pose of --recipe, with commas; the rest pose has what is left to 1
    #[arg(
        long,
        value_name = "T,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Handles",
        requires = "recipe"
    )]
    pub(crate) shares: Vec<f64>,
    /// Bending length, in model units or in % of the diagonal: longer is stiffer, 0 wrinkles [default: 0.75 times
    /// --width]
    #[arg(long, value_name = "L", value_parser = length, allow_negative_numbers = true, help_heading = "Base")]
    pub(crate) stiffness: Option<Length>,
    /// Share of lengths in [0, 1]: 0 keeps the detail, 1 the lengths of edges, at a higher cost
    #[arg(
        long,
        value_name = "T",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Base"
    )]
    pub(crate) keep_lengths: f64,
    #[command(flatten)]
    pub(crate) width: BaseWidthArgs,
}
