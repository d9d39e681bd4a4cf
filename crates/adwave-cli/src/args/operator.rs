//! The diffusion operator.

use super::parse::{count_from_one, parse_named};
use adwave::operator::{CloudGraph, OperatorKind, OperatorParams};
use adwave::shape::{CloudArea, MeshArea, WeldMode};
use clap::Args;
use std::num::NonZeroUsize;

/// Options of the diffusion operator that only the walk has.
pub(crate) const WALK_OPTIONS: [&str; 5] =
    ["--rings", "--mesh-area", "--directed", "--cloud-area", "--density-invariant"];

/// Options of the diffusion operator.
pub(crate) const OPERATOR_OPTIONS: [&str; 8] = [
    "--operator",
    "--rings",
    "--mesh-area",
    "--neighbors",
    "--directed",
    "--cloud-area",
    "--density-invariant",
    "--keep-creases",
];

/// Options of the diffusion operator.
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Diffusion operator")]
pub(crate) struct OperatorArgs {
    /// Operator that smooths the signal [default: surface for saliency and features of meshes, if levels are given by
    /// --lengths, or if two shapes are compared, else walk]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<OperatorKind>())]
    pub(crate) operator: Option<OperatorKind>,
    /// Mesh: distance in model units within which edges of open borders are welded; 0 welds equal positions only
    /// [default: a few steps of 32-bit floats, at most a thousandth of the shortest edge there]
    #[arg(long, value_name = "LENGTH", value_parser = parse_tolerance, conflicts_with = "no_weld")]
    pub(crate) weld: Option<f64>,
    /// Keep vertices at exactly equal positions apart
    #[arg(long)]
    pub(crate) no_weld: bool,
    /// Mesh: rings of neighbors that one step reaches
    #[arg(long, value_name = "N", value_parser = count_from_one, default_value_t = non_zero(OperatorParams::default().rings))]
    pub(crate) rings: NonZeroUsize,
    /// Mesh: area of a vertex
    #[arg(long, value_name = "KIND", value_parser = parse_named::<MeshArea>(), default_value_t)]
    pub(crate) mesh_area: MeshArea,
    /// Cloud: nearest neighbors that one step reaches
    #[arg(long, value_name = "K", value_parser = count_from_one, default_value_t = non_zero(OperatorParams::default().neighbors))]
    pub(crate) neighbors: NonZeroUsize,
    /// Cloud: step from each point to its nearest only, as in the paper, not in both directions (refused for other
    /// shapes)
    #[arg(long)]
    pub(crate) directed: bool,
    /// Cloud: area of a point
    #[arg(long, value_name = "KIND", value_parser = parse_named::<CloudArea>(), default_value_t)]
    pub(crate) cloud_area: CloudArea,
    /// Walk: remove the influence of the sampling density (α = 1 of Coifman and Lafon); slower where the density varies
    /// much
    #[arg(long)]
    pub(crate) density_invariant: bool,
    /// Mesh, cloud: do not step across creases, where normals turn sharply
    #[arg(long)]
    pub(crate) keep_creases: bool,
}

/// A length that is not negative.
fn parse_tolerance(text: &str) -> Result<f64, String> {
    let length = text.trim().parse::<f64>().ok().filter(|length| length.is_finite() && *length >= 0.0);
    length.ok_or_else(|| format!("a tolerance must be a length of at least 0, got {text}"))
}

/// A default of the library, which is at least 1.
fn non_zero(n: usize) -> NonZeroUsize {
    NonZeroUsize::new(n).unwrap_or(NonZeroUsize::MIN)
}

impl OperatorArgs {
    /// Parameters of the walk that the flags ask for.
    pub(crate) fn to_walk_params(&self) -> OperatorParams {
        OperatorParams::default()
            .with_weld(self.weld_mode())
            .with_rings(self.rings.get())
            .with_mesh_area(self.mesh_area)
            .with_neighbors(self.neighbors.get())
            .with_cloud_graph(if self.directed { CloudGraph::Directed } else { CloudGraph::Union })
            .with_cloud_area(self.cloud_area)
            .with_density_invariant(self.density_invariant)
            .with_keep_creases(self.keep_creases)
    }

    /// The first option of the walk that differs from its default.
    pub(crate) fn changed_walk_option(&self) -> Option<&'static str> {
        let (walk, unchanged) = (self.to_walk_params(), OperatorParams::default());
        let is_changed = [
            walk.rings != unchanged.rings,
            walk.mesh_area != unchanged.mesh_area,
            walk.cloud_graph != unchanged.cloud_graph,
            walk.cloud_area != unchanged.cloud_area,
            walk.density_invariant,
        ];
        is_changed.iter().position(|is_changed| *is_changed).map(|at| WALK_OPTIONS[at])
    }

    /// Rule by which vertices at equal or nearly equal positions are one.
    pub(crate) fn weld_mode(&self) -> WeldMode {
        match self.weld {
            _ if self.no_weld => WeldMode::Off,
            None => WeldMode::default(),
            Some(0.0) => WeldMode::EqualPositions,
            Some(tolerance) => WeldMode::Within(tolerance),
        }
    }
}
