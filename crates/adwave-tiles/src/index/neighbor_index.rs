//! The neighbor lists of all tiles.

use std::f64::consts::PI;

use crate::error::TilesError;
use crate::index::blocks::Blocks;
use crate::index::bounds_tree::BoundsTree;
use crate::index::neighbor_lists::{NeighborFile, NeighborLists};

/// The neighbor lists of all tiles, on disk, with the mean distance and the search tree in memory.
#[derive(Debug)]
pub(crate) struct NeighborIndex {
    files: Vec<NeighborFile>,
    blocks_per_tile: usize,
    /// For each block, a box around the balls to the k-th neighbors of its vertices.
    pub(crate) ball_bounds: BoundsTree,
    /// Mean distance between neighbors, E of (eq. 1), in units of the layout.
    pub(crate) mean_length: f64,
    pub(crate) rule: NeighborRule,
}

/// Rule that decides which vertices are neighbors, and which measure a vertex has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NeighborRule {
    /// Two vertices are neighbors if one is among the k nearest of the other. The measure is the distance to the k-th
    /// nearest.
    Nearest(usize),
    /// Two vertices are neighbors if they share an edge. The measure is the area.
    Edges,
}

impl NeighborRule {
    /// Area of a vertex (eq. 1) with this measure.
    pub(crate) fn area(self, measure: f64) -> f64 {
        match self {
            Self::Nearest(k) => PI * measure * measure / k.max(1) as f64,
            Self::Edges => measure,
        }
    }
}

/// Relative difference of distances that may count as equal when neighbors are chosen.
const TIE_TOLERANCE: f64 = 1e-8;

impl NeighborIndex {
    /// Takes the neighbor files of all tiles, in order.
    pub(crate) fn new(
        files: Vec<NeighborFile>,
        blocks: &Blocks,
        blocks_per_tile: usize,
        rule: NeighborRule,
    ) -> Self {
        let summaries = || files.iter().flat_map(|file| &file.summaries);
        let balls = blocks.bounds.iter().zip(summaries());
        // Ties may be slightly farther away than the k-th neighbor.
        let balls =
            balls.map(|(bounds, summary)| bounds.expand_by(summary.max_radius * (1.0 + TIE_TOLERANCE)));
        let ball_bounds = BoundsTree::new(balls.collect());
        let total: f64 = summaries().map(|summary| summary.distance_sum).sum();
        let n: u64 = summaries().map(|summary| summary.n_distances).sum();
        let mean_length = total / n.max(1) as f64;
        Self { files, blocks_per_tile, ball_bounds, mean_length, rule }
    }

    pub(crate) fn read_lists(&self, blocks: &Blocks, block: usize) -> Result<NeighborLists, TilesError> {
        self.file(block).read_lists(block, &blocks.vertices(block), blocks.n_vertices)
    }

    /// Areas of the vertices of a block (eq. 1), in squared units of the layout.
    pub(crate) fn read_areas(&self, blocks: &Blocks, block: usize) -> Result<Vec<f64>, TilesError> {
        let measures = self.file(block).read_measures(block, blocks.vertices(block).len())?;
        Ok(measures.into_iter().map(|measure| self.rule.area(measure)).collect())
    }

    fn file(&self, block: usize) -> &NeighborFile {
        &self.files[block / self.blocks_per_tile]
    }
}
