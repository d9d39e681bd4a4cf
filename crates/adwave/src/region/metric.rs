//! What regions are measured by: positions, neighbors and distances along a shape.

use super::{SurfaceSearch, stroke};
use crate::operator::Diffusion;
use crate::shape::{
    Adjacency, PreparedGeometry, squared_distance, triangles_at_vertices, try_vertex_normals,
};
use crate::{Cancelled, Progress, parallel};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::sync::{Arc, Mutex, OnceLock};

/// Along which edges distance is measured.
#[derive(Clone, Debug)]
pub enum Edges {
    /// Those between the neighbors of a diffusion operator.
    Diffusion(Arc<Diffusion>),
    /// Those of a mesh.
    Mesh(Arc<Adjacency>),
}

impl Edges {
    fn neighbors(&self) -> &Adjacency {
        match self {
            Self::Diffusion(diffusion) => diffusion.neighbors(),
            Self::Mesh(ring) => ring,
        }
    }
}

/// Distances along a shape, prepared for many regions.
///
/// What a region needs of the whole shape (a search tree over the vertices, their normals, the memory of a search) is made
/// once, by the first region that needs it; each further one costs what it covers.
#[derive(Debug)]
pub struct SurfaceMetric {
    geometry: Arc<PreparedGeometry>,
    edges: Edges,
    diagonal: f64,
    spacing: f64,
    rms_length: OnceLock<f64>,
    normals: OnceLock<Vec<[f64; 3]>>,
    tree: OnceLock<Tree>,
    searches: Mutex<Vec<SurfaceSearch>>,
}

/// The vertices as a search tree.
struct Tree(ImmutableKdTree<f64, 3>);

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tree")
    }
}

/// The welded vertices within a radius, by rising index, and the distance of each.
pub(super) struct Within {
    pub(super) vertices: Vec<u32>,
    pub(super) distances: Vec<f64>,
}

impl SurfaceMetric {
    /// The metric of a prepared shape over `edges`, in its analysis order. `diagonal` is that of the bounding box,
    /// `spacing` the mean distance of neighbors, both in model units (0 and 1 for a graph). O(1).
    pub fn new(geometry: Arc<PreparedGeometry>, edges: Edges, diagonal: f64, spacing: f64) -> Self {
        Self {
            geometry,
            edges,
            diagonal,
            spacing,
            rms_length: OnceLock::new(),
            normals: OnceLock::new(),
            tree: OnceLock::new(),
            searches: Mutex::default(),
        }
    }

    /// The prepared shape.
    pub fn geometry(&self) -> &PreparedGeometry {
        &self.geometry
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.geometry.vertex_map().n_vertices()
    }

    /// The welded vertex nearest to a point (finite, model units); `None` for a graph. O(log n), the first time O(n log n).
    pub fn nearest(&self, point: &[f64; 3]) -> Option<usize> {
        if self.geometry.points().is_empty() {
            return None;
        }
        let tree = self.tree.get_or_init(|| {
            Tree(
                ImmutableKdTree::new_from_slice(self.geometry.points())
                    .expect("the tree of finitely many finite points"),
            )
        });
        Some(tree.0.query(point).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize)
    }

    /// The vertices next to each welded vertex.
    pub(super) fn neighbors(&self) -> &Adjacency {
        self.edges.neighbors()
    }

    /// The root mean square distance of neighbors, every vertex weighing the same, in model units; 1 for a graph.
    pub(super) fn rms_length(&self, progress: Progress<'_>) -> Result<f64, Cancelled> {
        if let Some(length) = self.rms_length.get() {
            return Ok(*length);
        }
        let (points, neighbors) = (self.geometry.points(), self.neighbors());
        if points.is_empty() {
            return Ok(1.0);
        }
        let joined = (0..points.len()).filter(|&x| !neighbors.of(x).is_empty()).count().max(1);
        let squares = parallel::try_sum(points.len(), progress, |x| {
            let around = neighbors.of(x);
            let sum: f64 = around.iter().map(|&y| squared_distance(&points[x], &points[y as usize])).sum();
            sum / around.len().max(1) as f64
        })?;
        Ok(*self.rms_length.get_or_init(|| (squares / joined as f64).sqrt()))
    }

    /// The normals of the vertices; none for a cloud or a graph.
    pub(super) fn normals(&self, progress: Progress<'_>) -> Result<&[[f64; 3]], Cancelled> {
        if let Some(normals) = self.normals.get() {
            return Ok(normals);
        }
        let (points, triangles) = (self.geometry.points(), self.geometry.triangles());
        let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
        // Of two threads that come here at once one does the work for nothing.
        let normals = try_vertex_normals(points, triangles, &at_vertex, progress)?;
        Ok(self.normals.get_or_init(|| normals))
    }

    /// The vertices within `radius` of a line over the surface from place to place.
    pub(super) fn around_line(
        &self,
        path: &[[f64; 3]],
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Within, Cancelled> {
        let sources = stroke::sources(self, self.edges.neighbors(), self.spacing, path, progress)?;
        self.within(&sources, radius, progress)
    }

    /// The vertices within `radius` of the nearest of `sources` (vertex, distance it starts with).
    pub(super) fn within(
        &self,
        sources: &[(usize, f64)],
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Within, Cancelled> {
        let mut search =
            self.searches.lock().map_or_else(|_| None, |mut kept| kept.pop()).unwrap_or_default();
        let (neighbors, points) = (self.edges.neighbors(), self.geometry.points());
        let reached = search.run(neighbors, points, sources, radius, progress).map(<[u32]>::to_vec);
        let within = reached.map(|mut vertices| {
            vertices.sort_unstable();
            let distances = vertices.iter().map(|&x| search.distance(x as usize)).collect();
            Within { vertices, distances }
        });
        if let Ok(mut kept) = self.searches.lock() {
            kept.push(search);
        }
        within
    }
}
