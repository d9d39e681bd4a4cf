//! The closest point of a surface.

use adwave::shape::{PreparedGeometry, nearest_neighbors};
use adwave::signal::{FIT_NEIGHBORS, cloud_normals};
use adwave::vector::{add_scaled, cross, dot, norm, subtract, unit};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TrianglePointLocation};
use std::collections::HashSet;

/// How far beside the nearest point of a cloud, in spacings there, its tangent plane still stands for the surface.
const REACH: f64 = 1.5;

/// A mesh or cloud that closest points are asked of, at the welded vertices of a prepared geometry.
pub struct Surface {
    /// Lengths are divided by this before they are squared.
    unit: f64,
    kind: Kind,
}

enum Kind {
    Mesh {
        mesh: Box<TriMesh>,
        border: Border,
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
pub struct Closest {
    /// Where it is.
    pub point: [f64; 3],
    /// Unit normal of the triangle or tangent plane there, of either sign; zero on a triangle without area.
    pub normal: [f64; 3],
    /// The welded vertices that it lies between: of a cloud three times the nearest point.
    pub corners: [u32; 3],
    /// Their weights, which add up to 1.
    pub weights: [f64; 3],
    /// Whether it lies on a border: what was looked for may lie beyond it.
    pub is_border: bool,
}

impl Closest {
    /// A field of welded vertices there, by its weights.
    pub fn value(&self, field: &[f64]) -> f64 {
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * field[corner as usize]).sum()
    }
}

impl Surface {
    /// Of a mesh or cloud; `None` of a graph and of a shape without points, or a mesh without triangles is taken as its vertices. O(n log n).
    pub fn new(geometry: &PreparedGeometry) -> Option<Self> {
        let diagonal = geometry.shape().diagonal();
        let unit = if diagonal > 0.0 { diagonal.log2().floor().exp2() } else { 1.0 };
        let points: Vec<[f64; 3]> = geometry.points().iter().map(|p| p.map(|c| c / unit)).collect();
        if points.is_empty() {
            return None;
        }
        let triangles = geometry.triangles();
        let mesh =
            || TriMesh::new(points.iter().map(|&p| Vector::from(p)).collect(), triangles.to_vec()).ok();
        let found = if triangles.is_empty() { None } else { mesh() };
        let kind = if let Some(mesh) = found {
            Kind::Mesh { mesh: Box::new(mesh), border: Border::new(triangles) }
        } else {
            let near = nearest_neighbors(&points, FIT_NEIGHBORS);
            // Of the disc that so many points share.
            let share = (std::f64::consts::PI / near.k.max(1) as f64).sqrt();
            Kind::Cloud {
                tree: Box::new(ImmutableKdTree::new_from_slice(&points).ok()?),
                normals: cloud_normals(&points, &near),
                spacing: near.radius.iter().map(|r| r * share).collect(),
                points,
            }
        };
        Some(Self { unit, kind })
    }

    /// Whether there are triangles.
    pub fn is_mesh(&self) -> bool {
        matches!(self.kind, Kind::Mesh { .. })
    }

    /// The closest point to `point`: on a mesh exactly; on a cloud in the tangent plane of the nearest point where that lies
    /// beside it, else the nearest point, which then counts as the border. O(log n) as a rule.
    pub fn closest(&self, point: &[f64; 3]) -> Closest {
        let p = point.map(|c| c / self.unit);
        let found = match &self.kind {
            Kind::Mesh { mesh, border } => on_mesh(mesh, border, &p),
            Kind::Cloud { tree, points, normals, spacing } => on_cloud(tree, points, normals, spacing, &p),
        };
        Closest { point: found.point.map(|c| c * self.unit), ..found }
    }
}

fn on_mesh(mesh: &TriMesh, border: &Border, p: &[f64; 3]) -> Closest {
    let (found, (triangle, location)) = mesh.project_local_point_and_get_location(Vector::from(*p), false);
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
    Closest { point: found.point.into(), normal, corners, weights, is_border }
}

fn on_cloud(
    tree: &ImmutableKdTree<f64, 3>,
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    spacing: &[f64],
    p: &[f64; 3],
) -> Closest {
    let nearest = tree.query(p).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
    let (q, normal) = (points[nearest], normals[nearest]);
    let away = subtract(p, &q);
    let beside = add_scaled(&away, -dot(&away, &normal), &normal);
    let is_border = normal == [0.0; 3] || norm(&beside) > REACH * spacing[nearest];
    let point = if is_border { q } else { add_scaled(&q, 1.0, &beside) };
    Closest { point, normal, corners: [nearest as u32; 3], weights: [1.0, 0.0, 0.0], is_border }
}

/// The edges of one triangle only.
struct Border {
    edges: HashSet<(u32, u32)>,
    vertices: HashSet<u32>,
}

impl Border {
    fn new(triangles: &[[u32; 3]]) -> Self {
        let mut edges: Vec<(u32, u32)> =
            triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).map(sorted).collect();
        edges.sort_unstable();
        let edges: HashSet<_> =
            edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect();
        let vertices = edges.iter().flat_map(|&(a, b)| [a, b]).collect();
        Self { edges, vertices }
    }

    fn has_edge(&self, a: u32, b: u32) -> bool {
        self.edges.contains(&sorted((a, b)))
    }

    fn has_vertex(&self, x: u32) -> bool {
        self.vertices.contains(&x)
    }
}

fn sorted((a, b): (u32, u32)) -> (u32, u32) {
    (a.min(b), a.max(b))
}
