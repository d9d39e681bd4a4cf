//! A tile with the rings of neighbors around it that its result depends on.

use std::f64::consts::PI;
use std::ops::Range;

use adwave::Progress;
use adwave::pages::{release_freed, zeros};
use adwave::rows::Pattern;
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::box_tree::{Bounds, BoxTree};
use crate::near_file::{Near, NearFile};
use crate::stretches::Stretches;

/// What the neighborhoods of all tiles are, on disk.
#[derive(Debug)]
pub(crate) struct Neighborhoods {
    files: Vec<NearFile>,
    blocks_per_tile: usize,
    /// Boxes around the balls to the k-th neighbors of each block.
    balls: BoxTree,
    /// E.
    pub(crate) mean_length: f64,
    kind: Kind,
}

/// What is stored of a vertex, and who its neighbors are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// The distance to the k-th nearest; neighbors are those that it names and those that name it.
    Nearest(usize),
    /// The area; neighbors name each other.
    Faces,
}

impl Kind {
    /// The area of a vertex (eq. 1), by what is stored of it.
    fn area(self, stored: f64) -> f64 {
        match self {
            Self::Nearest(k) => PI * stored * stored / k.max(1) as f64,
            Self::Faces => stored,
        }
    }
}

impl Neighborhoods {
    /// The distance of the k-th nearest neighbor of a vertex of a cloud, by its area.
    pub(crate) fn radius(&self, area: f64) -> f64 {
        match self.kind {
            Kind::Nearest(k) => (area * k.max(1) as f64 / PI).sqrt(),
            Kind::Faces => 0.0,
        }
    }

    pub(crate) fn new(files: Vec<NearFile>, blocks: &Blocks, blocks_per_tile: usize, kind: Kind) -> Self {
        let summaries = || files.iter().flat_map(|file| &file.summaries);
        let balls = blocks.boxes.iter().zip(summaries());
        // Ties may be a little farther than the k-th.
        let balls = balls.map(|(bounds, summary)| bounds.widened(summary.radius * (1.0 + 1e-8))).collect();
        let total: f64 = summaries().map(|summary| summary.sum).sum();
        let n: u64 = summaries().map(|summary| summary.n_neighbors).sum();
        let mean_length = total / n.max(1) as f64;
        Self { files, blocks_per_tile, balls: BoxTree::new(balls), mean_length, kind }
    }

    fn near(&self, blocks: &Blocks, block: usize) -> Result<Near, TilesError> {
        self.files[block / self.blocks_per_tile].near(block, &blocks.vertices(block), blocks.n_vertices)
    }

    /// What is stored of each vertex of a block.
    fn measures(&self, blocks: &Blocks, block: usize) -> Result<Vec<f64>, TilesError> {
        self.files[block / self.blocks_per_tile].measures(block, blocks.vertices(block).len())
    }
}

/// Not reached.
const OUTSIDE: u16 = u16::MAX;

/// A block that is in memory.
struct Loaded {
    block: usize,
    /// Who is named, as long as the union is not known.
    near: Near,
    /// (named, naming) where the one named is in another block, sorted.
    across: Vec<(u32, u32)>,
    /// Who names or is named, for each vertex; empty until it is asked for.
    union: Near,
    /// The ring of each vertex.
    ring: Vec<u16>,
}

/// The vertices within some rings of a tile, in the order of the curve, and what T is made of.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) points: Vec<[f64; 3]>,
    /// Rows of the outermost ring are empty.
    pub(crate) neighbors: Pattern,
    pub(crate) areas: Vec<f64>,
    /// The vertices of the tile.
    pub(crate) own: Range<usize>,
    /// The places along the curve of all its vertices.
    pub(crate) stretches: Stretches,
}

struct Search<'a> {
    blocks: &'a Blocks,
    neighborhoods: &'a Neighborhoods,
    loaded: Vec<Loaded>,
    /// Where each block is among these.
    slots: Vec<u32>,
}

/// Not loaded.
const NOWHERE: u32 = u32::MAX;

/// A block that more than so many blocks are close to is looked at more closely: on a surface there are about nine. Tests have few
/// blocks.
const MANY_BLOCKS: usize = if cfg!(test) { 2 } else { 32 };

/// The block of a vertex, and its number there.
fn place_of(x: u32) -> (usize, usize) {
    (x as usize / VERTICES_IN_A_BLOCK, x as usize % VERTICES_IN_A_BLOCK)
}

/// How far a part goes, and how large it may be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) rings: usize,
    /// Vertices of the part.
    pub(crate) vertices: u64,
    /// Vertices of the blocks that are searched for it.
    pub(crate) searched: u64,
}

/// `each(part, blocks)` for a tile with its rings, or for pieces of it, in the order of their blocks.
///
/// A stretch of the curve can be several patches, which have more around them than one: where the vertices of the tile and its rings
/// are more than memory allows, one half comes after the other.
pub(crate) fn each_part(
    blocks: &Blocks,
    neighborhoods: &Neighborhoods,
    tile: Range<usize>,
    limits: Limits,
    progress: Progress<'_>,
    mut each: impl FnMut(Part, Range<usize>) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let mut to_do = vec![tile];
    while let Some(tile) = to_do.pop() {
        release_freed();
        if let Some(part) = part(blocks, neighborhoods, tile.clone(), limits, progress)? {
            each(part, tile)?;
        } else {
            let middle = tile.start.midpoint(tile.end);
            to_do.extend([middle..tile.end, tile.start..middle]);
        }
    }
    Ok(())
}

/// Collects the blocks `tile` and the rings around them; `None` as soon as that is more than the limits allow, unless it is one block.
pub(crate) fn part(
    blocks: &Blocks,
    neighborhoods: &Neighborhoods,
    tile: Range<usize>,
    limits: Limits,
    progress: Progress<'_>,
) -> Result<Option<Part>, TilesError> {
    let rings = limits.rings;
    let slots = vec![NOWHERE; blocks.len()];
    let mut search = Search { blocks, neighborhoods, loaded: Vec::new(), slots };
    search.unite(tile.clone().collect(), progress)?;
    let mut frontier: Vec<u32> = Vec::new();
    for block in tile.clone() {
        let slot = search.slots[block] as usize;
        search.loaded[slot].ring.fill(0);
        frontier.extend(blocks.vertices(block).map(|place| place as u32));
    }
    let mut n = frontier.len() as u64;
    for ring in 1..=rings {
        progress.check()?;
        // Rows of the ring before are wanted, so all that these name has to be there.
        frontier = search.next_ring(&frontier, ring as u16, progress)?;
        n += frontier.len() as u64;
        let is_too_large = n > limits.vertices || search.n_loaded() > limits.searched;
        if is_too_large && tile.len() > 1 {
            return Ok(None);
        }
        let touched = blocks_of(&frontier);
        if ring < rings {
            search.unite(touched, progress)?;
        }
    }
    search.part(&tile, rings as u16).map(Some)
}

/// The blocks of some vertices, without repetition.
fn blocks_of(places: &[u32]) -> Vec<usize> {
    let mut touched: Vec<usize> = places.iter().map(|&x| place_of(x).0).collect();
    touched.dedup();
    touched.sort_unstable();
    touched.dedup();
    touched
}

impl Search<'_> {
    /// The vertices of the blocks that are in memory.
    fn n_loaded(&self) -> u64 {
        (self.loaded.len() * VERTICES_IN_A_BLOCK) as u64
    }

    fn get(&self, block: usize) -> Option<&Loaded> {
        self.loaded.get(self.slots[block] as usize)
    }

    fn load(&mut self, mut wanted: Vec<usize>, progress: Progress<'_>) -> Result<(), TilesError> {
        wanted.retain(|&block| self.slots[block] == NOWHERE);
        let (blocks, neighborhoods) = (self.blocks, self.neighborhoods);
        let load = |&block: &usize| {
            progress.check()?;
            let vertices = blocks.vertices(block);
            let mut near = neighborhoods.near(blocks, block)?;
            near.measures = Vec::new();
            let across = match neighborhoods.kind {
                Kind::Nearest(_) => across(&vertices, &near),
                Kind::Faces => Vec::new(),
            };
            let ring = vec![OUTSIDE; vertices.len()];
            Ok(Loaded { block, near, across, union: Near::default(), ring })
        };
        let loaded: Vec<Loaded> = wanted.par_iter().map(load).collect::<Result<_, TilesError>>()?;
        for loaded in loaded {
            self.slots[loaded.block] = self.loaded.len() as u32;
            self.loaded.push(loaded);
        }
        Ok(())
    }

    /// The blocks whose vertices may name those of `block`.
    fn naming(&self, block: usize) -> Result<Vec<usize>, TilesError> {
        let mut found = Vec::new();
        let balls = &self.neighborhoods.balls;
        balls.touching(&self.blocks.boxes[block], &(0..0), &mut |other| found.push(other));
        if found.len() > MANY_BLOCKS {
            // Where the curve leaves the shape between two vertices, their block spans what lies between: its vertices one by one.
            found.clear();
            let mut last = usize::MAX;
            for position in self.blocks.positions(block)? {
                balls.touching(&Bounds::of(position), &(0..0), &mut |other| {
                    if other != last {
                        found.push(other);
                        last = other;
                    }
                });
            }
            found.sort_unstable();
            found.dedup();
        }
        Ok(found)
    }

    /// Makes sure that the rows of `wanted` are known: all blocks are loaded whose vertices may name theirs.
    fn unite(&mut self, mut wanted: Vec<usize>, progress: Progress<'_>) -> Result<(), TilesError> {
        wanted.retain(|&block| self.get(block).is_none_or(|loaded| loaded.union.offsets.is_empty()));
        if self.neighborhoods.kind == Kind::Faces {
            self.load(wanted.clone(), progress)?;
            for block in wanted {
                let loaded = &mut self.loaded[self.slots[block] as usize];
                loaded.union = std::mem::take(&mut loaded.near);
            }
            return Ok(());
        }
        let naming: Vec<Vec<usize>> =
            wanted.par_iter().map(|&block| self.naming(block)).collect::<Result<_, _>>()?;
        let mut needed: Vec<usize> = naming.iter().flatten().copied().chain(wanted.iter().copied()).collect();
        needed.sort_unstable();
        needed.dedup();
        self.load(needed, progress)?;
        let unite = |(&block, naming): (&usize, &Vec<usize>)| {
            progress.check()?;
            let slot = self.slots[block] as usize;
            let naming: Vec<&Loaded> = naming.iter().filter_map(|&other| self.get(other)).collect();
            Ok((slot, united(self.blocks.vertices(block), &self.loaded[slot].near, &naming)))
        };
        let united: Vec<(usize, Near)> =
            wanted.par_iter().zip(&naming).map(unite).collect::<Result<_, TilesError>>()?;
        for (slot, union) in united {
            let loaded = &mut self.loaded[slot];
            loaded.union = union;
            loaded.near = Near::default();
        }
        Ok(())
    }

    /// Marks what the vertices of the frontier, whose rows are known, name and was not reached: the next frontier.
    fn next_ring(
        &mut self,
        frontier: &[u32],
        ring: u16,
        progress: Progress<'_>,
    ) -> Result<Vec<u32>, TilesError> {
        let is_new = |y: u32| {
            let (block, i) = place_of(y);
            self.get(block).is_none_or(|loaded| loaded.ring[i] == OUTSIDE)
        };
        let unreached = |frontier: &[u32]| {
            let mut found = Vec::new();
            for &x in frontier {
                let (block, i) = place_of(x);
                let row = self.get(block).map_or(&[][..], |loaded| loaded.union.of(i));
                found.extend(row.iter().copied().filter(|&y| is_new(y)));
            }
            found.sort_unstable();
            found.dedup();
            found
        };
        let mut next: Vec<u32> = frontier.par_chunks(VERTICES_IN_A_BLOCK).flat_map_iter(unreached).collect();
        next.par_sort_unstable();
        next.dedup();
        self.load(blocks_of(&next), progress)?;
        for &y in &next {
            let (block, i) = place_of(y);
            self.loaded[self.slots[block] as usize].ring[i] = ring;
        }
        Ok(next)
    }

    fn part(mut self, tile: &Range<usize>, rings: u16) -> Result<Part, TilesError> {
        self.loaded.retain(|loaded| loaded.ring.iter().any(|&ring| ring != OUTSIDE));
        self.loaded.sort_unstable_by_key(|loaded| loaded.block);
        for (slot, loaded) in self.loaded.iter().enumerate() {
            self.slots[loaded.block] = slot as u32;
        }
        // The number of each vertex in the part.
        let mut n = 0;
        let mut own = 0..0;
        let mut numbers: Vec<Vec<u32>> = Vec::with_capacity(self.loaded.len());
        for loaded in &self.loaded {
            if loaded.block == tile.start {
                own.start = n as usize;
            }
            let number = |&ring: &u16| {
                let is_in = ring != OUTSIDE;
                n += u32::from(is_in);
                if is_in { n - 1 } else { u32::MAX }
            };
            numbers.push(loaded.ring.iter().map(number).collect());
            if loaded.block + 1 == tile.end {
                own.end = n as usize;
            }
        }
        let stretches = self.stretches();
        let (points, areas) = self.positions_and_areas(n as usize)?;
        let mut offsets: Vec<usize> = zeros(n as usize + 1);
        let mut at = 0;
        for loaded in &self.loaded {
            for (i, &ring) in loaded.ring.iter().enumerate().filter(|(_, ring)| **ring != OUTSIDE) {
                let length = if ring < rings { loaded.union.of(i).len() } else { 0 };
                offsets[at + 1] = offsets[at] + length;
                at += 1;
            }
        }
        let mut columns: Vec<u32> = zeros(offsets[at]);
        let mut rest = &mut columns[..];
        let mut jobs = Vec::new();
        for loaded in &self.loaded {
            let rows = loaded.ring.iter().enumerate().filter(|(_, ring)| **ring < rings);
            let length = rows.map(|(i, _)| loaded.union.of(i).len()).sum();
            let (of_block, after) = std::mem::take(&mut rest).split_at_mut(length);
            rest = after;
            jobs.push((loaded, of_block));
        }
        jobs.into_par_iter().for_each(|(loaded, columns)| {
            let rows = loaded.ring.iter().enumerate().filter(|(_, ring)| **ring < rings);
            let places = rows.flat_map(|(i, _)| loaded.union.of(i));
            for (column, &y) in columns.iter_mut().zip(places) {
                let (block, i) = place_of(y);
                *column = numbers[self.slots[block] as usize][i];
            }
        });
        let neighbors = Pattern::new(offsets, columns, points.len()).map_err(|e| {
            TilesError::Input(format!("neighborhoods contradict each other ({e}); begin anew"))
        })?;
        Ok(Part { points, neighbors, areas, own, stretches })
    }

    /// The places of the vertices that were reached.
    fn stretches(&self) -> Stretches {
        let mut stretches = Stretches::default();
        for loaded in &self.loaded {
            let places = self.blocks.vertices(loaded.block).zip(&loaded.ring);
            places.filter(|(_, ring)| **ring != OUTSIDE).for_each(|(place, _)| stretches.push(place));
        }
        stretches
    }

    /// The positions and areas (eq. 1) of the `n` vertices that were reached, read only now: the search does without.
    fn positions_and_areas(&self, n: usize) -> Result<(Vec<[f64; 3]>, Vec<f64>), TilesError> {
        let (mut points, mut areas): (Vec<[f64; 3]>, Vec<f64>) = (zeros(n), zeros(n));
        let (mut of_points, mut of_areas) = (&mut points[..], &mut areas[..]);
        let mut jobs = Vec::with_capacity(self.loaded.len());
        for loaded in &self.loaded {
            let n = loaded.ring.iter().filter(|ring| **ring != OUTSIDE).count();
            let (points, rest) = std::mem::take(&mut of_points).split_at_mut(n);
            let (areas, others) = std::mem::take(&mut of_areas).split_at_mut(n);
            (of_points, of_areas) = (rest, others);
            jobs.push((loaded, points, areas));
        }
        jobs.into_par_iter().try_for_each(|(loaded, points, areas)| {
            let positions = self.blocks.positions(loaded.block)?;
            let measures = self.neighborhoods.measures(self.blocks, loaded.block)?;
            let reached = loaded.ring.iter().zip(positions.iter().zip(measures));
            let reached = reached.filter(|(ring, _)| **ring != OUTSIDE).map(|(_, of)| of);
            for ((point, area), (position, measure)) in points.iter_mut().zip(areas).zip(reached) {
                *point = *position;
                *area = self.neighborhoods.kind.area(measure);
            }
            Ok::<(), TilesError>(())
        })?;
        Ok((points, areas))
    }
}

/// (named, naming) where the one named is in another block than `vertices`, sorted.
fn across(vertices: &Range<usize>, near: &Near) -> Vec<(u32, u32)> {
    let mut across: Vec<(u32, u32)> = vertices
        .clone()
        .enumerate()
        .flat_map(|(i, x)| near.of(i).iter().map(move |&y| (y, x as u32)))
        .filter(|(y, _)| !vertices.contains(&(*y as usize)))
        .collect();
    across.sort_unstable();
    across
}

/// Who names or is named by each of `vertices`, rising: `near` are those that they name, `naming` the blocks that may name them.
fn united(vertices: Range<usize>, near: &Near, naming: &[&Loaded]) -> Near {
    let (first, n) = (vertices.start, vertices.len());
    let own = |y: u32| (y as usize).checked_sub(first).filter(|&i| i < n);
    // (named, naming): all that name a vertex of the block.
    let across = naming.iter().flat_map(|other| {
        let start = other.across.partition_point(|(y, _)| (*y as usize) < first);
        other.across[start..].iter().take_while(|(y, _)| (*y as usize) < vertices.end).copied()
    });
    let mut ends: Vec<u32> = near.offsets[1..].to_vec();
    let mut count: Vec<u32> = (0..n).map(|i| near.of(i).len() as u32).collect();
    let inside = (0..n).flat_map(|i| near.of(i).iter().map(move |&y| (y, (first + i) as u32)));
    let naming = || inside.clone().chain(across.clone()).filter_map(|(y, x)| own(y).map(|i| (i, x)));
    naming().for_each(|(i, _)| count[i] += 1);
    let mut end = 0;
    for (end_of, count) in ends.iter_mut().zip(&count) {
        *end_of = end;
        end += count;
    }
    let mut places = vec![0; end as usize];
    let mut put = |i: usize, x: u32| {
        places[ends[i] as usize] = x;
        ends[i] += 1;
    };
    for i in 0..n {
        near.of(i).iter().for_each(|&y| put(i, y));
    }
    naming().for_each(|(i, x)| put(i, x));
    let mut union = Near { offsets: vec![0], places: Vec::with_capacity(places.len()), measures: Vec::new() };
    let mut start = 0;
    for end in ends {
        let row = &mut places[start..end as usize];
        row.sort_unstable();
        let before = union.places.len();
        for &y in &*row {
            if union.places.len() == before || union.places.last() != Some(&y) {
                union.places.push(y);
            }
        }
        start = end as usize;
        union.offsets.push(union.places.len() as u32);
    }
    union.places.shrink_to_fit();
    union
}
