//! The border of a shape, and the distance of vertices from it.

use super::Decomposer;
use crate::parallel;
use crate::region::{FrontSource, SourceExtent};
use crate::shape::{Adjacency, triangles_at_vertices};
use crate::signal::cloud_border;
use crate::{Cancelled, Progress};

/// Number of vertices that a thread searches at a time.
const VERTICES_AT_A_TIME: usize = 1 << 13;

/// Relative rounding of unfolded distances: a vertex that is as far from the border as a width does not count as farther.
const ROUNDING: f64 = 1e-14;

impl Decomposer {
    /// The welded vertices on the border of a mesh (ends of edges of a single triangle) or of a cloud (points with
    /// a gap between their neighbors), the ends of a curve, and those next to masked vertices; in ascending order.
    pub(crate) fn border(&self, progress: Progress<'_>) -> Result<Vec<usize>, Cancelled> {
        let geometry = self.geometry();
        if self.is_cloud() {
            return Ok(cloud_border(geometry.points(), self.neighbors()));
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
        if let Some(masked) = self.mask_flags() {
            let whole = geometry.incidence(progress)?.ring(progress)?;
            border.extend((0..masked.len()).filter(|&x| whole.row(x).iter().any(|&y| masked[y as usize])));
            border.retain(|&x| !masked[x]);
        }
        border.sort_unstable();
        border.dedup();
        Ok(border)
    }

    /// Distance of each welded vertex from the border along the surface, in model units; infinite beyond `radius`
    /// and on a shape without a border.
    pub(crate) fn distance_from_border(
        &self,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let metric = self.metric();
        let line = |x: usize| FrontSource { extent: SourceExtent::Line, ..metric.vertex_source(x, 0.0) };
        let sources: Vec<FrontSource> = self.border(progress)?.into_iter().map(line).collect();
        let within = metric.find_within(&sources, radius * (1.0 + ROUNDING), progress)?;
        let mut distances = vec![f64::INFINITY; self.geometry().n_vertices()];
        for (&x, distance) in within.vertices.iter().zip(within.distances) {
            distances[x as usize] = distance * (1.0 - ROUNDING);
        }
        Ok(distances)
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
