//! The arguments of `adwave simplify`.

use crate::args::{
    CloudPartArgs, SelectionArgs, count, count_from_one, file_name, length, number, parse_named,
};
use adwave::region::Length;
use adwave_io::ShapeKind;
use clap::{ArgGroup, Args};
use std::num::NonZeroUsize;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("target").required(true).args(["error", "vertices", "ratio", "level"])),
    after_help = "\
Edges of a mesh are collapsed; points of a cloud are dropped so that the rest are evenly spaced. Both keep a subset of the
vertices with all of their fields. A mesh keeps its parts, holes and handles, the places of its materials and texture
seams within the error, and the colors of its vertices. With --error no point of either surface is farther from the other,
which is proven on the way; --measure measures the distances of any result.

Examples:
  adwave simplify bust.obj -o small.obj --error 0.1%
  adwave simplify part.stl -o part-small.stl --error 0.05
  adwave simplify bunny.ply -o bunny-5k.ply --vertices 5000 --measure
  adwave simplify bunny.ply -o small.ply --ratio 0.1 --weights mean-curvature     or a field
  adwave simplify fsaverage5.gii -o fsaverage4.gii --level 1
  adwave simplify scan.laz -o thin.laz --error 0.25
  adwave simplify scan.laz -o thin.laz --error 0.5 --only classification=2   other points stay"
)]
pub(crate) struct SimplifyArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and others that 'adwave formats' lists; plain or gzip), '-', or sample:NAME
    #[arg(value_name = "SHAPE", value_parser = file_name())]
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) part: CloudPartArgs,
    #[command(flatten)]
    pub(crate) selection: SelectionArgs,
    /// Take the shape as this kind, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_parser = parse_named::<ShapeKind>())]
    pub(crate) kind: Option<ShapeKind>,
    /// Accept lengths in model units although coordinates are longitudes and latitudes
    #[arg(long)]
    pub(crate) allow_degrees: bool,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Largest distance between result and input, in model units or in % of the diagonal. A mesh keeps as few vertices
    /// as are found within it, proven for all points of both surfaces; points of a cloud are kept at least that far
    /// apart
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true, help_heading = "Target")]
    pub(crate) error: Option<Length>,
    /// Number of vertices; a note tells if the parts, holes and seams of a mesh need more
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Target")]
    pub(crate) vertices: Option<usize>,
    /// Share of the vertices, above 0 and at most 1
    #[arg(long, value_name = "R", value_parser = number, allow_negative_numbers = true, help_heading = "Target")]
    pub(crate) ratio: Option<f64>,
    /// Mesh: keep more vertices where this signal or field of the file is large in magnitude, such as a saliency map;
    /// it multiplies the squared distance by which collapses are ordered
    #[arg(long, value_name = "SIGNAL")]
    pub(crate) weights: Option<String>,
    /// Mesh made by cutting triangles into four, or polygons into quadrilaterals: the mesh before K cuts, by its vertices (see 'adwave info')
    #[arg(long, value_name = "K", value_parser = count_from_one, help_heading = "Target")]
    pub(crate) level: Option<NonZeroUsize>,
    /// Mesh: measure the largest distance and the rms between result and input, with a proof for all points of both
    /// surfaces; it takes a third more time and more than twice the memory
    #[arg(long)]
    pub(crate) measure: bool,
    /// Mesh: keep all vertices on borders
    #[arg(long)]
    pub(crate) keep_border: bool,
}
