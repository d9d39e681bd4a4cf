//! A sphere prepared for resampling: scaled to radius 1 about its center, checked, with areas at its vertices.

use super::SphereError;
use adwave::shape::{MeshArea, mesh_areas};
use adwave::vector::{cross, dot, norm, subtract};
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

/// Share of the radius by which vertices may lie off a sphere about the origin: files round to few digits.
const ROUNDED: f64 = 1e-3;
/// Share of the radius by which vertices may lie off the best sphere about any center.
const NEARLY_ROUND: f64 = 0.01;

/// A closed mesh of triangles on a sphere, to which other spheres are registered.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    pub(super) directions: Vec<[f64; 3]>,
    /// Triangles, seen from outside in counterclockwise order but for folded ones.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) areas: Vec<f64>,
    /// Radius in the unit of the points.
    pub radius: f64,
    /// Center in the unit of the points: the origin, unless the vertices lie on a sphere about another place.
    pub center: [f64; 3],
    /// Number of triangles that lie upside down, where the sphere is folded.
    pub n_folded: usize,
}

impl Sphere {
    /// Checks a mesh and scales it to radius 1 about its center. Points within 0.1 % of a sphere about the origin have
    /// their center there; else the center is that of the best sphere by least squares, which must fit to 1 %. The
    /// areas are thirds of the triangles on the unit sphere. O(n log n).
    ///
    /// # Errors
    /// [`SphereError`] if the points are not finite or not on a sphere, or the triangles are not closed or do not cover
    /// each direction once; folds are allowed.
    ///
    /// ```
    /// use adwave_register::Sphere;
    /// let equator = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, -2.0, 0.0]];
    /// let points = [&equator[..], &[[0.0, 0.0, 2.0], [0.0, 0.0, -2.0]]].concat();
    /// let [e, n, w, s, up, down] = [0, 1, 2, 3, 4, 5];
    /// let upper = [[e, n, up], [n, w, up], [w, s, up], [s, e, up]];
    /// let lower = [[n, e, down], [w, n, down], [s, w, down], [e, s, down]];
    /// let sphere = Sphere::new(&points, &[upper, lower].concat())?;
    /// assert_eq!((sphere.radius, sphere.n_vertices(), sphere.n_folded), (2.0, 6, 0));
    /// # Ok::<(), adwave_register::SphereError>(())
    /// ```
    pub fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, SphereError> {
        let n_vertices = points.len();
        let exists = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < n_vertices);
        if triangles.is_empty() || !triangles.iter().all(exists) {
            return Err(SphereError::NoTriangles { n_vertices });
        }
        if let Some(vertex) = points.iter().position(|p| p.iter().any(|c| !c.is_finite())) {
            return Err(SphereError::NotFinite(vertex));
        }
        let (center, radius) = fit_sphere(points)?;
        let direction = |p: &[f64; 3]| {
            let offset = subtract(p, &center).map(|c| c / radius);
            let length = norm(&offset);
            offset.map(|c| c / length)
        };
        let directions: Vec<[f64; 3]> = points.iter().map(direction).collect();
        check_closed(triangles)?;
        let cover =
            triangles.iter().map(|t| solid_angle(&directions, t)).sum::<f64>() / (4.0 * std::f64::consts::PI);
        let triangles = match cover.round() as i64 {
            1 => triangles.to_vec(),
            -1 => triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
            other => return Err(SphereError::Cover(other)),
        };
        let n_folded = triangles.iter().filter(|t| volume(&directions, t) < 0.0).count();
        let areas = mesh_areas(&directions, &triangles, MeshArea::Barycentric);
        let sphere = Self { directions, triangles, areas: Vec::new(), radius, center, n_folded };
        sphere.with_areas(areas)
    }

    /// Replaces the areas at the vertices, such as those of the anatomical surface on the same mesh
    /// ([`mesh_areas`](adwave::shape::mesh_areas)), in any unit.
    ///
    /// # Errors
    /// [`SphereError::Length`] for another number of areas, [`SphereError::Area`] for one that is not positive.
    pub fn with_areas(mut self, areas: Vec<f64>) -> Result<Self, SphereError> {
        let expected = self.n_vertices();
        if areas.len() != expected {
            return Err(SphereError::Length { what: "areas", expected, found: areas.len() });
        }
        if let Some(vertex) = areas.iter().position(|area| !(*area > 0.0 && area.is_finite())) {
            return Err(SphereError::Area { vertex, area: areas[vertex] });
        }
        self.areas = areas;
        Ok(self)
    }

    /// Takes the areas of another surface with the vertices of this sphere, such as the midthickness of the cortex: a
    /// third of each triangle at each of its corners.
    ///
    /// # Errors
    /// [`SphereError::Length`] for another number of points, [`SphereError::Area`] for a vertex without area.
    pub fn with_surface(self, points: &[[f64; 3]]) -> Result<Self, SphereError> {
        let (expected, found) = (self.n_vertices(), points.len());
        if found != expected {
            return Err(SphereError::Length { what: "the surface with the areas", expected, found });
        }
        let areas = mesh_areas(points, &self.triangles, MeshArea::Barycentric);
        self.with_areas(areas)
    }

    /// Remarks on what was assumed about the sphere, for people: another center than the origin, and folds.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.center != [0.0; 3] {
            let [x, y, z] = self.center.map(|c| format!("{c:.3}"));
            remarks.push(format!("its center is taken to be at {x} {y} {z}, where the best sphere has it"));
        }
        if self.n_folded > 0 {
            let n = self.n_folded;
            remarks.push(format!(
                "{n} of its triangles lie upside down, where it is folded, and are passed over"
            ));
        }
        remarks
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.directions.len()
    }

    /// Areas at the vertices.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }
}

/// Center and radius of the points.
fn fit_sphere(points: &[[f64; 3]]) -> Result<([f64; 3], f64), SphereError> {
    let size = points.iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    let (mut least, mut most) = (0.0, 0.0);
    if size > 0.0 {
        let fitted = || fit_center(points, size);
        for (center, allowed) in [(Some([0.0; 3]), ROUNDED), (fitted(), NEARLY_ROUND)] {
            let Some(center) = center else { continue };
            let scaled = |p: &[f64; 3]| norm(&subtract(p, &center).map(|c| c / size));
            let distance = |p: &[f64; 3]| scaled(p) * size;
            let mean = points.iter().map(scaled).sum::<f64>() / points.len() as f64 * size;
            let ends = points
                .iter()
                .map(distance)
                .fold((f64::INFINITY, 0.0_f64), |(least, most), r| (least.min(r), most.max(r)));
            if mean.is_finite() && ends.0 >= (1.0 - allowed) * mean && ends.1 <= (1.0 + allowed) * mean {
                return Ok((center, mean));
            }
            if least == 0.0 {
                (least, most) = ends;
            }
        }
    }
    Err(SphereError::NoSphere { least, most })
}

/// Center of the sphere nearest to the points by least squares of ‖p‖² = 2 c·p + d; `size` scales them.
fn fit_center(points: &[[f64; 3]], size: f64) -> Option<[f64; 3]> {
    let (mut matrix, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
    for p in points {
        let row = Vector4::new(2.0 * p[0] / size, 2.0 * p[1] / size, 2.0 * p[2] / size, 1.0);
        matrix += row * row.transpose();
        right += row * p.iter().map(|c| (c / size) * (c / size)).sum::<f64>();
    }
    let solved = matrix.lu().solve(&right)?;
    let center = [solved[0] * size, solved[1] * size, solved[2] * size];
    center.iter().all(|c| c.is_finite()).then_some(center)
}

/// Refuses triangles unless each edge has two, which pass it in opposite directions.
fn check_closed(triangles: &[[u32; 3]]) -> Result<(), SphereError> {
    let directed = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let mut edges: Vec<(u32, u32, bool)> =
        triangles.iter().flat_map(directed).map(|(a, b)| (a.min(b), a.max(b), a < b)).collect();
    edges.par_sort_unstable();
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if same.len() != 2 || same[0].2 == same[1].2 || same[0].0 == same[0].1 {
            return Err(SphereError::Open(same[0].0, same[0].1));
        }
    }
    Ok(())
}

/// Six times the signed volume between a triangle and the center: positive for one that is not folded.
fn volume(directions: &[[f64; 3]], triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| directions[v as usize]);
    dot(&a, &cross(&b, &c))
}

/// Signed solid angle of a triangle, in −2π..2π.
fn solid_angle(directions: &[[f64; 3]], triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| directions[v as usize]);
    2.0 * volume(directions, triangle).atan2(1.0 + dot(&a, &b) + dot(&b, &c) + dot(&c, &a))
}
