//! Normals, area and volume of a triangulated surface.

use super::adjacency::triangles_at_vertices;
use super::area::triangle_area;
use crate::parallel::{self, expect_not_cancelled};
use crate::rows::Pattern;
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Unit normal of a triangle times twice its area.
pub(super) fn doubled_normal(points: &[[f64; 3]], corners: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners.map(|v| Vector3::from(points[v as usize]));
    (b - a).cross(&(c - a))
}

/// Unit normals of the triangles, by the right-hand rule; zero for a triangle without area. O(triangles).
pub fn face_normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    parallel::collect(triangles.len(), |f| {
        doubled_normal(points, triangles[f]).try_normalize(0.0).unwrap_or_default().into()
    })
}

/// Unit normals of the vertices: the area-weighted mean of the triangle normals; zero if it vanishes or the vertex
/// has no triangle. O(triangles).
///
/// ```
/// use adwave::shape::vertex_normals;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]];
/// assert_eq!(vertex_normals(&points, &[[0, 1, 2]]), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3]]);
/// ```
pub fn vertex_normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let none = Progress::none();
    let at_vertex = expect_not_cancelled(triangles_at_vertices(points.len(), triangles, none));
    expect_not_cancelled(try_vertex_normals(points, triangles, &at_vertex, none))
}

/// [`vertex_normals`] from the triangles at each vertex; stops if the call is cancelled.
pub(crate) fn try_vertex_normals(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    parallel::try_collect(points.len(), progress, |x| {
        let around = at_vertex.row(x).iter();
        let sum: Vector3<f64> = around.map(|&f| doubled_normal(points, triangles[f as usize])).sum();
        sum.try_normalize(0.0).unwrap_or_default().into()
    })
}

/// Radius of the sphere about the origin on which all points lie, to 1e-5 of it; `None` if there is none. O(n).
pub(crate) fn sphere_radius(points: &[[f64; 3]]) -> Option<f64> {
    let norm = |p: &[f64; 3]| p[0].hypot(p[1]).hypot(p[2]);
    let radii = points.iter().map(norm);
    let (low, high) =
        radii.fold((f64::INFINITY, 0.0_f64), |(low, high), radius| (low.min(radius), high.max(radius)));
    // Steps of 32-bit floats and of rounded text.
    (low > 0.0 && low <= high && high.is_finite() && high - low <= 1e-5 * high).then_some(0.5 * (low + high))
}

/// Area of the surface in squared units of `points`. O(triangles).
pub fn surface_area(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    parallel::sum(triangles.len(), |f| {
        let [a, b, c] = triangles[f].map(|v| &points[v as usize]);
        triangle_area(a, b, c)
    })
}

/// Volume enclosed by a closed surface, in cubed units of `points`: `⅙ Σ a·(b × c)`, positive if normals point
/// outwards. Meaningless for an open surface. O(triangles).
///
/// ```
/// use adwave::shape::enclosed_volume;
/// let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let volume = enclosed_volume(&corner, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// assert!((volume - 1.0 / 6.0).abs() < 1e-15);
/// ```
pub fn enclosed_volume(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    // Measured from a point of the surface, because far from the origin the terms would cancel.
    let Some(origin) = points.first().map(|p| Vector3::from(*p)) else { return 0.0 };
    parallel::sum(triangles.len(), |f| {
        let [a, b, c] = triangles[f].map(|v| Vector3::from(points[v as usize]) - origin);
        a.dot(&b.cross(&c)) / 6.0
    })
}
