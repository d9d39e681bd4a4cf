//! Bands: the bands of a tile, or its positions after the gains.

use std::ops::Range;
use std::sync::Arc;

use adwave::Progress;
use adwave::bands::{BandsParams, Transform};
use adwave::local_fit::HeightPart;
use adwave::operator::{Diffusion, local_operator_of_neighbors};
use adwave::pages::{release_freed, zeros};
use adwave::positions::MoveDirection;
use rayon::prelude::*;

use super::StageContext;
use super::block_output::{BlockOutput, TileValues, block_range_in_tile};
use super::motion::Motion;
use super::totals::{BlockSums, StepSums};
use crate::error::TilesError;
use crate::halo::{TileWithHalo, visit_tiles_with_halo};
use crate::params::Params;

/// Computes the blocks `interior` and passes their output to `write`, in order. Returns the sums of each block.
pub(crate) fn compute_bands(
    context: &StageContext<'_>,
    motion: &Motion,
    interior: Range<usize>,
    progress: Progress<'_>,
    mut write: impl FnMut(&BlockOutput) -> Result<(), TilesError>,
) -> Result<Vec<BlockSums>, TilesError> {
    let StageContext { blocks, neighbor_index, limits, .. } = *context;
    let mut sums = Vec::with_capacity(interior.len());
    visit_tiles_with_halo(blocks, neighbor_index, interior, limits, progress, |tile, interior| {
        let values = tile_bands(context, motion, tile, interior.clone(), progress)?;
        sums.extend(values.write_blocks(context, interior, progress, &mut write)?);
        Ok(())
    })?;
    Ok(sums)
}

fn tile_bands(
    context: &StageContext<'_>,
    motion: &Motion,
    tile: TileWithHalo,
    interior: Range<usize>,
    progress: Progress<'_>,
) -> Result<TileValues, TilesError> {
    let StageContext { params, blocks, neighbor_index, .. } = *context;
    let series = params.output_series()?;
    let normals = if params.changes_positions() { motion.normals(&tile, progress)? } else { None };
    let TileWithHalo { points, neighbors, areas, interior_range, .. } = tile;
    // The search that collected the tile has freed its blocks.
    release_freed();
    let first = interior.start;
    let block_range = |block| block_range_in_tile(blocks, &interior_range, first, block);
    let n_members = |block| block_range(block).filter(|&x| !neighbors.row(x).is_empty()).count() as u64;
    let members: Vec<u64> = interior.clone().map(n_members).collect();
    let operator =
        local_operator_of_neighbors(&points, neighbors, areas, neighbor_index.mean_length, progress)?;
    let block_step_sums =
        |(block, n_members)| StepSums::from_operator(&operator, block_range(block), n_members);
    let step_sums: Vec<StepSums> = interior.into_par_iter().zip(members).map(block_step_sums).collect();
    let diffusion = Arc::new(Diffusion::new(operator, progress)?);
    let transform = Transform::new(Arc::clone(&diffusion), &BandsParams::default())?;
    let mut series_values: Vec<Vec<f64>> = series.iter().map(|_| zeros(3 * points.len())).collect();
    if !series.is_empty() {
        let mut outputs: Vec<&mut [f64]> = series_values.iter_mut().map(|values| &mut values[..]).collect();
        transform.apply_fixed_series_into(points.as_flattened(), 3, &series, &mut outputs, progress)?;
    }
    if params.moves_heights() {
        let axis = params.along.and_then(MoveDirection::axis).unwrap_or(2);
        let part = HeightPart { transform: &transform, rows: &diffusion, points: &points, axis };
        series_values.insert(0, height_changes(params, motion, part, interior_range.clone(), progress)?);
    } else if params.changes_positions() {
        let first = blocks.vertices(first).start;
        motion.restrict(&mut series_values[0], interior_range.clone(), first, normals.as_deref());
    }
    Ok(TileValues { points, series_values, interior_range, step_sums, is_far: Vec::new() })
}

/// Changes of the positions of a tile whose vertices move along an axis about a local linear fit, three numbers per
/// vertex; 0 outside of the interior.
fn height_changes(
    params: &Params,
    motion: &Motion,
    part: HeightPart<'_>,
    interior: Range<usize>,
    progress: Progress<'_>,
) -> Result<Vec<f64>, TilesError> {
    let mean_confidence = motion.height_fit.map_or(0.0, |fit| fit.mean_confidence);
    let heights = params.height_series()?.change(part, interior.clone(), mean_confidence, progress)?;
    let mut changes: Vec<f64> = zeros(3 * part.points.len());
    for (x, height) in interior.zip(heights) {
        changes[3 * x + part.axis] = height;
    }
    Ok(changes)
}
