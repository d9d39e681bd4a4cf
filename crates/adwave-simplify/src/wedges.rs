//! A mesh made ready for collapses: welded, cut into triangles, split along seams, in the unit box.

use crate::SimplifyError;
use adwave::shape::{Mesh, Polygons, VertexMap, WeldMode, bounding_box, triangulate};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Triangles over wedges. A wedge is what the corners at one position have in common: all of them where no labels are given,
/// else those of one label. Where two labels meet there are two wedges at a position, which is a seam.
pub(crate) struct Wedges {
    /// The position of each wedge in the unit box, longest side 1.
    pub(crate) points: Vec<[f64; 3]>,
    /// The first vertex of the mesh at each wedge.
    pub(crate) vertex: Vec<u32>,
    /// The triangles that have an area, each once.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Which corners of the mesh's faces each triangle has.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Model units in a side of the unit box.
    pub(crate) unit: f64,
    /// How many faces were left out: without area, or the same as another.
    pub(crate) n_left_out: usize,
}

impl Wedges {
    /// Prepares a mesh; `labels` are one per corner of its faces or none at all. O(corners log corners).
    pub(crate) fn new(
        mesh: &Mesh,
        labels: Option<&[u32]>,
        progress: Progress<'_>,
    ) -> Result<Self, SimplifyError> {
        let n_corners = mesh.faces().corners().len();
        if let Some(labels) = labels.filter(|labels| labels.len() != n_corners) {
            return Err(SimplifyError::Labels { found: labels.len(), n_corners });
        }
        let vertex_map = VertexMap::new(mesh.points(), WeldMode::EqualPositions);
        progress.check()?;
        let (wedge_of, vertex) = wedges(mesh, &vertex_map, labels);
        progress.check()?;
        let own: Vec<[f64; 3]> = vertex.iter().map(|&x| mesh.points()[x as usize]).collect();
        let (points, unit) = in_unit_box(&own);
        let cut = corner_triangles(mesh);
        let (triangles, corners) = with_area(&cut, &wedge_of, &points, progress)?;
        let n_left_out = cut.len() - triangles.len();
        let mut wedges = Self { points, vertex, triangles, corners, unit, n_left_out };
        wedges.drop_unused();
        if wedges.triangles.is_empty() { Err(SimplifyError::NoSurface) } else { Ok(wedges) }
    }

    /// How many vertices of the mesh these triangles have.
    pub(crate) fn n_vertices(&self, triangles: &[[u32; 3]]) -> usize {
        let mut vertices: Vec<u32> =
            triangles.as_flattened().iter().map(|&wedge| self.vertex[wedge as usize]).collect();
        vertices.par_sort_unstable();
        vertices.dedup();
        vertices.len()
    }

    /// Takes away wedges that only faces without area had.
    fn drop_unused(&mut self) {
        let mut place = vec![u32::MAX; self.points.len()];
        for &wedge in self.triangles.as_flattened() {
            place[wedge as usize] = 0;
        }
        let mut n = 0;
        for (wedge, place) in place.iter_mut().enumerate().filter(|(_, place)| **place == 0) {
            *place = n as u32;
            self.points[n] = self.points[wedge];
            self.vertex[n] = self.vertex[wedge];
            n += 1;
        }
        self.points.truncate(n);
        self.vertex.truncate(n);
        for wedge in self.triangles.as_flattened_mut() {
            *wedge = place[*wedge as usize];
        }
    }
}

/// The wedge of every corner, and the first vertex of every wedge.
fn wedges(mesh: &Mesh, vertex_map: &VertexMap, labels: Option<&[u32]>) -> (Vec<u32>, Vec<u32>) {
    let corners = mesh.faces().corners();
    let key = |k: usize| {
        let label = labels.map_or(0, |labels| labels[k]);
        (vertex_map.welded(corners[k] as usize) as u32, label, corners[k], k as u32)
    };
    let mut sorted: Vec<_> = (0..corners.len()).into_par_iter().map(key).collect();
    sorted.par_sort_unstable();
    let (mut wedge_of, mut vertex) = (vec![0; corners.len()], Vec::new());
    let mut last = None;
    for (position, label, x, corner) in sorted {
        if last != Some((position, label)) {
            vertex.push(x);
            last = Some((position, label));
        }
        wedge_of[corner as usize] = vertex.len() as u32 - 1;
    }
    (wedge_of, vertex)
}

/// Positions in the box whose longest side is 1, and the length of that side; 1 where all are one.
pub(crate) fn in_unit_box(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
    let (lo, hi) = bounding_box(points).unwrap_or_default();
    let side = (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max);
    let unit = if side > 0.0 { side } else { 1.0 };
    // Divided, not multiplied by a reciprocal, which is infinite for the smallest sides.
    let inside = points.par_iter().map(|p| std::array::from_fn(|c| (p[c] - lo[c]) / unit)).collect();
    (inside, unit)
}

/// Triangles whose corners are corners of the mesh's faces.
fn corner_triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let faces = mesh.faces();
    let n = faces.corners().len() as u32;
    if faces.triangles().is_some() {
        return (0..n / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    }
    let points: Vec<[f64; 3]> = faces.corners().iter().map(|&x| mesh.points()[x as usize]).collect();
    let mut own = Polygons::with_capacity(faces.len(), n as usize);
    let mut first = 0;
    for face in faces.iter() {
        let next = first + face.len() as u32;
        own.push(&(first..next).collect::<Vec<_>>());
        first = next;
    }
    triangulate(&points, &own)
}

/// The triangles over wedges that have an area, each once, and the corners of each.
#[expect(clippy::type_complexity, reason = "two lists of the same triangles")]
fn with_area(
    cut: &[[u32; 3]],
    wedge_of: &[u32],
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<(Vec<[u32; 3]>, Vec<[u32; 3]>), Cancelled> {
    let mut named: Vec<([u32; 3], u32)> = cut
        .par_iter()
        .enumerate()
        .map(|(t, corners)| (corners.map(|k| wedge_of[k as usize]), t as u32))
        .filter(|(triangle, _)| has_area(triangle.map(|w| points[w as usize])))
        .map(|(triangle, t)| (smallest_first(triangle), t))
        .collect();
    progress.check()?;
    named.par_sort_unstable();
    named.dedup_by_key(|(triangle, _)| *triangle);
    named.par_sort_unstable_by_key(|&(_, t)| t);
    progress.check()?;
    let corners: Vec<[u32; 3]> = named.iter().map(|&(_, t)| cut[t as usize]).collect();
    let triangles = corners.iter().map(|corners| corners.map(|k| wedge_of[k as usize])).collect();
    Ok((triangles, corners))
}

/// Triangles thinner than rounding leaves them have no normal and no nearest place: this times the longest side squared.
const LEAST_AREA: f64 = 1e-14;

fn has_area([a, b, c]: [[f64; 3]; 3]) -> bool {
    let (u, v) = (minus(b, a), minus(c, a));
    let longest = length(u).max(length(v)).max(length(minus(c, b)));
    doubled_area([a, b, c]) > LEAST_AREA * longest * longest
}

/// The same triangle, run through the same way round, from its smallest wedge.
pub(crate) fn smallest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or([a, b, c])
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// `(b − a) × (c − a)`, twice the area long.
pub(crate) fn doubled_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (u, v) = (minus(b, a), minus(c, a));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(crate) fn doubled_area(triangle: [[f64; 3]; 3]) -> f64 {
    length(doubled_normal(triangle))
}
