//! What is unusual about a shape: counts that explain a surprising result.

use super::{
    Adjacency, MAX_COORDINATE, PreparedGeometry, Shape, enclosed_volume, n_components, surface_area,
};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Counts of what a mesh, cloud or graph consists of and of what may be wrong with it.
///
/// Edges, components and isolated vertices are counted after welding.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Vertices, points or nodes of the shape.
    pub n_vertices: usize,
    /// Faces of the shape.
    pub n_faces: usize,
    /// Faces of more than three corners.
    pub n_polygons: usize,
    /// Distinct undirected edges of faces, of the neighbour graph, or of the graph.
    pub n_edges: usize,
    /// Connected components of these edges, a vertex without edges being one by itself.
    pub n_components: usize,
    /// Edges of one face only.
    pub n_boundary_edges: usize,
    /// Edges of three faces or more.
    pub n_non_manifold_edges: usize,
    /// Edges that two faces run through in the same direction: their normals disagree.
    pub n_misoriented_edges: usize,
    /// Faces without area, up to rounding.
    pub n_zero_area_faces: usize,
    /// Faces with the same vertices as an earlier face.
    pub n_repeated_faces: usize,
    /// Vertices at the position of an earlier vertex.
    pub n_welded: usize,
    /// Vertices of the analysis without neighbours: they keep their value in every band.
    pub n_isolated: usize,
    /// Vertices of no face.
    pub n_unreferenced: usize,
    /// Surface area in squared model units; 0 without faces.
    pub area: f64,
    /// Enclosed volume in cubed model units, where every edge has two faces that agree on the orientation.
    pub volume: Option<f64>,
    /// Euler characteristic V − E + F of the welded mesh without unreferenced vertices; `None` without faces.
    pub euler_characteristic: Option<i64>,
}

/// Counts what `shape` consists of, given its [`PreparedGeometry`] and the neighbours that its walk steps to. O(n log n).
pub fn health(shape: &Shape, geometry: &PreparedGeometry, neighbours: &Adjacency) -> Health {
    let mut health = Health {
        n_vertices: shape.n_vertices(),
        n_faces: 0,
        n_polygons: 0,
        n_edges: neighbours.neighbours.len() / 2,
        n_components: n_components(neighbours),
        n_boundary_edges: 0,
        n_non_manifold_edges: 0,
        n_misoriented_edges: 0,
        n_zero_area_faces: 0,
        n_repeated_faces: 0,
        n_welded: shape.n_vertices() - geometry.n_vertices(),
        n_isolated: (0..geometry.n_vertices()).filter(|&x| neighbours.of(x).is_empty()).count(),
        n_unreferenced: 0,
        area: 0.0,
        volume: None,
        euler_characteristic: None,
    };
    let Shape::Mesh(mesh) = shape else { return health };
    debug_assert!(mesh.points().iter().flatten().all(|c| c.abs() <= MAX_COORDINATE));
    let faces = mesh.faces();
    health.n_faces = faces.len();
    health.n_polygons = faces.iter().filter(|f| f.len() > 3).count();

    let mut referenced = vec![false; mesh.points().len()];
    for &corner in faces.corners() {
        referenced[corner as usize] = true;
    }
    health.n_unreferenced = referenced.iter().filter(|&&r| !r).count();

    let class = |corner: u32| geometry.vertex_map.welded(corner as usize) as u32;
    health.n_zero_area_faces = (0..faces.len())
        .into_par_iter()
        .filter(|&f| has_no_area(faces.get(f).iter().map(|&c| &mesh.points()[c as usize])))
        .count();

    let mut corner_sets: Vec<Vec<u32>> = faces
        .iter()
        .map(|face| {
            let mut corners: Vec<u32> = face.iter().map(|&c| class(c)).collect();
            corners.sort_unstable();
            corners
        })
        .collect();
    corner_sets.par_sort_unstable();
    health.n_repeated_faces = corner_sets.windows(2).filter(|pair| pair[0] == pair[1]).count();
    drop(corner_sets);

    // Every edge of every face as (smaller end, larger end, runs upwards).
    let mut half_edges: Vec<(u32, u32, bool)> = Vec::with_capacity(faces.corners().len());
    for face in faces.iter().filter(|f| f.len() > 2) {
        for k in 0..face.len() {
            let (a, b) = (class(face[k]), class(face[(k + 1) % face.len()]));
            if a != b {
                half_edges.push((a.min(b), a.max(b), a < b));
            }
        }
    }
    half_edges.par_sort_unstable();
    let mut n_edges = 0_usize;
    for edge in half_edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        n_edges += 1;
        match edge {
            [_] => health.n_boundary_edges += 1,
            [e, f] => health.n_misoriented_edges += usize::from(e.2 == f.2),
            _ => health.n_non_manifold_edges += 1,
        }
    }
    health.n_edges = n_edges;

    health.area = surface_area(&geometry.points, &geometry.triangles);
    let closed = health.n_boundary_edges == 0 && health.n_non_manifold_edges == 0 && !half_edges.is_empty();
    if closed && health.n_misoriented_edges == 0 {
        health.volume = Some(enclosed_volume(&geometry.points, &geometry.triangles));
    }
    if !faces.is_empty() {
        let mut used = vec![false; geometry.n_vertices()];
        for &corner in faces.corners() {
            used[class(corner) as usize] = true;
        }
        let n_used = used.iter().filter(|&&u| u).count();
        health.euler_characteristic = Some(n_used as i64 - n_edges as i64 + faces.len() as i64);
    }
    health
}

/// Whether the corners of a face span no area beyond rounding (or are fewer than three).
fn has_no_area<'a>(corners: impl ExactSizeIterator<Item = &'a [f64; 3]> + Clone) -> bool {
    let count = corners.len();
    let Some(first) = corners.clone().next().filter(|_| count > 2) else { return true };
    let origin = Vector3::from(*first);
    let around = corners.map(|p| Vector3::from(*p) - origin);
    let size = around.clone().map(|d| d.amax()).fold(0.0, f64::max);
    if size == 0.0 {
        return true;
    }
    let around: Vec<_> = around.map(|d| d / size).collect();
    let newell: Vector3<f64> = (0..count).map(|k| around[k].cross(&around[(k + 1) % count])).sum();
    newell.norm() <= 4.0 * f64::EPSILON * count as f64
}

impl Health {
    /// Whether every edge has exactly two faces.
    pub fn is_closed(&self) -> bool {
        self.n_faces > 0 && self.n_boundary_edges == 0 && self.n_non_manifold_edges == 0
    }
}
