//! Closest points of a surface.

use adwave::shape::{PreparedGeometry, try_nearest_neighbors};
use adwave::signal::{FIT_NEIGHBORS, plane_normals};
use adwave::vector::{add_scaled, cross, dot, norm, subtract, unit};
use adwave::{BackgroundWork, Cancelled, Progress};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TrianglePointLocation};
use std::collections::HashSet;

/// Radius, in local spacings, within which the tangent plane at a point of a cloud represents the surface.
const TANGENT_RADIUS: f64 = 1.5;

/// Search structure for the closest points of a mesh or cloud, over the welded vertices of a prepared geometry.
pub struct ClosestPointSearch {
    /// Power of two by which lengths are divided, to avoid overflow of squares.
    unit: f64,
    index: SurfaceIndex,
}

enum SurfaceIndex {
    Mesh {
        mesh: Box<TriMesh>,
        border: BorderEdges,
    },
    Cloud {
        tree: Box<ImmutableKdTree<f64, 3>>,
        points: Vec<[f64; 3]>,
        normals: Vec<[f64; 3]>,
        spacing: Vec<f64>,
    },
}

/// The closest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Position.
    pub point: [f64; 3],
    /// Unit normal of the triangle or tangent plane, of either sign; zero on a degenerate triangle.
    pub normal: [f64; 3],
    /// Welded vertices of the triangle; for a cloud three times the nearest point.
    pub corners: [u32; 3],
    /// Barycentric weights, with sum 1.
    pub weights: [f64; 3],
    /// True if the point lies on a border: the query may correspond to a point beyond it.
    pub is_border: bool,
}

impl ClosestPoint {
    /// Interpolates a field of the welded vertices.
    pub fn value(&self, field: &[f64]) -> f64 {
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * field[corner as usize]).sum()
    }
}

impl ClosestPointSearch {
    /// Builds the search structure in O(n log n); `None` for a graph or a shape without points. A mesh without
    /// triangles is treated as a cloud.
    ///
    /// # Errors
    /// [`Cancelled`] on cancellation.
    pub fn new(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<Option<Self>, Cancelled> {
        let diagonal = geometry.shape().diagonal();
        let unit = if diagonal > 0.0 { diagonal.log2().floor().exp2() } else { 1.0 };
        let points: Vec<[f64; 3]> = geometry.points().iter().map(|p| p.map(|c| c / unit)).collect();
        if points.is_empty() {
            return Ok(None);
        }
        let triangles = geometry.triangles();
        let index = if let Some(mesh) = triangle_mesh(&points, triangles, progress)? {
            SurfaceIndex::Mesh { mesh: Box::new(mesh), border: BorderEdges::new(triangles) }
        } else {
            let Ok(tree) = ImmutableKdTree::new_from_slice(&points) else { return Ok(None) };
            let near = try_nearest_neighbors(&points, FIT_NEIGHBORS, progress)?;
            progress.check()?;
            // Spacing of k points that share a disk.
            let share = (std::f64::consts::PI / near.k.max(1) as f64).sqrt();
            SurfaceIndex::Cloud {
                tree: Box::new(tree),
                normals: plane_normals(&points, &near.adjacency, progress)?,
                spacing: near.radius.iter().map(|r| r * share).collect(),
                points,
            }
        };
        Ok(Some(Self { unit, index }))
    }

    /// Returns true for a mesh with triangles.
    pub fn is_mesh(&self) -> bool {
        matches!(self.index, SurfaceIndex::Mesh { .. })
    }

    /// Finds the closest point, typically in O(log n). On a mesh it is exact. On a cloud it is the projection to the
    /// tangent plane of the nearest point, if that is near enough; otherwise it is the nearest point, marked as border.
    pub fn closest(&self, point: &[f64; 3]) -> ClosestPoint {
        let p = point.map(|c| c / self.unit);
        let closest = match &self.index {
            SurfaceIndex::Mesh { mesh, border } => closest_on_mesh(mesh, border, &p),
            SurfaceIndex::Cloud { tree, points, normals, spacing } => {
                closest_on_cloud(tree, points, normals, spacing, &p)
            }
        };
        ClosestPoint { point: closest.point.map(|c| c * self.unit), ..closest }
    }
}

/// The triangles with their hierarchy; `None` if there are none. The library cannot be stopped, so it works on a thread of
/// its own.
fn triangle_mesh(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Option<TriMesh>, Cancelled> {
    if triangles.is_empty() {
        return Ok(None);
    }
    let build = || {
        let corners = points.iter().map(|&p| Vector::from(p)).collect();
        let triangles = triangles.to_vec();
        move || TriMesh::new(corners, triangles).ok()
    };
    match BackgroundWork::start(build()) {
        Some(started) => Ok(started.finish(progress)?.flatten()),
        None => Ok(build()()),
    }
}

fn closest_on_mesh(mesh: &TriMesh, border: &BorderEdges, p: &[f64; 3]) -> ClosestPoint {
    let (projection, (triangle, location)) =
        mesh.project_local_point_and_get_location(Vector::from(*p), false);
    let corners = mesh.indices()[triangle as usize];
    let at = |k: usize| -> [f64; 3] { mesh.vertices()[corners[k] as usize].into() };
    let normal = unit(&cross(&subtract(&at(1), &at(0)), &subtract(&at(2), &at(0)))).unwrap_or_default();
    let weights = location.barycentric_coordinates().unwrap_or([1.0 / 3.0; 3]);
    let is_border = match location {
        TrianglePointLocation::OnVertex(k) => border.has_vertex(corners[k as usize]),
        TrianglePointLocation::OnEdge(..) => {
            let ends: Vec<u32> = (0..3).filter(|&k| weights[k] > 0.0).map(|k| corners[k]).collect();
            matches!(ends[..], [a, b] if border.has_edge(a, b))
                || matches!(ends[..], [a] if border.has_vertex(a))
        }
        _ => false,
    };
    ClosestPoint { point: projection.point.into(), normal, corners, weights, is_border }
}

fn closest_on_cloud(
    tree: &ImmutableKdTree<f64, 3>,
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    spacing: &[f64],
    p: &[f64; 3],
) -> ClosestPoint {
    let nearest = tree.query(p).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
    let (q, normal) = (points[nearest], normals[nearest]);
    let offset = subtract(p, &q);
    let tangential = add_scaled(&offset, -dot(&offset, &normal), &normal);
    let is_border = normal == [0.0; 3] || norm(&tangential) > TANGENT_RADIUS * spacing[nearest];
    let point = if is_border { q } else { add_scaled(&q, 1.0, &tangential) };
    ClosestPoint { point, normal, corners: [nearest as u32; 3], weights: [1.0, 0.0, 0.0], is_border }
}

/// Edges with a single triangle, ascending.
fn border_edges(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let mut edges: Vec<(u32, u32)> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(sort_edge).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

/// Vertices of edges with a single triangle, ascending.
pub(crate) fn border_vertices(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut vertices: Vec<u32> = border_edges(triangles).into_iter().flat_map(|(a, b)| [a, b]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// Set of the edges with a single triangle, and set of their vertices.
struct BorderEdges {
    edges: HashSet<(u32, u32)>,
    vertices: HashSet<u32>,
}

impl BorderEdges {
    fn new(triangles: &[[u32; 3]]) -> Self {
        let edges: HashSet<_> = border_edges(triangles).into_iter().collect();
        let vertices = edges.iter().flat_map(|&(a, b)| [a, b]).collect();
        Self { edges, vertices }
    }

    fn has_edge(&self, a: u32, b: u32) -> bool {
        self.edges.contains(&sort_edge([a, b]))
    }

    fn has_vertex(&self, x: u32) -> bool {
        self.vertices.contains(&x)
    }
}

/// Orders the ends of an edge.
pub(crate) fn sort_edge([a, b]: [u32; 2]) -> (u32, u32) {
    (a.min(b), a.max(b))
}
