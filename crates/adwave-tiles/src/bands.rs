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
use crate::outputs::Outputs;
use crate::part::{Neighbourhoods, Part, each_part};
use crate::plan::Plan;
use crate::totals::{BlockOutcome, LengthSums, StepSums};
use crate::{TilesError, cloud, mesh};

/// What a tile gives for some blocks.
pub(crate) struct Made {
    /// The records as they come out; the map is 0 as yet.
    pub(crate) records: Vec<u8>,
    /// The lengths of all bands of each vertex, where there are to be maps.
    pub(crate) lengths: Vec<u8>,
}

/// Blocks whose records are in memory together.
const AT_A_TIME: usize = 64;

/// The bands and coordinates of a tile, and gives what becomes of its blocks to `out`, in their order.
pub(crate) fn bands_of_tile(
    plan: &Plan,
    blocks: &Blocks,
    neighbourhoods: &Neighbourhoods,
    tile: Range<usize>,
    progress: Progress<'_>,
    mut out: impl FnMut(&Made) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let mut outcomes = Vec::with_capacity(tile.len());
    let mean_length = neighbourhoods.mean_length;
    each_part(blocks, neighbourhoods, tile, plan.limits()?, progress, |part, tile| {
        outcomes.extend(bands_of_part(plan, blocks, part, mean_length, tile, progress, &mut out)?);
        Ok(())
    })?;
    Ok(outcomes)
}

fn bands_of_part(
    plan: &Plan,
    blocks: &Blocks,
    part: Part,
    mean_length: f64,
    tile: Range<usize>,
    progress: Progress<'_>,
    out: &mut impl FnMut(&Made) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let series = plan.params.series()?;
    let own = part.own.clone();
    // The blocks that it was made of.
    release_freed();
    let operator =
        local_operator_of_neighbours(&part.points, part.neighbours, part.areas, mean_length, progress)?;
    let first = blocks.vertices(tile.start).start;
    // The vertices of a block, among those of the part.
    let within = |block: usize| {
        let vertices = blocks.vertices(block);
        own.start + vertices.start - first..own.start + vertices.end - first
    };
    let all: Vec<usize> = tile.collect();
    let steps: Vec<StepSums> = all.par_iter().map(|&block| StepSums::of(&operator, within(block))).collect();
    let diffusion = Arc::new(Diffusion::new(operator, progress)?);
    let transform = Transform::new(diffusion, &BandsParams::default())?;
    let points = part.points;
    let mut outs: Vec<Vec<f64>> = series.iter().map(|_| zeros(3 * points.len())).collect();
    if !series.is_empty() {
        let mut slices: Vec<&mut [f64]> = outs.iter_mut().map(|out| &mut out[..]).collect();
        transform.fixed_into(points.as_flattened(), 3, &series, &mut slices, progress)?;
    }
    drop(transform);
    let outs: Vec<&[[f64; 3]]> = outs.iter().map(|out| out.as_chunks::<3>().0).collect();
    let (unit, measures) = (plan.layout.unit(), plan.params.has_maps());
    let mut outcomes = Vec::with_capacity(all.len());
    for (group, steps) in all.chunks(AT_A_TIME).zip(steps.chunks(AT_A_TIME)) {
        progress.check()?;
        let made: Vec<(Made, BlockOutcome)> = group
            .par_iter()
            .zip(steps)
            .map(|(&block, &steps)| {
                let own = within(block);
                let outs = outs.iter().map(|out| &out[own.clone()]).collect();
                let outs = Outputs::new(&plan.params, unit, outs);
                let sums = |values: &[[f64; 3]]| LengthSums::of(values, mean_length);
                let records = blocks.records(block)?;
                let outcome = BlockOutcome {
                    n_points: (records.len() / plan.layout.record_bytes()) as u64,
                    moved: outs.change.map_or_else(LengthSums::default, sums),
                    bands: outs.bands.iter().map(|band| sums(band)).collect(),
                    steps,
                };
                let lengths = if measures { outs.lengths() } else { Vec::new() };
                let points = &points[own];
                let records = match plan.layout {
                    Layout::Las(steps) => cloud::records_of_block(plan, steps, &records, points, &outs)?,
                    Layout::Mesh(_) => mesh::results_of_block(plan, blocks, &records, points, &outs),
                };
                Ok((Made { records, lengths }, outcome))
            })
            .collect::<Result<_, TilesError>>()?;
        for (made, outcome) in made {
            out(&made)?;
            outcomes.push(outcome);
        }
    }
    Ok(outcomes)
}
