//! The one-rings and areas of a tile's vertices, for meshes.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave::pages::release_freed;
use adwave::shape::{
    Adjacency, MeshArea, Polygons, face_areas, face_ring, face_vertex_normals, one_ring, triangulate,
};
use rayon::prelude::*;

use crate::error::TilesError;
use crate::files::write_atomic;
use crate::index::blocks::Blocks;
use crate::index::face_lists::{FaceFile, decode_all_corners, decode_corners, split_first_face};
use crate::index::neighbor_lists::{BlockNeighbors, BlockSummary, NeighborLists, write_neighbor_file};
use crate::index::position_cache::PositionCache;
use crate::stages::motion::{SURFACE_ROW_BYTES, SurfaceRow};
use crate::vector::length;

/// Neighbors of a vertex by the faces around it.
#[derive(Clone, Copy)]
pub(crate) enum RingRule {
    /// Vertices that share a side of a face: the steps of the walk.
    Sides,
    /// Vertices that share a side of a triangle into which faces are cut: the neighbors that the denoiser uses.
    Triangles,
}

/// Finds the neighbors of the vertices of the blocks `interior` by the faces of the tile and writes them.
pub(crate) fn write_one_rings(
    blocks: &Blocks,
    interior: Range<usize>,
    face_file: &FaceFile,
    ring_rule: RingRule,
    paths: OneRingPaths<'_>,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    release_freed();
    let surroundings = TileFaces::read(blocks, &interior, face_file)?;
    progress.check()?;
    let ring = match ring_rule {
        RingRule::Sides => face_ring(surroundings.points.len(), &surroundings.faces),
        RingRule::Triangles => {
            one_ring(surroundings.points.len(), &triangulate(&surroundings.points, &surroundings.faces))
        }
    };
    progress.check()?;
    let areas = face_areas(&surroundings.points, &surroundings.faces, MeshArea::Barycentric);
    let first_block = interior.start;
    let found: Vec<BlockNeighbors> = interior
        .into_par_iter()
        .map(|block| {
            progress.check()?;
            Ok(surroundings.block_neighbors(&blocks.vertices(block), &ring, &areas))
        })
        .collect::<Result<_, TilesError>>()?;
    if let Some(path) = paths.surface {
        let vertices = blocks.vertices_of_range(&(first_block..first_block + found.len()));
        surroundings.write_surface_rows(&vertices, path)?;
    }
    write_neighbor_file(paths.neighbors, first_block, &found)
}

/// Files of the neighbors of a tile.
#[derive(Clone, Copy)]
pub(crate) struct OneRingPaths<'a> {
    /// Neighbor lists and areas.
    pub(crate) neighbors: &'a Path,
    /// Rows of [`SurfaceRow`], if vertices may move along normals.
    pub(crate) surface: Option<&'a Path>,
}

/// The vertices of a tile, the vertices that share a face with them, and these faces. Vertices are in the order of the
/// curve.
struct TileFaces {
    /// Indices of the vertices before the tile, ascending.
    before: Vec<u32>,
    /// Indices of the vertices after the tile, ascending.
    after: Vec<u32>,
    /// Indices of the vertices of the tile.
    interior: Range<usize>,
    points: Vec<[f64; 3]>,
    /// Faces in the order of the mesh, with local indices.
    faces: Polygons,
}

impl TileFaces {
    fn read(blocks: &Blocks, interior: &Range<usize>, face_file: &FaceFile) -> Result<Self, TilesError> {
        let bytes = face_file.read()?;
        let vertices = blocks.vertices_of_range(interior);
        let mut before: Vec<u32> =
            decode_all_corners(&bytes).filter(|&vertex| !vertices.contains(&(vertex as usize))).collect();
        before.par_sort_unstable();
        before.dedup();
        if before.last().is_some_and(|&last| u64::from(last) >= blocks.n_vertices) {
            return Err(face_file.incomplete());
        }
        let after = before.split_off(before.partition_point(|&vertex| (vertex as usize) < vertices.start));
        let cache = PositionCache::new(blocks);
        let position = |&vertex: &u32| cache.position(vertex as usize);
        let mut points = before.iter().map(position).collect::<Result<Vec<_>, _>>()?;
        points.extend(blocks.read_positions_of_range(interior)?);
        for vertex in &after {
            points.push(position(vertex)?);
        }
        let mut tile = Self { before, after, interior: vertices, points, faces: Polygons::new() };
        let mut face = Vec::new();
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let (corners, after) = split_first_face(rest).ok_or_else(|| face_file.incomplete())?;
            rest = after;
            face.clear();
            face.extend(decode_corners(corners).map(|vertex| tile.local_index(vertex)));
            tile.faces.push(&face);
        }
        tile.faces = std::mem::take(&mut tile.faces).with_canonical_starts(&tile.points);
        Ok(tile)
    }

    fn local_index(&self, vertex: u32) -> u32 {
        let at = vertex as usize;
        let index = if at < self.interior.start {
            self.before.partition_point(|&other| other < vertex)
        } else if at < self.interior.end {
            self.before.len() + at - self.interior.start
        } else {
            self.before.len() + self.interior.len() + self.after.partition_point(|&other| other < vertex)
        };
        index as u32
    }

    fn vertex_index(&self, local_index: u32) -> u32 {
        let i = local_index as usize;
        if let Some(&vertex) = self.before.get(i) {
            return vertex;
        }
        let i = i - self.before.len();
        let after = self.after.get(i.wrapping_sub(self.interior.len()));
        after.map_or((self.interior.start + i) as u32, |&vertex| vertex)
    }

    /// Writes the normal of each of the `vertices` of the tile, and whether it is on a border.
    fn write_surface_rows(&self, vertices: &Range<usize>, path: &Path) -> Result<(), TilesError> {
        let normals = face_vertex_normals(&self.points, &self.faces);
        let is_border = self.border_flags();
        let first = self.local_index(vertices.start as u32) as usize;
        let mut bytes = Vec::with_capacity(SURFACE_ROW_BYTES * vertices.len());
        for x in first..first + vertices.len() {
            SurfaceRow { normal: normals[x], is_border: is_border[x] }.encode(&mut bytes);
        }
        write_atomic(path, |out| out.write_all(&bytes).map_err(TilesError::io(path)))
    }

    /// Flags of the ends of edges of a single triangle; right at the vertices of the tile, all of whose faces are
    /// known.
    fn border_flags(&self) -> Vec<bool> {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for [a, b, c] in triangulate(&self.points, &self.faces) {
            if a != b && b != c && c != a {
                edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
            }
        }
        edges.par_sort_unstable();
        let mut is_border = vec![false; self.points.len()];
        for same in edges.chunk_by(|e, f| e == f).filter(|same| same.len() == 1) {
            same[0].iter().for_each(|&x| is_border[x as usize] = true);
        }
        is_border
    }

    fn block_neighbors(&self, vertices: &Range<usize>, ring: &Adjacency, areas: &[f64]) -> BlockNeighbors {
        let mut lists = NeighborLists::new();
        let mut summary = BlockSummary::default();
        let first = self.local_index(vertices.start as u32) as usize;
        lists.measures.extend(&areas[first..first + vertices.len()]);
        for x in first..first + vertices.len() {
            let distance = |y: u32| {
                let [p, q] = [self.points[x], self.points[y as usize]];
                length([p[0] - q[0], p[1] - q[1], p[2] - q[2]])
            };
            lists.neighbors.extend(ring.row(x).iter().map(|&y| self.vertex_index(y)));
            lists.end_list();
            // Each edge once, in the order of the curve, so that the sum does not depend on the tiles.
            let later = ring.row(x).iter().filter(|&&y| y as usize > x);
            summary.distance_sum += later.clone().map(|&y| distance(y)).sum::<f64>();
            summary.n_distances += later.count() as u64;
        }
        BlockNeighbors { first_vertex: vertices.start, lists, summary }
    }
}
