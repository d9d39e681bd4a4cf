//! Which shape, how its diffusion operator is built, and which levels.

use super::PartArgs;
use super::named::named;
use crate::error::CliError;
use adwave::bands::{BandsParams, FWHM};
use adwave::operator::{CloudGraph, OperatorKind, OperatorParams};
use adwave::region::{Length, RegionSyntaxError};
use adwave::shape::{CloudArea, MeshArea, WeldMode};
use clap::{Args, ValueEnum};
use std::num::NonZeroUsize;

/// A shape, and how its diffusion operator is built.
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
#[derive(Clone, Debug, Args)]
pub(crate) struct ShapeArgs {
    /// File (OBJ, PLY, STL, glTF, VTK, LAS and all else that 'adwave formats' lists; plain or gzip), '-', or sample:NAME
    #[arg(value_name = "SHAPE")]
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) part: PartArgs,
    /// Take the shape as this, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_enum, help_heading = "Shape")]
    pub(crate) kind: Option<Kind>,
    /// Number of vertices of a sample (about)
    #[arg(long, value_name = "N", help_heading = "Shape")]
    pub(crate) vertices: Option<usize>,
    /// Noise along the normals of a sample: its standard deviation in mean edge lengths
    #[arg(long, value_name = "S", help_heading = "Shape")]
    pub(crate) noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "K", default_value_t = 1, help_heading = "Shape")]
    pub(crate) seed: u64,
    /// By what a signal is smoothed [default: surface where levels are given by --lengths and where two shapes are compared, else walk]
    #[arg(long, value_name = "KIND", value_enum, help_heading = "Diffusion operator")]
    pub(crate) operator: Option<OperatorArg>,
    /// Take vertices at exactly equal positions as different vertices
    #[arg(long, help_heading = "Diffusion operator")]
    pub(crate) no_weld: bool,
    /// Mesh: how many rings of neighbors one step takes in
    #[arg(long, value_name = "N", value_parser = at_least_one, default_value_t = count(OperatorParams::default().rings), help_heading = "Diffusion operator")]
    pub(crate) rings: NonZeroUsize,
    /// Mesh: the area of a vertex
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Diffusion operator")]
    pub(crate) mesh_area: MeshAreaArg,
    /// Cloud: how many nearest neighbors one step takes in
    #[arg(long, value_name = "K", value_parser = at_least_one, default_value_t = count(OperatorParams::default().neighbors), help_heading = "Diffusion operator")]
    pub(crate) neighbors: NonZeroUsize,
    /// Cloud: step to the nearest of each point only, as the paper has it, not in both directions
    #[arg(long, help_heading = "Diffusion operator")]
    pub(crate) directed: bool,
    /// Cloud: the area of a point
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Diffusion operator")]
    pub(crate) cloud_area: CloudAreaArg,
    /// Walk: take out how densely the shape was sampled (Coifman & Lafon's α = 1, neighbors by length); slower where that varies much
    #[arg(long, help_heading = "Diffusion operator")]
    pub(crate) density_invariant: bool,
    /// Mesh, cloud: do not step across creases, where normals turn sharply
    #[arg(long, help_heading = "Diffusion operator")]
    pub(crate) keep_creases: bool,
}

/// Reads a number of things, in words that do not speak of types.
pub(crate) fn at_least_one(text: &str) -> Result<NonZeroUsize, String> {
    let found = text.trim().parse::<usize>().ok().and_then(NonZeroUsize::new);
    found.ok_or_else(|| "it takes a whole number of at least 1".to_owned())
}

/// The same from 0 on: what none of them means is said where it is asked for.
fn whole(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "it takes a whole number, not below 0".to_owned())
}

/// A default of the library, which is at least 1.
fn count(n: usize) -> NonZeroUsize {
    NonZeroUsize::new(n).unwrap_or(NonZeroUsize::MIN)
}

impl ShapeArgs {
    /// How the diffusion operator is built where levels are given by number.
    pub(crate) fn operator(&self) -> Result<OperatorParams, CliError> {
        self.operator_or(OperatorKind::Walk)
    }

    /// How the diffusion operator is built for these levels: widths should mean the same on every mesh.
    pub(crate) fn operator_for(&self, levels: &LevelArgs) -> Result<OperatorParams, CliError> {
        self.operator_or(if levels.by_width() { OperatorKind::Surface } else { OperatorKind::Walk })
    }

    /// How the diffusion operator is built, of this kind where neither a kind nor an option of the walk is asked for.
    pub(crate) fn operator_or(&self, kind: OperatorKind) -> Result<OperatorParams, CliError> {
        let default = OperatorParams::default();
        let walk = self.walk();
        if self.directed && self.density_invariant {
            let said = "--density-invariant steps both ways; leave out --directed";
            return Err(CliError::Input(said.to_owned()));
        }
        let only_of_walk = [
            ("--rings", walk.rings != default.rings),
            ("--mesh-area", walk.mesh_area != default.mesh_area),
            ("--directed", walk.cloud_graph != default.cloud_graph),
            ("--cloud-area", walk.cloud_area != default.cloud_area),
            ("--density-invariant", walk.density_invariant),
        ];
        let asked = only_of_walk.iter().find(|(_, is_asked)| *is_asked).map(|(option, _)| *option);
        match (self.operator.map(OperatorKind::from), asked) {
            (Some(OperatorKind::Surface), Some(option)) => Err(CliError::Input(format!(
                "{option} is an option of the walk; leave it out, or ask for --operator walk"
            ))),
            (None, Some(_)) => Ok(walk),
            (asked, _) => Ok(walk.with_kind(asked.unwrap_or(kind))),
        }
    }

    /// The same with the operator of the surface where none is asked for: for what is compared between meshes.
    pub(crate) fn over_meshes(&self) -> Self {
        let operator = self.operator_or(OperatorKind::Surface).map_or(self.operator, |o| Some(o.kind.into()));
        Self { operator, ..self.clone() }
    }

    fn walk(&self) -> OperatorParams {
        OperatorParams::default()
            .with_weld(if self.no_weld { WeldMode::Off } else { WeldMode::EqualPositions })
            .with_rings(self.rings.get())
            .with_mesh_area(self.mesh_area.into())
            .with_neighbors(self.neighbors.get())
            .with_cloud_graph(if self.directed { CloudGraph::Directed } else { CloudGraph::Union })
            .with_cloud_area(self.cloud_area.into())
            .with_density_invariant(self.density_invariant)
            .with_keep_creases(self.keep_creases)
    }
}

/// What a file can be taken as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    Mesh,
    Cloud,
    Graph,
}

named! {
    /// `adwave::operator::OperatorKind` by its names here.
    OperatorArg for OperatorKind {
        /// The paper's lazy random walk over the mesh
        Walk = Walk,
        /// Heat on the surface: widths that hardly depend on the mesh
        Surface = Surface,
    }
}

named! {
    /// `adwave::shape::MeshArea` by its names here.
    MeshAreaArg for MeshArea {
        Barycentric = Barycentric,
        MixedVoronoi = MixedVoronoi,
    }
}

named! {
    /// `adwave::shape::CloudArea` by its names here.
    CloudAreaArg for CloudArea {
        KthNeighbor = KthNeighbor,
        Unit = Unit,
        TangentVoronoi = TangentVoronoi,
    }
}

/// Which levels.
#[derive(Debug, Args)]
pub(crate) struct LevelArgs {
    /// Number of levels, each of twice as many steps of the diffusion as the one before (dyadic): 1, 2, 4 … 2^(J-1) [default: until a level is 2 % of the diagonal wide, for features 4 %, for signed saliency 16 %, as in diff; 4 to 16]
    #[arg(long, short = 'j', value_name = "J", value_parser = whole, allow_negative_numbers = true, help_heading = "Levels")]
    pub(crate) levels: Option<usize>,
    /// So many levels for each doubling of the steps in place of one: 2^(k/V) steps, whole or not
    #[arg(long, value_name = "V", value_parser = whole, allow_negative_numbers = true, help_heading = "Levels", conflicts_with_all = ["steps", "lengths"])]
    pub(crate) voices: Option<usize>,
    /// Levels of these numbers of steps, increasing, whole or not, from 1/64
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', help_heading = "Levels", conflicts_with_all = ["levels", "lengths"])]
    pub(crate) steps: Option<Vec<f64>>,
    /// Largest error of a band, relative to the band: 1e-13 to 0.1
    #[arg(long, value_name = "E", default_value_t = BandsParams::default().accuracy, help_heading = "Levels")]
    pub(crate) accuracy: f64,
    /// Levels of these widths σ in model units or in % of the diagonal, increasing: the root mean square distance that one value spreads to; σ/√2 along each axis of a surface, a full width at half maximum of 1.665 σ
    #[arg(
        long,
        value_name = "L,L,…",
        value_delimiter = ',',
        value_parser = any_length,
        allow_negative_numbers = true,
        help_heading = "Levels",
        conflicts_with_all = ["levels", "voices"]
    )]
    pub(crate) lengths: Option<Vec<Length>>,
    /// Levels of these full widths at half maximum, in model units or in % of the diagonal, increasing: --lengths of FWHM/1.665
    #[arg(
        long,
        value_name = "L,L,…",
        value_delimiter = ',',
        value_parser = any_length,
        allow_negative_numbers = true,
        help_heading = "Levels",
        conflicts_with_all = ["levels", "voices", "steps", "lengths"]
    )]
    pub(crate) fwhm: Option<Vec<Length>>,
}

/// Reads a length of any size: what no level or error can have is refused when all is known.
pub(crate) fn any_length(text: &str) -> Result<Length, RegionSyntaxError> {
    match text.trim().parse() {
        Ok(units) => Ok(Length::Units(units)),
        Err(_) => text.parse(),
    }
}

impl LevelArgs {
    /// Whether levels are asked for at all.
    pub(crate) fn is_asked(&self) -> bool {
        self.levels.is_some() || self.steps.is_some() || self.by_width() || self.voices.is_some()
    }

    /// Whether levels are asked for by width.
    pub(crate) fn by_width(&self) -> bool {
        self.lengths.is_some() || self.fwhm.is_some()
    }

    /// The widths σ that are asked for.
    pub(crate) fn widths(&self) -> Option<Vec<Length>> {
        let from_fwhm = |width: &Length| match *width {
            Length::Units(width) => Length::Units(width / FWHM),
            Length::PercentOfDiagonal(width) => Length::PercentOfDiagonal(width / FWHM),
        };
        let by_fwhm = || Some(self.fwhm.as_ref()?.iter().map(from_fwhm).collect());
        self.lengths.clone().or_else(by_fwhm)
    }
}
