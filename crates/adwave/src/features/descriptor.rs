//! Descriptors of the neighborhood of a feature, for comparison.

use super::Feature;
use super::response::{ResponseLevel, layers};
use crate::Decomposer;
use crate::Progress;
use crate::bands::Wavelets;
use crate::features::Response;
use crate::parallel::{self, expect_not_cancelled};
use crate::population::Population;
use crate::shape::squared_distance;
use std::collections::HashSet;

/// Number of levels read on each side of the feature's level.
const LEVELS_BESIDE: usize = 2;
/// Number of levels read.
const LEVELS: usize = 2 * LEVELS_BESIDE + 1;
/// Number of rings around the feature, each σ wide.
const RINGS: usize = 3;
/// Numbers per level: the positive and the negative part in each ring, and the response at the vertex itself.
const PER_LEVEL: usize = 2 * RINGS + 1;

/// Length of a descriptor.
pub const DESCRIPTOR_LENGTH: usize = LEVELS * PER_LEVEL;

/// A vector of Euclidean norm 1 (or all 0). For each of the levels j − 2 … j + 2 it holds the root mean square of
/// the positive and of the negative part of the normalized response in three rings, each σ wide, then the response
/// at the vertex itself. A missing level gives zeros.
pub type Descriptor = [f64; DESCRIPTOR_LENGTH];

/// Computes the descriptors of features, in their order. They are invariant to motion and to scale, because rings
/// and levels are counted from the feature's own σ; they are invariant to rotation if the norm of the signal is.
///
/// Means in the rings are weighted by area and run over the vertices connected to the feature within the outer
/// ring. O(vertices within 3σ) per feature.
///
/// # Panics
/// If the features or the bands do not belong to the shape.
pub fn describe(decomposer: &Decomposer, wavelets: &Wavelets, features: &[Feature]) -> Vec<Descriptor> {
    let layers = expect_not_cancelled(layers(
        &Population::new(decomposer),
        wavelets,
        Response::Normalized,
        Progress::none(),
    ));
    let levels = &layers[0].levels;
    let areas = decomposer.place_measure();
    parallel::map_items(decomposer.n_vertices(), features.len(), |k| {
        descriptor(decomposer, levels, areas, &features[k])
    })
}

fn descriptor(
    decomposer: &Decomposer,
    levels: &[ResponseLevel<'_>],
    areas: Option<&[f64]>,
    feature: &Feature,
) -> Descriptor {
    let x = decomposer.vertex_map().welded(feature.vertex);
    let mut numbers = [0.0; DESCRIPTOR_LENGTH];
    let mut ring_areas = [0.0; RINGS];
    let first = feature.level as isize - LEVELS_BESIDE as isize;
    let looked_at: Vec<(usize, &ResponseLevel<'_>)> = (0..LEVELS)
        .filter_map(|k| Some((k, levels.get(usize::try_from(first + k as isize - 1).ok()?)?)))
        .collect();
    for (y, ring) in find_within(decomposer, x, feature.sigma) {
        let area = areas.map_or(1.0, |areas| areas[y]);
        ring_areas[ring] += area;
        for &(k, level) in &looked_at {
            let r = level.value(y);
            let part = usize::from(r < 0.0);
            numbers[k * PER_LEVEL + 2 * ring + part] += area * r * r;
        }
    }
    for (k, level) in looked_at {
        let row = &mut numbers[k * PER_LEVEL..][..PER_LEVEL];
        for (pair, area) in row.chunks_exact_mut(2).zip(ring_areas) {
            for v in pair {
                *v = if area > 0.0 { (*v / area).sqrt() } else { 0.0 };
            }
        }
        row[2 * RINGS] = level.value(x);
    }
    let norm = numbers.iter().map(|v| v * v).sum::<f64>().sqrt();
    if norm > 0.0 {
        for v in &mut numbers {
            *v /= norm;
        }
    }
    numbers
}

/// The vertices connected to `x` within the outermost ring, and their rings.
fn find_within(decomposer: &Decomposer, x: usize, sigma: f64) -> Vec<(usize, usize)> {
    let points = decomposer.positions();
    let neighbors = decomposer.neighbors();
    let mut seen = HashSet::from([x]);
    let mut found = vec![(x, 0)];
    let mut at = 0;
    while at < found.len() {
        let (y, ring) = found[at];
        at += 1;
        for &z in neighbors.row(y) {
            let z = z as usize;
            // On a graph σ² counts hops: breadth-first hops stand for squared distances.
            let ring = if points.is_empty() {
                ring + 1
            } else {
                (squared_distance(&points[x], &points[z]).sqrt() / sigma) as usize
            };
            if ring < RINGS && seen.insert(z) {
                found.push((z, ring));
            }
        }
    }
    found
}
