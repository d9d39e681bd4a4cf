//! What a feature's surroundings look like, as a row of numbers that can be compared.

use super::Feature;
use super::response::{Level, layers};
use crate::Decomposer;
use crate::Progress;
use crate::bands::Wavelets;
use crate::features::Response;
use crate::parallel::{self, unstopped};
use crate::population::Population;
use crate::shape::squared_distance;
use std::collections::HashSet;

/// Levels on each side of the feature's own that it reads.
const LEVELS_BESIDE: usize = 2;
/// Levels that it reads.
const LEVELS: usize = 2 * LEVELS_BESIDE + 1;
/// Rings round the feature, each one σ wide.
const RINGS: usize = 3;
/// Numbers for each level: the positive and the negative part in each ring, and the response at the vertex itself.
const PER_LEVEL: usize = 2 * RINGS + 1;

/// Numbers in a descriptor.
pub const DESCRIPTOR_LENGTH: usize = LEVELS * PER_LEVEL;

/// Numbers of Euclidean norm 1 (or all 0): for each of the levels j − 2 … j + 2 the root mean square of the positive and of
/// the negative part of the normalized response in three rings, each one σ wide, then the response at the vertex itself. A
/// level that there is not gives zeros.
pub type Descriptor = [f64; DESCRIPTOR_LENGTH];

/// The descriptors of features, in their order. They do not change when the shape is moved, and neither when it is scaled,
/// as rings and levels are counted from the feature's own σ; invariance to rotation is that of the signal's norm.
///
/// Means in the rings are weighted by area and run over what is connected to the feature within the outer ring. O(vertices
/// within 3σ) each.
///
/// # Panics
/// When the features or the bands are not those of the shape.
pub fn describe(decomposer: &Decomposer, wavelets: &Wavelets, features: &[Feature]) -> Vec<Descriptor> {
    let layers =
        unstopped(layers(&Population::new(decomposer), wavelets, Response::Normalized, Progress::none()));
    let levels = &layers[0].levels;
    let areas = decomposer.welded_areas();
    parallel::map_items(decomposer.n_vertices(), features.len(), |k| {
        descriptor(decomposer, levels, areas, &features[k])
    })
}

fn descriptor(decomposer: &Decomposer, levels: &[Level<'_>], areas: &[f64], feature: &Feature) -> Descriptor {
    let x = decomposer.geometry().vertex_map().welded(feature.vertex);
    let mut numbers = [0.0; DESCRIPTOR_LENGTH];
    let mut ring_areas = [0.0; RINGS];
    let first = feature.level as isize - LEVELS_BESIDE as isize;
    let looked_at: Vec<(usize, &Level<'_>)> = (0..LEVELS)
        .filter_map(|k| Some((k, levels.get(usize::try_from(first + k as isize - 1).ok()?)?)))
        .collect();
    for (y, ring) in within(decomposer, x, feature.sigma) {
        ring_areas[ring] += areas[y];
        for &(k, level) in &looked_at {
            let r = level.at(y);
            let part = usize::from(r < 0.0);
            numbers[k * PER_LEVEL + 2 * ring + part] += areas[y] * r * r;
        }
    }
    for (k, level) in looked_at {
        let row = &mut numbers[k * PER_LEVEL..][..PER_LEVEL];
        for (pair, area) in row.chunks_exact_mut(2).zip(ring_areas) {
            for v in pair {
                *v = if area > 0.0 { (*v / area).sqrt() } else { 0.0 };
            }
        }
        row[2 * RINGS] = level.at(x);
    }
    let norm = numbers.iter().map(|v| v * v).sum::<f64>().sqrt();
    if norm > 0.0 {
        for v in &mut numbers {
            *v /= norm;
        }
    }
    numbers
}

/// The vertices that are connected with `x` within the outermost ring, and their rings.
fn within(decomposer: &Decomposer, x: usize, sigma: f64) -> Vec<(usize, usize)> {
    let points = decomposer.geometry().points();
    let neighbors = decomposer.neighbors();
    let mut seen = HashSet::from([x]);
    let mut found = vec![(x, 0)];
    let mut at = 0;
    while at < found.len() {
        let (y, ring) = found[at];
        at += 1;
        for &z in neighbors.of(y) {
            let z = z as usize;
            // On a graph σ counts the root of hops squared: rings of breadth-first hops stand for distances.
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
