//! The walk of commands that work on nodes without a shape.

use super::parse::{count_from_one, number, parse_named};
use adwave_graph::{KernelName, Normalization, Symmetrization};
use clap::{ArgGroup, Args};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// A walk as given, for commands on a shape.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Diffusion operator")]
pub(crate) struct GivenWalkArgs {
    /// Walk as given, instead of the shape's own: a matrix (.mtx) with a row for each vertex, diagonal included, whose
    /// rows sum to 1
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
    /// Points of any dimension (.npy or .csv, n × d): steps go to their nearest neighbors
    #[arg(long, value_name = "FILE")]
    pub(crate) points: Option<PathBuf>,
    /// Points: number of nearest neighbors [default: 15]
    #[arg(long, value_name = "K", value_parser = count_from_one)]
    pub(crate) neighbors: Option<NonZeroUsize>,
    /// Points: weights by distance [default: adaptive]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<KernelName>())]
    pub(crate) kernel: Option<KernelName>,
    /// Weight of the loop at each node; "keep" takes the diagonal of the graph
    #[arg(long, value_name = "WEIGHT")]
    pub(crate) self_loops: Option<String>,
    /// Graph that is directed: make its weights symmetric
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Symmetrization>())]
    pub(crate) symmetrize: Option<Symmetrization>,
    /// Divisors of the weights [default: row]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Normalization>())]
    pub(crate) normalize: Option<Normalization>,
    /// Share of the steps that stay, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = number)]
    pub(crate) stay: Option<f64>,
}

/// Neighbor whose distance is the scale of a point.
pub(crate) const SCALE_NEIGHBOR: usize = 5;
