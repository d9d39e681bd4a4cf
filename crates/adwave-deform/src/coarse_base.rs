//! The coarse shape S_J, its samples and the nodes that move it: all that does not depend on handles.

use crate::DeformError;
use crate::front::{Cover, NO_SOURCE, PlacedGraph, RepeatedFront, SourceOrder};
use crate::symmetry::MirrorPlanes;
use adwave::bands::{BandsParams, Schedule};
use adwave::shape::{Adjacency, label_components};
use adwave::vector::{Vector, norm, subtract};
use adwave::{Decomposer, Progress};
use rayon::prelude::*;

/// Distance of nodes in widths σ_J.
const NODE_SPACING: f64 = 0.75;

/// Width σ_J of the base, as a share of the extent, if none is given.
const DEFAULT_WIDTH: f64 = 0.045;

/// Relative error of the bands that are taken off the shape for its base. The base only has to be smooth, because
/// details are measured relative to it; each digit would cost 8 % of the time of binding.
const ACCURACY: f64 = 1e-4;

/// Distance at which the weight of a node is 0, in distances of nodes.
const REACH: f64 = 2.0;

/// Distance of samples in distances of nodes.
const SAMPLE_SPACING: f64 = 0.25;

/// Length of paths along edges, in reaches, up to which a node has its full weight: edges make detours.
const FULL_PATH: f64 = 1.45;

/// Length of paths along edges, in reaches, from which a node has no weight, however near it is through space.
const LONGEST_PATH: f64 = 1.8;

/// Number of nodes above which they are set farther apart.
const MAX_NODES: usize = 1500;

/// Number of nodes that parts may need at most.
const MAX_NODES_OF_PARTS: usize = 6000;

/// Number of vertices that a thread takes at a time.
pub(crate) const ROWS_AT_A_TIME: usize = 1 << 12;

/// The coarse shape and its nodes. Lengths are in units of the distance of nodes, vertices are welded and in the
/// analysis order.
#[derive(Debug)]
pub(crate) struct CoarseBase {
    /// Distance of nodes in model units.
    pub(crate) unit: f64,
    /// Width σ_J in model units.
    pub(crate) sigma: f64,
    /// Positions S_J.
    pub(crate) points: Vec<Vector>,
    /// Area of each sample's cell, in units of the mean area of a node.
    pub(crate) sample_areas: Vec<f64>,
    pub(crate) takes_part: Vec<bool>,
    /// Connected part of each vertex.
    pub(crate) part: Vec<u32>,
    /// Vertex of each sample.
    pub(crate) samples: Vec<u32>,
    pub(crate) sample_neighbors: Adjacency,
    /// Vertex of each node.
    pub(crate) nodes: Vec<u32>,
    /// Weights of nodes at each vertex, which sum to 1.
    pub(crate) rows: BlendRows,
}

/// Columns and weights of each row.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlendRows {
    pub(crate) offsets: Vec<usize>,
    pub(crate) columns: Vec<u32>,
    pub(crate) weights: Vec<f64>,
}

/// Columns of one row and their weights.
#[derive(Clone, Copy)]
pub(crate) struct BlendRow<'a> {
    pub(crate) columns: &'a [u32],
    pub(crate) weights: &'a [f64],
}

impl BlendRows {
    pub(crate) fn row(&self, x: usize) -> BlendRow<'_> {
        let range = self.offsets[x]..self.offsets[x + 1];
        BlendRow { columns: &self.columns[range.clone()], weights: &self.weights[range] }
    }

    /// Rows that `row(x, entries)` writes, by several threads.
    pub(crate) fn from_rows(
        n: usize,
        progress: Progress<'_>,
        row: impl Fn(usize, &mut Vec<(u32, f64)>) + Sync,
    ) -> Result<Self, DeformError> {
        let chunks: Vec<Self> = (0..n.div_ceil(ROWS_AT_A_TIME))
            .into_par_iter()
            .map(|chunk| {
                let mut rows = Self::default();
                if progress.is_cancelled() {
                    return rows;
                }
                let mut entries = Vec::new();
                for x in chunk * ROWS_AT_A_TIME..n.min((chunk + 1) * ROWS_AT_A_TIME) {
                    entries.clear();
                    row(x, &mut entries);
                    rows.columns.extend(entries.iter().map(|(column, _)| *column));
                    rows.weights.extend(entries.iter().map(|(_, weight)| *weight));
                    rows.offsets.push(rows.columns.len());
                }
                rows
            })
            .collect();
        progress.check()?;
        let mut all = Self { offsets: vec![0], ..Self::default() };
        for chunk in chunks {
            let before = all.columns.len();
            all.offsets.extend(chunk.offsets.iter().map(|end| before + end));
            all.columns.extend_from_slice(&chunk.columns);
            all.weights.extend_from_slice(&chunk.weights);
        }
        Ok(all)
    }
}

impl CoarseBase {
    /// Smooths the shape to the last level and distributes samples and nodes over it.
    pub(crate) fn new(
        decomposer: &Decomposer,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let geometry = decomposer.geometry_for("a deformation")?;
        let n = geometry.n_vertices();
        if geometry.points().len() != n || n == 0 {
            return Err(DeformError::NoPositions);
        }
        let step = decomposer.operator().step_length();
        let sigma = schedule.sigma(step).last().copied().unwrap_or_default();
        let smooth = smooth_positions_within(ACCURACY, decomposer, schedule, progress)?;
        let takes_part = participants(decomposer);
        let (part, n_parts) = label_components(decomposer.neighbors());
        let planes = MirrorPlanes::find(decomposer, &takes_part);
        // A shape whose points coincide has no length to measure by.
        let mut spacing = if sigma > 0.0 && sigma.is_finite() { NODE_SPACING * sigma } else { 1.0 };
        loop {
            let points: Vec<Vector> = smooth.iter().map(|p| p.map(|c| c / spacing)).collect();
            let graph = PlacedGraph { neighbors: decomposer.neighbors(), points: &points };
            let cover = graph.cover(&planes, SAMPLE_SPACING, progress)?;
            let sample_neighbors =
                neighbors_of_cells(decomposer.neighbors(), &cover.owner, cover.sources.len());
            let sample_points: Vec<Vector> = cover.sources.iter().map(|&x| points[x as usize]).collect();
            let samples = PlacedGraph { neighbors: &sample_neighbors, points: &sample_points };
            let mirrored = MirroredSamples { planes: &planes, cover: &cover };
            let nodes = samples.cover(&mirrored, 1.0, progress)?.sources;
            if nodes.len() > MAX_NODES.max(2 * n_parts) {
                spacing *= (nodes.len() as f64 / MAX_NODES as f64).sqrt().max(1.1);
                continue;
            }
            if nodes.len() > MAX_NODES_OF_PARTS {
                return Err(DeformError::Singular(format!("the shape falls into {n_parts} parts")));
            }
            let paths = paths_from_nodes(samples, &nodes, progress)?;
            let sampled = SampledNodes { samples, sample_of: &cover.owner, nodes: &nodes, paths: &paths };
            let rows = BlendRows::from_rows(n, progress, |x, entries| sampled.weights(x, &points, entries))?;
            let nodes: Vec<u32> = nodes.iter().map(|&s| cover.sources[s as usize]).collect();
            let n_nodes = nodes.len() as f64;
            let sample_areas = areas_of_cells(decomposer, &cover.owner, cover.sources.len(), n_nodes);
            return Ok(Self {
                unit: spacing,
                sigma,
                points,
                sample_areas,
                takes_part,
                part,
                samples: cover.sources,
                sample_neighbors,
                nodes,
                rows,
            });
        }
    }

    /// Positions of the nodes.
    pub(crate) fn centers(&self) -> Vec<Vector> {
        self.nodes.iter().map(|&x| self.points[x as usize]).collect()
    }
}

/// Levels whose last is the usual base of a deformation: one of width 4.5 % of the [extent](Decomposer::extent), or the
/// default levels of a shape that is too coarse for it.
pub fn default_base(decomposer: &Decomposer) -> Schedule {
    let width = DEFAULT_WIDTH * decomposer.extent();
    let by_width = Schedule::lengths(&[width], decomposer.operator().step_length());
    match by_width {
        Ok(schedule) if schedule.steps()[0] >= 1.0 => schedule,
        _ => decomposer.default_schedule().schedule,
    }
}

/// Welded positions S_J in model units.
pub(crate) fn smooth_positions(
    decomposer: &Decomposer,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Vec<Vector>, DeformError> {
    smooth_positions_within(BandsParams::default().accuracy, decomposer, schedule, progress)
}

/// Welded positions S_J in model units, with bands of a relative accuracy.
fn smooth_positions_within(
    accuracy: f64,
    decomposer: &Decomposer,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Vec<Vector>, DeformError> {
    let geometry = decomposer.geometry_for("a deformation")?;
    let Some(points) = geometry.shape().points() else { return Err(DeformError::NoPositions) };
    let request =
        decomposer.request(points.as_flattened(), 3, schedule).accuracy(accuracy).progress(progress);
    let (details, _) = request.weighted(&vec![1.0; schedule.n_levels()])?;
    let details = geometry.vertex_map().mean(&details, 3);
    let smooth = |(p, d): (&Vector, &Vector)| {
        let s = subtract(p, d);
        if s.iter().all(|c| c.is_finite()) { s } else { *p }
    };
    Ok(geometry.points().iter().zip(details.as_chunks().0).map(smooth).collect())
}

/// Flags of the welded vertices that take part in the analysis.
fn participants(decomposer: &Decomposer) -> Vec<bool> {
    let mut takes_part = vec![true; decomposer.n_places()];
    for (flag, out) in takes_part.iter_mut().zip(decomposer.domain().outsiders().unwrap_or_default()) {
        *flag = !out;
    }
    for (flag, masked) in takes_part.iter_mut().zip(decomposer.mask_flags().unwrap_or_default()) {
        *flag &= !masked;
    }
    takes_part
}

/// Areas of the cells of a cover in units of the mean area of a node, so that energies do not depend on the number of
/// vertices; equal areas if the shape has none.
fn areas_of_cells(decomposer: &Decomposer, owner: &[u32], n_cells: usize, n_nodes: f64) -> Vec<f64> {
    // Over the vertices of the analysis, whose order only their positions decide.
    let mut welded = vec![0.0; owner.len()];
    for (a, &x) in decomposer.areas().iter().zip(decomposer.vertex_map().as_slice()) {
        welded[x as usize] += a;
    }
    let mut areas = vec![0.0; n_cells];
    for (a, &cell) in welded.iter().zip(owner).filter(|(_, cell)| **cell != NO_SOURCE) {
        areas[cell as usize] += a;
    }
    let total: f64 = areas.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return vec![n_nodes / n_cells.max(1) as f64; n_cells];
    }
    areas.iter().map(|a| a / total * n_nodes).collect()
}

/// Cells of a cover that touch.
fn neighbors_of_cells(neighbors: &Adjacency, owner: &[u32], n_cells: usize) -> Adjacency {
    // Neighboring vertices have neighboring numbers, so that a chunk has few pairs of cells.
    let pairs_of = |chunk: usize| {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for x in chunk * ROWS_AT_A_TIME..owner.len().min((chunk + 1) * ROWS_AT_A_TIME) {
            for &y in neighbors.row(x) {
                let (a, b) = (owner[x], owner[y as usize]);
                if a != b && a != NO_SOURCE && b != NO_SOURCE {
                    pairs.push((a, b));
                    pairs.push((b, a));
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    };
    let n_chunks = owner.len().div_ceil(ROWS_AT_A_TIME);
    let chunks: Vec<_> = (0..n_chunks).into_par_iter().map(pairs_of).collect();
    let mut pairs = chunks.concat();
    pairs.sort_unstable();
    pairs.dedup();
    let mut offsets = vec![0; n_cells + 1];
    for (a, _) in &pairs {
        offsets[*a as usize + 1] += 1;
    }
    for k in 0..n_cells {
        offsets[k + 1] += offsets[k];
    }
    let columns = pairs.iter().map(|(_, b)| *b).collect();
    Adjacency::new(offsets, columns, n_cells).unwrap_or_else(|_| Adjacency::empty(n_cells))
}

/// For each sample the nodes within the longest path and the lengths of the paths.
fn paths_from_nodes(
    samples: PlacedGraph<'_>,
    nodes: &[u32],
    progress: Progress<'_>,
) -> Result<BlendRows, DeformError> {
    let mut front = RepeatedFront::new(samples);
    let mut found: Vec<(u32, u32, f64)> = Vec::new();
    for (k, &node) in (0..).zip(nodes) {
        progress.check()?;
        // A sample is at most a sample's distance from its vertices.
        let reached = front.run(node, LONGEST_PATH * REACH + 2.0 * SAMPLE_SPACING);
        found.extend(reached.into_iter().map(|(s, d)| (s, k, d)));
    }
    found.sort_unstable_by_key(|(s, k, _)| (*s, *k));
    let mut rows = BlendRows { offsets: vec![0; samples.points.len() + 1], ..BlendRows::default() };
    for (s, k, d) in found {
        rows.offsets[s as usize + 1] += 1;
        rows.columns.push(k);
        rows.weights.push(d);
    }
    for s in 0..samples.points.len() {
        rows.offsets[s + 1] += rows.offsets[s];
    }
    Ok(rows)
}

/// Samples in the order of their vertices' covers, with the samples at their mirror images.
struct MirroredSamples<'a> {
    planes: &'a MirrorPlanes<'a>,
    cover: &'a Cover,
}

impl SourceOrder for MirroredSamples<'_> {
    fn order(&self) -> Vec<u32> {
        (0..self.cover.sources.len() as u32).collect()
    }

    fn images(&self, sample: u32) -> Vec<u32> {
        let images = self.planes.images(self.cover.sources[sample as usize]);
        images.iter().map(|&y| self.cover.owner[y as usize]).filter(|&s| s != NO_SOURCE).collect()
    }
}

/// Samples and nodes, from which the weights at any vertex follow.
struct SampledNodes<'a> {
    samples: PlacedGraph<'a>,
    sample_of: &'a [u32],
    /// Sample of each node.
    nodes: &'a [u32],
    paths: &'a BlendRows,
}

impl SampledNodes<'_> {
    /// Weights at vertex `x`: a bump of the straight distance, if the path along the surface is not much longer.
    fn weights(&self, x: usize, points: &[Vector], entries: &mut Vec<(u32, f64)>) {
        let sample = self.sample_of[x];
        if sample == NO_SOURCE {
            return;
        }
        let BlendRow { columns: nodes, weights: paths } = self.paths.row(sample as usize);
        for (&node, &path) in nodes.iter().zip(paths) {
            let center = self.samples.points[self.nodes[node as usize] as usize];
            let t = norm(&subtract(&points[x], &center)) / REACH;
            if t >= 1.0 {
                continue;
            }
            let mut weight = (1.0 - t * t).powi(3);
            if path > FULL_PATH * REACH - 2.0 * SAMPLE_SPACING {
                let path = self.path_to(x, points, sample as usize, node) / REACH;
                weight *= smooth_rise((LONGEST_PATH - path) / (LONGEST_PATH - FULL_PATH));
            }
            if weight > 0.0 {
                entries.push((node, weight));
            }
        }
        normalize(entries);
    }

    /// Length of the shortest path from a node to `x` over a sample near `x`.
    fn path_to(&self, x: usize, points: &[Vector], sample: usize, node: u32) -> f64 {
        let over = |s: usize| {
            let BlendRow { columns: nodes, weights: paths } = self.paths.row(s);
            let path = nodes.binary_search(&node).map_or(f64::INFINITY, |k| paths[k]);
            path + norm(&subtract(&points[x], &self.samples.points[s]))
        };
        let around = self.samples.neighbors.row(sample);
        around.iter().map(|&s| over(s as usize)).fold(over(sample), f64::min)
    }
}

/// Divides weights by their sum.
pub(crate) fn normalize(entries: &mut [(u32, f64)]) {
    let sum: f64 = entries.iter().map(|(_, weight)| weight).sum();
    for (_, weight) in entries {
        *weight /= sum;
    }
}

/// The quintic 6t⁵ − 15t⁴ + 10t³, from 0 at t ≤ 0 to 1 at t ≥ 1.
pub(crate) fn smooth_rise(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}
