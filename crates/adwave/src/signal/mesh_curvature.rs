//! Curvature of a triangulated surface by cotangents and angle defects.

use super::Curvature;
use crate::parallel::{self, unstopped};
use crate::shape::{Adjacency, MeshArea, triangles_at_vertices, try_mesh_areas, try_one_ring};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Twice the area over the square of the longest side below which a triangle counts as without area: its cotangents would
/// be rounding.
const THIN: f64 = 1e-12;

/// Mean and Gaussian curvature at the vertices, in 1/unit and 1/unit² of `points`; always finite. O(triangles).
///
/// `2H·n = 1/(2A) Σ_y (cot α + cot β)(x − y)` with the mixed area A; H has the sign that makes it positive where the surface
/// bends away from its normal (a sphere with normals out). `K = (2π − Σ angles)/A`.
///
/// On the border neither is defined: a border vertex takes the mean of its inner neighbors, 0 where it has none. A vertex
/// of no triangle gets 0.
///
/// Source: `meyer2003`.
pub fn mesh_curvature(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Curvature {
    unstopped(try_mesh_curvature(points, triangles, Progress::none()))
}

/// [`mesh_curvature`], stopped when the call is.
pub(crate) fn try_mesh_curvature(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Curvature, Cancelled> {
    let n = points.len();
    let at_vertex = triangles_at_vertices(n, triangles, progress)?;
    let areas = try_mesh_areas(points, triangles, &at_vertex, MeshArea::MixedVoronoi, progress)?;
    let ring = try_one_ring(triangles, &at_vertex, progress)?;
    let vertices: Vec<Vertex> = parallel::try_collect(n, progress, |x| {
        let around = at_vertex.of(x).iter().map(|&f| triangles[f as usize]);
        Vertex::measure(points, x as u32, areas[x], around, ring.of(x))
    })?;
    let inner = |x: usize, value: fn(&Vertex) -> f64| match vertices[x].place {
        Place::Inside => value(&vertices[x]),
        Place::Border => mean_of_inner(&vertices, &ring, x, value),
    };
    Ok(Curvature {
        mean: parallel::try_collect(n, progress, |x| inner(x, |v| v.mean))?,
        gaussian: parallel::try_collect(n, progress, |x| inner(x, |v| v.gaussian))?,
    })
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Place {
    #[default]
    Inside,
    Border,
}

#[derive(Clone, Default)]
struct Vertex {
    mean: f64,
    gaussian: f64,
    place: Place,
}

impl Vertex {
    fn measure(
        points: &[[f64; 3]],
        x: u32,
        area: f64,
        triangles: impl Iterator<Item = [u32; 3]>,
        ring: &[u32],
    ) -> Self {
        let here = Vector3::from(points[x as usize]);
        let (mut bend, mut normal, mut angles) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let mut seen: Vec<u32> = Vec::with_capacity(16);
        for corners in triangles {
            let Some(k) = corners.iter().position(|&c| c == x) else { continue };
            let [b, c] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
            if b == c || b == x || c == x {
                continue;
            }
            seen.extend([b, c]);
            let [b, c] = [b, c].map(|v| Vector3::from(points[v as usize]));
            let (ab, ac, bc) = (b - here, c - here, c - b);
            let cross = ab.cross(&ac);
            let doubled = cross.norm();
            let longest = ab.norm_squared().max(ac.norm_squared()).max(bc.norm_squared());
            if doubled <= THIN * longest {
                continue;
            }
            let (cot_b, cot_c) = (-ab.dot(&bc) / doubled, ac.dot(&bc) / doubled);
            bend -= cot_b * ac + cot_c * ab;
            angles += doubled.atan2(ab.dot(&ac));
            normal += cross;
        }
        let once = |y: &u32| seen.iter().filter(|&z| z == y).count() == 1;
        let place = if ring.iter().any(once) { Place::Border } else { Place::Inside };
        if area <= 0.0 {
            return Self { mean: 0.0, gaussian: 0.0, place };
        }
        let bend = bend / (2.0 * area);
        let (mean, gaussian) = (0.5 * bend.norm().copysign(bend.dot(&normal)), (TAU - angles) / area);
        // Needles of an area near the smallest double.
        let finite = |v: f64| if v.is_finite() { v } else { 0.0 };
        Self { mean: finite(mean), gaussian: finite(gaussian), place }
    }
}

fn mean_of_inner(vertices: &[Vertex], ring: &Adjacency, x: usize, value: fn(&Vertex) -> f64) -> f64 {
    let inner = ring.of(x).iter().map(|&y| &vertices[y as usize]).filter(|v| v.place == Place::Inside);
    let (sum, n) = inner.fold((0.0, 0_u32), |(sum, n), v| (sum + value(v), n + 1));
    if n > 0 { sum / f64::from(n) } else { 0.0 }
}
