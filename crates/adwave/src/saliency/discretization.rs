//! The share of a level that its mesh and noise explain.

use super::VERTICES_AT_A_TIME;
use crate::operator::OperatorKind;
use crate::population::Population;
use crate::shape::{Adjacency, distance};
use crate::{Cancelled, Decomposer, Progress, parallel};

/// Mean square difference between a vertex and the mean of its ring on the two finest levels, for independent values of
/// variance 1 on an even mesh.
pub(crate) const ROUGHNESS: [f64; 2] = [0.26, 0.068];

/// Variance on a level for independent values of variance 1, times σ_j² and divided by the area of a vertex. It is
/// (4 + 2 − 16/3)/4π = 0.053 on a plane, and up to 0.09 on the finest levels and on uneven meshes.
pub(crate) const VARIANCE: f64 = 0.09;

/// Deviation of a level due to the triangles, relative to its mean, for edges as long as σ; it falls with the square of
/// the length of the edges.
const TRIANGLES: f64 = 0.2;

/// Largest deviation from the mean that the mesh and noise cause, in standard deviations.
const LARGEST: f64 = 6.0;

/// Estimates of what the mesh of a surface, and noise, contribute to the variance of a level.
pub(super) struct Discretization {
    /// Variance of independent displacements of the vertices that would make the finest levels as rough as they are.
    noise: f64,
    /// Mean area of a vertex.
    area: f64,
    /// Mean fourth power of the mean length of the edges at a vertex.
    edges: f64,
}

impl Discretization {
    /// Measures the roughness of the finest `levels`. `None` unless the operator is heat on a mesh.
    pub(super) fn new(
        decomposer: &Decomposer,
        population: &Population<'_>,
        levels: &[&[f64]],
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let is_mesh = decomposer.geometry().is_some_and(|geometry| !geometry.triangles().is_empty());
        if !is_mesh || decomposer.operator_kind() != OperatorKind::Surface {
            return Ok(None);
        }
        let ring = decomposer.ring(progress.quiet())?;
        let n = ring.n_rows();
        let noise = levels
            .iter()
            .zip(ROUGHNESS)
            .map(|(level, of_noise)| population.mean_over(n, |x| roughness_at(&ring, level, x)) / of_noise);
        let noise = noise.fold(0.0, f64::max);
        let points = decomposer.positions();
        let n_members = (0..n).filter(|&x| !population.is_masked(x)).count().max(1);
        let area =
            decomposer.place_measure().map_or(0.0, |areas| parallel::sum(n, |x| areas[x])) / n_members as f64;
        let edges = population.mean_over(n, |x| {
            let row = ring.row(x);
            let sum: f64 = row.iter().map(|&y| distance(&points[x], &points[y as usize])).sum();
            (sum / row.len().max(1) as f64).powi(4)
        });
        Ok(Some(Self { noise, area, edges }))
    }

    /// Share of a level of width `sigma` that stands out: 0 if the mesh and noise explain its largest deviation from the
    /// mean, 1 if they explain at most half of its square.
    pub(super) fn share_standing_out(&self, population: &Population<'_>, level: &[f64], sigma: f64) -> f64 {
        let known = |x: usize| if level[x].is_nan() { 0.0 } else { level[x] };
        let chunk = |range: std::ops::Range<usize>| {
            range
                .map(|x| if population.is_masked(x) { 0.0 } else { population.weight(x) * known(x) })
                .sum::<f64>()
        };
        let sum: f64 = parallel::map_chunks(level.len(), VERTICES_AT_A_TIME, chunk).iter().sum();
        let mean = sum / population.total();
        let most = parallel::max(level.len(), 0.0, |x| {
            if population.is_masked(x) { 0.0 } else { (known(x) - mean).abs() }
        });
        let of_noise = VARIANCE * self.noise * self.area / (sigma * sigma);
        let of_triangles = (TRIANGLES * mean).powi(2) * self.edges / sigma.powi(4);
        let explained = LARGEST * LARGEST * (of_noise + of_triangles);
        if most > 0.0 { (most * most / explained - 1.0).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// Squared difference between the value at `x` and the mean over its ring.
pub(crate) fn roughness_at(ring: &Adjacency, level: &[f64], x: usize) -> f64 {
    let row = ring.row(x);
    if row.is_empty() || level[x].is_nan() {
        return 0.0;
    }
    let mean = row.iter().map(|&y| level[y as usize]).sum::<f64>() / row.len() as f64;
    if mean.is_nan() { 0.0 } else { (level[x] - mean).powi(2) }
}
