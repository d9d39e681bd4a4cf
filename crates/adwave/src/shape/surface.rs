//! Normals, area and volume of a triangulated surface.

use super::adjacency::triangles_at_vertices;
use super::area::triangle_area;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Twice the area of a triangle times its unit normal.
fn doubled_normal(points: &[[f64; 3]], corners: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners.map(|v| Vector3::from(points[v as usize]));
    (b - a).cross(&(c - a))
}

/// Unit normals of the triangles, by the right-hand rule; zero where a triangle has no area. O(triangles).
pub fn face_normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    triangles
        .par_iter()
        .map(|&t| doubled_normal(points, t).try_normalize(0.0).unwrap_or_default().into())
        .collect()
}

/// Unit normals of the vertices: the area-weighted mean of the triangles' normals; zero where that vanishes or where a
/// vertex has no triangle. O(triangles).
///
/// ```
/// use adwave::shape::vertex_normals;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]];
/// assert_eq!(vertex_normals(&points, &[[0, 1, 2]]), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3]]);
/// ```
pub fn vertex_normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let (offsets, at_vertex) = triangles_at_vertices(points.len(), triangles);
    (0..points.len())
        .into_par_iter()
        .map(|x| {
            let sum: Vector3<f64> = at_vertex[offsets[x]..offsets[x + 1]]
                .iter()
                .map(|&f| doubled_normal(points, triangles[f as usize]))
                .sum();
            sum.try_normalize(0.0).unwrap_or_default().into()
        })
        .collect()
}

/// Area of the surface in squared units of `points`. O(triangles).
pub fn surface_area(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    crate::parallel::sum(triangles.len(), |f| {
        let [a, b, c] = triangles[f].map(|v| &points[v as usize]);
        triangle_area(a, b, c)
    })
}

/// Volume that a closed surface encloses, in cubed units of `points`: `⅙ Σ a·(b × c)`, positive where normals point out.
/// Without meaning on an open surface. O(triangles).
///
/// ```
/// use adwave::shape::enclosed_volume;
/// let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let volume = enclosed_volume(&corner, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// assert!((volume - 1.0 / 6.0).abs() < 1e-15);
/// ```
pub fn enclosed_volume(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    // Measured from a point of the surface: far from the origin the terms would cancel.
    let Some(origin) = points.first().map(|p| Vector3::from(*p)) else { return 0.0 };
    crate::parallel::sum(triangles.len(), |f| {
        let [a, b, c] = triangles[f].map(|v| Vector3::from(points[v as usize]) - origin);
        a.dot(&b.cross(&c)) / 6.0
    })
}
