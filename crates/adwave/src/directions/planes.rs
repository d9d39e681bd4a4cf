//! Tangent planes of the welded vertices of a mesh or the points of a cloud.

use crate::laplacian::TangentPlane;
use crate::parallel;
use crate::shape::{PreparedGeometry, triangles_at_vertices};
use crate::signal::try_cloud_normals;
use crate::vector::{Vector, add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress};

/// Length of the sum of the triangles' normals relative to the sum of their lengths below which the normals of a vertex
/// contradict each other, as where triangles have different orientations.
const AGREEING: f64 = 0.05;

/// Planes of the vertices of a mesh across the sums of their triangles' normals by area, and of the points of a cloud
/// across the normals that the cloud has, or that fit `neighbors` nearest points best.
pub(super) fn tangent_planes(
    geometry: &PreparedGeometry,
    neighbors: usize,
    progress: Progress<'_>,
) -> Result<Vec<TangentPlane>, Cancelled> {
    let (points, _) = geometry.unit_points(progress)?;
    let n = geometry.n_vertices();
    if geometry.shape().is_cloud() {
        let normals = if let Some(given) = geometry.given_normals() {
            given.normals.clone()
        } else {
            let near = geometry.nearest(&points, neighbors, progress)?;
            try_cloud_normals(&points, &near, progress)?
        };
        return parallel::try_collect(n, progress, |x| {
            TangentPlane::from_normal(&unit(&normals[x]).unwrap_or_default())
        });
    }
    let triangles = geometry.triangles();
    let at_vertex = triangles_at_vertices(n, triangles, progress)?;
    parallel::try_collect(n, progress, |x| {
        let normals = || {
            at_vertex.row(x).iter().map(|&t| {
                let [a, b, c] = triangles[t as usize].map(|corner| points[corner as usize]);
                cross(&subtract(&b, &a), &subtract(&c, &a))
            })
        };
        TangentPlane::from_normal(&mean_normal(normals))
    })
}

/// Unit vector of the sum; if the vectors contradict each other, of the sum with all on the side of the longest. 0
/// without any.
fn mean_normal<I: Iterator<Item = Vector>>(normals: impl Fn() -> I) -> Vector {
    let sum = normals().fold([0.0; 3], |sum, v| add_scaled(&sum, 1.0, &v));
    let total: f64 = normals().map(|v| norm(&v)).sum();
    if norm(&sum) < AGREEING * total {
        let longest = normals().max_by(|a, b| norm(a).total_cmp(&norm(b))).unwrap_or_default();
        let aligned =
            normals().fold([0.0; 3], |sum, v| add_scaled(&sum, 1.0_f64.copysign(dot(&v, &longest)), &v));
        return unit(&aligned).unwrap_or_default();
    }
    unit(&sum).unwrap_or_default()
}
