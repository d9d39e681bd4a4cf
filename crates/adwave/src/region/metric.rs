//! Positions, neighbors and distances along a shape, by which regions are measured.

use super::front::{Corners, FrontSearch, FrontSource, SourceExtent};
use super::place::SurfacePlace;
use super::{SurfaceSearch, stroke};
use crate::domain::{Domain, stated_neighbors};
use crate::mask::Mask;
use crate::operator::Diffusion;
use crate::shape::{Adjacency, PreparedGeometry, VertexMap, distance, squared_distance};
use crate::{Cancelled, Progress, parallel};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::sync::{Arc, Mutex, OnceLock};

/// Edges along which distance is measured: between the neighbors that a domain states, such as those of a mesh, or else
/// between those of a diffusion operator.
#[derive(Debug)]
pub(crate) struct MetricEdges {
    /// Neighbors that the domain states, listed when they are first needed: those of a volume take more memory than the
    /// volume.
    pub(crate) stated: Arc<OnceLock<Adjacency>>,
    /// Places that are left out of them.
    pub(crate) mask: Option<Arc<Mask>>,
    /// Rows with an entry for each neighbor, if the domain may state none.
    pub(crate) rows: Option<Arc<Diffusion>>,
}

/// Distances along a shape, prepared for many regions: over the triangles of a mesh, along edges elsewhere.
///
/// Data of the whole shape that a region needs (a search tree over the vertices, their normals, the memory of a
/// search) are built by the first region that needs them; each further region costs what it covers.
#[derive(Debug)]
pub struct SurfaceMetric {
    domain: Arc<dyn Domain>,
    edges: MetricEdges,
    diagonal: f64,
    spacing: f64,
    rms_length: OnceLock<f64>,
    normals: OnceLock<Vec<[f64; 3]>>,
    tree: OnceLock<VertexTree>,
    corners: OnceLock<Corners>,
    searches: Mutex<Vec<SurfaceSearch>>,
    front_searches: Mutex<Vec<FrontSearch>>,
}

/// Search tree over the vertices.
struct VertexTree(ImmutableKdTree<f64, 3>);

impl std::fmt::Debug for VertexTree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tree")
    }
}

/// Welded vertices within a radius, in ascending order, and their distances.
pub(crate) struct VerticesWithin {
    pub(crate) vertices: Vec<u32>,
    pub(crate) distances: Vec<f64>,
}

impl SurfaceMetric {
    /// Metric of a domain over `edges`, in the order of its places. `diagonal` is the diagonal of the bounding
    /// box and `spacing` the mean distance of neighbors, both in model units (0 and 1 for a graph). O(1).
    pub(crate) fn new(domain: Arc<dyn Domain>, edges: MetricEdges, diagonal: f64, spacing: f64) -> Self {
        Self {
            domain,
            edges,
            diagonal,
            spacing,
            rms_length: OnceLock::new(),
            normals: OnceLock::new(),
            tree: OnceLock::new(),
            corners: OnceLock::new(),
            searches: Mutex::default(),
            front_searches: Mutex::default(),
        }
    }

    /// Map from the vertices of the shape, or the places in the caller's order, to the places.
    pub fn vertex_map(&self) -> &VertexMap {
        self.domain.vertex_map()
    }

    /// Number of places.
    pub(crate) fn n_places(&self) -> usize {
        self.vertex_map().n_welded()
    }

    /// Positions of the places in model units; empty without positions.
    pub(crate) fn positions(&self) -> &[[f64; 3]] {
        self.domain.positions()
    }

    /// Triangles between the places; empty unless they are the vertices of a mesh.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        self.domain.geometry().map_or(&[], PreparedGeometry::triangles)
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.vertex_map().n_vertices()
    }

    /// Welded vertex nearest to a point (finite, model units); `None` for a graph. O(log n); the first call O(n log
    /// n).
    pub fn nearest(&self, point: &[f64; 3]) -> Option<usize> {
        if self.positions().is_empty() {
            return None;
        }
        let tree = self.tree.get_or_init(|| {
            VertexTree(
                ImmutableKdTree::new_from_slice(self.positions())
                    .expect("the tree of finitely many finite points"),
            )
        });
        Some(tree.0.query(point).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize)
    }

    /// Neighbors of each welded vertex.
    pub(super) fn neighbors(&self) -> &Adjacency {
        let MetricEdges { stated, mask, rows } = &self.edges;
        let masked = mask.as_deref().map(Mask::welded);
        let stated = stated_neighbors(&*self.domain, masked, stated, Progress::none());
        parallel::expect_not_cancelled(stated).unwrap_or_else(|| {
            rows.as_ref().expect("a domain states its neighbors if its operator has no rows").neighbors()
        })
    }

    /// Root mean square distance of neighbors, with equal weight per vertex, in model units; 1 for a graph.
    pub(super) fn rms_length(&self, progress: Progress<'_>) -> Result<f64, Cancelled> {
        if let Some(length) = self.rms_length.get() {
            return Ok(*length);
        }
        let (points, neighbors) = (self.positions(), self.neighbors());
        if points.is_empty() {
            return Ok(1.0);
        }
        let joined = (0..points.len()).filter(|&x| !neighbors.row(x).is_empty()).count().max(1);
        let squares = parallel::try_sum(points.len(), progress, |x| {
            let around = neighbors.row(x);
            let sum: f64 = around.iter().map(|&y| squared_distance(&points[x], &points[y as usize])).sum();
            sum / around.len().max(1) as f64
        })?;
        Ok(*self.rms_length.get_or_init(|| (squares / joined as f64).sqrt()))
    }

    /// Normals of the vertices; empty for a cloud or a graph.
    pub(super) fn normals(&self, progress: Progress<'_>) -> Result<&[[f64; 3]], Cancelled> {
        if let Some(normals) = self.normals.get() {
            return Ok(normals);
        }
        // If two threads arrive here at once, one of them works in vain.
        let normals = match self.domain.geometry() {
            Some(geometry) => geometry.incidence(progress)?.normals(geometry.points(), progress)?,
            None => Vec::new(),
        };
        Ok(self.normals.get_or_init(|| normals))
    }

    /// The triangles at the vertices of a mesh; `None` for a cloud or a graph.
    pub(super) fn corners(&self, progress: Progress<'_>) -> Result<Option<&Corners>, Cancelled> {
        let triangles = self.triangles();
        if triangles.is_empty() {
            return Ok(None);
        }
        if let Some(corners) = self.corners.get() {
            return Ok(Some(corners));
        }
        // If two threads arrive here at once, one of them works in vain.
        let corners = Corners::new(triangles, self.neighbors(), progress)?;
        Ok(Some(self.corners.get_or_init(|| corners)))
    }

    /// Location on the shape nearest to a point, near the nearest vertex.
    ///
    /// # Panics
    /// If the shape is a graph without positions.
    pub(super) fn nearest_place(
        &self,
        p: &[f64; 3],
        progress: Progress<'_>,
    ) -> Result<SurfacePlace, Cancelled> {
        progress.check()?;
        let points = self.positions();
        let vertex = self.nearest(p).expect("a place has a position");
        if let Some(corners) = self.corners(progress)? {
            return Ok(SurfacePlace::nearest_on_mesh(p, vertex, corners, points));
        }
        let around = self.neighbors().row(vertex).iter();
        let reach = around.map(|&y| distance(&points[vertex], &points[y as usize])).fold(0.0, f64::max);
        Ok(SurfacePlace::nearest_among_points(p, vertex, reach, points))
    }

    /// Vertices within `radius` of a line over the surface through the given points.
    pub(super) fn find_around_line(
        &self,
        path: &[[f64; 3]],
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<VerticesWithin, Cancelled> {
        let sources = stroke::sources(self, self.spacing, path, progress)?;
        self.find_within(&sources, radius, progress)
    }

    /// A vertex as a source with the distance `start`.
    pub(crate) fn vertex_source(&self, vertex: usize, start: f64) -> FrontSource {
        let point = self.positions().get(vertex).copied().unwrap_or_default();
        FrontSource { vertex, point, start, extent: SourceExtent::Point, number: 0 }
    }

    /// Vertices within `radius` of the nearest of `sources`.
    pub(crate) fn find_within(
        &self,
        sources: &[FrontSource],
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<VerticesWithin, Cancelled> {
        let (neighbors, points) = (self.neighbors(), self.positions());
        if let Some(corners) = self.corners(progress)? {
            let mut search = take_search(&self.front_searches);
            let reached = search.run(corners, points, sources, radius, progress).map(<[u32]>::to_vec);
            let within = reached.map(|reached| VerticesWithin::new(reached, |x| search.distance(x)));
            keep_search(&self.front_searches, search);
            return within;
        }
        let along_edges = |source: &FrontSource| match points.get(source.vertex) {
            Some(p) => (source.vertex, source.start + distance(p, &source.point)),
            None => (source.vertex, source.start),
        };
        let sources: Vec<(usize, f64)> = sources.iter().map(along_edges).collect();
        let mut search = take_search(&self.searches);
        let reached = search.run(neighbors, points, &sources, radius, progress).map(<[u32]>::to_vec);
        let within = reached.map(|reached| VerticesWithin::new(reached, |x| search.distance(x)));
        keep_search(&self.searches, search);
        within
    }
}

impl VerticesWithin {
    fn new(mut vertices: Vec<u32>, distance: impl Fn(usize) -> f64) -> Self {
        vertices.sort_unstable();
        let distances = vertices.iter().map(|&x| distance(x as usize)).collect();
        Self { vertices, distances }
    }
}

/// Memory of an earlier search.
fn take_search<S: Default>(kept: &Mutex<Vec<S>>) -> S {
    kept.lock().map_or_else(|_| None, |mut kept| kept.pop()).unwrap_or_default()
}

/// Keeps the memory of a search for the next one.
fn keep_search<S>(kept: &Mutex<Vec<S>>, search: S) {
    if let Ok(mut kept) = kept.lock() {
        kept.push(search);
    }
}
