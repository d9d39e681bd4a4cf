//! The k nearest neighbors of a tile's vertices, for clouds.
//!
//! They are searched in the tile first. If the ball to the k-th neighbor intersects the box of a block of another tile,
//! the points of that block are compared too, by the same rule for ties. Strays have no neighbors and are no neighbors.
//! The sum of distances is taken vertex by vertex in the order of the curve, so that it does not depend on the tiles.

use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave::pages::release_freed;
use adwave::shape::{Neighborhoods, STRAY_NEIGHBORS, nearest_neighbors, nearest_to_vertex};
use rayon::prelude::*;

use super::strays::{Repair, StraySearch};
use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::bounds_tree::BoundsTree;
use crate::index::neighbor_lists::{BlockNeighbors, BlockSummary, NeighborLists, write_neighbor_file};
use crate::index::position_cache::{IndexedPoint, PositionCache};

/// Relative difference of distances that may count as equal when neighbors are chosen.
const TIE_TOLERANCE: f64 = 1e-8;

/// Finds the `k` nearest neighbors of the vertices of the blocks `interior` and writes them to `path`; `tree` holds the
/// boxes of all blocks.
pub(crate) fn write_nearest_neighbors(
    blocks: &Blocks,
    tree: &BoundsTree,
    interior: Range<usize>,
    k: usize,
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    release_freed();
    let points = blocks.read_positions_of_range(&interior)?;
    progress.check()?;
    let search = |k| NearestSearch::new(blocks, tree, &interior, &points, k);
    let near = search(STRAY_NEIGHBORS);
    let near_lists = near.block_lists(progress)?;
    let mut lists = if k == STRAY_NEIGHBORS { None } else { Some(search(k).block_lists(progress)?) };
    let repairs =
        StraySearch::new(&near, &near_lists).repairs(lists.as_deref().unwrap_or(&near_lists), k, progress)?;
    let mut lists = lists.take().unwrap_or(near_lists);
    repair_lists(&mut lists, repairs);
    let summarize = |(block, lists): (usize, NeighborLists)| {
        progress.check()?;
        let vertices = blocks.vertices(block);
        let summary = near.summary(&vertices, &lists)?;
        Ok(BlockNeighbors { first_vertex: vertices.start, lists, summary })
    };
    let found: Vec<BlockNeighbors> =
        interior.clone().into_par_iter().zip(lists).map(summarize).collect::<Result<_, TilesError>>()?;
    write_neighbor_file(path, interior.start, &found)
}

/// Replaces lists of vertices, by their index in the tile.
fn repair_lists(lists: &mut [NeighborLists], repairs: Vec<Repair>) {
    let mut repairs = repairs.into_iter().peekable();
    let mut first = 0;
    for lists in lists {
        let end = first + lists.measures.len();
        if repairs.peek().is_some_and(|repair| repair.index < end) {
            let mut repaired = NeighborLists::new();
            for i in 0..lists.measures.len() {
                let (neighbors, radius) = match repairs.next_if(|repair| repair.index == first + i) {
                    Some(repair) => (repair.neighbors, repair.radius),
                    None => (lists.list(i).to_vec(), lists.measures[i]),
                };
                repaired.neighbors.extend(neighbors);
                repaired.measures.push(radius);
                repaired.end_list();
            }
            *lists = repaired;
        }
        first = end;
    }
}

/// Search for the `k` nearest neighbors of any vertex, the vertices of a tile first.
pub(super) struct NearestSearch<'a> {
    tree: &'a BoundsTree,
    /// Blocks of the tile.
    interior: Range<usize>,
    pub(super) first_vertex: usize,
    /// Positions of the vertices of the tile.
    points: &'a [[f64; 3]],
    /// Nearest neighbors among these.
    in_tile: Neighborhoods,
    k: usize,
    /// Number of neighbors that a vertex has in the whole cloud.
    n_expected: usize,
    cache: PositionCache<'a>,
}

impl<'a> NearestSearch<'a> {
    fn new(
        blocks: &'a Blocks,
        tree: &'a BoundsTree,
        interior: &Range<usize>,
        points: &'a [[f64; 3]],
        k: usize,
    ) -> Self {
        Self {
            tree,
            first_vertex: blocks.vertices(interior.start).start,
            in_tile: nearest_neighbors(points, k),
            points,
            k,
            // A smaller tile than this has too few points: any other point may be a neighbor.
            n_expected: k.min((blocks.n_vertices as usize).saturating_sub(1)),
            cache: PositionCache::new(blocks),
            interior: interior.clone(),
        }
    }

    /// Number of vertices of the whole cloud.
    pub(super) fn n_vertices(&self) -> usize {
        self.cache.blocks.n_vertices as usize
    }

    /// Index of a vertex in the tile; `None` for one of another tile.
    pub(super) fn index_in_tile(&self, vertex: u32) -> Option<usize> {
        (vertex as usize).checked_sub(self.first_vertex).filter(|&i| i < self.points.len())
    }

    pub(super) fn position(&self, vertex: u32) -> Result<[f64; 3], TilesError> {
        match self.index_in_tile(vertex) {
            Some(i) => Ok(self.points[i]),
            None => self.cache.position(vertex as usize),
        }
    }

    /// Neighbor lists of all blocks of the tile, with the distances to the k-th neighbors.
    fn block_lists(&self, progress: Progress<'_>) -> Result<Vec<NeighborLists>, TilesError> {
        let block_lists = |block| {
            progress.check()?;
            let mut lists = NeighborLists::new();
            for vertex in self.cache.blocks.vertices(block) {
                let radius = self.push_neighbors(vertex, &mut lists.neighbors)?;
                lists.measures.push(radius);
                lists.end_list();
            }
            Ok(lists)
        };
        self.interior.clone().into_par_iter().map(block_lists).collect()
    }

    fn summary(&self, vertices: &Range<usize>, lists: &NeighborLists) -> Result<BlockSummary, TilesError> {
        Ok(BlockSummary {
            distance_sum: self.sum_of_distances(vertices, lists)?,
            n_distances: lists.neighbors.len() as u64,
            max_radius: lists.measures.iter().copied().fold(0.0, f64::max),
        })
    }

    /// Neighbors of any vertex of the cloud, ascending, and the distance to the k-th.
    pub(super) fn neighbors_anywhere(&self, vertex: u32, k: usize) -> Result<(Vec<u32>, f64), TilesError> {
        let blocks = self.cache.blocks;
        let block = vertex as usize / VERTICES_IN_A_BLOCK;
        let position = self.position(vertex)?;
        let own = self.cache.block(block)?;
        let mut candidates = vec![IndexedPoint { vertex, position }];
        candidates.extend(own.points(blocks.vertices(block).start).filter(|point| point.vertex != vertex));
        let reach =
            kth_distance(candidates.iter().map(|p| squared_distance(&p.position, &position)).collect(), k);
        let limit = (reach * (1.0 + TIE_TOLERANCE)).powi(2);
        candidates.retain(|point| squared_distance(&point.position, &position) <= limit);
        let ball = BoundingBox::from_point(position).expand_by(reach * (1.0 + TIE_TOLERANCE));
        let mut other_blocks = Vec::new();
        self.tree.visit_intersecting(&ball, &(block..block + 1), &mut |other| other_blocks.push(other));
        let mut neighbors = Vec::new();
        let radius = self.push_neighbors_across_border(other_blocks, reach, k, candidates, &mut neighbors)?;
        Ok((neighbors, radius))
    }

    /// Appends the neighbors of a vertex. Returns the distance to the k-th.
    fn push_neighbors(&self, vertex: usize, neighbors: &mut Vec<u32>) -> Result<f64, TilesError> {
        let i = vertex - self.first_vertex;
        let reach = if self.in_tile.k < self.n_expected {
            f64::INFINITY
        } else {
            self.in_tile.radius[i] * (1.0 + TIE_TOLERANCE)
        };
        let ball = BoundingBox::from_point(self.points[i]).expand_by(reach);
        let mut other_blocks = Vec::new();
        self.tree.visit_intersecting(&ball, &self.interior, &mut |block| other_blocks.push(block));
        let vertex_index = |y: u32| (self.first_vertex + y as usize) as u32;
        let in_tile = self.in_tile.adjacency.row(i).iter();
        if other_blocks.is_empty() {
            neighbors.extend(in_tile.map(|&y| vertex_index(y)));
            return Ok(self.in_tile.radius[i]);
        }
        let mut candidates = Vec::with_capacity(8 * self.k);
        candidates.push(IndexedPoint { vertex: vertex as u32, position: self.points[i] });
        candidates.extend(
            in_tile.map(|&y| IndexedPoint { vertex: vertex_index(y), position: self.points[y as usize] }),
        );
        self.push_neighbors_across_border(other_blocks, reach, self.k, candidates, neighbors)
    }

    /// Appends the nearest neighbors of the first candidate, among all candidates and the points of `other_blocks`.
    /// Returns the distance to the k-th.
    ///
    /// The candidates include the k nearest of all points that are not in `other_blocks`. The k nearest in the tile are
    /// among the k nearest of all, or farther away than these. All points within `reach` are compared together, by the
    /// same function and in the same order as in memory.
    fn push_neighbors_across_border(
        &self,
        mut other_blocks: Vec<usize>,
        mut reach: f64,
        k: usize,
        mut candidates: Vec<IndexedPoint>,
        neighbors: &mut Vec<u32>,
    ) -> Result<f64, TilesError> {
        let blocks = self.cache.blocks;
        let IndexedPoint { vertex, position } = candidates[0];
        let squared_distance = |point: &IndexedPoint| squared_distance(&point.position, &position);
        let box_distance = |block: usize| blocks.bounds[block].distance_to(position);
        // The nearest first, so that distant blocks need not be read.
        other_blocks.sort_by(|&a, &b| box_distance(a).total_cmp(&box_distance(b)).then(a.cmp(&b)));
        for block in other_blocks {
            if box_distance(block) > reach * (1.0 + TIE_TOLERANCE) {
                break;
            }
            let limit = (reach * (1.0 + TIE_TOLERANCE)).powi(2);
            let ball = BoundingBox::from_point(position).expand_by(reach);
            let positions = self.cache.block(block)?;
            let near = positions.points_near(&ball, blocks.vertices(block).start);
            candidates.extend(near.filter(|point| squared_distance(point) <= limit));
            if candidates.len() > 4 * k + 64 {
                reach = reach.min(kth_distance(candidates.iter().map(squared_distance).collect(), k));
                let limit = (reach * (1.0 + TIE_TOLERANCE)).powi(2);
                candidates.retain(|point| squared_distance(point) <= limit);
            }
        }
        Ok(nearest_candidates(vertex, k, candidates, neighbors))
    }

    /// Sum of the distances to all neighbors of the vertices of a block, vertex by vertex.
    fn sum_of_distances(&self, vertices: &Range<usize>, lists: &NeighborLists) -> Result<f64, TilesError> {
        let mut total = 0.0;
        for (i, vertex) in vertices.clone().enumerate() {
            let position = self.points[vertex - self.first_vertex];
            let mut vertex_sum = 0.0;
            for &y in lists.list(i) {
                let local = (y as usize).checked_sub(self.first_vertex);
                let other = match local.and_then(|i| self.points.get(i)) {
                    Some(other) => *other,
                    None => self.cache.position(y as usize)?,
                };
                let difference = |c: usize| position[c] - other[c];
                vertex_sum += (0..3).map(|c| difference(c) * difference(c)).sum::<f64>().sqrt();
            }
            total += vertex_sum;
        }
        Ok(total)
    }
}

pub(super) fn squared_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c])).sum()
}

/// Appends the `k` nearest of the candidates, one of which is `vertex` itself, by the rule for ties. Returns the
/// distance to the k-th.
pub(super) fn nearest_candidates(
    vertex: u32,
    k: usize,
    mut candidates: Vec<IndexedPoint>,
    neighbors: &mut Vec<u32>,
) -> f64 {
    candidates.sort_unstable_by_key(|point| point.vertex);
    let points: Vec<[f64; 3]> = candidates.iter().map(|point| point.position).collect();
    let i = candidates.partition_point(|other| other.vertex < vertex);
    let mut nearest = Vec::new();
    let radius = nearest_to_vertex(&points, i, k, &mut nearest);
    neighbors.extend(nearest.into_iter().map(|y| candidates[y as usize].vertex));
    radius
}

/// Distance of the k-th nearest candidate, one of which is the vertex itself with distance 0; infinite if there are
/// fewer.
fn kth_distance(mut squared_distances: Vec<f64>, k: usize) -> f64 {
    if squared_distances.len() <= k {
        return f64::INFINITY;
    }
    squared_distances.select_nth_unstable_by(k, f64::total_cmp).1.sqrt()
}
