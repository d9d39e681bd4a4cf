//! Triangles of a mesh as nodes of a graph: adjacency, areas, centroids, normals.

use super::{FaceNeighbors, NormalFilterError};
use adwave::shape::PreparedGeometry;
use adwave::vector::{Vector, cross, norm, subtract, unit};
use rayon::prelude::*;

/// Largest number of faces at a vertex; it is limited because each face lists all faces that share a vertex with it.
const MAX_FACES_AT_VERTEX: usize = 500;
/// Largest number of neighbors of a face within a radius; the nearest rings are kept.
const MAX_WITHIN: usize = 500;

/// Lists of faces, stored one after another.
#[derive(Debug)]
pub(super) struct FaceLists {
    ends: Vec<usize>,
    items: Vec<u32>,
}

impl FaceLists {
    fn new(lists: Vec<Vec<u32>>) -> Self {
        let mut end = 0;
        let ends = lists.iter().map(|list| {
            end += list.len();
            end
        });
        Self { ends: ends.collect(), items: lists.into_iter().flatten().collect() }
    }

    pub(super) fn list(&self, f: usize) -> &[u32] {
        let start = if f == 0 { 0 } else { self.ends[f - 1] };
        &self.items[start..self.ends[f]]
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }
}

/// Triangles with their neighbors; positions may change, neighbors do not.
#[derive(Debug)]
pub(super) struct Faces<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    /// Faces at each vertex, in ascending order, each once.
    pub(super) at_vertex: FaceLists,
}

/// Area, centroid and normal of each face at given positions.
#[derive(Debug)]
pub(super) struct FaceGeometry {
    pub(super) areas: Vec<f64>,
    pub(super) centroids: Vec<Vector>,
    /// Unit normals; zero for faces without area.
    pub(super) normals: Vec<Vector>,
}

impl<'a> Faces<'a> {
    pub(super) fn new(geometry: &'a PreparedGeometry) -> Result<Self, NormalFilterError> {
        let triangles = geometry.triangles();
        if triangles.is_empty() {
            return Err(NormalFilterError::NotAMesh);
        }
        let mut at_vertex = vec![Vec::new(); geometry.n_vertices()];
        for (f, corners) in (0_u32..).zip(triangles) {
            for &v in corners {
                let here: &mut Vec<u32> = &mut at_vertex[v as usize];
                if here.last() != Some(&f) {
                    here.push(f);
                }
            }
        }
        if let Some(welded) = at_vertex.iter().position(|here| here.len() > MAX_FACES_AT_VERTEX) {
            let map = geometry.vertex_map();
            let vertex = (0..map.n_vertices()).find(|&x| map.welded(x) == welded).unwrap_or(welded);
            let (n_faces, most) = (at_vertex[welded].len(), MAX_FACES_AT_VERTEX);
            return Err(NormalFilterError::TooManyFaces { vertex, n_faces, most });
        }
        Ok(Self { triangles, at_vertex: FaceLists::new(at_vertex) })
    }

    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Computes areas, centroids and normals of the faces at the given positions.
    pub(super) fn measure(&self, points: &[Vector]) -> FaceGeometry {
        let geometry_of_triangle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            let doubled = cross(&subtract(&b, &a), &subtract(&c, &a));
            let centroid: Vector = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
            (0.5 * norm(&doubled), (centroid, unit(&doubled).unwrap_or_default()))
        };
        let (areas, (centroids, normals)) = self.triangles.par_iter().map(geometry_of_triangle).unzip();
        FaceGeometry { areas, centroids, normals }
    }

    /// Lists the neighbors of each face in ascending order, without the face itself. The relation is symmetric.
    pub(super) fn neighbors(&self, kind: FaceNeighbors) -> FaceLists {
        FaceLists::new((0..self.len()).into_par_iter().map(|f| self.neighbors_of(f, kind)).collect())
    }

    fn neighbors_of(&self, f: usize, kind: FaceNeighbors) -> Vec<u32> {
        let corners = self.triangles[f];
        let mut found: Vec<u32> =
            corners.iter().flat_map(|&v| self.at_vertex.list(v as usize)).copied().collect();
        found.sort_unstable();
        found.dedup();
        let shared = |g: u32| {
            let mut other = self.triangles[g as usize];
            other.sort_unstable();
            (0..3).filter(|&k| (k == 0 || other[k] != other[k - 1]) && corners.contains(&other[k])).count()
        };
        found.retain(|&g| g as usize != f && (kind == FaceNeighbors::ByVertex || shared(g) >= 2));
        found
    }

    /// Lists, for each face, the face itself and the faces around it whose centroids are within `radius` of its own.
    /// They are found by walking over shared vertices, at most [`MAX_WITHIN`].
    pub(super) fn faces_within_radius(
        &self,
        radius: f64,
        centroids: &[Vector],
        neighbors: &FaceLists,
    ) -> FaceLists {
        let faces_around = |f: usize| {
            let (mut inside, mut seen, mut next) = (vec![f as u32], vec![f as u32], 0);
            while next < inside.len() && inside.len() < MAX_WITHIN {
                for &g in neighbors.list(inside[next] as usize) {
                    if seen.contains(&g) {
                        continue;
                    }
                    seen.push(g);
                    if norm(&subtract(&centroids[g as usize], &centroids[f])) <= radius {
                        inside.push(g);
                    }
                }
                next += 1;
            }
            inside.truncate(MAX_WITHIN);
            inside
        };
        FaceLists::new((0..self.len()).into_par_iter().map(faces_around).collect())
    }

    /// Lists the pairs of faces across each edge; an edge with more than two faces pairs each face with the next by
    /// index.
    pub(super) fn pairs_across_edges(&self) -> Vec<[u32; 2]> {
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.len());
        for (f, t) in (0_u32..).zip(self.triangles) {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                if a != b {
                    sides.push(([a.min(b), a.max(b)], f));
                }
            }
        }
        sides.par_sort_unstable();
        sides.dedup();
        sides.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| [w[0].1, w[1].1]).collect()
    }

    /// Marks the vertices at an edge with a single face.
    pub(super) fn border_vertices(&self, n_vertices: usize) -> Vec<bool> {
        let mut sides: Vec<[u32; 2]> = self
            .triangles
            .iter()
            .flat_map(|t| (0..3).map(|k| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])]))
            .collect();
        sides.par_sort_unstable();
        let mut border = vec![false; n_vertices];
        for side in sides.chunk_by(|a, b| a == b).filter(|equal| equal.len() == 1) {
            border[side[0][0] as usize] = true;
            border[side[0][1] as usize] = true;
        }
        border
    }
}

/// Mean distance between the centroids across edges; 1 if the mean is 0, so that it can be a divisor.
pub(super) fn mean_distance(across: &[[u32; 2]], centroids: &[Vector]) -> f64 {
    let distance = |&[f, g]: &[u32; 2]| norm(&subtract(&centroids[f as usize], &centroids[g as usize]));
    let mean = across.iter().map(distance).sum::<f64>() / across.len().max(1) as f64;
    if mean > 0.0 { mean } else { 1.0 }
}

/// Computes `e^(−d²/2σ²)` for the distance d between `a` and `b`.
pub(super) fn gaussian(a: &Vector, b: &Vector, sigma: f64) -> f64 {
    let d = norm(&subtract(a, b)) / sigma;
    (-0.5 * d * d).exp()
}

/// Widths of the two weights of a bilateral filter: for the distance of centroids, and for the distance of unit
/// vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct BilateralWidths {
    pub(super) space: f64,
    pub(super) range: f64,
}

/// Computes `n_f ← unit(Σ_g A_g · W(c_f − c_g) · W(u_f − u_g) · n_g)` over the neighbors g, where u are the vectors
/// `compared`. A normal does not change if the sum vanishes.
pub(super) fn filter_normals(
    measures: &FaceGeometry,
    normals: &[Vector],
    compared: &[Vector],
    neighbors: &FaceLists,
    widths: BilateralWidths,
) -> Vec<Vector> {
    let filter_at = |f: usize| {
        let mut sum = [0.0; 3];
        for &g in neighbors.list(f) {
            let g = g as usize;
            let weight = measures.areas[g]
                * gaussian(&measures.centroids[f], &measures.centroids[g], widths.space)
                * gaussian(&compared[f], &compared[g], widths.range);
            sum = adwave::vector::add_scaled(&sum, weight, &normals[g]);
        }
        unit(&sum).unwrap_or(normals[f])
    };
    (0..neighbors.len()).into_par_iter().map(filter_at).collect()
}
