//! Preparation of a mesh for collapses: welded, triangulated, split along seams, scaled to the unit box.

use crate::SimplifyError;
use adwave::shape::{Mesh, Polygons, VertexMap, WeldMode, bounding_box, triangulate};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Triangles over wedges. A wedge is the set of corners at one position with the same label. Two wedges at one position
/// form a seam; without labels there is one wedge per position.
pub(crate) struct Wedges {
    /// Position of each wedge in the unit box, whose longest side is 1.
    pub(crate) points: Vec<[f64; 3]>,
    /// First vertex of the mesh at each wedge.
    pub(crate) vertex: Vec<u32>,
    /// Triangles with a positive area, without repetitions.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Corners of the mesh's faces at each triangle.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Length of the unit in model units.
    pub(crate) unit: f64,
    /// Number of degenerate or repeated triangles that were removed.
    pub(crate) n_left_out: usize,
}

impl Wedges {
    /// Prepares a mesh; `labels`, if given, has one value per corner of its faces. O(corners log corners).
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
        let positions: Vec<[f64; 3]> = vertex.iter().map(|&x| mesh.points()[x as usize]).collect();
        let (points, unit) = scale_to_unit_box(&positions);
        let faces = corner_triangles(mesh);
        let (triangles, corners) = select_nondegenerate(&faces, &wedge_of, &points, progress)?;
        let n_left_out = faces.len() - triangles.len();
        let mut wedges = Self { points, vertex, triangles, corners, unit, n_left_out };
        wedges.drop_unused();
        if wedges.triangles.is_empty() { Err(SimplifyError::NoSurface) } else { Ok(wedges) }
    }

    /// Counts the vertices of the mesh that triangles use.
    pub(crate) fn n_vertices(&self, triangles: &[[u32; 3]]) -> usize {
        let mut vertices: Vec<u32> =
            triangles.as_flattened().iter().map(|&wedge| self.vertex[wedge as usize]).collect();
        vertices.par_sort_unstable();
        vertices.dedup();
        vertices.len()
    }

    /// Removes wedges that only degenerate faces used.
    fn drop_unused(&mut self) {
        let mut index = vec![u32::MAX; self.points.len()];
        for &wedge in self.triangles.as_flattened() {
            index[wedge as usize] = 0;
        }
        let mut n = 0;
        for (wedge, index) in index.iter_mut().enumerate().filter(|(_, index)| **index == 0) {
            *index = n as u32;
            self.points[n] = self.points[wedge];
            self.vertex[n] = self.vertex[wedge];
            n += 1;
        }
        self.points.truncate(n);
        self.vertex.truncate(n);
        for wedge in self.triangles.as_flattened_mut() {
            *wedge = index[*wedge as usize];
        }
    }
}

/// Assigns a wedge to every corner, and lists the first vertex of every wedge.
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

/// Scales positions to the box whose longest side is 1; returns the length of that side, 1 if all positions are equal.
pub(crate) fn scale_to_unit_box(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
    let (lo, hi) = bounding_box(points).unwrap_or_default();
    let side = (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max);
    let unit = if side > 0.0 { side } else { 1.0 };
    // A reciprocal would be infinite for the smallest sides.
    let inside = points.par_iter().map(|p| std::array::from_fn(|c| (p[c] - lo[c]) / unit)).collect();
    (inside, unit)
}

/// Triangulates the faces; triangles are triples of corners of the faces.
fn corner_triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let faces = mesh.faces();
    let n = faces.corners().len() as u32;
    if faces.triangles().is_some() {
        return (0..n / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    }
    let points: Vec<[f64; 3]> = faces.corners().iter().map(|&x| mesh.points()[x as usize]).collect();
    let mut corner_faces = Polygons::with_capacity(faces.len(), n as usize);
    let mut first = 0;
    for face in faces.iter() {
        let next = first + face.len() as u32;
        corner_faces.push(&(first..next).collect::<Vec<_>>());
        first = next;
    }
    triangulate(&points, &corner_faces)
}

/// Selects the triangles over wedges with a positive area, without repetitions, and their corners.
#[expect(clippy::type_complexity, reason = "two lists of the same triangles")]
fn select_nondegenerate(
    faces: &[[u32; 3]],
    wedge_of: &[u32],
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<(Vec<[u32; 3]>, Vec<[u32; 3]>), Cancelled> {
    let mut named: Vec<([u32; 3], u32)> = faces
        .par_iter()
        .enumerate()
        .map(|(t, corners)| (corners.map(|k| wedge_of[k as usize]), t as u32))
        .filter(|(triangle, _)| has_area(triangle.map(|w| points[w as usize])))
        .map(|(triangle, t)| (rotate_to_smallest(triangle), t))
        .collect();
    progress.check()?;
    named.par_sort_unstable();
    named.dedup_by_key(|(triangle, _)| *triangle);
    named.par_sort_unstable_by_key(|&(_, t)| t);
    progress.check()?;
    let corners: Vec<[u32; 3]> = named.iter().map(|&(_, t)| faces[t as usize]).collect();
    let triangles = corners.iter().map(|corners| corners.map(|k| wedge_of[k as usize])).collect();
    Ok((triangles, corners))
}

/// Smallest doubled area relative to the squared longest side; thinner triangles have no reliable normal.
const MIN_RELATIVE_AREA: f64 = 1e-14;

fn has_area([a, b, c]: [[f64; 3]; 3]) -> bool {
    let (u, v) = (minus(b, a), minus(c, a));
    let longest = length(u).max(length(v)).max(length(minus(c, b)));
    doubled_area([a, b, c]) > MIN_RELATIVE_AREA * longest * longest
}

/// Rotates a triangle to begin at its smallest wedge, with the same orientation.
pub(crate) fn rotate_to_smallest([a, b, c]: [u32; 3]) -> [u32; 3] {
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or([a, b, c])
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// `(b − a) × (c − a)`, whose length is twice the area.
pub(crate) fn doubled_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (u, v) = (minus(b, a), minus(c, a));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(crate) fn doubled_area(triangle: [[f64; 3]; 3]) -> f64 {
    length(doubled_normal(triangle))
}
