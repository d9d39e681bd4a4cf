//! Diffusion that does not cross creases.

use crate::operator::Diffusion;
use crate::shape::{
    PreparedGeometry, Shape, squared_distance, triangles_at_vertices, try_nearest_neighbours,
    try_vertex_normals,
};
use crate::signal::{FIT_NEIGHBOURS, OutwardError, outward_normals, try_cloud_normals};
use crate::{Cancelled, Progress, parallel};

/// Steps that smooth the normals before they are compared, so that noise is not taken for creases.
const NORMAL_STEPS: usize = 2;

/// How unlike normals may be, in roots of the median of the squared difference over neighbours.
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
        normals = parallel::try_collect(normals.len(), progress, |x| stepped(&diffusion, &normals, x))?;
    }
    let points = geometry.points();
    let squared_length = |x: usize, y: usize| squared_distance(&points[x], &points[y]);
    diffusion.guided(&normals, REACH, squared_length, progress)
}

/// `Σ_y Φ₁(x,y)·n_y`.
fn stepped(diffusion: &Diffusion, normals: &[[f64; 3]], x: usize) -> [f64; 3] {
    let (columns, weights) = diffusion.row(x);
    let mut stays = 1.0;
    let mut sum = [0.0; 3];
    let mut add = |w: f64, n: &[f64; 3]| sum.iter_mut().zip(n).for_each(|(s, n)| *s += w * n);
    for (&y, &w) in columns.iter().zip(weights) {
        add(w, &normals[y as usize]);
        stays -= w;
    }
    add(stays, &normals[x]);
    sum
}

/// Normals of the welded vertices that agree from one to the next where they can; `None` of a graph.
fn normals(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<Option<Vec<[f64; 3]>>, Cancelled> {
    let (points, _) = geometry.unit_points(progress)?;
    match geometry.shape() {
        Shape::Graph(_) => Ok(None),
        // Which side is outside does not matter, only that neighbours agree.
        Shape::Cloud(_) => {
            let near = try_nearest_neighbours(&points, FIT_NEIGHBOURS, progress)?;
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
