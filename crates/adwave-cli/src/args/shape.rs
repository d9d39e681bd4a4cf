//! The shape.

use super::file_name::file_name;
use super::parse::{count, number, seed};
use super::{CloudPartArgs, OperatorArgs, SelectionArgs};
use adwave_io::ShapeKind;
use clap::{Args, ValueEnum};

/// A shape and its diffusion operator.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShapeArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and others that 'adwave formats' lists; plain or gzip), '-', sample:NAME, or points:FILE.npy (n × d)
    #[arg(value_name = "SHAPE", value_parser = file_name())]
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) part: CloudPartArgs,
    #[command(flatten)]
    pub(crate) selection: SelectionArgs,
    /// Take the shape as this kind, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_enum, help_heading = "Shape")]
    pub(crate) kind: Option<ShapeKindArg>,
    /// Approximate number of vertices of a sample
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Shape")]
    pub(crate) vertices: Option<usize>,
    /// Noise along the normals of a sample: its standard deviation in mean edge lengths
    #[arg(long, value_name = "S", value_parser = number, help_heading = "Shape")]
    pub(crate) noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "K", value_parser = seed, default_value_t = 1, help_heading = "Shape")]
    pub(crate) seed: u64,
    /// Accept lengths in model units although coordinates are longitudes and latitudes
    #[arg(long, help_heading = "Shape")]
    pub(crate) allow_degrees: bool,
    #[command(flatten)]
    pub(crate) operator: OperatorArgs,
}

/// Kind that a file is taken as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeKindArg {
    Mesh,
    Cloud,
    Graph,
}

impl From<ShapeKindArg> for ShapeKind {
    fn from(kind: ShapeKindArg) -> Self {
        match kind {
            ShapeKindArg::Mesh => Self::Mesh,
            ShapeKindArg::Cloud => Self::Cloud,
            ShapeKindArg::Graph => Self::Graph,
        }
    }
}
