//! The domain of a mesh, a point cloud or a graph.

use super::Domain;
use crate::local_fit::LocalFit;
use crate::operator::{OperatorKind, OperatorParams};
use crate::parallel;
use crate::shape::{Adjacency, PreparedGeometry, Shape, VertexMap, triangles_at_vertices};
use crate::signal::cloud_border;
use crate::{Cancelled, Progress};
use std::borrow::Cow;

/// Number of vertices that a thread searches at a time.
const VERTICES_AT_A_TIME: usize = 1 << 13;

/// The welded vertices of a shape, with the areas and lengths that its operator found.
#[derive(Clone, Debug)]
pub struct ShapeDomain {
    geometry: PreparedGeometry,
    areas: Vec<f64>,
    mean_length: [f64; 1],
    /// Diagonal of the bounding box of all vertices.
    diagonal: f64,
    /// Relation between the neighbors of a step and those of the mesh.
    steps: StepNeighbors,
}

/// Relation between the neighbors of a step and the edges of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StepNeighbors {
    /// Steps follow the edges, or the shape has no others.
    Edges,
    /// Steps reach farther than one ring of edges.
    Rings,
    /// Steps follow other edges than those of the mesh.
    Others,
}

impl ShapeDomain {
    /// Joins a prepared shape with the areas of its welded vertices (squared model units) and the mean length of its
    /// edges (model units) that its operator found.
    ///
    /// # Panics
    /// Unless there is one area for each welded vertex.
    pub(crate) fn new(
        geometry: PreparedGeometry,
        areas: Vec<f64>,
        mean_length: f64,
        params: &OperatorParams,
    ) -> Self {
        assert_eq!(areas.len(), geometry.n_vertices(), "an area for each welded vertex");
        let steps = match geometry.triangles() {
            [] => StepNeighbors::Edges,
            _ if params.kind == OperatorKind::Surface || params.density_invariant => StepNeighbors::Others,
            _ if params.rings > 1 => StepNeighbors::Rings,
            _ => StepNeighbors::Edges,
        };
        let diagonal = geometry.shape().diagonal();
        Self { geometry, areas, mean_length: [mean_length], diagonal, steps }
    }

    fn is_cloud(&self) -> bool {
        self.geometry.shape().is_cloud()
    }

    fn edges(&self, progress: Progress<'_>) -> Result<Adjacency, Cancelled> {
        self.geometry.incidence(progress)?.ring(progress)
    }
}

impl Domain for ShapeDomain {
    fn vertex_map(&self) -> &VertexMap {
        self.geometry.vertex_map()
    }

    fn measure(&self) -> Option<&[f64]> {
        Some(&self.areas)
    }

    fn spacings(&self) -> &[f64] {
        &self.mean_length
    }

    fn positions(&self) -> &[[f64; 3]] {
        self.geometry.points()
    }

    fn extent(&self, masked: Option<&[bool]>) -> f64 {
        match masked {
            Some(masked) => self.geometry.extent_without(masked),
            None => self.geometry.extent(),
        }
    }

    fn diagonal(&self) -> f64 {
        self.diagonal
    }

    fn neighbors(&self, progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        match self.steps {
            StepNeighbors::Others => Ok(Some(Cow::Owned(self.edges(progress)?))),
            StepNeighbors::Edges | StepNeighbors::Rings => Ok(None),
        }
    }

    fn has_neighbors(&self) -> bool {
        self.steps == StepNeighbors::Others
    }

    fn one_ring(&self, progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        match self.steps {
            StepNeighbors::Rings => Ok(Some(Cow::Owned(self.edges(progress)?))),
            StepNeighbors::Edges | StepNeighbors::Others => Ok(None),
        }
    }

    fn feature_rings(&self) -> usize {
        if self.is_cloud() { 1 } else { 2 }
    }

    fn outsiders(&self) -> Option<Vec<bool>> {
        self.geometry.participation().outsiders()
    }

    /// The ends of edges of a single triangle, the points of a cloud with a gap between their neighbors, or the ends of
    /// a curve, and the vertices next to masked ones.
    fn border(
        &self,
        neighbors: &Adjacency,
        masked: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        let geometry = &self.geometry;
        if self.is_cloud() {
            return Ok(cloud_border(geometry.points(), neighbors));
        }
        if geometry.curve_edges().is_some() {
            return Ok(geometry.curve_ends());
        }
        let triangles = geometry.triangles();
        let at_vertex = triangles_at_vertices(geometry.n_vertices(), triangles, progress)?;
        let chunks = parallel::try_map_chunks(
            geometry.n_vertices(),
            VERTICES_AT_A_TIME,
            progress,
            Vec::new,
            |ends, range| {
                range.filter(|&x| has_single_edge(x, triangles, &at_vertex, ends)).collect::<Vec<_>>()
            },
        )?;
        let mut border = chunks.concat();
        if let Some(masked) = masked {
            border.extend(super::next_to_masked(&self.edges(progress)?, masked));
            border.retain(|&x| !masked[x]);
        }
        border.sort_unstable();
        border.dedup();
        Ok(border)
    }

    fn may_fill_volume(&self) -> bool {
        self.is_cloud()
    }

    /// A constant fit on a graph or a curve, where slopes along the curve are no bias, unless the nodes are cells of a
    /// surface.
    fn local_fit(&self, asked: LocalFit) -> LocalFit {
        match self.geometry.shape() {
            Shape::Graph(graph) if graph.cell_areas().is_none() => LocalFit::Constant,
            _ => asked,
        }
    }

    fn geometry(&self) -> Option<&PreparedGeometry> {
        Some(&self.geometry)
    }
}

/// True if an edge at `x` belongs to one triangle. Triangles with a repeated corner have no edges.
fn has_single_edge(x: usize, triangles: &[[u32; 3]], at_vertex: &Adjacency, ends: &mut Vec<u32>) -> bool {
    ends.clear();
    for &f in at_vertex.row(x) {
        let [a, b, c] = triangles[f as usize];
        if a != b && b != c && c != a {
            ends.extend([a, b, c].into_iter().filter(|&y| y as usize != x));
        }
    }
    ends.sort_unstable();
    ends.chunk_by(|a, b| a == b).any(|same| same.len() == 1)
}
