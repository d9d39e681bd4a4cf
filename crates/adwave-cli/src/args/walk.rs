//! The walk of commands that work on nodes without a shape.

use super::parse::{count_from_one, number};
use adwave_graph::{Kernel, Normalization, Symmetrization};
use clap::{ArgGroup, Args, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// A walk as given, for commands on a shape.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Diffusion operator")]
pub(crate) struct GivenWalkArgs {
    /// Walk as given, instead of the shape's own: a matrix (.mtx) with a row for each vertex, diagonal included, whose rows sum to 1
    #[arg(long, value_name = "FILE", conflicts_with = "operator")]
    pub(crate) walk: Option<PathBuf>,
}

/// The walk: a graph, a matrix of probabilities, or points.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Walk")]
#[group(skip)]
#[command(group(ArgGroup::new("source").args(["graph", "walk", "points"])))]
pub(crate) struct WalkArgs {
    /// Weights of a graph: a matrix (.mtx), or a list of edges "u v weight" with nodes counted from 0
    #[arg(long, value_name = "FILE")]
    pub(crate) graph: Option<PathBuf>,
    /// The walk as given: a matrix (.mtx) whose rows, diagonal included, are at least 0 and sum to 1
    #[arg(long, value_name = "FILE")]
    pub(crate) walk: Option<PathBuf>,
    /// Points of any dimension (.npy, n × d): steps go to their nearest neighbors
    #[arg(long, value_name = "FILE")]
    pub(crate) points: Option<PathBuf>,
    /// Points: number of nearest neighbors [default: 15]
    #[arg(long, value_name = "K", value_parser = count_from_one)]
    pub(crate) neighbors: Option<NonZeroUsize>,
    /// Points: weights by distance [default: adaptive]
    #[arg(long, value_name = "KIND", value_enum)]
    pub(crate) kernel: Option<KernelArg>,
    /// Weight of the loop at each node; "keep" takes the diagonal of the graph
    #[arg(long, value_name = "WEIGHT")]
    pub(crate) self_loops: Option<String>,
    /// Graph that is directed: make its weights symmetric
    #[arg(long, value_name = "KIND", value_enum)]
    pub(crate) symmetrize: Option<SymmetrizeArg>,
    /// Divisors of the weights [default: row]
    #[arg(long, value_name = "KIND", value_enum)]
    pub(crate) normalize: Option<NormalizeArg>,
    /// Share of the steps that stay, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = number)]
    pub(crate) stay: Option<f64>,
}

/// Weights of neighbors by their distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum KernelArg {
    /// exp(−d/σ), σ the distance to the fifth neighbor, mean of both directions
    Adaptive,
    /// exp(−d²/2E²), E the mean distance, as in the paper
    Paper,
    /// exp(−d²/σσ′) with the scales of both points
    SelfTuning,
    /// The paper's, divided by the density of the points
    DensityInvariant,
}

/// Neighbor whose distance is the scale of a point.
pub(crate) const SCALE_NEIGHBOR: usize = 5;

impl KernelArg {
    pub(crate) fn to_kernel(self) -> Kernel {
        match self {
            Self::Adaptive => Kernel::Adaptive { decay: 1.0, scale_neighbor: SCALE_NEIGHBOR },
            Self::Paper => Kernel::Paper,
            Self::SelfTuning => Kernel::SelfTuning { scale_neighbor: SCALE_NEIGHBOR },
            Self::DensityInvariant => Kernel::DensityInvariant,
        }
    }
}

/// Rule that makes weights symmetric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SymmetrizeArg {
    /// The mean of both directions
    Mean,
    /// The larger of both directions
    Maximum,
}

impl From<SymmetrizeArg> for Symmetrization {
    fn from(kind: SymmetrizeArg) -> Self {
        match kind {
            SymmetrizeArg::Mean => Self::Mean,
            SymmetrizeArg::Maximum => Self::Maximum,
        }
    }
}

/// Divisors of the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NormalizeArg {
    /// Rows sum to 1: values are averaged
    Row,
    /// Columns sum to 1: amounts are moved
    Column,
    /// Both by square roots
    Symmetric,
}

impl From<NormalizeArg> for Normalization {
    fn from(kind: NormalizeArg) -> Self {
        match kind {
            NormalizeArg::Row => Self::Row,
            NormalizeArg::Column => Self::Column,
            NormalizeArg::Symmetric => Self::Symmetric,
        }
    }
}
