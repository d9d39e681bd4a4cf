//! Denoise: the positions of a tile without noise, by weights that a sample of the whole shape decides.

use std::ops::Range;

use adwave::Progress;
use adwave::denoise::{DenoiseChoice, SharedNoise};
use adwave::pages::release_freed;
use adwave::shape::{Mesh, PointCloud, Polygons, PreparedGeometry, Shape, ShapeError, WeldMode};

use super::StageContext;
use super::block_output::{BlockOutput, TileValues};
use super::totals::{BlockSums, StepSums};
use crate::error::TilesError;
use crate::halo::{TileWithHalo, visit_tiles_with_halo};
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::face_lists::FaceFiles;
use crate::index::interval_set::IntervalSet;
use crate::params::Params;

/// Number of pieces of the sample, evenly spaced along the curve.
const N_PIECES: usize = 16;

/// Number of blocks of a piece.
const BLOCKS_PER_PIECE: usize = 2;

/// Largest number of vertices of the sample.
pub(crate) const MAX_SAMPLE_VERTICES: usize = N_PIECES * BLOCKS_PER_PIECE * VERTICES_IN_A_BLOCK;

/// Knowledge of the surface around the vertices: their neighbors in a cloud, or the faces of a mesh.
pub(crate) enum TileSurface {
    Cloud,
    Mesh(FaceFiles),
}

/// The decisions for the whole shape, and its surface.
pub(crate) struct Denoiser {
    pub(crate) choice: DenoiseChoice,
    pub(crate) surface: TileSurface,
}

/// Blocks of the sample, which do not depend on the tiles; all blocks if there are few.
pub(crate) fn sample_blocks(n_blocks: usize) -> Vec<usize> {
    if n_blocks <= N_PIECES * BLOCKS_PER_PIECE {
        return (0..n_blocks).collect();
    }
    let first = |k: usize| k * n_blocks / N_PIECES + (n_blocks / N_PIECES - BLOCKS_PER_PIECE) / 2;
    (0..N_PIECES).flat_map(|k| first(k)..first(k) + BLOCKS_PER_PIECE).collect()
}

/// Estimates the noise and chooses the weights on a sample; `faces` are those of a mesh. Lengths are in units of the
/// layout, of which one is `unit` model units.
pub(crate) fn choose_weights(
    params: &Params,
    blocks: &Blocks,
    faces: Option<&FaceFiles>,
    unit: f64,
    progress: Progress<'_>,
) -> Result<DenoiseChoice, TilesError> {
    let (mut points, mut vertices) = (Vec::new(), IntervalSet::default());
    for block in sample_blocks(blocks.len()) {
        points.extend(blocks.read_positions(block)?);
        blocks.vertices(block).for_each(|vertex| vertices.push(vertex));
    }
    let invalid = |e: ShapeError| TilesError::Input(e.to_string());
    let shape = match faces {
        None => Shape::Cloud(PointCloud::new(points).map_err(invalid)?),
        Some(faces) => {
            let triangles = faces.triangles(&vertices, &points, progress)?;
            Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).map_err(invalid)?)
        }
    };
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, progress.quiet())?;
    let mut denoise = params.denoise.unwrap_or_default();
    denoise.noise = denoise.noise.map(|noise| noise / unit);
    if let SharedNoise::Deviation(shared) = &mut denoise.shared {
        *shared /= unit;
    }
    let choice = DenoiseChoice::estimate(&geometry, &denoise, progress.quiet())?;
    let (needed, given) = (choice.neighbors(), params.neighbors);
    if faces.is_none() && given < needed {
        return Err(TilesError::Input(format!(
            "the points lie in lines, so {needed} neighbors of each must be known to span several lines, and {given} \
             are; use --neighbors {needed}"
        )));
    }
    Ok(choice)
}

/// Denoises the blocks `interior` and passes their output to `write`, in order. Returns the sums of each block.
pub(crate) fn denoise_tile(
    context: &StageContext<'_>,
    denoiser: &Denoiser,
    interior: Range<usize>,
    progress: Progress<'_>,
    mut write: impl FnMut(&BlockOutput) -> Result<(), TilesError>,
) -> Result<Vec<BlockSums>, TilesError> {
    let StageContext { blocks, neighbor_index, limits, .. } = *context;
    let mut sums = Vec::with_capacity(interior.len());
    visit_tiles_with_halo(blocks, neighbor_index, interior, limits, progress, |tile, interior| {
        // The search that collected the tile has freed its blocks.
        release_freed();
        let interior_range = tile.interior_range.clone();
        let Moved { points, changes, is_far } = moved_positions(tile, denoiser, progress)?;
        let values = TileValues {
            points,
            series_values: vec![changes],
            interior_range,
            step_sums: vec![StepSums::default(); interior.len()],
            is_far,
        };
        sums.extend(values.write_blocks(context, interior, progress, &mut write)?);
        Ok(())
    })?;
    Ok(sums)
}

/// Positions of a tile with its halo before denoising, and their changes.
struct Moved {
    points: Vec<[f64; 3]>,
    /// Three numbers per vertex.
    changes: Vec<f64>,
    /// True for vertices of a mesh that were stopped at three times the noise; empty for a cloud, whose points stay
    /// then.
    is_far: Vec<bool>,
}

fn moved_positions(
    tile: TileWithHalo,
    denoiser: &Denoiser,
    progress: Progress<'_>,
) -> Result<Moved, TilesError> {
    let TileWithHalo { points, neighbors, vertices, .. } = tile;
    let (denoised, is_far) = match &denoiser.surface {
        TileSurface::Cloud => {
            (denoiser.choice.denoise_cloud(&points, &neighbors, progress.quiet())?, Vec::new())
        }
        TileSurface::Mesh(faces) => {
            drop(neighbors);
            let triangles = faces.triangles(&vertices, &points, progress)?;
            let part = denoiser.choice.denoise_mesh(&points, &triangles, progress.quiet())?;
            (part.points, part.is_stopped)
        }
    };
    let mut changes = denoised.into_flattened();
    for (change, before) in changes.iter_mut().zip(points.as_flattened()) {
        *change -= before;
    }
    Ok(Moved { points, changes, is_far })
}
