//! The bands of a tile, and its points as they come out.

use std::ops::Range;
use std::sync::Arc;

use adwave::Progress;
use adwave::bands::{BandsParams, Transform};
use adwave::operator::{Diffusion, local_operator_of_neighbours};
use adwave::pages::{release_freed, zeros};
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::Blocks;
use crate::layout::{set_whole, whole};
use crate::part::{Neighbourhoods, Part, part};
use crate::plan::Plan;

/// What a tile gives, block by block: numbers that are the same however the cloud is cut.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct BlockOutcome {
    pub(crate) n_points: u64,
    /// The sum of the squares of the distances moved, and the largest distance, over vertices.
    pub(crate) moved: (f64, f64),
    /// The same of each band that was asked for.
    pub(crate) bands: Vec<(f64, f64)>,
}

/// Blocks whose records are in memory together.
const AT_A_TIME: usize = 64;

/// The bands and coordinates of a tile, and gives the records of its blocks to `out`, in their order.
///
/// A stretch of the curve can be several patches, which have more around them than one: where the vertices of the tile and its rings
/// are more than memory allows, one half comes after the other.
pub(crate) fn bands_of_tile(
    plan: &Plan,
    blocks: &Blocks,
    neighbourhoods: &Neighbourhoods,
    tile: Range<usize>,
    progress: Progress<'_>,
    mut out: impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let limits = plan.limits()?;
    let k = plan.params.neighbours.min((blocks.n_vertices as usize).saturating_sub(1));
    let mut outcomes = Vec::with_capacity(tile.len());
    let mut to_do = vec![tile];
    while let Some(tile) = to_do.pop() {
        release_freed();
        if let Some(part) = part(blocks, neighbourhoods, tile.clone(), limits, k, progress)? {
            let mean_length = neighbourhoods.mean_length;
            outcomes.extend(bands_of_part(plan, blocks, part, mean_length, tile, progress, &mut out)?);
        } else {
            let middle = tile.start.midpoint(tile.end);
            to_do.extend([middle..tile.end, tile.start..middle]);
        }
    }
    Ok(outcomes)
}

fn bands_of_part(
    plan: &Plan,
    blocks: &Blocks,
    part: Part,
    mean_length: f64,
    tile: Range<usize>,
    progress: Progress<'_>,
    out: &mut impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let series = plan.params.series()?;
    let own = part.own.clone();
    // The blocks that it was made of.
    release_freed();
    let operator =
        local_operator_of_neighbours(&part.points, part.neighbours, part.areas, mean_length, progress)?;
    let diffusion = Arc::new(Diffusion::new(operator, progress)?);
    let transform = Transform::new(diffusion, &BandsParams::default())?;
    let points = part.points;
    let mut outs: Vec<Vec<f64>> = series.iter().map(|_| zeros(3 * points.len())).collect();
    if !series.is_empty() {
        let mut slices: Vec<&mut [f64]> = outs.iter_mut().map(|out| &mut out[..]).collect();
        transform.fixed_into(points.as_flattened(), 3, &series, &mut slices, progress)?;
    }
    drop(transform);
    let outs: Vec<&[[f64; 3]]> = outs.iter().map(|out| &out.as_chunks::<3>().0[own.clone()]).collect();
    let points = &points[own];
    let mut outcomes = Vec::with_capacity(tile.len());
    let first = blocks.vertices(tile.start).start;
    let all: Vec<usize> = tile.collect();
    for group in all.chunks(AT_A_TIME) {
        progress.check()?;
        let made: Vec<(Vec<u8>, BlockOutcome)> = group
            .par_iter()
            .map(|&block| {
                let vertices = blocks.vertices(block);
                let own = vertices.start - first..vertices.end - first;
                let outs: Vec<&[[f64; 3]]> = outs.iter().map(|out| &out[own.clone()]).collect();
                records_of_block(plan, &blocks.records(block)?, &points[own], &outs)
            })
            .collect::<Result<_, TilesError>>()?;
        for (records, outcome) in made {
            out(&records)?;
            outcomes.push(outcome);
        }
    }
    Ok(outcomes)
}

fn records_of_block(
    plan: &Plan,
    records: &[u8],
    points: &[[f64; 3]],
    outs: &[&[[f64; 3]]],
) -> Result<(Vec<u8>, BlockOutcome), TilesError> {
    let (layout, moves) = (plan.layout, plan.params.moves());
    let (changes, bands) = outs.split_at(usize::from(moves));
    let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let summary = |values: &[[f64; 3]]| {
        values.iter().map(length).fold((0.0, 0.0), |(sum, most), l| (sum + l * l, f64::max(most, l)))
    };
    let outcome = BlockOutcome {
        n_points: (records.len() / layout.record_bytes) as u64,
        moved: changes.first().map_or((0.0, 0.0), |change| summary(change)),
        bands: bands.iter().map(|band| summary(band)).collect(),
    };
    let mut made = Vec::with_capacity(records.len() + 4 * bands.len() * outcome.n_points as usize);
    let (mut vertex, mut last) = (0, None);
    for record in records.chunks_exact(layout.record_bytes) {
        let here = whole(record);
        vertex += usize::from(last.is_some_and(|last| last != here));
        last = Some(here);
        let start = made.len();
        made.extend_from_slice(record);
        if let Some(change) = changes.first().map(|change| change[vertex]) {
            let moved: [f64; 3] = std::array::from_fn(|c| points[vertex][c] + change[c]);
            let Some(whole) = layout.nearest(moved) else {
                return Err(TilesError::Input(format!(
                    "a point would move to {moved:?}, which 32-bit coordinates of this scale do not reach; use smaller gains"
                )));
            };
            set_whole(&mut made[start..], whole);
        }
        for band in bands {
            made.extend_from_slice(&(length(&band[vertex]) as f32).to_le_bytes());
        }
    }
    Ok((made, outcome))
}
