//! The shape.

use super::parse::{count, number, seed};
use super::{CloudPartArgs, OperatorArgs};
use adwave_io::{FieldCondition, FieldConditionError, Selection, ShapeKind};
use clap::{Args, ValueEnum};

/// A shape and its diffusion operator.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShapeArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and others that 'adwave formats' lists; plain or gzip), '-', or sample:NAME
    #[arg(value_name = "SHAPE")]
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
    #[command(flatten)]
    pub(crate) operator: OperatorArgs,
}

/// The vertices that take part.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Part of the data")]
pub(crate) struct SelectionArgs {
    /// Compute on these vertices only: FIELD=VALUE,VALUE,… or FIELD=LOW..HIGH; several are joined by "and". The others keep
    /// their positions and values and are no neighbors
    #[arg(long, value_name = "FIELD=…", value_parser = parse_condition)]
    only: Vec<FieldCondition>,
    /// Compute where this file of one number per vertex is neither 0 nor NaN (.npy, .csv, .gii or a FreeSurfer file; :NAME
    /// selects a column)
    #[arg(long, value_name = "FILE")]
    mask: Option<String>,
}

impl SelectionArgs {
    pub(crate) fn to_selection(&self) -> Selection {
        Selection { conditions: self.only.clone(), mask: self.mask.clone() }
    }
}

fn parse_condition(text: &str) -> Result<FieldCondition, FieldConditionError> {
    text.parse()
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
