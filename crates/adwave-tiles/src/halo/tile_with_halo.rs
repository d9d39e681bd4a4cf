//! The vertices of a tile and its halo, with the data from which T is assembled.

use std::ops::Range;

use adwave::pages::zeros;
use adwave::rows::Pattern;
use rayon::prelude::*;

use super::ring_search::{BlockVertex, NOT_IN_HALO, RingSearch};
use crate::error::TilesError;
use crate::index::interval_set::IntervalSet;

/// A tile with its halo. Its vertices are in the order of the curve; their position in this order is the *local index*.
#[derive(Debug)]
pub(crate) struct TileWithHalo {
    /// Positions, in units of the layout.
    pub(crate) points: Vec<[f64; 3]>,
    /// Neighbors by local index. Rows of the outermost ring are empty.
    pub(crate) neighbors: Pattern,
    /// Areas of the vertices (eq. 1).
    pub(crate) areas: Vec<f64>,
    /// Local indices of the interior.
    pub(crate) interior_range: Range<usize>,
    /// Vertex indices along the curve; the rank of an index is the local index.
    pub(crate) vertices: IntervalSet,
}

impl TileWithHalo {
    /// Takes the vertices that a search of `n_rings` rings around the blocks `interior` has reached.
    pub(crate) fn from_search(
        mut search: RingSearch<'_>,
        interior: &Range<usize>,
        n_rings: u16,
    ) -> Result<Self, TilesError> {
        search.retain_reached();
        let mut n = 0;
        let mut interior_range = 0..0;
        let mut local_indices: Vec<Vec<u32>> = Vec::with_capacity(search.loaded.len());
        for loaded in &search.loaded {
            if loaded.block == interior.start {
                interior_range.start = n as usize;
            }
            let local_index = |&ring: &u16| {
                let is_reached = ring != NOT_IN_HALO;
                n += u32::from(is_reached);
                if is_reached { n - 1 } else { u32::MAX }
            };
            local_indices.push(loaded.rings.iter().map(local_index).collect());
            if loaded.block + 1 == interior.end {
                interior_range.end = n as usize;
            }
        }
        let vertices = reached_vertices(&search);
        let (points, areas) = read_points_and_areas(&search, n as usize)?;
        let neighbors = local_neighbors(&search, &local_indices, points.len(), n_rings)?;
        Ok(Self { points, neighbors, areas, interior_range, vertices })
    }
}

fn reached_vertices(search: &RingSearch<'_>) -> IntervalSet {
    let mut vertices = IntervalSet::default();
    for loaded in &search.loaded {
        let rings = search.blocks.vertices(loaded.block).zip(&loaded.rings);
        rings.filter(|(_, ring)| **ring != NOT_IN_HALO).for_each(|(vertex, _)| vertices.push(vertex));
    }
    vertices
}

/// Neighbor lists of the `n` reached vertices by local index.
fn local_neighbors(
    search: &RingSearch<'_>,
    local_indices: &[Vec<u32>],
    n: usize,
    n_rings: u16,
) -> Result<Pattern, TilesError> {
    let mut offsets: Vec<usize> = zeros(n + 1);
    let mut at = 0;
    for loaded in &search.loaded {
        for (i, &ring) in loaded.rings.iter().enumerate().filter(|(_, ring)| **ring != NOT_IN_HALO) {
            let length = if ring < n_rings { loaded.neighbors(i).len() } else { 0 };
            offsets[at + 1] = offsets[at] + length;
            at += 1;
        }
    }
    let mut columns: Vec<u32> = zeros(offsets[at]);
    let mut rest = &mut columns[..];
    let mut jobs = Vec::new();
    for loaded in &search.loaded {
        let rows = loaded.rings.iter().enumerate().filter(|(_, ring)| **ring < n_rings);
        let length = rows.map(|(i, _)| loaded.neighbors(i).len()).sum();
        let (block_columns, after) = std::mem::take(&mut rest).split_at_mut(length);
        rest = after;
        jobs.push((loaded, block_columns));
    }
    jobs.into_par_iter().for_each(|(loaded, columns)| {
        let rows = loaded.rings.iter().enumerate().filter(|(_, ring)| **ring < n_rings);
        let neighbors = rows.flat_map(|(i, _)| loaded.neighbors(i));
        for (column, &y) in columns.iter_mut().zip(neighbors) {
            let y = BlockVertex::from_index(y);
            *column = local_indices[search.slot(y)][y.i];
        }
    });
    Pattern::new(offsets, columns, n).map_err(|e| {
        TilesError::Input(format!(
            "the neighbor lists of the tiles are inconsistent ({e}); delete the work folder and start again"
        ))
    })
}

/// Reads the positions and areas (eq. 1) of the `n` reached vertices. The search itself does not need them.
fn read_points_and_areas(search: &RingSearch<'_>, n: usize) -> Result<(Vec<[f64; 3]>, Vec<f64>), TilesError> {
    let (mut points, mut areas): (Vec<[f64; 3]>, Vec<f64>) = (zeros(n), zeros(n));
    let (mut rest_of_points, mut rest_of_areas) = (&mut points[..], &mut areas[..]);
    let mut jobs = Vec::with_capacity(search.loaded.len());
    for loaded in &search.loaded {
        let n = loaded.rings.iter().filter(|ring| **ring != NOT_IN_HALO).count();
        let (points, more_points) = std::mem::take(&mut rest_of_points).split_at_mut(n);
        let (areas, more_areas) = std::mem::take(&mut rest_of_areas).split_at_mut(n);
        (rest_of_points, rest_of_areas) = (more_points, more_areas);
        jobs.push((loaded, points, areas));
    }
    jobs.into_par_iter().try_for_each(|(loaded, points, areas)| {
        let block_positions = search.blocks.read_positions(loaded.block)?;
        let block_areas = search.neighbor_index.read_areas(search.blocks, loaded.block)?;
        let all = loaded.rings.iter().zip(block_positions.iter().zip(block_areas));
        let reached = all.filter(|(ring, _)| **ring != NOT_IN_HALO).map(|(_, values)| values);
        for ((point, area), (position, block_area)) in points.iter_mut().zip(areas).zip(reached) {
            *point = *position;
            *area = block_area;
        }
        Ok::<(), TilesError>(())
    })?;
    Ok((points, areas))
}
