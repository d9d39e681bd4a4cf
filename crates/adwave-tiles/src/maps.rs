//! What the bands of all tiles decide: the saliency map, and features (Algorithm 2).

use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

use adwave::Progress;
use adwave::features::is_extremum;
use adwave::pages::zeros;
use adwave::rows::Pattern;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::TilesError;
use crate::blocks::Blocks;
use crate::files::At;
use crate::layout::{Layout, vertex_number};
use crate::part::{Limits, Neighborhoods, Part, each_part};
use crate::plan::Plan;
use crate::totals::LevelSummary;

/// Blocks whose results are in memory together.
const AT_A_TIME: usize = 64;

/// Responses that differ by less than this part are equal: lengths are 32-bit floats.
const TIE: f64 = f32::EPSILON as f64;

/// The lengths of all bands, tile by tile, in units of the layout.
pub(crate) struct Lengths {
    paths: Vec<PathBuf>,
    files: Vec<OnceLock<At>>,
    n_levels: usize,
    /// Vertices of each tile but the last.
    vertices_per_tile: usize,
}

impl Lengths {
    pub(crate) fn new(paths: Vec<PathBuf>, n_levels: usize, vertices_per_tile: usize) -> Self {
        let files = paths.iter().map(|_| OnceLock::new()).collect();
        Self { paths, files, n_levels, vertices_per_tile }
    }

    /// Those of some vertices, by their places along the curve: a row each, the levels from fine to coarse.
    fn read(&self, places: Range<usize>, out: &mut Vec<f32>) -> Result<(), TilesError> {
        let row_bytes = 4 * self.n_levels;
        let mut next = places.start;
        while next < places.end {
            let tile = next / self.vertices_per_tile;
            let first = tile * self.vertices_per_tile;
            let end = places.end.min(first + self.vertices_per_tile);
            let file = if let Some(file) = self.files[tile].get() {
                file
            } else {
                let opened = At::open(&self.paths[tile])?;
                self.files[tile].get_or_init(|| opened)
            };
            let bytes = file.read(((next - first) * row_bytes) as u64, (end - next) * row_bytes)?;
            out.extend(bytes.as_chunks::<4>().0.iter().map(|&l| f32::from_le_bytes(l)));
            next = end;
        }
        Ok(())
    }
}

/// The records of a tile as they come out, given to `out` block by block: those of `made` with the map.
pub(crate) fn map_of_tile(
    (plan, blocks): (&Plan, &Blocks),
    tile: Range<usize>,
    (made, lengths): (&At, &Lengths),
    levels: &[LevelSummary],
    progress: Progress<'_>,
    mut out: impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let (row_bytes, unit) = (plan.row_bytes(), plan.layout.unit());
    let first = blocks.first_record(tile.start);
    let blocks_of_tile: Vec<usize> = tile.collect();
    for group in blocks_of_tile.chunks(AT_A_TIME) {
        progress.check()?;
        let mapped = |&block: &usize| {
            let (start, end) = (blocks.first_record(block) - first, blocks.first_record(block + 1) - first);
            let mut rows = made.read(start * row_bytes as u64, (end - start) as usize * row_bytes)?;
            if plan.params.saliency.is_some() {
                let mut of_block = Vec::new();
                lengths.read(blocks.vertices(block), &mut of_block)?;
                let records = blocks.records(block)?;
                let bytes = plan.layout.record_bytes();
                let mut rest = &mut rows[..];
                for (same, lengths) in
                    blocks.of_one_vertex(&records).zip(of_block.chunks_exact(levels.len().max(1)))
                {
                    // Λ(x) = Σ_j α_j·|W_f(j,x)| (eq. 17)
                    let terms =
                        levels.iter().zip(lengths).map(|(level, &l)| level.alpha * unit * f64::from(l));
                    let map = (terms.sum::<f64>() as f32).to_le_bytes();
                    let (of_vertex, after) = rest.split_at_mut(same.len() / bytes * row_bytes);
                    rest = after;
                    for row in of_vertex.chunks_exact_mut(row_bytes) {
                        row[row_bytes - map.len()..].copy_from_slice(&map);
                    }
                }
            }
            Ok(rows)
        };
        let mapped: Vec<Vec<u8>> = group.par_iter().map(mapped).collect::<Result<_, TilesError>>()?;
        mapped.iter().try_for_each(|rows| out(rows))?;
    }
    Ok(())
}

/// A feature as it is stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredFeature {
    /// Its place along the curve.
    pub(crate) place: usize,
    /// Of a mesh the vertex in the file, of a cloud the point in the order of the curve; of several at one position the first.
    pub(crate) vertex: u64,
    /// In model units.
    pub(crate) position: [f64; 3],
    pub(crate) level: usize,
    /// ‖W_j‖ over its mean.
    pub(crate) response: f64,
}

/// The features of a tile: vertices where ‖W_j‖, over the mean of its level, is above θ and an extremum over neighbors and levels.
pub(crate) fn features_of_tile(
    (plan, blocks): (&Plan, &Blocks),
    neighborhoods: &Neighborhoods,
    tile: Range<usize>,
    lengths: &Lengths,
    levels: &[LevelSummary],
    progress: Progress<'_>,
) -> Result<Vec<StoredFeature>, TilesError> {
    let Some(theta) = plan.params.theta else { return Ok(Vec::new()) };
    let unit = plan.layout.unit();
    let scales: Vec<f64> =
        levels.iter().map(|level| if level.mean > 0.0 { level.mean / unit } else { 1.0 }).collect();
    // As the library has it: two rings on a mesh, on a cloud what one step takes in.
    let rings = if matches!(plan.layout, Layout::Mesh(_)) { 2 } else { 1 };
    let mut found = Vec::new();
    let limits = Limits { rings, ..plan.limits()? };
    each_part(blocks, neighborhoods, tile, limits, progress, |part, tile| {
        let search = Search::new(&part, lengths, &scales, rings, theta)?;
        let first = blocks.vertices(tile.start).start;
        let of_block = |block: usize| {
            progress.check()?;
            let vertices = blocks.vertices(block);
            let own = part.own.start + vertices.start - first;
            let hits: Vec<(usize, usize)> = (0..vertices.len())
                .flat_map(|i| (2..levels.len()).map(move |level| (i, level)))
                .filter(|&(i, level)| search.is_feature(own + i, level))
                .collect();
            if hits.is_empty() {
                return Ok(Vec::new());
            }
            let names = first_records(plan, blocks, block)?;
            let stored = |&(i, level): &(usize, usize)| StoredFeature {
                place: vertices.start + i,
                vertex: names[i],
                position: part.points[own + i].map(|c| c * unit),
                level,
                response: search.response(own + i, level),
            };
            Ok(hits.iter().map(stored).collect())
        };
        let of_blocks: Vec<Vec<StoredFeature>> =
            tile.into_par_iter().map(of_block).collect::<Result<_, TilesError>>()?;
        found.extend(of_blocks.concat());
        Ok(())
    })?;
    Ok(found)
}

/// By what number each vertex of a block is known ([`StoredFeature::vertex`]).
fn first_records(plan: &Plan, blocks: &Blocks, block: usize) -> Result<Vec<u64>, TilesError> {
    let records = blocks.records(block)?;
    let mut next = blocks.first_record(block);
    let bytes = plan.layout.record_bytes();
    let name = |same: &[u8]| {
        let first = next;
        next += (same.len() / bytes) as u64;
        match plan.layout {
            Layout::Las(_) => first,
            Layout::Mesh(_) => {
                same.chunks_exact(bytes).map(|r| u64::from(vertex_number(r))).min().unwrap_or(0)
            }
        }
    };
    Ok(blocks.of_one_vertex(&records).map(name).collect())
}

/// The search in a tile and its rings.
struct Search<'a> {
    neighbors: &'a Pattern,
    lengths: Vec<f32>,
    scales: &'a [f64],
    rings: usize,
    theta: f64,
}

impl<'a> Search<'a> {
    fn new(
        part: &'a Part,
        lengths: &Lengths,
        scales: &'a [f64],
        rings: usize,
        theta: f64,
    ) -> Result<Self, TilesError> {
        let mut all: Vec<f32> = zeros(part.points.len() * scales.len());
        all.clear();
        for stretch in part.stretches.ranges() {
            lengths.read(stretch.clone(), &mut all)?;
        }
        Ok(Self { neighbors: &part.neighbors, lengths: all, scales, rings, theta })
    }

    /// R(j,x) (see [`Response`](adwave::features::Response)).
    fn response(&self, x: usize, level: usize) -> f64 {
        f64::from(self.lengths[x * self.scales.len() + level - 1]) / self.scales[level - 1]
    }

    /// Whether x, a vertex of the tile, is a feature of a level that is neither the first nor the last.
    fn is_feature(&self, x: usize, level: usize) -> bool {
        let levels = |y: usize| [level - 1, level, level + 1].map(|level| self.response(y, level));
        let near = self.neighbors.row(x);
        // Algorithm 2: |R(j,x)| > θ·mean|R(j)|, and an extremum over place and scale
        self.response(x, level) > self.theta
            && is_extremum(x, near, TIE, levels)
            && (self.rings == 1 || is_extremum(x, &self.two_rings(x), TIE, levels))
    }

    fn two_rings(&self, x: usize) -> Vec<u32> {
        let near = self.neighbors.row(x);
        let next = near.iter().flat_map(|&y| self.neighbors.row(y as usize));
        let mut both: Vec<u32> = near.iter().chain(next).copied().filter(|&y| y as usize != x).collect();
        both.sort_unstable();
        both.dedup();
        both
    }
}
