//! Motion: the directions in which the vertices of a tile move, and the facts about the whole shape that these depend
//! on.

use std::ops::Range;
use std::sync::Arc;

use adwave::Progress;
use adwave::bands::{BandsParams, Transform};
use adwave::local_fit::{HeightPart, HeightSeries};
use adwave::operator::{Diffusion, local_operator_of_neighbors};
use adwave::positions::{MoveDirection, NormalSign, smoothed_normals};
use adwave::signal::plane_normals;
use serde::{Deserialize, Serialize};

use super::StageContext;
use super::denoise::sample_blocks;
use super::open_parts::OpenParts;
use crate::error::TilesError;
use crate::halo::{HaloLimits, TileWithHalo, visit_tiles_with_halo};
use crate::index::vertex_rows::VertexRows;
use crate::params::Movement;

/// Bytes of a row of [`Motion::mesh_rows`]: a normal and a flag.
pub(crate) const SURFACE_ROW_BYTES: usize = 25;

/// Normal of a vertex of a mesh by its faces, and its place on a border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceRow {
    /// Unit normal, or zero.
    pub(crate) normal: [f64; 3],
    /// True at the ends of edges of a single triangle.
    pub(crate) is_border: bool,
}

impl SurfaceRow {
    pub(crate) fn encode(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.normal.iter().flat_map(|c| c.to_le_bytes()));
        bytes.push(u8::from(self.is_border));
    }

    pub(crate) fn decode(row: &[u8]) -> Self {
        let (normal, flag) = row.split_at(SURFACE_ROW_BYTES - 1);
        let c = normal.as_chunks::<8>().0;
        Self { normal: [0, 1, 2].map(|k| f64::from_le_bytes(c[k])), is_border: flag[0] != 0 }
    }
}

/// Statistics of the fits of heights over the shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct HeightFit {
    /// Mean weight of the gradients, on a sample of the shape.
    pub(crate) mean_confidence: f64,
}

/// The rule by which vertices move, with the facts about the whole shape that it needs.
pub(crate) struct Motion {
    pub(crate) movement: Movement,
    /// Rows of [`SurfaceRow`] of a mesh whose vertices may move along normals.
    pub(crate) mesh_rows: Option<VertexRows>,
    /// Parts of a mesh that have a border.
    pub(crate) open_parts: Option<OpenParts>,
    pub(crate) height_fit: Option<HeightFit>,
}

impl Motion {
    /// Directions at all vertices of a tile with its halo, which are needed before its neighbors are moved; `None` if
    /// vertices move as they are filtered, or along an axis.
    pub(crate) fn normals(
        &self,
        tile: &TileWithHalo,
        progress: Progress<'_>,
    ) -> Result<Option<Vec<[f64; 3]>>, TilesError> {
        let needs_normals = match self.movement {
            Movement::Free | Movement::Heights(_) => false,
            Movement::OpenParts => self.open_parts.as_ref().is_some_and(|parts| !parts.is_empty()),
            Movement::Directed(direction) => direction.axis().is_none(),
        };
        if !needs_normals {
            return Ok(None);
        }
        let (normals, sign) = match &self.mesh_rows {
            Some(rows) => {
                let mut normals = Vec::with_capacity(tile.points.len());
                for range in tile.vertices.ranges() {
                    rows.visit(range.clone(), |rows| {
                        normals.extend(
                            rows.chunks_exact(SURFACE_ROW_BYTES).map(|r| SurfaceRow::decode(r).normal),
                        );
                    })?;
                }
                (normals, NormalSign::Side)
            }
            None => (plane_normals(&tile.points, &tile.neighbors, progress)?, NormalSign::Arbitrary),
        };
        Ok(Some(smoothed_normals(normals, &tile.neighbors, sign, progress)?))
    }

    /// Restricts the changes of the vertices `interior` of a tile, three numbers per vertex of the tile, to the
    /// directions in which they may move. `first` is the index of the first of them along the curve.
    pub(crate) fn restrict(
        &self,
        changes: &mut [f64],
        interior: Range<usize>,
        first: usize,
        normals: Option<&[[f64; 3]]>,
    ) {
        let direction = match self.movement {
            Movement::Free | Movement::Heights(_) => return,
            Movement::OpenParts => MoveDirection::Normal,
            Movement::Directed(direction) => direction,
        };
        let is_restricted = |i: usize| match (self.movement, &self.open_parts) {
            (Movement::OpenParts, Some(parts)) => parts.contains(first + i),
            (Movement::OpenParts, None) => false,
            _ => true,
        };
        let rows = changes.as_chunks_mut::<3>().0;
        for (i, x) in interior.enumerate() {
            if is_restricted(i) {
                let normal = normals.map_or([0.0; 3], |normals| normals[x]);
                rows[x] = direction.part_of(&rows[x], &normal);
            }
        }
    }
}

/// Mean weight of the gradients of heights along `axis`, on the blocks of the sample.
pub(crate) fn fit_heights(
    context: &StageContext<'_>,
    axis: usize,
    progress: Progress<'_>,
) -> Result<HeightFit, TilesError> {
    let StageContext { blocks, neighbor_index, limits, .. } = *context;
    let limits = HaloLimits { n_rings: HeightSeries::CONFIDENCE_REACH, ..limits };
    let (mut sum, mut n) = (0.0, 0);
    for block in sample_blocks(blocks.len()) {
        visit_tiles_with_halo(blocks, neighbor_index, block..block + 1, limits, progress, |tile, _| {
            let TileWithHalo { points, neighbors, areas, interior_range, .. } = tile;
            let operator =
                local_operator_of_neighbors(&points, neighbors, areas, neighbor_index.mean_length, progress)?;
            let rows = Arc::new(Diffusion::new(operator, progress)?);
            let transform = Transform::new(Arc::clone(&rows), &BandsParams::default())?;
            let part = HeightPart { transform: &transform, rows: &rows, points: &points, axis };
            n += interior_range.len();
            sum += HeightSeries::sum_of_confidence(part, interior_range, progress)?;
            Ok(())
        })?;
    }
    Ok(HeightFit { mean_confidence: sum / n.max(1) as f64 })
}
