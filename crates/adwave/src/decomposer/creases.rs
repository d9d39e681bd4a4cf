//! Diffusion that does not cross creases.

use crate::operator::Diffusion;
use crate::shape::{PreparedGeometry, Shape, squared_distance};
use crate::signal::{FIT_NEIGHBORS, OutwardError, outward_normals, try_cloud_normals};
use crate::sparse::try_apply;
use crate::{Cancelled, Progress};

/// Number of steps that smooth the normals before they are compared, so that noise is not taken for creases.
const NORMAL_STEPS: usize = 2;

/// Difference of normals at which steps are damped, in square roots of the median squared difference between
/// neighbors.
const REACH: f64 = 2.5;

/// Reduces the weights of steps across which the normals of a mesh or cloud turn (see
/// [`keep_creases`](crate::operator::OperatorParams::keep_creases)); the diffusion of a graph is returned
/// unchanged.
pub(super) fn respect_creases(
    diffusion: Diffusion,
    geometry: &PreparedGeometry,
    progress: Progress<'_>,
) -> Result<Diffusion, Cancelled> {
    let Some(mut normals) = normals(geometry, progress)? else { return Ok(diffusion) };
    for _ in 0..NORMAL_STEPS {
        let before = normals.clone();
        try_apply(&diffusion, before.as_flattened(), normals.as_flattened_mut(), 3, progress)?;
    }
    let points = geometry.points();
    let squared_length = |x: usize, y: usize| squared_distance(&points[x], &points[y]);
    diffusion.weigh_by_guide(&normals, REACH, squared_length, progress)
}

/// Normals of the welded vertices, consistently oriented between neighbors as far as possible; `None` for a graph.
fn normals(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<Option<Vec<[f64; 3]>>, Cancelled> {
    let (points, _) = geometry.unit_points(progress)?;
    match geometry.shape() {
        Shape::Graph(_) => Ok(None),
        // Only the agreement of neighbors matters, not which side is outside.
        Shape::Cloud(_) => {
            let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
            try_cloud_normals(&points, &near, progress).map(Some)
        }
        Shape::Mesh(_) => {
            let mut normals = match outward_normals(geometry, None, progress) {
                Ok(outward) => outward.normals,
                Err(OutwardError::Cancelled(cancelled)) => return Err(cancelled),
                Err(other) => unreachable!("{other}"),
            };
            // Without an outside, the orientation of the triangles decides.
            let as_given = geometry.incidence(progress)?.normals(&points, progress)?;
            for (n, given) in normals.iter_mut().zip(as_given) {
                if *n == [0.0; 3] {
                    *n = given;
                }
            }
            Ok(Some(normals))
        }
    }
}
