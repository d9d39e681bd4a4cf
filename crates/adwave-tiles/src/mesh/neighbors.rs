//! The neighbors and areas of a tile's vertices, by the faces around them.

use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave::pages::release_freed;
use adwave::shape::{Adjacency, MeshArea, Polygons, mesh_areas, one_ring, triangulate};
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::near_file::{self, BlockSummary, Near};
use crate::neighbors::{PositionCache, positions_of_tile};
use crate::outputs::length;

/// Finds and writes the neighborhoods of the vertices of the blocks `tile`, whose faces are in the file `faces`, of `n_bytes` bytes.
pub(crate) fn neighbors_of_tile(
    blocks: &Blocks,
    tile: Range<usize>,
    (faces, n_bytes): (&Path, u64),
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    release_freed();
    let around = Around::read(blocks, &tile, faces, n_bytes)?;
    progress.check()?;
    let triangles = triangulate(&around.points, &around.faces);
    progress.check()?;
    let ring = one_ring(around.points.len(), &triangles);
    progress.check()?;
    let areas = mesh_areas(&around.points, &triangles, MeshArea::Barycentric);
    let near: Vec<(usize, Near, BlockSummary)> = tile
        .into_par_iter()
        .map(|block| {
            progress.check()?;
            let vertices = blocks.vertices(block);
            let (near, summary) = around.block(&vertices, &ring, &areas);
            Ok((vertices.start, near, summary))
        })
        .collect::<Result<_, TilesError>>()?;
    near_file::write(path, near.first().map_or(0, |(first, ..)| first / VERTICES_IN_A_BLOCK), &near)
}

/// The vertices of a tile and those that share a face with them, in the order of the curve.
struct Around {
    /// The places of those that come before the tile, and after it.
    before: Vec<u32>,
    after: Vec<u32>,
    /// The places of those of the tile.
    own: Range<usize>,
    points: Vec<[f64; 3]>,
    /// In the order of the mesh; corners are counted among `points`.
    faces: Polygons,
}

impl Around {
    fn read(blocks: &Blocks, tile: &Range<usize>, faces: &Path, n_bytes: u64) -> Result<Self, TilesError> {
        let bytes = std::fs::read(faces).map_err(TilesError::io(faces))?;
        let broken = || TilesError::broken(faces, "its faces are not whole");
        if bytes.len() as u64 != n_bytes {
            return Err(broken());
        }
        let own = blocks.vertices(tile.start).start..blocks.vertices(tile.end - 1).end;
        let others = all_places(&bytes).filter(|&place| !own.contains(&(place as usize)));
        let mut before: Vec<u32> = others.collect();
        before.par_sort_unstable();
        before.dedup();
        if before.last().is_some_and(|&last| u64::from(last) >= blocks.n_vertices) {
            return Err(broken());
        }
        let after = before.split_off(before.partition_point(|&place| (place as usize) < own.start));
        let cache = PositionCache::new(blocks);
        let position = |&place: &u32| cache.position(place as usize);
        let mut points = before.iter().map(position).collect::<Result<Vec<_>, _>>()?;
        points.extend(positions_of_tile(blocks, tile)?);
        for place in &after {
            points.push(position(place)?);
        }
        let mut around = Self { before, after, own, points, faces: Polygons::new() };
        let mut face = Vec::new();
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let (corners, after) = first_face(rest).ok_or_else(broken)?;
            rest = after;
            face.clear();
            face.extend(places(corners).map(|place| around.number(place)));
            around.faces.push(&face);
        }
        Ok(around)
    }

    /// The number of a vertex among the points.
    fn number(&self, place: u32) -> u32 {
        let at = place as usize;
        let number = if at < self.own.start {
            self.before.partition_point(|&other| other < place)
        } else if at < self.own.end {
            self.before.len() + at - self.own.start
        } else {
            self.before.len() + self.own.len() + self.after.partition_point(|&other| other < place)
        };
        number as u32
    }

    /// The place of a point along the curve.
    fn place(&self, number: u32) -> u32 {
        let i = number as usize;
        if let Some(&place) = self.before.get(i) {
            return place;
        }
        let i = i - self.before.len();
        self.after.get(i.wrapping_sub(self.own.len())).map_or((self.own.start + i) as u32, |&place| place)
    }

    fn block(&self, vertices: &Range<usize>, ring: &Adjacency, areas: &[f64]) -> (Near, BlockSummary) {
        let mut near = Near { offsets: vec![0], ..Near::default() };
        let mut summary = BlockSummary { sum: 0.0, n_neighbors: 0, radius: 0.0 };
        let first = self.number(vertices.start as u32) as usize;
        near.measures.extend(&areas[first..first + vertices.len()]);
        for x in first..first + vertices.len() {
            let distance = |y: u32| {
                let [p, q] = [self.points[x], self.points[y as usize]];
                length([p[0] - q[0], p[1] - q[1], p[2] - q[2]])
            };
            near.places.extend(ring.row(x).iter().map(|&y| self.place(y)));
            near.offsets.push(near.places.len() as u32);
            // Each edge once, in the order of the curve: no tile decides it.
            let later = ring.row(x).iter().filter(|&&y| y as usize > x);
            summary.sum += later.clone().map(|&y| distance(y)).sum::<f64>();
            summary.n_neighbors += later.count() as u64;
        }
        (near, summary)
    }
}

/// The corners of the first face, four bytes each, and what follows it.
pub(super) fn first_face(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (n, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked((u32::from_le_bytes(*n) as usize).checked_mul(4)?)
}

/// The places of the corners of a face.
pub(super) fn places(corners: &[u8]) -> impl Iterator<Item = u32> {
    corners.as_chunks::<4>().0.iter().map(|place| u32::from_le_bytes(*place))
}

/// The places of the corners of all faces.
fn all_places(bytes: &[u8]) -> impl Iterator<Item = u32> {
    let mut rest = bytes;
    let faces = std::iter::from_fn(move || {
        let (corners, after) = first_face(rest)?;
        rest = after;
        Some(corners)
    });
    faces.flat_map(places)
}
