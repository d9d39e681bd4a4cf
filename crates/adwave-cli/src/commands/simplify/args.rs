//! The arguments of `adwave simplify`.

use crate::args::{Kind, PartArgs, any_length};
use adwave::region::Length;
use clap::{ArgGroup, Args};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("target").required(true).args(["error", "vertices", "ratio"])),
    after_help = "\
Of a mesh edges are collapsed; of a cloud points are dropped so that the rest are evenly spaced. Both keep a subset of the
vertices, with all that the file says of them. The distance that is reported is measured, not estimated.

Examples:
  adwave simplify bust.obj -o small.obj --error 0.1%
  adwave simplify part.stl -o part-small.stl --error 0.05
  adwave simplify bunny.ply -o bunny-5k.ply --vertices 5000
  adwave simplify scan.laz -o thin.laz --error 0.25"
)]
pub(crate) struct SimplifyArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and all else that 'adwave formats' lists; plain or gzip), '-', or sample:NAME
    #[arg(value_name = "SHAPE")]
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) part: PartArgs,
    /// Take the shape as this, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_enum)]
    pub(crate) kind: Option<Kind>,
    /// Where the result goes; the format is that of the extension
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// The greatest distance between result and input, in model units or in % of the diagonal: of a mesh as few vertices as
    /// are found within it, of a cloud the least distance that points are apart
    #[arg(long, value_name = "LENGTH", value_parser = any_length, allow_negative_numbers = true, help_heading = "Target")]
    pub(crate) error: Option<Length>,
    /// So many vertices
    #[arg(long, value_name = "N", help_heading = "Target")]
    pub(crate) vertices: Option<usize>,
    /// This share of the vertices, above 0 and at most 1
    #[arg(long, value_name = "R", allow_negative_numbers = true, help_heading = "Target")]
    pub(crate) ratio: Option<f64>,
    /// Mesh: the vertices of borders stay
    #[arg(long)]
    pub(crate) keep_border: bool,
}
