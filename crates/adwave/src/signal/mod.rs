//! Signals derived from the shape itself: normals, curvatures, shape index, density, degree of a graph's nodes; and
//! the luminance of colors.
//!
//! [`surface_signal`] computes one by its kind on meshes and clouds; the other functions work on points and
//! triangles.

mod close_sheets;
mod cloud_normals;
mod curvature;
mod degree;
mod luminance;
mod mesh_curvature;
mod moved_normals;
mod outward;
mod principal;
mod quadric;

pub use crate::shape::orientation::{PointWithNormal, SideStep, side_step};
pub use close_sheets::{CloseSheets, close_sheets, find_close_sheets};
pub(crate) use cloud_normals::cloud_border;
pub(crate) use cloud_normals::{aligned_normals, try_cloud_normals};
pub use cloud_normals::{cloud_normals, normals_facing, plane_normals};
pub use curvature::Curvature;
pub use degree::degree;
pub use luminance::{lightness, luminance};
pub use mesh_curvature::mesh_curvature;
use mesh_curvature::try_mesh_curvature;
pub use moved_normals::{
    MovedPoints, StoredNormals, moved_cloud_normals, moved_corner_normals, moved_tangent,
};
pub use outward::{OutwardError, OutwardInfo, OutwardNormals, outward_normals};
use principal::principal_directions;
pub use quadric::cloud_curvature;
use quadric::try_cloud_curvature;
pub(crate) use quadric::{TangentFrame, fit_quadric};

use crate::shape::{CloudArea, MeshArea, PreparedGeometry, Shape, try_cloud_areas};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress, parallel};
use thiserror::Error;

/// Default number of nearest points for fitting a normal or a curvature of a cloud: three times the six
/// coefficients of a quadric, which averages noise.
pub const FIT_NEIGHBORS: usize = 20;

/// Number of nearest points that measure the density of a cloud.
const DENSITY_NEIGHBORS: usize = 10;

/// Curvedness, in 1/size of the shape, below which it counts as flat; rounding alone gives about 1e-9 on a fine
/// mesh of a plane.
const FLAT: f64 = 1e-6;

/// A signal derived from the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceSignal {
    /// Unit normals, three channels.
    Normals,
    /// Mean curvature in 1/model unit; positive on a sphere with outward normals.
    MeanCurvature,
    /// Gaussian curvature in 1/model unit².
    GaussianCurvature,
    /// Shape index in [−1, 1]: 1 on a bump, 0 on a saddle or a plane, −1 in a pit.
    ShapeIndex,
    /// Direction of the larger principal curvature times the difference of both, in 1/model unit: three channels of a
    /// line, of which v and −v mean the same.
    PrincipalDirection,
    /// Points per squared model unit; clouds only.
    Density,
}

impl SurfaceSignal {
    /// All kinds.
    pub const ALL: [Self; 6] = [
        Self::Normals,
        Self::MeanCurvature,
        Self::GaussianCurvature,
        Self::ShapeIndex,
        Self::PrincipalDirection,
        Self::Density,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::MeanCurvature => "mean-curvature",
            Self::GaussianCurvature => "gaussian-curvature",
            Self::ShapeIndex => "shape-index",
            Self::PrincipalDirection => "principal-direction",
            Self::Density => "density",
        }
    }

    /// Unit of the values; `None` for a dimensionless signal.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Normals | Self::ShapeIndex => None,
            Self::MeanCurvature | Self::PrincipalDirection => Some("1/model unit"),
            Self::GaussianCurvature => Some("1/model unit²"),
            Self::Density => Some("points/model unit²"),
        }
    }

    /// The kind with that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Number of values per vertex.
    pub fn n_channels(self) -> usize {
        if matches!(self, Self::Normals | Self::PrincipalDirection) { 3 } else { 1 }
    }
}

/// Error of deriving a signal from a shape.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SignalError {
    /// The shape is a graph or curve, which has no surface.
    #[error("a graph has no surface, so it has no {}; name a field", .kind.name())]
    NoPositions {
        /// The requested signal.
        kind: SurfaceSignal,
    },
    /// The signal exists for clouds only.
    #[error("a mesh has no {}; take it as a cloud to get that of its vertices", .kind.name())]
    CloudsOnly {
        /// The requested signal.
        kind: SurfaceSignal,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SignalError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(cancelled) => cancelled.kind(),
            _ => ErrorKind::Input,
        }
    }
}

/// Computes the signal `kind` of a prepared shape, n_vertices × [`n_channels`](SurfaceSignal::n_channels), in the
/// order of the shape; always finite. O(n) on a mesh, O(n log n) on a cloud.
///
/// On a cloud, normals and curvatures come from a quadric fitted to each point and its [`FIT_NEIGHBORS`] nearest
/// points; their sign comes from orienting neighboring normals consistently (see [`cloud_normals`]).
///
/// # Errors
/// [`SignalError`] if the shape is a graph, a density is requested on a mesh, or the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{PreparedGeometry, PointCloud, Shape, WeldMode};
/// use adwave::signal::{SurfaceSignal, surface_signal};
/// // A square grid of step 0.5: 4 points a unit area. The 10th nearest point is two steps away, and π·1²·density = 10
/// // neighbors give 3.2: the disc reaches half-way to the next points.
/// let grid = (0..400).map(|i| [0.5 * f64::from(i % 20), 0.5 * f64::from(i / 20), 0.0]).collect();
/// let shape = Shape::Cloud(PointCloud::new(grid)?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// let density = surface_signal(&geometry, SurfaceSignal::Density, Progress::none())?;
/// assert!((density[210] - 10.0 / std::f64::consts::PI).abs() < 1e-12);
/// let mean_curvature = surface_signal(&geometry, SurfaceSignal::MeanCurvature, Progress::none())?;
/// assert!(mean_curvature.iter().all(|h| h.abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn surface_signal(
    geometry: &PreparedGeometry,
    kind: SurfaceSignal,
    progress: Progress<'_>,
) -> Result<Vec<f64>, SignalError> {
    let is_mesh = match geometry.shape() {
        Shape::Mesh(_) => true,
        Shape::Cloud(_) => false,
        Shape::Graph(_) => return Err(SignalError::NoPositions { kind }),
    };
    if is_mesh && kind == SurfaceSignal::Density {
        return Err(SignalError::CloudsOnly { kind });
    }
    progress.step(0, STAGES)?;
    let (points, unit) = geometry.unit_points(progress)?;
    let normals = || {
        Ok::<_, Cancelled>(if is_mesh {
            geometry.incidence(progress)?.normals(&points, progress)?
        } else {
            let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
            progress.step(1, STAGES)?;
            try_cloud_normals(&points, &near, progress)?
        })
    };
    let curvature = || {
        if is_mesh {
            let areas = geometry.incidence(progress)?.areas(&points, MeshArea::MixedVoronoi, progress)?;
            return try_mesh_curvature(&points, geometry.triangles(), &areas, progress);
        }
        let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
        progress.step(1, STAGES)?;
        try_cloud_curvature(&points, &near, progress)
    };
    let in_model_units = |mut values: Vec<f64>, scaled: fn(f64, f64) -> f64| {
        parallel::try_visit_rows(&mut values, 1, 1 << 13, progress, |_, values| {
            for value in values {
                *value = scaled(*value, unit);
            }
        })?;
        Ok::<_, Cancelled>(values)
    };
    let values = match kind {
        SurfaceSignal::Normals => normals()?.into_flattened(),
        SurfaceSignal::MeanCurvature => in_model_units(curvature()?.mean, |h, unit| h / unit)?,
        SurfaceSignal::GaussianCurvature => in_model_units(curvature()?.gaussian, |k, unit| k / unit / unit)?,
        SurfaceSignal::PrincipalDirection => {
            let neighbors = if is_mesh {
                geometry.incidence(progress)?.ring(progress)?
            } else {
                geometry.nearest(&points, FIT_NEIGHBORS, progress)?.adjacency
            };
            let found = principal_directions(&points, &normals()?, &neighbors, progress)?;
            in_model_units(found.into_flattened(), |v, unit| v / unit)?
        }
        SurfaceSignal::ShapeIndex => curvature()?.shape_index(FLAT * (unit / geometry.size_unit())),
        SurfaceSignal::Density => {
            let near = geometry.nearest(&points, DENSITY_NEIGHBORS, progress)?;
            progress.step(1, STAGES)?;
            let areas = try_cloud_areas(&points, &near, CloudArea::KthNeighbor, progress)?;
            in_model_units(areas, |a, unit| if a > 0.0 { 1.0 / (a * unit * unit) } else { 0.0 })?
        }
    };
    progress.step(2, STAGES)?;
    let signal = geometry.vertex_map().try_scatter(&values, kind.n_channels(), progress)?;
    progress.step(STAGES, STAGES)?;
    Ok(signal)
}

/// Number of reported stages: neighbors, values, conversion to the order of the shape.
const STAGES: u64 = 3;

#[cfg(test)]
mod tests;
