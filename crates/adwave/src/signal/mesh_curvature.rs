//! Curvature of a triangulated surface by cotangents and angle defects.

use super::Curvature;
use crate::parallel::{self, expect_not_cancelled};
use crate::shape::{Adjacency, MeshArea, mesh_areas, triangles_at_vertices, try_one_ring};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Largest quotient of twice the area and the squared longest side for which a triangle counts as having no area,
/// because its cotangents would be rounding.
const THIN: f64 = 1e-12;

/// Mean and Gaussian curvature at the vertices, in 1/unit and 1/unit² of `points`; always finite. O(triangles).
///
/// `2H·n = 1/(2A) Σ_y (cot α + cot β)(x − y)` with the mixed area A. H is positive where the surface bends away
/// from its normal (a sphere with outward normals). `K = (2π − Σ angles)/A`.
///
/// On the border neither is defined: a border vertex gets the mean over its inner neighbors, 0 if there are none. A
/// vertex without a triangle gets 0.
///
/// Source: `meyer2003`.
pub fn mesh_curvature(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Curvature {
    let areas = mesh_areas(points, triangles, MeshArea::MixedVoronoi);
    expect_not_cancelled(try_mesh_curvature(points, triangles, &areas, Progress::none()))
}

/// [`mesh_curvature`] from the mixed areas of the vertices; stops if the call is cancelled.
pub(crate) fn try_mesh_curvature(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    areas: &[f64],
    progress: Progress<'_>,
) -> Result<Curvature, Cancelled> {
    let n = points.len();
    let at_vertex = triangles_at_vertices(n, triangles, progress)?;
    let ring = try_one_ring(triangles, &at_vertex, progress)?;
    let vertices: Vec<VertexCurvature> = parallel::try_collect(n, progress, |x| {
        let around = at_vertex.row(x).iter().map(|&f| triangles[f as usize]);
        VertexCurvature::measure(points, x as u32, areas[x], around, ring.row(x))
    })?;
    let inner = |x: usize, value: fn(&VertexCurvature) -> f64| match vertices[x].place {
        VertexPosition::Inside => value(&vertices[x]),
        VertexPosition::Border => inner_mean(&vertices, &ring, x, value),
    };
    Ok(Curvature {
        mean: parallel::try_collect(n, progress, |x| inner(x, |v| v.mean))?,
        gaussian: parallel::try_collect(n, progress, |x| inner(x, |v| v.gaussian))?,
    })
}

#[derive(Clone, Copy, Default, PartialEq)]
enum VertexPosition {
    #[default]
    Inside,
    Border,
}

#[derive(Clone, Default)]
struct VertexCurvature {
    mean: f64,
    gaussian: f64,
    place: VertexPosition,
}

impl VertexCurvature {
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
        let place = if ring.iter().any(once) { VertexPosition::Border } else { VertexPosition::Inside };
        if area <= 0.0 {
            return Self { mean: 0.0, gaussian: 0.0, place };
        }
        let bend = bend / (2.0 * area);
        let (mean, gaussian) = (0.5 * bend.norm().copysign(bend.dot(&normal)), (TAU - angles) / area);
        // Needles with an area near the smallest double.
        let finite = |v: f64| if v.is_finite() { v } else { 0.0 };
        Self { mean: finite(mean), gaussian: finite(gaussian), place }
    }
}

fn inner_mean(
    vertices: &[VertexCurvature],
    ring: &Adjacency,
    x: usize,
    value: fn(&VertexCurvature) -> f64,
) -> f64 {
    let inner =
        ring.row(x).iter().map(|&y| &vertices[y as usize]).filter(|v| v.place == VertexPosition::Inside);
    let (sum, n) = inner.fold((0.0, 0_u32), |(sum, n), v| (sum + value(v), n + 1));
    if n > 0 { sum / f64::from(n) } else { 0.0 }
}
