//! The shape.

use super::file_name::file_name;
use super::parse::{count, number, parse_named, seed};
use super::{CloudPartArgs, OperatorArgs, SelectionArgs};
use adwave_io::ShapeKind;
use clap::Args;

/// A shape and its diffusion operator.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShapeArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and others that 'adwave formats' lists; plain or gzip), '-', sample:NAME, or
    /// points:FILE.npy (n × d)
    #[arg(value_name = "SHAPE", value_parser = file_name())]
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) part: CloudPartArgs,
    #[command(flatten)]
    pub(crate) selection: SelectionArgs,
    /// Take the shape as this kind, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_parser = parse_named::<ShapeKind>(), help_heading = "Shape")]
    pub(crate) kind: Option<ShapeKind>,
    /// Mesh of a part of a CIFTI, as STRUCTURE=FILE if the file does not say of which; once for each part
    #[arg(long, value_name = "FILE", value_parser = file_name(), help_heading = "Shape")]
    pub(crate) surface: Vec<String>,
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
