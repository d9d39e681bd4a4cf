//! Deviations of a level that the mesh and noise explain.

use super::VERTICES_AT_A_TIME;
use crate::operator::OperatorKind;
use crate::population::Population;
use crate::shape::{Adjacency, distance};
use crate::{Cancelled, Decomposer, Progress, parallel};

/// Mean square difference between a vertex and the mean of its ring on the two finest levels, for independent values of
/// variance 1 on an even mesh.
const ROUGHNESS: [f64; 2] = [0.26, 0.068];

/// Variance on a level for independent values of variance 1, times σ_j² and divided by the area of a vertex. It is
/// (4 + 2 − 16/3)/4π = 0.053 on a plane, and up to 0.09 on the finest levels and on uneven meshes.
pub(crate) const VARIANCE: f64 = 0.09;

/// Deviation of a level due to the triangles, relative to its mean, for edges as long as σ; it falls with the square of
/// the length of the edges.
const TRIANGLES: f64 = 0.2;

/// Largest deviation from the mean that the mesh and noise cause, in standard deviations.
const LARGEST: f64 = 6.0;

/// Number of successive vertices of the analysis order, which lie together, that share an estimate of the noise.
const VERTICES_TOGETHER: usize = 64;

/// Estimates of what the mesh of a surface, and noise, contribute to the levels of a map.
pub(super) struct Discretization {
    /// Variance of noise at a vertex times its area in squares of the unit, the largest of the vertex, of its neighbors
    /// and of the mean of all.
    noise: Vec<f64>,
    /// Fourth power of the mean length of the edges at a vertex in the unit, likewise the largest around it.
    edges: Vec<f64>,
    /// Unit of length in model units, so that powers neither overflow nor underflow.
    unit: f64,
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
        let (points, unit) = (decomposer.positions(), unit_length(decomposer));
        let edges = parallel::collect(ring.n_rows(), |x| {
            let row = ring.row(x);
            let sum: f64 = row.iter().map(|&y| distance(&points[x], &points[y as usize])).sum();
            (sum / (unit * row.len().max(1) as f64)).powi(4)
        });
        // A level reaches at least the neighbors, and the coarse ones average over many.
        let largest_around = |values: Vec<f64>| {
            // Relative to the largest, as their products with areas may exceed the largest number.
            let most = parallel::max(values.len(), 0.0, |x| values[x]).max(f64::MIN_POSITIVE);
            let mean = most * population.mean_over(values.len(), |x| values[x] / most);
            parallel::collect(values.len(), |x| {
                ring.row(x).iter().fold(values[x].max(mean), |most, &y| most.max(values[y as usize]))
            })
        };
        let noise = largest_around(noise_times_area(decomposer, levels, &ring));
        Ok(Some(Self { noise, edges: largest_around(edges), unit }))
    }

    /// Part of a level of width `sigma` that the mesh and noise explain.
    pub(super) fn level(&self, population: &Population<'_>, level: &[f64], sigma: f64) -> ExplainedLevel<'_> {
        let known = |x: usize| if level[x].is_nan() { 0.0 } else { level[x] };
        let chunk = |range: std::ops::Range<usize>| {
            range
                .map(|x| if population.is_masked(x) { 0.0 } else { population.weight(x) * known(x) })
                .sum::<f64>()
        };
        let sum: f64 = parallel::map_chunks(level.len(), VERTICES_AT_A_TIME, chunk).iter().sum();
        let mean = sum / population.total();
        let sigma = sigma / self.unit;
        let of_noise = LARGEST * LARGEST * VARIANCE / (sigma * sigma);
        let of_triangles = (LARGEST * TRIANGLES * mean).powi(2) / sigma.powi(4);
        let mut found = ExplainedLevel { of: self, mean, of_noise, of_triangles, share: 0.0 };
        let most = parallel::max(level.len(), 0.0, |x| {
            let away = if population.is_masked(x) { 0.0 } else { (known(x) - mean).abs() };
            if away > 0.0 { away / found.explained(x) } else { 0.0 }
        });
        found.share = (most * most - 1.0).clamp(0.0, 1.0);
        found
    }
}

/// Part of one level that the mesh and noise explain.
pub(super) struct ExplainedLevel<'a> {
    of: &'a Discretization,
    mean: f64,
    of_noise: f64,
    of_triangles: f64,
    /// Share of the level that counts: 0 if the mesh and noise explain every deviation from the mean, 1 if they explain
    /// at most half of the square of one.
    pub(super) share: f64,
}

impl ExplainedLevel<'_> {
    /// Largest deviation from the mean at `x` that is explained.
    fn explained(&self, x: usize) -> f64 {
        (self.of_noise * self.of.noise[x] + self.of_triangles * self.of.edges[x]).sqrt()
    }

    /// The `value` of the level at `x`, which had been multiplied by `left`, less what is explained of its deviation from
    /// the mean where the level does not count completely.
    pub(super) fn standing_out(&self, x: usize, value: f64, left: f64) -> f64 {
        let mean = left * self.mean;
        let away = value - mean;
        mean + away.signum() * (away.abs() - (1.0 - self.share) * left * self.explained(x)).max(0.0)
    }
}

/// Length in model units in which areas and edges are measured: the mean length of an edge.
pub(crate) fn unit_length(decomposer: &Decomposer) -> f64 {
    let length = decomposer.mean_length();
    if length.is_normal() { length } else { 1.0 }
}

/// Variance of independent displacements that would make the two finest `levels` as rough as they are, times the area of
/// the vertex in squares of [`unit_length`], at each vertex. Groups of adjacent vertices share the larger of the two
/// estimates.
pub(crate) fn noise_times_area(decomposer: &Decomposer, levels: &[&[f64]], ring: &Adjacency) -> Vec<f64> {
    let n = ring.n_rows();
    let group = |g: usize| {
        let vertices = g * VERTICES_TOGETHER..((g + 1) * VERTICES_TOGETHER).min(n);
        let estimate = |(level, of_noise): (&&[f64], f64)| {
            let known = vertices.clone().filter(|&x| !level[x].is_nan());
            let n_known = known.clone().count().max(1);
            known.map(|x| roughness_at(ring, level, x)).sum::<f64>() / (n_known as f64 * of_noise)
        };
        levels.iter().zip(ROUGHNESS).map(estimate).fold(0.0, f64::max)
    };
    let groups: Vec<f64> = parallel::map_items(n, n.div_ceil(VERTICES_TOGETHER), group);
    let (areas, unit) = (decomposer.place_measure(), unit_length(decomposer));
    parallel::collect(n, |x| {
        groups[x / VERTICES_TOGETHER] * areas.map_or(1.0, |areas| areas[x] / unit / unit)
    })
}

/// Squared difference between the value at `x` and the mean over its ring.
fn roughness_at(ring: &Adjacency, level: &[f64], x: usize) -> f64 {
    let row = ring.row(x);
    if row.is_empty() || level[x].is_nan() {
        return 0.0;
    }
    let mean = row.iter().map(|&y| level[y as usize]).sum::<f64>() / row.len() as f64;
    if mean.is_nan() { 0.0 } else { (level[x] - mean).powi(2) }
}
