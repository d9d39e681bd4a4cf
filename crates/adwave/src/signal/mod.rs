//! Signals that come from the shape itself: normals, curvatures, shape index, density, the degree of a
//! graph's nodes; and the luminance of colours.
//!
//! [`surface_signal`] computes one by its kind on meshes and clouds alike; the parts can be used by themselves on points
//! and triangles.

mod cloud_normals;
mod curvature;
mod degree;
mod luminance;
mod mesh_curvature;
mod quadric;

pub(crate) use cloud_normals::cloud_border;
pub use cloud_normals::cloud_normals;
pub use curvature::Curvature;
pub use degree::degree;
pub use luminance::{lightness, luminance};
pub use mesh_curvature::mesh_curvature;
pub use quadric::cloud_curvature;
pub(crate) use quadric::{Frame, fit_quadric};

use crate::shape::{CloudArea, PreparedGeometry, Shape, cloud_areas, nearest_neighbours, vertex_normals};
use thiserror::Error;

/// How many nearest points a normal or a curvature of a cloud is fitted to, where nothing else is said: three times what
/// a quadric's six coefficients need, so that noise is averaged.
pub const FIT_NEIGHBOURS: usize = 20;

/// How many nearest points the density of a cloud is measured with.
const DENSITY_NEIGHBOURS: usize = 10;

/// Curvedness, in 1/size of the shape, below which it is flat: rounding alone gives a fine mesh of a plane about 1e-9.
const FLAT: f64 = 1e-6;

/// A signal that the shape gives by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceSignal {
    /// Unit normals, three channels.
    Normals,
    /// Mean curvature in 1/model unit; > 0 on a sphere whose normals point out.
    MeanCurvature,
    /// Gaussian curvature in 1/model unit².
    GaussianCurvature,
    /// Shape index in [−1, 1]: 1 on a bump, 0 on a saddle or a plane, −1 in a pit.
    ShapeIndex,
    /// Points per squared model unit; clouds only.
    Density,
}

impl SurfaceSignal {
    /// Every kind.
    pub const ALL: [Self; 5] =
        [Self::Normals, Self::MeanCurvature, Self::GaussianCurvature, Self::ShapeIndex, Self::Density];

    /// What it is called on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::MeanCurvature => "mean-curvature",
            Self::GaussianCurvature => "gaussian-curvature",
            Self::ShapeIndex => "shape-index",
            Self::Density => "density",
        }
    }

    /// In what it is measured; `None` where it is a number.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Normals | Self::ShapeIndex => None,
            Self::MeanCurvature => Some("1/model unit"),
            Self::GaussianCurvature => Some("1/model unit²"),
            Self::Density => Some("points/model unit²"),
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Numbers at each vertex.
    pub fn n_channels(self) -> usize {
        if self == Self::Normals { 3 } else { 1 }
    }
}

/// Why a shape does not give a signal.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SignalError {
    /// A graph has no positions.
    #[error("a graph has no positions, so it has no {}; name a field", .kind.name())]
    NoPositions {
        /// What was asked for.
        kind: SurfaceSignal,
    },
    /// A mesh was asked for what only clouds have.
    #[error("a mesh has no {}; take it as a cloud to get that of its vertices", .kind.name())]
    CloudsOnly {
        /// What was asked for.
        kind: SurfaceSignal,
    },
}

/// The signal `kind` of `shape`, n_vertices × [`n_channels`](SurfaceSignal::n_channels), in the order of the shape; always
/// finite. `geometry` is the shape's own. O(n) on a mesh, O(n log n) on a cloud.
///
/// On a cloud normals and curvatures come from a quadric that is fitted to each point and its [`FIT_NEIGHBOURS`] nearest;
/// their sign from orienting neighbouring normals alike (see [`cloud_normals`]).
///
/// # Errors
/// [`SignalError`] where the shape is a graph, or a density is asked for on a mesh.
///
/// ```
/// use adwave::shape::{PreparedGeometry, PointCloud, Shape, WeldMode};
/// use adwave::signal::{SurfaceSignal, surface_signal};
/// // A square grid of step 0.5: 4 points a unit area. The 10th nearest point is two steps away, and π·1²·density = 10
/// // neighbours give 3.2: the disc reaches half-way to the next points.
/// let grid = (0..400).map(|i| [0.5 * f64::from(i % 20), 0.5 * f64::from(i / 20), 0.0]).collect();
/// let shape = Shape::Cloud(PointCloud::new(grid)?);
/// let domain = PreparedGeometry::new(&shape, WeldMode::EqualPositions);
/// let density = surface_signal(&shape, &domain, SurfaceSignal::Density)?;
/// assert!((density[210] - 10.0 / std::f64::consts::PI).abs() < 1e-12);
/// assert!(surface_signal(&shape, &domain, SurfaceSignal::MeanCurvature)?.iter().all(|h| h.abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn surface_signal(
    shape: &Shape,
    geometry: &PreparedGeometry,
    kind: SurfaceSignal,
) -> Result<Vec<f64>, SignalError> {
    let is_mesh = match shape {
        Shape::Mesh(_) => true,
        Shape::Cloud(_) => false,
        Shape::Graph(_) => return Err(SignalError::NoPositions { kind }),
    };
    let (points, unit) = geometry.unit_points();
    let curvature = || {
        if is_mesh {
            mesh_curvature(&points, &geometry.triangles)
        } else {
            cloud_curvature(&points, &nearest_neighbours(&points, FIT_NEIGHBOURS))
        }
    };
    let values = match kind {
        SurfaceSignal::Normals if is_mesh => vertex_normals(&points, &geometry.triangles).into_flattened(),
        SurfaceSignal::Normals => {
            cloud_normals(&points, &nearest_neighbours(&points, FIT_NEIGHBOURS)).into_flattened()
        }
        SurfaceSignal::MeanCurvature => curvature().mean.into_iter().map(|h| h / unit).collect(),
        SurfaceSignal::GaussianCurvature => {
            curvature().gaussian.into_iter().map(|k| k / unit / unit).collect()
        }
        SurfaceSignal::ShapeIndex => curvature().shape_index(FLAT),
        SurfaceSignal::Density if is_mesh => return Err(SignalError::CloudsOnly { kind }),
        SurfaceSignal::Density => {
            let near = nearest_neighbours(&points, DENSITY_NEIGHBOURS);
            let areas = cloud_areas(&points, &near, CloudArea::KthNeighbour);
            areas.into_iter().map(|a| if a > 0.0 { 1.0 / (a * unit * unit) } else { 0.0 }).collect()
        }
    };
    Ok(geometry.vertex_map.scatter(&values, kind.n_channels()))
}

#[cfg(test)]
mod tests;
