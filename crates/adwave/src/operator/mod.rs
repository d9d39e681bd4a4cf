//! From a prepared shape to diffusion on it: the local operator T (eq. 1) and the diffusion operator `Φ₁ = [T]_r`
//! (eq. 4), one step of a lazy random walk. [`Operator`] is the interface that bands require of any operator.

mod density;
mod difference_steps;
mod diffusion;
mod dispersion;
mod given;
mod guided;
mod interface;
mod local;
mod row_function;
mod spectrum;
mod surface;

pub(crate) use difference_steps::DifferenceSteps;
pub use diffusion::{Diffusion, DiffusionError, Semigroup};
pub(crate) use guided::{Sites, site_diffusion, typical_difference, typical_difference_of, typical_square};
pub use interface::{
    BlockPrecision, Continuation, Invariant, KeptMeasure, Leap, NoRows, Operator, RowOutput, RowWeights,
    SignalBlock, Steps, Sum, Weighing,
};
pub use local::{LocalOperator, local_operator, local_operator_of_neighbors};
pub use row_function::RowFunction;
pub use surface::{SurfaceDiffusion, SurfaceInfo, surface_diffusion};

use crate::named_values;
use crate::shape::{CloudArea, MeshArea, WeldMode};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Symmetry of the neighbor graph of a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum CloudGraph {
    /// `y` is a neighbor of `x` if either is among the nearest points of the other. Φ₁ is then reversible and its
    /// spectrum real.
    #[default]
    Union,
    /// The neighbors of a point are its nearest points alone, as in the paper. Φ₁ need not be reversible.
    Directed,
}

/// Kind of operator that smooths signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OperatorKind {
    /// The paper's lazy random walk over the mesh (eq. 4): a step goes to neighbors, whatever their distance.
    #[default]
    Walk,
    /// Heat on the surface, by its Laplace–Beltrami operator: the bands depend on the surface and hardly on its
    /// mesh.
    Surface,
}

named_values!(OperatorKind, "operator", {
    Walk => "walk", "Lazy random walk over the edges, as in the paper";
    Surface => "surface", "Heat on the surface: widths that hardly depend on the mesh";
});

/// Treatment of the end points of a curve, the vertices with one neighbor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum EndPoints {
    /// End points keep their values, and smoothing neither shortens nor flattens the curve next to them.
    #[default]
    Keep,
    /// End points are smoothed like other vertices, which draws them in.
    Free,
}

/// Treatment of the vertices of a surface that exchange heat the fastest, and determine the number of products.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Masses {
    /// The masses of 1 % of the vertices are raised, which bounds the cost on meshes with tiny or thin triangles.
    #[default]
    Raised,
    /// The masses are those of the mesh, except where the cost would have no bound at all.
    Exact,
}

/// Task that decides which operator is used if none is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OperatorTask {
    /// Levels are counted in steps.
    StepLevels,
    /// Levels are given by their widths, which should mean the same on every mesh.
    WidthLevels,
    /// Two shapes are compared, or their features are matched.
    Comparison,
    /// Details of a mesh are looked for: saliency and features.
    Analysis,
}

impl OperatorTask {
    /// The operator that suits the task: heat on the surface where the triangles must not matter, else the walk of the
    /// paper.
    pub fn default_kind(self) -> OperatorKind {
        match self {
            Self::StepLevels => OperatorKind::Walk,
            Self::WidthLevels | Self::Comparison | Self::Analysis => OperatorKind::Surface,
        }
    }
}

/// Error of asking for the operator of the surface together with an option of the walk.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "{option} is an option of the walk and has no effect on the surface operator; leave it out or choose the walk"
)]
pub struct WalkOptionError {
    /// Name of the option, as the caller knows it.
    pub option: String,
}

/// The operator for a task: the one asked for; else the walk if `walk_option` names an option that only the walk has;
/// else `default`.
///
/// ```
/// use adwave::operator::{OperatorKind, OperatorTask, choose_operator};
/// let default = OperatorTask::WidthLevels.default_kind();
/// assert_eq!(choose_operator(None, default, None), Ok(OperatorKind::Surface));
/// assert_eq!(choose_operator(None, default, Some("rings")), Ok(OperatorKind::Walk));
/// assert!(choose_operator(Some(OperatorKind::Surface), default, Some("rings")).is_err());
/// ```
///
/// # Errors
/// [`WalkOptionError`] if the operator of the surface is asked for together with an option of the walk.
pub fn choose_operator(
    asked: Option<OperatorKind>,
    default: OperatorKind,
    walk_option: Option<&str>,
) -> Result<OperatorKind, WalkOptionError> {
    match (asked, walk_option) {
        (Some(OperatorKind::Surface), Some(option)) => Err(WalkOptionError { option: option.to_owned() }),
        (Some(kind), _) => Ok(kind),
        (None, Some(_)) => Ok(OperatorKind::Walk),
        (None, None) => Ok(default),
    }
}

/// Parameters of the diffusion operator. The defaults are those of the paper, made precise.
///
/// ```
/// use adwave::operator::OperatorParams;
/// let params = OperatorParams::default().with_neighbors(16);
/// assert_eq!((params.neighbors, params.rings), (16, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OperatorParams {
    /// Kind of operator. A curve ([`Graph::curve`](crate::shape::Graph::curve)) always has heat by arc length.
    pub kind: OperatorKind,
    /// Welding of vertices at equal positions.
    pub weld: WeldMode,
    /// Mesh: number of rings of neighbors that a step may reach, at least 1.
    pub rings: usize,
    /// Mesh: definition of the area of a vertex.
    pub mesh_area: MeshArea,
    /// Cloud: number of nearest neighbors that a step may reach, at least 1.
    pub neighbors: usize,
    /// Cloud: symmetry of the neighbor graph.
    pub cloud_graph: CloudGraph,
    /// Cloud: definition of the area of a point.
    pub cloud_area: CloudArea,
    /// Walk: removes the density of the samples (see [`local_operator`]); the graph of a cloud is then symmetric.
    pub density_invariant: bool,
    /// Favors vertices with similar normals: each weight is multiplied by `exp(−‖n_x − n_y‖²/2s²)`, where n are the
    /// normals of the vertices of a mesh or cloud after two steps and s is 2.5 times the square root of the median
    /// of `‖n_x − n_y‖²` over neighbors (see [`Diffusion::weigh_by_guide`]). A graph has no normals and does not
    /// change.
    pub keep_creases: bool,
    /// Curve: treatment of its end points.
    pub end_points: EndPoints,
    /// Heat on a surface: masses of the vertices with the fastest exchange (see [`surface_diffusion`]).
    pub masses: Masses,
    /// Heat on a mesh of a sphere about the origin: makes up for the mesh's error on short waves (see
    /// [`surface_diffusion`]), as for maps of the sky and of the Earth.
    pub corrects_dispersion: bool,
}

impl Default for OperatorParams {
    fn default() -> Self {
        Self {
            kind: OperatorKind::default(),
            weld: WeldMode::default(),
            rings: 1,
            mesh_area: MeshArea::default(),
            neighbors: 10,
            cloud_graph: CloudGraph::default(),
            cloud_area: CloudArea::default(),
            density_invariant: false,
            keep_creases: false,
            end_points: EndPoints::default(),
            masses: Masses::default(),
            corrects_dispersion: false,
        }
    }
}

impl OperatorParams {
    /// Sets whether heat on a sphere makes up for the mesh's error on short waves.
    #[must_use]
    pub fn with_corrected_dispersion(self, corrects_dispersion: bool) -> Self {
        Self { corrects_dispersion, ..self }
    }

    /// Sets the kind of operator.
    #[must_use]
    pub fn with_kind(self, kind: OperatorKind) -> Self {
        Self { kind, ..self }
    }

    /// Sets the welding of vertices at equal positions.
    #[must_use]
    pub fn with_weld(self, weld: WeldMode) -> Self {
        Self { weld, ..self }
    }

    /// Sets the number of rings that a step may reach on a mesh; 0 counts as 1.
    #[must_use]
    pub fn with_rings(self, rings: usize) -> Self {
        Self { rings: rings.max(1), ..self }
    }

    /// Sets the definition of the area of a mesh vertex.
    #[must_use]
    pub fn with_mesh_area(self, mesh_area: MeshArea) -> Self {
        Self { mesh_area, ..self }
    }

    /// Sets the number of nearest points that a step may reach on a cloud; 0 counts as 1.
    #[must_use]
    pub fn with_neighbors(self, neighbors: usize) -> Self {
        Self { neighbors: neighbors.max(1), ..self }
    }

    /// Sets the symmetry of the neighbor graph of a cloud.
    #[must_use]
    pub fn with_cloud_graph(self, cloud_graph: CloudGraph) -> Self {
        Self { cloud_graph, ..self }
    }

    /// Sets the definition of the area of a point of a cloud.
    #[must_use]
    pub fn with_cloud_area(self, cloud_area: CloudArea) -> Self {
        Self { cloud_area, ..self }
    }

    /// Sets the removal of the sampling density from the walk.
    #[must_use]
    pub fn with_density_invariant(self, density_invariant: bool) -> Self {
        Self { density_invariant, ..self }
    }

    /// Sets the treatment of the end points of a curve.
    #[must_use]
    pub fn with_end_points(self, end_points: EndPoints) -> Self {
        Self { end_points, ..self }
    }

    /// Sets the treatment of the masses of the vertices with the fastest exchange.
    #[must_use]
    pub fn with_masses(self, masses: Masses) -> Self {
        Self { masses, ..self }
    }

    /// Sets the preference for vertices with similar normals.
    #[must_use]
    pub fn with_keep_creases(self, keep_creases: bool) -> Self {
        Self { keep_creases, ..self }
    }
}
