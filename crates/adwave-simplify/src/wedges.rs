//! Preparation of a mesh for collapses: welded, triangulated, split along seams, scaled to the unit box.

use crate::appearance::{Appearance, AppearanceValues};
use crate::error::SimplifyError;
use crate::geometry::{doubled_area, length, minus};
use adwave::shape::{Mesh, Polygons, VertexMap, WeldMode, bounding_box, triangulate};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Triangles over wedges. A wedge is the set of corners at one position with equal labels. Two wedges at one position
/// form a seam; without labels there is one wedge per position.
pub(crate) struct Wedges {
    /// Coordinates of each wedge in the unit box, whose longest side is 1.
    pub(crate) points: Vec<[f64; 3]>,
    /// Number of the position of each wedge, increasing without gaps in the order of the wedges.
    pub(crate) position: Vec<u32>,
    /// First vertex of the mesh at each wedge.
    pub(crate) vertex: Vec<u32>,
    /// Triangles with a positive area, without repetitions.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Corners of the mesh's faces at each triangle.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Length of the unit box's longest side, in model units.
    pub(crate) unit: f64,
    /// Number of degenerate or repeated triangles that were removed.
    pub(crate) n_left_out: usize,
}

/// Connected parts of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Number of parts with borders; each keeps at least 3 vertices.
    pub n_open: usize,
    /// Number of parts without borders; each keeps at least 4 vertices.
    pub n_closed: usize,
}

impl Parts {
    /// Smallest number of vertices that all parts together keep.
    pub fn n_least_vertices(&self) -> usize {
        3 * self.n_open + 4 * self.n_closed
    }
}

impl Wedges {
    /// Prepares a mesh. O(corners log corners).
    pub(crate) fn new(
        mesh: &Mesh,
        appearance: Appearance<'_>,
        progress: Progress<'_>,
    ) -> Result<Self, SimplifyError> {
        let n_corners = mesh.faces().corners().len();
        if let Some(labels) = appearance.labels.filter(|labels| labels.len() != n_corners) {
            return Err(SimplifyError::Labels { found: labels.len(), n_corners });
        }
        if let Some(AppearanceValues { values, n_channels }) = appearance.values
            && (n_channels == 0 || values.len() != n_corners * n_channels)
        {
            return Err(SimplifyError::Values { found: values.len(), n_corners, n_channels });
        }
        let vertex_map = VertexMap::new(mesh.points(), WeldMode::EqualPositions);
        progress.check()?;
        let (wedge_of, vertex, position) = wedges(mesh, &vertex_map, appearance);
        progress.check()?;
        let positions: Vec<[f64; 3]> = vertex.iter().map(|&x| mesh.points()[x as usize]).collect();
        let (points, unit) = scale_to_unit_box(&positions);
        let faces = corner_triangles(mesh);
        let (triangles, corners) = select_nondegenerate(&faces, &wedge_of, &points, progress)?;
        let n_left_out = faces.len() - triangles.len();
        let mut wedges = Self { points, position, vertex, triangles, corners, unit, n_left_out };
        wedges.drop_unused();
        if wedges.triangles.is_empty() { Err(SimplifyError::NoSurface) } else { Ok(wedges) }
    }

    /// Importance of each position: the largest magnitude of the weights of its vertices, relative to the largest of
    /// all. O(n).
    pub(crate) fn importance(&self, mesh: &Mesh, weights: &[f64]) -> Result<Vec<f64>, SimplifyError> {
        let n_vertices = mesh.points().len();
        if weights.len() != n_vertices {
            return Err(SimplifyError::Weights { found: weights.len(), n_vertices });
        }
        if let Some(vertex) = weights.iter().position(|w| !w.is_finite()) {
            return Err(SimplifyError::Weight { value: weights[vertex], vertex });
        }
        let corners = mesh.faces().corners();
        let mut importance = vec![0.0_f64; self.n_positions()];
        for (&wedge, &corner) in self.triangles.as_flattened().iter().zip(self.corners.as_flattened()) {
            let of = &mut importance[self.position[wedge as usize] as usize];
            *of = of.max(weights[corners[corner as usize] as usize].abs());
        }
        let greatest = importance.iter().copied().fold(0.0, f64::max);
        if greatest > 0.0 {
            for w in &mut importance {
                *w /= greatest;
            }
        } else {
            importance.fill(1.0);
        }
        Ok(importance)
    }

    /// Number of positions.
    pub(crate) fn n_positions(&self) -> usize {
        self.position.last().map_or(0, |&last| last as usize + 1)
    }

    /// Counts the vertices of the mesh that the triangles use.
    pub(crate) fn n_vertices(&self, triangles: &[[u32; 3]]) -> usize {
        let n = self.vertex.iter().map(|&x| x as usize + 1).max().unwrap_or(0);
        let mut is_used = vec![false; n];
        for &wedge in triangles.as_flattened() {
            is_used[self.vertex[wedge as usize] as usize] = true;
        }
        is_used.into_iter().filter(|&used| used).count()
    }

    /// Numbers the charts of the triangles, the parts that are connected by edges other than seams. O(triangles log
    /// triangles).
    pub(crate) fn charts(&self) -> Vec<u32> {
        let n = self.triangles.len();
        if self.n_positions() == self.points.len() {
            return vec![0; n]; // one wedge per position: no seams
        }
        let mut edges: Vec<([u32; 2], u32)> = (0..n)
            .into_par_iter()
            .flat_map_iter(|t| {
                let [a, b, c] = self.triangles[t];
                [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], t as u32))
            })
            .collect();
        edges.par_sort_unstable();
        let mut parent: Vec<u32> = (0..n as u32).collect();
        for pair in edges.windows(2) {
            if pair[0].0 == pair[1].0 {
                let (s, t) = (root(&mut parent, pair[0].1), root(&mut parent, pair[1].1));
                parent[s.max(t) as usize] = s.min(t);
            }
        }
        (0..n as u32).map(|t| root(&mut parent, t)).collect()
    }

    /// Counts the connected parts with and without borders; a common vertex connects. O(triangles log triangles).
    pub(crate) fn count_parts(&self) -> Parts {
        let n = self.n_positions() as u32;
        let mut parent: Vec<u32> = (0..n).collect();
        let mut edges = Vec::with_capacity(3 * self.triangles.len());
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|wedge| self.position[wedge as usize]);
            for [a, b] in [[a, b], [b, c], [c, a]] {
                edges.push([a.min(b), a.max(b)]);
                let (s, t) = (root(&mut parent, a), root(&mut parent, b));
                parent[s.max(t) as usize] = s.min(t);
            }
        }
        edges.par_sort_unstable();
        let mut is_open = vec![false; n as usize];
        for edge in edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
            is_open[root(&mut parent, edge[0][0]) as usize] = true;
        }
        let mut parts = Parts::default();
        for p in (0..n).filter(|&p| parent[p as usize] == p) {
            if is_open[p as usize] {
                parts.n_open += 1;
            } else {
                parts.n_closed += 1;
            }
        }
        parts
    }

    /// Removes wedges that only degenerate faces used.
    fn drop_unused(&mut self) {
        let mut index = vec![u32::MAX; self.points.len()];
        for &wedge in self.triangles.as_flattened() {
            index[wedge as usize] = 0;
        }
        let (mut n, mut n_positions, mut last) = (0, 0, None);
        for (wedge, index) in index.iter_mut().enumerate().filter(|(_, index)| **index == 0) {
            *index = n as u32;
            self.points[n] = self.points[wedge];
            self.vertex[n] = self.vertex[wedge];
            if last != Some(self.position[wedge]) {
                last = Some(self.position[wedge]);
                n_positions += 1;
            }
            self.position[n] = n_positions - 1;
            n += 1;
        }
        self.points.truncate(n);
        self.vertex.truncate(n);
        self.position.truncate(n);
        for wedge in self.triangles.as_flattened_mut() {
            *wedge = index[*wedge as usize];
        }
    }
}

/// Assigns a wedge to every corner, and lists the first vertex and the welded vertex of every wedge.
fn wedges(mesh: &Mesh, vertex_map: &VertexMap, appearance: Appearance<'_>) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let corners = mesh.faces().corners();
    if appearance.labels.is_none() && appearance.values.is_none() {
        return wedges_at_positions(corners, vertex_map);
    }
    let key = |k: usize| {
        let position = vertex_map.welded(corners[k] as usize) as u32;
        (position, corner_label(appearance, k), corners[k], k as u32)
    };
    let mut sorted: Vec<_> = (0..corners.len()).into_par_iter().map(key).collect();
    sorted.par_sort_unstable();
    let (mut wedge_of, mut vertex, mut at) = (vec![0; corners.len()], Vec::new(), Vec::new());
    let mut last = None;
    for (position, label, x, corner) in sorted {
        if last != Some((position, label)) {
            vertex.push(x);
            at.push(position);
            last = Some((position, label));
        }
        wedge_of[corner as usize] = vertex.len() as u32 - 1;
    }
    (wedge_of, vertex, at)
}

/// Assigns a wedge to every corner, one per position.
fn wedges_at_positions(corners: &[u32], vertex_map: &VertexMap) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let mut first = vec![u32::MAX; vertex_map.n_welded()];
    for &x in corners {
        let first = &mut first[vertex_map.welded(x as usize)];
        *first = x.min(*first);
    }
    let mut wedge_at = vec![0; first.len()];
    let (mut vertex, mut at) = (Vec::new(), Vec::new());
    for (position, &x) in first.iter().enumerate().filter(|(_, x)| **x != u32::MAX) {
        wedge_at[position] = vertex.len() as u32;
        vertex.push(x);
        at.push(position as u32);
    }
    let wedge_of = corners.par_iter().map(|&x| wedge_at[vertex_map.welded(x as usize)]).collect();
    (wedge_of, vertex, at)
}

/// Number of a corner that differs for corners with different labels, and nearly always for those with different
/// values.
fn corner_label(appearance: Appearance<'_>, corner: usize) -> u64 {
    let label = u64::from(appearance.labels.map_or(0, |labels| labels[corner]));
    let Some(AppearanceValues { values, n_channels }) = appearance.values else { return label };
    // 0 and −0 are the same value.
    let row = values[corner * n_channels..][..n_channels].iter().map(|x| (x + 0.0).to_bits());
    let hash = row.fold(0_u64, |hash, x| (hash ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31));
    label << 32 | hash >> 32
}

/// Finds the root of a tree, and halves the path to it.
fn root(parent: &mut [u32], mut t: u32) -> u32 {
    while parent[t as usize] != t {
        parent[t as usize] = parent[parent[t as usize] as usize];
        t = parent[t as usize];
    }
    t
}

/// Scales positions to the box whose longest side is 1; also returns the length of that side, or 1 if all positions are
/// equal.
pub(crate) fn scale_to_unit_box(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
    let (lo, hi) = bounding_box(points).unwrap_or_default();
    let side = (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max);
    let unit = if side > 0.0 { side } else { 1.0 };
    // A reciprocal would be infinite for the smallest sides.
    let inside = points.par_iter().map(|p| std::array::from_fn(|c| (p[c] - lo[c]) / unit)).collect();
    (inside, unit)
}

/// Triangulates the faces; the triangles are triples of corner numbers.
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

/// Selects the triangles of positive area, without repetitions, as wedges and as corners.
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
