//! Diffusion that does not cross creases.

use crate::operator::Diffusion;
use crate::shape::{
    PreparedGeometry, Shape, squared_distance, triangles_at_vertices, try_nearest_neighbors,
    try_vertex_normals,
};
use crate::signal::{FIT_NEIGHBORS, OutwardError, outward_normals, try_cloud_normals};
use crate::sparse::try_apply;
use crate::{Cancelled, Progress};

/// Steps that smooth the normals before they are compared, so that noise is not taken for creases.
const NORMAL_STEPS: usize = 2;

/// How unlike normals may be, in roots of the median of the squared difference over neighbors.
const REACH: f64 = 2.5;

/// The same diffusion with the steps weighed down across which the normals of a mesh or cloud turn (see
/// [`keep_creases`](crate::operator::OperatorParams::keep_creases)); a graph's is left as it is.
pub(super) fn keeping_creases(
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
    diffusion.guided(&normals, REACH, squared_length, progress)
}

/// Normals of the welded vertices that agree from one to the next where they can; `None` of a graph.
fn normals(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<Option<Vec<[f64; 3]>>, Cancelled> {
    let (points, _) = geometry.unit_points(progress)?;
    match geometry.shape() {
        Shape::Graph(_) => Ok(None),
        // Which side is outside does not matter, only that neighbors agree.
        Shape::Cloud(_) => {
            let near = try_nearest_neighbors(&points, FIT_NEIGHBORS, progress)?;
            try_cloud_normals(&points, &near, progress).map(Some)
        }
        Shape::Mesh(_) => {
            let mut normals = match outward_normals(geometry, None, progress) {
                Ok(outward) => outward.normals,
                Err(OutwardError::Cancelled(cancelled)) => return Err(cancelled),
                Err(other) => unreachable!("{other}"),
            };
            // As the triangles run, where there is no outside.
            let triangles = geometry.triangles();
            let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
            let as_given = try_vertex_normals(&points, triangles, &at_vertex, progress)?;
            for (n, given) in normals.iter_mut().zip(as_given) {
                if *n == [0.0; 3] {
                    *n = given;
                }
            }
            Ok(Some(normals))
        }
    }
}
