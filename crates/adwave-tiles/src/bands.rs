//! The bands of a tile, and what comes out for its points.

use std::ops::Range;
use std::sync::Arc;

use adwave::Progress;
use adwave::bands::{BandsParams, Transform};
use adwave::operator::{Diffusion, local_operator_of_neighbours};
use adwave::pages::{release_freed, zeros};
use rayon::prelude::*;

use crate::blocks::Blocks;
use crate::layout::Layout;
use crate::part::{Neighbourhoods, Part, part};
use crate::plan::Plan;
use crate::{TilesError, cloud, mesh};

/// What a tile gives, block by block: numbers that are the same however the shape is cut.
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
    let mut outcomes = Vec::with_capacity(tile.len());
    let mut to_do = vec![tile];
    while let Some(tile) = to_do.pop() {
        release_freed();
        if let Some(part) = part(blocks, neighbourhoods, tile.clone(), limits, progress)? {
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
                let records = blocks.records(block)?;
                let outcome = outcome(plan, records.len() / plan.layout.record_bytes(), &outs);
                let made = match plan.layout {
                    Layout::Las(steps) => {
                        cloud::records_of_block(plan, steps, &records, &points[own], &outs)?
                    }
                    Layout::Mesh(_) => mesh::results_of_block(plan, blocks, &records, &points[own], &outs),
                };
                Ok((made, outcome))
            })
            .collect::<Result<_, TilesError>>()?;
        for (records, outcome) in made {
            out(&records)?;
            outcomes.push(outcome);
        }
    }
    Ok(outcomes)
}

/// The length of a vector.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// What a block of some points gives, whose outputs are `outs`, in model units.
fn outcome(plan: &Plan, n_points: usize, outs: &[&[[f64; 3]]]) -> BlockOutcome {
    let unit = plan.layout.unit();
    let (changes, bands) = outs.split_at(usize::from(plan.params.moves()));
    let summary = |values: &&[[f64; 3]]| {
        let lengths = values.iter().map(|v| length(*v) * unit);
        lengths.fold((0.0, 0.0), |(sum, most), l| (sum + l * l, f64::max(most, l)))
    };
    BlockOutcome {
        n_points: n_points as u64,
        moved: changes.first().map_or((0.0, 0.0), summary),
        bands: bands.iter().map(summary).collect(),
    }
}
