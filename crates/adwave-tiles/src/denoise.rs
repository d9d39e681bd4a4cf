//! Noise taken off the positions of a tile, by what a sample of the whole decides.

use std::ops::Range;

use adwave::Progress;
use adwave::denoise::DenoiseChoice;
use adwave::pages::release_freed;
use adwave::shape::{Mesh, PointCloud, Polygons, PreparedGeometry, Shape, WeldMode};
use adwave::signal::plane_normals;

use crate::TilesError;
use crate::blocks::Blocks;
use crate::made::{Made, Results};
use crate::mesh::FaceFiles;
use crate::part::{Neighborhoods, Part, each_part};
use crate::plan::Plan;
use crate::sides::Sides;
use crate::stretches::Stretches;
use crate::totals::{BlockOutcome, StepSums};

/// Pieces that a sample is of, evenly spread along the curve.
const PIECES: usize = 16;

/// Blocks of each piece.
const BLOCKS_A_PIECE: usize = 2;

/// Vertices of a sample at the most.
pub(crate) const MOST_SAMPLED: usize = PIECES * BLOCKS_A_PIECE * crate::VERTICES_IN_A_BLOCK;

/// What says how the surface lies around a vertex.
pub(crate) enum Surface {
    /// Which side the normals of a cloud are on.
    Cloud(Sides),
    /// The faces of a mesh.
    Mesh(FaceFiles),
}

/// The blocks of the sample, all where there are few: whatever the tiles are.
fn sampled(n_blocks: usize) -> Vec<usize> {
    if n_blocks <= PIECES * BLOCKS_A_PIECE {
        return (0..n_blocks).collect();
    }
    let first = |k: usize| k * n_blocks / PIECES + (n_blocks / PIECES - BLOCKS_A_PIECE) / 2;
    (0..PIECES).flat_map(|k| first(k)..first(k) + BLOCKS_A_PIECE).collect()
}

/// What is decided by a sample of the whole; `faces` are those of a mesh. Lengths are in units of the layout.
pub(crate) fn choose(
    plan: &Plan,
    blocks: &Blocks,
    faces: Option<&FaceFiles>,
    progress: Progress<'_>,
) -> Result<DenoiseChoice, TilesError> {
    let (mut points, mut places) = (Vec::new(), Stretches::default());
    for block in sampled(blocks.len()) {
        points.extend(blocks.positions(block)?);
        blocks.vertices(block).for_each(|place| places.push(place));
    }
    let invalid = |e: adwave::shape::ShapeError| TilesError::Input(e.to_string());
    let shape = match faces {
        None => Shape::Cloud(PointCloud::new(points).map_err(invalid)?),
        Some(faces) => {
            let triangles = faces.triangles(&places, &points, progress)?;
            Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).map_err(invalid)?)
        }
    };
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, progress.quiet())?;
    let mut params = plan.params.denoise.unwrap_or_default();
    params.noise = params.noise.map(|noise| noise / plan.layout.unit());
    Ok(DenoiseChoice::estimate(&geometry, &params, progress.quiet())?)
}

/// A vertex that moved farther than this many standard deviations of the noise is counted.
const FAR: f64 = 3.0;

/// Takes the noise off the positions of a tile, and gives what becomes of its blocks to `out`, in their order.
pub(crate) fn denoised_tile(
    (plan, blocks): (&Plan, &Blocks),
    neighborhoods: &Neighborhoods,
    (choice, surface): (&DenoiseChoice, &Surface),
    tile: Range<usize>,
    progress: Progress<'_>,
    mut out: impl FnMut(&Made) -> Result<(), TilesError>,
) -> Result<Vec<BlockOutcome>, TilesError> {
    let mut outcomes = Vec::with_capacity(tile.len());
    each_part(blocks, neighborhoods, tile, plan.limits()?, progress, |part, tile| {
        // The blocks that it was made of.
        release_freed();
        let own = part.own.clone();
        let (points, changes) = changes(part, choice, surface, progress)?;
        let results = Results {
            points,
            outs: vec![changes],
            own,
            steps: vec![StepSums::default(); tile.len()],
            mean_length: neighborhoods.mean_length,
            far: FAR * choice.info.noise,
        };
        outcomes.extend(results.hand_over((plan, blocks), tile, progress, &mut out)?);
        Ok(())
    })?;
    Ok(outcomes)
}

/// The positions of a part, and how they change.
fn changes(
    part: Part,
    choice: &DenoiseChoice,
    surface: &Surface,
    progress: Progress<'_>,
) -> Result<(Vec<[f64; 3]>, Vec<f64>), TilesError> {
    let Part { points, neighbors, stretches, .. } = part;
    let moved = match surface {
        Surface::Cloud(sides) => {
            let mut normals = plane_normals(&points, &neighbors, progress)?;
            for (normal, is_turned) in normals.iter_mut().zip(sides.are_turned(&stretches)?) {
                if is_turned {
                    *normal = normal.map(|c| -c);
                }
            }
            choice.denoise_cloud(&points, neighbors, normals, progress.quiet())?
        }
        Surface::Mesh(faces) => {
            drop(neighbors);
            let triangles = faces.triangles(&stretches, &points, progress)?;
            choice.denoise_mesh(&points, &triangles, progress.quiet())?
        }
    };
    let mut changes = moved.into_flattened();
    for (change, before) in changes.iter_mut().zip(points.as_flattened()) {
        *change -= before;
    }
    Ok((points, changes))
}

#[cfg(test)]
mod tests;
