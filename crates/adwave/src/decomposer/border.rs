//! The border of a domain, and the distance of places from it.

use super::Decomposer;
use crate::region::{FrontSource, SourceExtent};
use crate::{Cancelled, Progress};

/// Relative rounding of unfolded distances: a vertex that is as far from the border as a width does not count as
/// farther.
const ROUNDING: f64 = 1e-14;

impl Decomposer {
    /// The places on the border of the domain, and those next to masked ones, in ascending order.
    pub(crate) fn border(&self, progress: Progress<'_>) -> Result<Vec<usize>, Cancelled> {
        self.domain().border(self.neighbors(), self.mask_flags(), progress)
    }

    /// Distance of each place from the border along the domain, in model units; infinite beyond `radius`
    /// and on a domain without a border.
    pub(crate) fn distance_from_border(
        &self,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let reach = radius * (1.0 + ROUNDING);
        if let Some(mut distances) = self.domain().border_distances(self.mask_flags(), reach, progress)? {
            for distance in &mut distances {
                *distance *= 1.0 - ROUNDING;
            }
            return Ok(distances);
        }
        let metric = self.metric();
        let line = |x: usize| FrontSource { extent: SourceExtent::Line, ..metric.vertex_source(x, 0.0) };
        let sources: Vec<FrontSource> = self.border(progress)?.into_iter().map(line).collect();
        let within = metric.find_within(&sources, reach, progress)?;
        let mut distances = vec![f64::INFINITY; self.n_places()];
        for (&x, distance) in within.vertices.iter().zip(within.distances) {
            distances[x as usize] = distance * (1.0 - ROUNDING);
        }
        Ok(distances)
    }
}
