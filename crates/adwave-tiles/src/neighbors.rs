//! The nearest neighbors of a tile's vertices, exact across its border.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex};

use adwave::Progress;
use adwave::pages::{release_freed, zeros};
use adwave::shape::{nearest_neighbors, nearest_to_vertex};
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::box_tree::{Bounds, BoxTree};
use crate::near_file::{self, BlockSummary, Near};

/// Distances within this part of each other may count as equal where the neighbors are chosen.
const TIE: f64 = 1e-8;

/// Finds and writes the neighborhoods of the vertices of the blocks `tile`.
pub(crate) fn neighbors_of_tile(
    blocks: &Blocks,
    tree: &BoxTree,
    tile: Range<usize>,
    k: usize,
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    release_freed();
    let first = tile.start * VERTICES_IN_A_BLOCK;
    let points = positions_of_tile(blocks, &tile)?;
    progress.check()?;
    let own = nearest_neighbors(&points, k);
    // Where there are not enough points in the tile, any other may be a neighbor.
    let wanted = k.min((blocks.n_vertices as usize).saturating_sub(1));
    let reach = |i: usize| if own.k < wanted { f64::INFINITY } else { own.radius[i] * (1.0 + TIE) };
    let cache = PositionCache::new(blocks);
    let near: Vec<(usize, Near, BlockSummary)> = tile
        .clone()
        .into_par_iter()
        .map(|block| {
            progress.check()?;
            let vertices = blocks.vertices(block);
            let mut near = Near { offsets: vec![0], ..Near::default() };
            let mut summary = BlockSummary { sum: 0.0, n_neighbors: 0, radius: 0.0 };
            for place in vertices.clone() {
                let i = place - first;
                let mut others = Vec::new();
                let around = Bounds::of(points[i]).widened(reach(i));
                tree.touching(&around, &tile, &mut |block| others.push(block));
                let start = near.places.len();
                let radius = if others.is_empty() {
                    near.places.extend(own.adjacency.row(i).iter().map(|&y| (first + y as usize) as u32));
                    own.radius[i]
                } else {
                    let mut known: Vec<(u32, [f64; 3])> = Vec::with_capacity(8 * k);
                    known.push((place as u32, points[i]));
                    let named = own.adjacency.row(i).iter();
                    known.extend(named.map(|&y| ((first + y as usize) as u32, points[y as usize])));
                    across(&cache, others, reach(i), k, &mut known, &mut near.places)?
                };
                near.measures.push(radius);
                near.offsets.push(near.places.len() as u32);
                summary.radius = summary.radius.max(radius);
                summary.n_neighbors += (near.places.len() - start) as u64;
            }
            summary.sum = sum_of_distances(&near, &vertices, first, &points, &cache)?;
            Ok((vertices.start, near, summary))
        })
        .collect::<Result<_, TilesError>>()?;
    near_file::write(path, tile.start, &near)
}

/// The positions of the vertices of the blocks `tile`.
pub(crate) fn positions_of_tile(blocks: &Blocks, tile: &Range<usize>) -> Result<Vec<[f64; 3]>, TilesError> {
    let n = blocks.vertices(tile.end - 1).end - tile.start * VERTICES_IN_A_BLOCK;
    let mut points: Vec<[f64; 3]> = zeros(n);
    points.par_chunks_mut(VERTICES_IN_A_BLOCK).zip(tile.clone()).try_for_each(|(points, block)| {
        points.copy_from_slice(&blocks.positions(block)?);
        Ok::<(), TilesError>(())
    })?;
    Ok(points)
}

/// The neighbors of the first of `known`, which are those that its own tile names, with the points of the blocks `others` of other
/// tiles: appended to `places`. Its distance to the k-th.
///
/// The k nearest of a tile are among the k nearest of all, or farther: all that is within `reach` is compared at once, by the
/// same function, in the same order.
fn across(
    cache: &PositionCache<'_>,
    mut others: Vec<usize>,
    mut reach: f64,
    k: usize,
    known: &mut Vec<(u32, [f64; 3])>,
    places: &mut Vec<u32>,
) -> Result<f64, TilesError> {
    let (place, position) = known[0];
    let square = |p: &[f64; 3]| (0..3).map(|c| (p[c] - position[c]) * (p[c] - position[c])).sum::<f64>();
    let box_distance = |block: usize| {
        let Bounds { lo, hi } = cache.blocks.boxes[block];
        let beside = |c: usize| (lo[c] - position[c]).max(position[c] - hi[c]).max(0.0);
        (0..3).map(|c| beside(c) * beside(c)).sum::<f64>().sqrt()
    };
    // The nearest first, so that what is far need not be read.
    others.sort_by(|&a, &b| box_distance(a).total_cmp(&box_distance(b)).then(a.cmp(&b)));
    for block in others {
        if box_distance(block) > reach * (1.0 + TIE) {
            break;
        }
        let held = cache.get(block)?;
        let first = cache.blocks.vertices(block).start;
        let (limit, ball) = ((reach * (1.0 + TIE)).powi(2), Bounds::of(position).widened(reach));
        for (group, positions) in held.positions.chunks(GROUP).enumerate() {
            if held.boxes[group].touches(&ball) {
                let here = (first + group * GROUP..).zip(positions).filter(|(_, p)| square(p) <= limit);
                known.extend(here.map(|(y, p)| (y as u32, *p)));
            }
        }
        if known.len() > 4 * k + 64 {
            reach = reach.min(kth_distance(known, k, square));
            let limit = (reach * (1.0 + TIE)).powi(2);
            known.retain(|(_, p)| square(p) <= limit);
        }
    }
    known.sort_unstable_by_key(|(place, _)| *place);
    let points: Vec<[f64; 3]> = known.iter().map(|(_, p)| *p).collect();
    let i = known.partition_point(|(other, _)| *other < place);
    let mut near = Vec::new();
    let radius = nearest_to_vertex(&points, i, k, &mut near);
    places.extend(near.into_iter().map(|y| known[y as usize].0));
    Ok(radius)
}

/// The distance of the k-th of `known` from the first of them, which has a square of 0; infinite where there are fewer.
fn kth_distance(known: &[(u32, [f64; 3])], k: usize, square: impl Fn(&[f64; 3]) -> f64) -> f64 {
    let mut squares: Vec<f64> = known.iter().map(|(_, p)| square(p)).collect();
    if squares.len() <= k {
        return f64::INFINITY;
    }
    squares.select_nth_unstable_by(k, f64::total_cmp).1.sqrt()
}

/// The sum of the distances to all neighbors, vertex by vertex, in the order of the curve: no tile decides it.
fn sum_of_distances(
    near: &Near,
    vertices: &Range<usize>,
    first: usize,
    points: &[[f64; 3]],
    cache: &PositionCache<'_>,
) -> Result<f64, TilesError> {
    let mut total = 0.0;
    for (i, place) in vertices.clone().enumerate() {
        let here = points[place - first];
        let mut of_vertex = 0.0;
        for &y in near.of(i) {
            let there = match (y as usize).checked_sub(first).and_then(|i| points.get(i)) {
                Some(there) => *there,
                None => cache.position(y as usize)?,
            };
            of_vertex += (0..3).map(|c| (here[c] - there[c]) * (here[c] - there[c])).sum::<f64>().sqrt();
        }
        total += of_vertex;
    }
    Ok(total)
}

/// Vertices of a block that have a box of their own.
const GROUP: usize = 64;

/// The positions of a block.
struct Held {
    positions: Vec<[f64; 3]>,
    /// Those of each group.
    boxes: Vec<Bounds>,
}

impl Held {
    fn new(positions: Vec<[f64; 3]>) -> Self {
        let around = |group: &[[f64; 3]]| {
            group.iter().fold(Bounds::NONE, |mut sum, p| {
                sum.include(&Bounds::of(*p));
                sum
            })
        };
        let boxes = positions.chunks(GROUP).map(around).collect();
        Self { positions, boxes }
    }
}

/// Positions of blocks of other tiles, the last ones kept.
pub(crate) struct PositionCache<'a> {
    blocks: &'a Blocks,
    kept: Mutex<Kept>,
}

/// Blocks with the time of their last use, and the time.
type Kept = (u64, HashMap<usize, (u64, Arc<Held>)>);

/// Blocks that are kept: 50 MB.
const MOST_KEPT: usize = 512;

impl<'a> PositionCache<'a> {
    pub(crate) fn new(blocks: &'a Blocks) -> Self {
        Self { blocks, kept: Mutex::default() }
    }

    /// The position of a vertex, by its place along the curve.
    pub(crate) fn position(&self, place: usize) -> Result<[f64; 3], TilesError> {
        Ok(self.get(place / VERTICES_IN_A_BLOCK)?.positions[place % VERTICES_IN_A_BLOCK])
    }

    fn get(&self, block: usize) -> Result<Arc<Held>, TilesError> {
        let lock = || self.kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        {
            let mut kept = lock();
            let (clock, kept) = &mut *kept;
            *clock += 1;
            if let Some((used, held)) = kept.get_mut(&block) {
                *used = *clock;
                return Ok(Arc::clone(held));
            }
        }
        let held = Arc::new(Held::new(self.blocks.positions(block)?));
        let mut kept = lock();
        let (clock, kept) = &mut *kept;
        if kept.len() >= MOST_KEPT {
            // The older half goes.
            let mut times: Vec<u64> = kept.values().map(|(used, _)| *used).collect();
            let middle = *times.select_nth_unstable(MOST_KEPT / 2).1;
            kept.retain(|_, (used, _)| *used > middle);
        }
        kept.insert(block, (*clock, Arc::clone(&held)));
        Ok(held)
    }
}
