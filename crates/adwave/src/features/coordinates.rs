//! Features of the coordinates of a shape: bumps and dents, with their sizes.

use super::cloud::cloud_features;
use super::surface::mesh_features;
use super::{Feature, FeatureError, FeatureParams};
use crate::bands::{BandsError, BandsParams, Schedule, Wavelets};
use crate::shape::{NoShape, triangles_at_vertices, try_vertex_normals};
use crate::signal::{FIT_NEIGHBORS, OutwardError, outward_normals, try_cloud_normals};
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use thiserror::Error;

/// Error of finding the features of coordinates.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CoordinateFeatureError {
    /// The levels or parameters do not allow features.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The normals cannot be found.
    #[error(transparent)]
    Outward(#[from] OutwardError),
    /// The domain is no shape.
    #[error(transparent)]
    NoShape(#[from] NoShape),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for CoordinateFeatureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Features(e) => e.kind(),
            Self::Bands(e) => e.kind(),
            Self::Outward(e) => e.kind(),
            Self::NoShape(e) => e.kind(),
            Self::Cancelled(e) => e.kind(),
        }
    }
}

/// Coordinates of a mesh or cloud with the levels on which features are sought.
#[derive(Clone, Copy, Debug)]
pub struct ShapeCoordinates<'a> {
    /// Positions of the vertices, in the order of the shape.
    pub points: &'a [[f64; 3]],
    /// Normals of the file, three numbers a vertex, in the order of the shape.
    pub normals: Option<&'a [f64]>,
    /// Levels.
    pub schedule: &'a Schedule,
    /// Accuracy and method of the bands.
    pub bands: BandsParams,
}

/// Features and the responses in which they were found.
#[derive(Clone, Debug)]
pub struct CoordinateFeatures {
    /// The features, in the order of [`features`](super::features()).
    pub features: Vec<Feature>,
    /// Responses W_j·n, corrected for the mesh or for the spread of the points, in model units, as bands of one
    /// channel: positive where the surface is convex at the size of the level, if the shape has an outside. Those of
    /// a cloud are less their medians.
    pub wavelets: Wavelets,
}

/// Finds the features of the coordinates of a mesh or cloud: places that stand out from their surroundings by more than
/// the triangles, the drawing of the points, and noise can cause. O(n × levels).
///
/// *Mesh.* The response R(j,x) is `W_j·n·m_j/M_j`, with the unit normal n of the surface smoothed by S(j), the second
/// moment `M_j(x) = Σ_y ψ_j(x,y)·|y − x|²` of the wavelet and its value `m_j = −(σ_j² − σ_(j−1)²)` on a plane. Its
/// contrast is `C(j,x) = (R(j,x) − median of R(j) over the ring of 1.5 to 2.5 σ_j)/σ_j`, so that a uniform response,
/// however large, is no feature. A feature is a vertex at which R(j) is extremal within two rings, σ_j^(−¼)·C(j) is
/// larger than on the levels beside j, and |C| exceeds 14 standard deviations d of what this mesh causes where there is
/// nothing:
///
/// `d² = 0.09·⟨s²·a⟩/σ_j⁴ + (0.0061·b·(e/σ_j)²·(1 + 2.5·e/σ_j))² + (accuracy·rms R(j)/σ_j)²`
///
/// s² is the variance of independent displacements that would make the two finest levels as rough as they are, a
/// the area of a vertex, b the root mean square difference of the normals from that at x, and e the root mean
/// square length of the edges; means run over the disk. Side lobes beside stronger features of the opposite sign
/// and weaker answers to the same detail are dropped, and what one side of a part that is thinner than σ answers while the
/// opposite side answers the other way. Closer than 4σ_j to a border there are none, unless
/// [`FeatureParams::border_sigmas`] says otherwise. `response` is C, `strength` is |C|/d, and `sigma` lies between
/// levels: for a Gaussian bump of small height it is its standard deviation to 10 %. θ, the response and the scope
/// of the parameters do not apply.
///
/// *Cloud.* The response is `W_j·n·⟨M_j⟩/M_j`, where `M_j(x) = Σ_y ψ_j(x,y)·|y − x|²` and ⟨M_j⟩ is its mean: on a
/// sphere `W_j·n` is `−M_j/2R` at every point. Its median is subtracted, and
/// [`Response::Normalized`](super::Response::Normalized) divides by σ_j as
/// [`Response::Sigma`](super::Response::Sigma) does, since on a smooth cloud no level is more uneven than another. A
/// feature must differ from the mean of the response between σ and 2σ around it by more than 9 standard deviations of
/// the response. The standard deviation is the root mean square difference from the responses of two random halves of
/// the points, the larger of the local and the global one. Levels finer than half of the points resolves have no
/// features, and the features of the last level include bumps that are wider. Of significant features within σ of
/// each other the strongest is kept.
///
/// # Errors
/// [`CoordinateFeatureError`] if the bands, the normals or the features cannot be computed.
///
/// # Panics
/// Unless the shape has as many vertices.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule};
/// use adwave::features::{FeatureParams, ShapeCoordinates, coordinate_features};
/// use adwave::sample::Sample;
/// use adwave::shape::{PointCloud, Shape};
/// use adwave::{Decomposer, Progress};
/// let points = Sample::from_name("sphere", Some(2000))?.points;
/// let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone())?));
/// let schedule = Schedule::dyadic(6)?;
/// let coordinates =
///     ShapeCoordinates { points: &points, normals: None, schedule: &schedule, bands: BandsParams::default() };
/// let found = coordinate_features(&decomposer, &coordinates, &FeatureParams::default(), Progress::none())?;
/// assert!(found.features.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn coordinate_features(
    decomposer: &Decomposer,
    coordinates: &ShapeCoordinates<'_>,
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<CoordinateFeatures, CoordinateFeatureError> {
    params.check()?;
    let n_levels = coordinates.schedule.n_levels();
    if n_levels < 3 {
        return Err(FeatureError::TooFewLevels { n_levels }.into());
    }
    let normals = normals(decomposer, coordinates.normals, progress)?;
    let find = if decomposer.geometry().is_some_and(|geometry| geometry.shape().is_cloud()) {
        cloud_features
    } else {
        mesh_features
    };
    find(decomposer, coordinates, &normals, params, progress)
}

/// Outward normals; on a surface without an outside, the normals of one of its sides.
fn normals(
    decomposer: &Decomposer,
    file: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, CoordinateFeatureError> {
    let geometry = decomposer.geometry_for("a search for features of coordinates")?;
    let mut normals = outward_normals(geometry, file, progress.quiet())?.normals;
    if normals.contains(&[0.0; 3]) {
        let (points, _) = geometry.unit_points(progress)?;
        let triangles = geometry.triangles();
        let one_side = if triangles.is_empty() {
            let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
            try_cloud_normals(&points, &near, progress)?
        } else {
            let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
            try_vertex_normals(&points, triangles, &at_vertex, progress)?
        };
        for (normal, other) in normals.iter_mut().zip(one_side) {
            if *normal == [0.0; 3] {
                *normal = other;
            }
        }
    }
    Ok(normals)
}
