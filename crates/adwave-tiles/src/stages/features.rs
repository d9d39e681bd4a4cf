//! The features of a tile (Algorithm 2), a part of the maps stage.

use std::ops::Range;

use adwave::Progress;
use adwave::features::is_extremum;
use adwave::pages::zeros;
use adwave::rows::Pattern;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::StageContext;
use super::maps::BandResults;
use crate::error::TilesError;
use crate::halo::{HaloLimits, TileWithHalo, visit_tiles_with_halo};
use crate::index::blocks::Blocks;
use crate::layout::{RecordLayout, index_in_file};

/// Relative difference below which responses are equal: norms are stored as 32-bit floats.
const TIE_TOLERANCE: f64 = f32::EPSILON as f64;

/// A feature as a tile stores it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredFeature {
    /// Vertex index along the curve.
    pub(crate) curve_index: usize,
    /// For a mesh the index of the vertex in the file, for a cloud the index of the point in the order of the curve. If
    /// several have the same position, it is the first.
    pub(crate) vertex: u64,
    /// Position in model units.
    pub(crate) position: [f64; 3],
    pub(crate) level: usize,
    /// ‖W_j‖ over its mean.
    pub(crate) response: f64,
}

/// Finds the features in the blocks `interior`: vertices where ‖W_j‖ over the mean of its level exceeds θ and is an
/// extremum over neighbors and levels.
pub(crate) fn find_features(
    context: &StageContext<'_>,
    interior: Range<usize>,
    bands: BandResults<'_>,
    progress: Progress<'_>,
) -> Result<Vec<StoredFeature>, TilesError> {
    let StageContext { shape, params, blocks, neighbor_index, limits } = *context;
    let Some(theta) = params.theta else { return Ok(Vec::new()) };
    let unit = shape.layout.unit();
    let level_scale = |mean: f64| if mean > 0.0 { mean / unit } else { 1.0 };
    let scales: Vec<f64> = bands.levels.iter().map(|level| level_scale(level.mean)).collect();
    // As in memory: two rings on a mesh, the neighbors of one step in a cloud.
    let n_rings = if shape.is_mesh() { 2 } else { 1 };
    let limits = HaloLimits { n_rings, ..limits };
    let mut found = Vec::new();
    visit_tiles_with_halo(blocks, neighbor_index, interior, limits, progress, |tile, interior| {
        let search = FeatureSearch {
            neighbors: &tile.neighbors,
            norms: tile_norms(&tile, bands, scales.len())?,
            scales: &scales,
            n_rings,
            theta,
        };
        let first = blocks.vertices(interior.start).start;
        let block_features = |block: usize| {
            progress.check()?;
            let vertices = blocks.vertices(block);
            let start = tile.interior_range.start + vertices.start - first;
            let hits: Vec<(usize, usize)> = (0..vertices.len())
                .flat_map(|i| (2..bands.levels.len()).map(move |level| (i, level)))
                .filter(|&(i, level)| search.is_feature(start + i, level))
                .collect();
            if hits.is_empty() {
                return Ok(Vec::new());
            }
            let names = output_indices(shape.layout, blocks, block)?;
            let stored = |&(i, level): &(usize, usize)| StoredFeature {
                curve_index: vertices.start + i,
                vertex: names[i],
                position: tile.points[start + i].map(|c| c * unit),
                level,
                response: search.response(start + i, level),
            };
            Ok(hits.iter().map(stored).collect())
        };
        let features: Vec<Vec<StoredFeature>> =
            interior.into_par_iter().map(block_features).collect::<Result<_, TilesError>>()?;
        found.extend(features.concat());
        Ok(())
    })?;
    Ok(found)
}

/// Norms of all bands at the vertices of a tile with its halo, a row per vertex.
fn tile_norms(tile: &TileWithHalo, bands: BandResults<'_>, n_levels: usize) -> Result<Vec<f32>, TilesError> {
    let mut norms: Vec<f32> = zeros(tile.points.len() * n_levels);
    norms.clear();
    for range in tile.vertices.ranges() {
        bands.norms.read(range.clone(), &mut norms)?;
    }
    Ok(norms)
}

/// Index of each vertex of a block in the output ([`StoredFeature::vertex`]).
fn output_indices(layout: RecordLayout, blocks: &Blocks, block: usize) -> Result<Vec<u64>, TilesError> {
    let records = blocks.read_records(block)?;
    let mut indices: Vec<u64> = Vec::with_capacity(blocks.vertices(block).len());
    for (row, (vertex, record)) in (blocks.first_record(block)..).zip(blocks.with_vertices(&records)) {
        let Some(vertex) = vertex else { continue };
        let index = match layout {
            RecordLayout::Las(_) => row,
            RecordLayout::Mesh(_) => u64::from(index_in_file(record)),
        };
        if vertex == indices.len() {
            indices.push(index);
        }
        indices[vertex] = indices[vertex].min(index);
    }
    Ok(indices)
}

/// The responses of a tile with its halo.
struct FeatureSearch<'a> {
    neighbors: &'a Pattern,
    /// Norms of all bands, a row per vertex, in units of the layout.
    norms: Vec<f32>,
    /// Mean norm of each level.
    scales: &'a [f64],
    n_rings: usize,
    theta: f64,
}

impl FeatureSearch<'_> {
    /// R(j,x) (see [`Response`](adwave::features::Response)).
    fn response(&self, x: usize, level: usize) -> f64 {
        f64::from(self.norms[x * self.scales.len() + level - 1]) / self.scales[level - 1]
    }

    /// Returns true if x, a vertex of the interior, is a feature of `level`, which is neither the first nor the last.
    fn is_feature(&self, x: usize, level: usize) -> bool {
        let levels = |y: usize| [level - 1, level, level + 1].map(|level| self.response(y, level));
        let neighbors = self.neighbors.row(x);
        // Algorithm 2: |R(j,x)| > θ·mean|R(j)|, and an extremum over place and scale
        self.response(x, level) > self.theta
            && is_extremum(x, neighbors, TIE_TOLERANCE, levels)
            && (self.n_rings == 1 || is_extremum(x, &self.two_ring(x), TIE_TOLERANCE, levels))
    }

    fn two_ring(&self, x: usize) -> Vec<u32> {
        let neighbors = self.neighbors.row(x);
        let next = neighbors.iter().flat_map(|&y| self.neighbors.row(y as usize));
        let mut both: Vec<u32> = neighbors.iter().chain(next).copied().filter(|&y| y as usize != x).collect();
        both.sort_unstable();
        both.dedup();
        both
    }
}
