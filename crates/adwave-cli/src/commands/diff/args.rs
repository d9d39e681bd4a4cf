//! The arguments of `adwave diff`.

use crate::args::{LevelArgs, ShapeArgs, file_name, length};
use adwave::region::Length;
use adwave_render::{Up, View};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Shapes with the same vertices and faces in the same order are compared vertex by vertex: the difference is a vector, OTHER -
SHAPE. Other shapes are compared by the signed distance from each vertex of SHAPE to the closest point of OTHER, positive where
OTHER lies outside. For a cloud the sign is that of the side of OTHER if OTHER is closed: positive inside of it. A vertex whose
closest point lies on a border of OTHER has no value, unless it lies exactly beside the border, since OTHER may continue beyond.
The greatest distances both ways (forward, reverse) include those places, and those between vertices. The bands of the
difference show at which scale the two differ.

Images and volumes with the same sizes and affine matrix are compared place by place; places without data in either take no part.

Output by extension:
  .html       a page with both shapes, a map of the difference, a table by level, and a map of
              each band
  .ply .vtp   SHAPE with the fields difference, W1 ... WJ and the rest S_J
  .nii .tif   of an image or a volume, the same as frames; also .nrrd, .npy and others
  .npz        of an image or a volume, the arrays of 'adwave transform' for the difference

Examples:
  adwave diff before.ply after.ply                      a table by level, in model units
  adwave diff scan1.ply scan2.ply --align -o diff.html     two scans, aligned first
  adwave diff part.stl printed.ply --align --limit 5%    points farther away are not compared
  adwave diff a.ply b.ply --lengths 1,2,5,10 -o diff.ply --json
  adwave diff before.nii.gz after.nii.gz --fwhm 4,8,16 -o diff.nii.gz")]
pub(crate) struct DiffArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Other version: a file, '-', or sample:NAME
    #[arg(value_name = "OTHER", value_parser = file_name())]
    pub(crate) other: String,
    /// File for the difference (.html, .ply or .vtp; of images and volumes their formats); without it only a table is
    /// printed
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Align OTHER with SHAPE first, by a robust rigid motion: from where it is, or from features and a grid of
    /// rotations
    ///
    /// A note says if the result is not certain: if many places stay apart and features agree on no motion, or if other
    /// motions fit equally well.
    #[arg(long, help_heading = "Comparison")]
    pub(crate) align: bool,
    /// Points that are compared
    #[arg(long, value_name = "KIND", value_enum, default_value_t = ByArg::Auto, help_heading = "Comparison")]
    pub(crate) by: ByArg,
    /// Largest distance of a closest point, in model units or in % of the diagonal; farther ones are left out
    #[arg(long, value_name = "L", value_parser = length, help_heading = "Comparison")]
    pub(crate) limit: Option<Length>,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// View: front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Pictures"
    )]
    pub(crate) view: View,
    /// Axis that points up: x, y or z [default: guessed, as by render]
    #[arg(long, value_name = "AXIS", help_heading = "Pictures")]
    pub(crate) up: Option<Up>,
}

/// Points that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ByArg {
    /// Vertices if both shapes have the same vertices and faces in the same order, else closest points
    Auto,
    /// Vertex with vertex, by their order
    Vertex,
    /// Each vertex with the closest point of the other shape
    Closest,
}
