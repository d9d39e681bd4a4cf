//! The bands of a tile.

use std::ops::Range;
use std::sync::Arc;

use adwave::Progress;
use adwave::bands::{BandsParams, Transform};
use adwave::operator::{Diffusion, local_operator_of_neighbors};
use adwave::pages::{release_freed, zeros};
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::Blocks;
use crate::made::{Made, Results, within};
use crate::part::{Neighborhoods, Part, each_part};
use crate::plan::Plan;
use crate::totals::{BlockOutcome, StepSums};

/// The bands and coordinates of a tile, and gives what becomes of its blocks to `out`, in their order.
pub(crate) fn bands_of_tile(
    (plan, blocks): (&Plan, &Blocks),
    neighborhoods: &Neighborhoods,
    tile: Range<usize>,
    progress: Progress<'_>,
    mut out: impl FnMut(&Made) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let mut outcomes = Vec::with_capacity(tile.len());
    let mean_length = neighborhoods.mean_length;
    each_part(blocks, neighborhoods, tile, plan.limits()?, progress, |part, tile| {
        let results = bands_of_part(plan, blocks, part, mean_length, tile.clone(), progress)?;
        outcomes.extend(results.hand_over((plan, blocks), tile, progress, &mut out)?);
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
) -> Result<Results, TilesError> {
    let series = plan.params.series()?;
    let own = part.own.clone();
    // The blocks that it was made of.
    release_freed();
    let operator =
        local_operator_of_neighbors(&part.points, part.neighbors, part.areas, mean_length, progress)?;
    let first = tile.start;
    let steps_of = |block| StepSums::of(&operator, within(blocks, &own, first, block));
    let steps: Vec<StepSums> = tile.into_par_iter().map(steps_of).collect();
    let diffusion = Arc::new(Diffusion::new(operator, progress)?);
    let transform = Transform::new(diffusion, &BandsParams::default())?;
    let points = part.points;
    let mut outs: Vec<Vec<f64>> = series.iter().map(|_| zeros(3 * points.len())).collect();
    if !series.is_empty() {
        let mut slices: Vec<&mut [f64]> = outs.iter_mut().map(|out| &mut out[..]).collect();
        transform.apply_fixed_series_into(points.as_flattened(), 3, &series, &mut slices, progress)?;
    }
    Ok(Results { points, outs, own, steps, mean_length, far: f64::INFINITY })
}
