//! Strays of a cloud: points that lead to no more than ten points, which have no neighbors and are nobody's neighbors.
//!
//! A point is a stray by the radii of a few points around it. Radii in the tile are known; radii in other tiles are
//! searched only where the points of the tile do not decide.

use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::{Arc, Mutex};

use adwave::Progress;
use adwave::shape::{STRAY_NEIGHBORS, is_stray, leads_to};
use rayon::prelude::*;

use super::nearest::{NearestSearch, nearest_candidates, squared_distance};
use crate::error::TilesError;
use crate::index::blocks::VERTICES_IN_A_BLOCK;
use crate::index::neighbor_lists::NeighborLists;
use crate::index::position_cache::IndexedPoint;

/// List of a vertex that differs once strays are left out.
pub(super) struct Repair {
    /// Index of the vertex in the tile.
    pub(super) index: usize,
    pub(super) neighbors: Vec<u32>,
    /// Distance to the k-th neighbor; 0 for a stray.
    pub(super) radius: f64,
}

/// The nearest neighbors of a vertex, ascending, and the distance to the last of them.
type NearList = Arc<(Vec<u32>, f64)>;

pub(super) struct StraySearch<'a> {
    search: &'a NearestSearch<'a>,
    /// The [`STRAY_NEIGHBORS`] nearest neighbors of the vertices of the tile, by block.
    lists: &'a [NeighborLists],
    /// Neighbors of vertices of other tiles, as far as they were searched.
    elsewhere: Mutex<HashMap<u32, NearList>>,
    /// Vertices of other tiles that are known to be strays or not.
    known: Mutex<HashMap<u32, bool>>,
}

impl<'a> StraySearch<'a> {
    pub(super) fn new(search: &'a NearestSearch<'a>, lists: &'a [NeighborLists]) -> Self {
        Self { search, lists, elsewhere: Mutex::default(), known: Mutex::default() }
    }

    /// Lists of the vertices of the tile that differ from `lists`, of `k` neighbors, once strays are left out; in
    /// ascending order of the vertices.
    pub(super) fn repairs(
        &self,
        lists: &[NeighborLists],
        k: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<Repair>, TilesError> {
        if self.search.n_vertices() <= STRAY_NEIGHBORS {
            return Ok(Vec::new());
        }
        let flags: Vec<Vec<bool>> = (0..lists.len())
            .into_par_iter()
            .map(|block| {
                progress.check()?;
                let first = self.search.first_vertex + block * VERTICES_IN_A_BLOCK;
                let vertices = first..first + lists[block].measures.len();
                vertices.map(|vertex| self.is_stray(vertex as u32)).collect()
            })
            .collect::<Result<_, TilesError>>()?;
        let flags = flags.concat();
        let repaired: Vec<Vec<Repair>> = lists
            .par_iter()
            .enumerate()
            .map(|(block, lists)| {
                progress.check()?;
                let first = block * VERTICES_IN_A_BLOCK;
                let mut repairs = Vec::new();
                for i in 0..lists.measures.len() {
                    let index = first + i;
                    if flags[index] {
                        repairs.push(Repair { index, neighbors: Vec::new(), radius: 0.0 });
                        continue;
                    }
                    let mut n_strays = 0;
                    for &y in lists.list(i) {
                        n_strays += usize::from(self.is_flagged(y, &flags)?);
                    }
                    if n_strays > 0 {
                        let (neighbors, radius) = self.members_near(index, k, k + n_strays, &flags)?;
                        repairs.push(Repair { index, neighbors, radius });
                    }
                }
                Ok(repairs)
            })
            .collect::<Result<_, TilesError>>()?;
        Ok(repaired.into_iter().flatten().collect())
    }

    /// The `k` nearest vertices that are no strays, and the distance to the last; the search starts with `n` vertices.
    fn members_near(
        &self,
        index: usize,
        k: usize,
        mut n: usize,
        flags: &[bool],
    ) -> Result<(Vec<u32>, f64), TilesError> {
        let vertex = (self.search.first_vertex + index) as u32;
        loop {
            let (near, _) = self.search.neighbors_anywhere(vertex, n)?;
            let mut candidates = vec![self.indexed(vertex)?];
            for &y in &near {
                if !self.is_flagged(y, flags)? {
                    candidates.push(self.indexed(y)?);
                }
            }
            if candidates.len() > k || near.len() + 1 >= self.search.n_vertices() {
                let mut neighbors = Vec::new();
                let radius = nearest_candidates(vertex, k, candidates, &mut neighbors);
                return Ok((neighbors, radius));
            }
            n *= 2;
        }
    }

    fn indexed(&self, vertex: u32) -> Result<IndexedPoint, TilesError> {
        Ok(IndexedPoint { vertex, position: self.search.position(vertex)? })
    }

    /// True for a stray; `flags` are those of the tile.
    fn is_flagged(&self, vertex: u32, flags: &[bool]) -> Result<bool, TilesError> {
        if let Some(i) = self.search.index_in_tile(vertex) {
            return Ok(flags[i]);
        }
        let lock = || self.known.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(&is_known) = lock().get(&vertex) {
            return Ok(is_known);
        }
        let is_stray = self.is_stray(vertex)?;
        lock().insert(vertex, is_stray);
        Ok(is_stray)
    }

    fn is_stray(&self, vertex: u32) -> Result<bool, TilesError> {
        if self.search.index_in_tile(vertex).is_some() {
            // The points of the tile usually suffice, which need no search.
            let mut reach = |x: u32, found: &mut Vec<u32>| {
                self.push_reached_in_tile(x, found);
                Ok::<(), Infallible>(())
            };
            let Ok(may_be_stray) = is_stray(vertex, &mut reach);
            if !may_be_stray {
                return Ok(false);
            }
        }
        is_stray(vertex, &mut |x, found| self.push_reached(x, found))
    }

    /// Appends the vertices of the tile to which a vertex of the tile leads.
    fn push_reached_in_tile(&self, x: u32, found: &mut Vec<u32>) {
        let Some((list, _)) = self.list_in_tile(x) else { return };
        for &y in list {
            let (Some((_, radius)), Ok(distance)) = (self.list_in_tile(y), self.distance(x, y)) else {
                continue;
            };
            if leads_to(distance, radius) {
                found.push(y);
            }
        }
    }

    /// Appends the vertices to which a vertex leads.
    fn push_reached(&self, x: u32, found: &mut Vec<u32>) -> Result<(), TilesError> {
        let near = self.neighborhood(x)?;
        for &y in &near.0 {
            if leads_to(self.distance(x, y)?, self.neighborhood(y)?.1) {
                found.push(y);
            }
        }
        Ok(())
    }

    fn distance(&self, x: u32, y: u32) -> Result<f64, TilesError> {
        Ok(squared_distance(&self.search.position(x)?, &self.search.position(y)?).sqrt())
    }

    /// Neighbors of a vertex of the tile and the distance to the last; `None` for a vertex of another tile.
    fn list_in_tile(&self, vertex: u32) -> Option<(&[u32], f64)> {
        let i = self.search.index_in_tile(vertex)?;
        let lists = &self.lists[i / VERTICES_IN_A_BLOCK];
        Some((lists.list(i % VERTICES_IN_A_BLOCK), lists.measures[i % VERTICES_IN_A_BLOCK]))
    }

    fn neighborhood(&self, vertex: u32) -> Result<NearList, TilesError> {
        if let Some((list, radius)) = self.list_in_tile(vertex) {
            return Ok(Arc::new((list.to_vec(), radius)));
        }
        let lock = || self.elsewhere.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = lock().get(&vertex) {
            return Ok(Arc::clone(known));
        }
        let found = Arc::new(self.search.neighbors_anywhere(vertex, STRAY_NEIGHBORS)?);
        lock().insert(vertex, Arc::clone(&found));
        Ok(found)
    }
}
