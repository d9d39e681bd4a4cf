//! The border of a shape, and the distance of vertices from it.

use super::Decomposer;
use crate::parallel;
use crate::region::{FrontSource, SourceExtent};
use crate::signal::cloud_border;
use crate::{Cancelled, Progress};

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
        let mut edges: Vec<(u32, u32)> = Vec::with_capacity(3 * geometry.triangles().len());
        for t in geometry.triangles().iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
            edges.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a.min(b), a.max(b))));
        }
        parallel::sort_unstable_by(&mut edges, progress, Ord::cmp)?;
        let single = edges.chunk_by(|e, f| e == f).filter(|same| same.len() == 1);
        let mut border: Vec<usize> =
            single.flat_map(|same| [same[0].0 as usize, same[0].1 as usize]).collect();
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
