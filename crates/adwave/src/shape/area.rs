//! Area that a vertex represents on the surface.

use super::adjacency::triangles_at_vertices;
use super::{Adjacency, Neighborhoods, distance, squared_distance};
use crate::named_values;
use crate::parallel::{self, expect_not_cancelled};
use crate::rows::Pattern;
use crate::{Cancelled, Progress};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Definition of the area of a mesh vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshArea {
    /// A third of the area of the triangles at the vertex.
    #[default]
    Barycentric,
    /// The Voronoi cell within the triangles, cut at the midpoints where a triangle is obtuse (`meyer2003`). Like
    /// `Barycentric` it sums to the surface area.
    MixedVoronoi,
}

named_values!(MeshArea, "mesh area", {
    Barycentric => "barycentric", "A third of the area of the triangles at the vertex";
    MixedVoronoi => "mixed-voronoi", "The Voronoi cell within the triangles";
});

/// Definition of the area of a point of a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum CloudArea {
    /// `π·r_k²/k`, `r_k` the distance to the k-th nearest neighbor.
    #[default]
    KthNeighbor,
    /// The constant 1.
    Unit,
    /// The Voronoi cell in the best-fitting plane of the neighborhood, within the disc of radius `r_k`.
    TangentVoronoi,
}

named_values!(CloudArea, "cloud area", {
    KthNeighbor => "kth-neighbor", "The disc up to the k-th nearest neighbor, divided by k";
    Unit => "unit", "1 for every point";
    TangentVoronoi => "tangent-voronoi", "The Voronoi cell in the tangent plane";
});

/// Area of a triangle.
pub(crate) fn triangle_area(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> f64 {
    let (a, b, c) = (Vector3::from(*a), Vector3::from(*b), Vector3::from(*c));
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Areas of the vertices of a mesh, in squared units of `points`; ≥ 0, and 0 at a vertex without a triangle.
/// O(triangles).
///
/// The areas sum to the area of the surface for every definition.
///
/// ```
/// use adwave::shape::{MeshArea, mesh_areas};
/// let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
/// assert_eq!(mesh_areas(&points, &[[0, 1, 2]], MeshArea::Barycentric), [1.0; 3]);
/// ```
pub fn mesh_areas(points: &[[f64; 3]], triangles: &[[u32; 3]], kind: MeshArea) -> Vec<f64> {
    let none = Progress::none();
    let at_vertex = expect_not_cancelled(triangles_at_vertices(points.len(), triangles, none));
    expect_not_cancelled(try_mesh_areas(points, triangles, &at_vertex, kind, none))
}

/// [`mesh_areas`] from the triangles at each vertex; stops if the call is cancelled.
pub(crate) fn try_mesh_areas(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    at_vertex: &Pattern,
    kind: MeshArea,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    if kind == MeshArea::Barycentric {
        let thirds = parallel::try_collect(triangles.len(), progress, |f| {
            let [a, b, c] = triangles[f].map(|v| &points[v as usize]);
            triangle_area(a, b, c) / 3.0
        })?;
        let share = |&f: &u32| thirds[f as usize];
        return parallel::try_collect(points.len(), progress, |x| at_vertex.row(x).iter().map(share).sum());
    }
    parallel::try_collect(points.len(), progress, |x| {
        let around = at_vertex.row(x);
        let share = |(k, f): (usize, &u32)| {
            // A triangle with a repeated corner is listed once for each of them; it has no area.
            if around[..k].contains(f) {
                return 0.0;
            }
            mixed_voronoi(points, triangles[*f as usize], x as u32)
        };
        around.iter().enumerate().map(share).sum()
    })
}

/// The part of a triangle that belongs to its corner `x`.
pub(super) fn mixed_voronoi(points: &[[f64; 3]], corners: [u32; 3], x: u32) -> f64 {
    let Some(k) = corners.iter().position(|&c| c == x) else { return 0.0 };
    let [a, b, c] = [0, 1, 2].map(|i| &points[corners[(k + i) % 3] as usize]);
    let area = triangle_area(a, b, c);
    let (ab, ac, bc) = (squared_distance(a, b), squared_distance(a, c), squared_distance(b, c));
    if area == 0.0 {
        0.0
    } else if bc >= ab + ac {
        area / 2.0 // obtuse (or right) at this corner
    } else if ac >= ab + bc || ab >= ac + bc {
        area / 4.0 // obtuse at another corner
    } else {
        // ⅛(|ab|²·cot γ + |ac|²·cot β), with cot γ = (|ac|² + |bc|² − |ab|²) / 4·area at c, and likewise β at b.
        (ab * (ac + bc - ab) + ac * (ab + bc - ac)) / (32.0 * area)
    }
}

/// Areas of the points of a cloud, in squared units of `points`; > 0 unless all neighbors coincide with the point.
/// O(n k), for `TangentVoronoi` O(n k²).
///
/// # Panics
/// Unless `near` has one neighborhood per point.
pub fn cloud_areas(points: &[[f64; 3]], near: &Neighborhoods, kind: CloudArea) -> Vec<f64> {
    expect_not_cancelled(try_cloud_areas(points, near, kind, Progress::none()))
}

/// [`cloud_areas`]; stops if the call is cancelled.
pub(crate) fn try_cloud_areas(
    points: &[[f64; 3]],
    near: &Neighborhoods,
    kind: CloudArea,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let disc = |x: usize| PI * near.radius[x] * near.radius[x] / near.k.max(1) as f64;
    parallel::try_collect(points.len(), progress, |x| match kind {
        CloudArea::Unit => 1.0,
        CloudArea::KthNeighbor => disc(x),
        CloudArea::TangentVoronoi => tangent_voronoi(points, &near.adjacency, x, near.radius[x]),
    })
}

/// Number of corners of the polygon that represents the disc before bisectors cut it.
const DISC_CORNERS: usize = 24;

/// Area of the Voronoi cell of `x` among its neighbors, in their best-fitting plane through `x`, within radius `r`.
fn tangent_voronoi(points: &[[f64; 3]], near: &Adjacency, x: usize, r: f64) -> f64 {
    if r == 0.0 {
        return 0.0;
    }
    let (u, v) = tangent_plane(points, near.row(x), x, r);
    let (u, v) = (Vector3::from(u), Vector3::from(v));
    let origin = Vector3::from(points[x]);
    let offsets = near.row(x).iter().map(|&y| (Vector3::from(points[y as usize]) - origin) / r);
    let mut cell: Vec<[f64; 2]> = (0..DISC_CORNERS)
        .map(|k| {
            let angle = 2.0 * PI * k as f64 / DISC_CORNERS as f64;
            [angle.cos(), angle.sin()]
        })
        .collect();
    for d in offsets {
        let q = [d.dot(&u), d.dot(&v)];
        let half = 0.5 * (q[0] * q[0] + q[1] * q[1]);
        if half > 0.0 {
            cell = clip(&cell, q, half);
        }
    }
    let doubled: f64 = (0..cell.len())
        .map(|k| {
            let (p, q) = (cell[k], cell[(k + 1) % cell.len()]);
            p[0] * q[1] - p[1] * q[0]
        })
        .sum();
    0.5 * doubled.abs() * r * r
}

/// Two orthogonal unit vectors in the plane that fits the points `near` best; `r` is of the order of their
/// distances from `x`.
pub(crate) fn tangent_plane(points: &[[f64; 3]], near: &[u32], x: usize, r: f64) -> ([f64; 3], [f64; 3]) {
    let origin = Vector3::from(points[x]);
    let offsets = near.iter().map(|&y| (Vector3::from(points[y as usize]) - origin) / r);
    let mean = offsets.clone().sum::<Vector3<f64>>() / near.len().max(1) as f64;
    let covariance = offsets.fold(Matrix3::zeros(), |m, d| m + (d - mean) * (d - mean).transpose());
    if covariance.trace() == 0.0 {
        // All points coincide, so any plane through them will do, but not one across.
        let along = mean.try_normalize(0.0).unwrap_or_else(Vector3::x);
        let across = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
        return (along.into(), across.into());
    }
    let eigen = covariance.symmetric_eigen();
    let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let across = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    (across.into_owned().into(), normal.cross(&across).into())
}

/// The part of a convex polygon with p·q ≤ half.
fn clip(polygon: &[[f64; 2]], q: [f64; 2], half: f64) -> Vec<[f64; 2]> {
    let side = |p: &[f64; 2]| p[0] * q[0] + p[1] * q[1] - half;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, p) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let (here, there) = (side(p), side(next));
        if here <= 0.0 {
            kept.push(*p);
        }
        if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
            let t = here / (here - there);
            kept.push([p[0] + t * (next[0] - p[0]), p[1] + t * (next[1] - p[1])]);
        }
    }
    kept
}

/// Mean length of the distinct undirected edges of a symmetric neighborhood; 0 without edges.
pub(crate) fn mean_edge_length(
    points: &[[f64; 3]],
    edges: &Adjacency,
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let total = parallel::try_sum(points.len(), progress, |x| {
        let later = edges.row(x).iter().filter(|&&y| y as usize > x);
        later.map(|&y| distance(&points[x], &points[y as usize])).sum()
    })?;
    let count = edges.nnz() / 2;
    Ok(if count == 0 { 0.0 } else { total / count as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::nearest_neighbors;

    /// Sums of a few areas in double precision.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn vertex_areas_sum_to_the_area_of_the_surface() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 2.0, 0.5], [-3.0, 0.2, 1.0], [0.0, 0.0, 0.0]];
        let triangles = [[0, 1, 2], [0, 2, 3], [3, 3, 1], [0, 1, 4]];
        let total: f64 =
            triangles.iter().map(|t| triangle_area(&points[t[0]], &points[t[1]], &points[t[2]])).sum();
        let triangles = triangles.map(|t| t.map(|v| v as u32));
        for kind in [MeshArea::Barycentric, MeshArea::MixedVoronoi] {
            let sum: f64 = mesh_areas(&points, &triangles, kind).iter().sum();
            assert!((sum - total).abs() < ROUNDING * total, "{kind:?}: {sum} for {total}");
        }
    }

    #[test]
    fn the_voronoi_cell_of_a_square_grid_is_its_square() {
        let mut points = Vec::new();
        for i in 0..7 {
            for j in 0..7 {
                points.push([f64::from(i), 0.3, f64::from(j)]);
            }
        }
        let near = nearest_neighbors(&points, 10);
        let areas = cloud_areas(&points, &near, CloudArea::TangentVoronoi);
        assert!((areas[24] - 1.0).abs() < ROUNDING, "{}", areas[24]);
        let disc = cloud_areas(&points, &near, CloudArea::KthNeighbor)[24];
        assert!((disc - PI * 4.0 / 10.0).abs() < ROUNDING);
    }
}
