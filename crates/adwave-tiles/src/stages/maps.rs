//! Maps: the saliency map of a tile, whose weights depend on the bands of all tiles.

use std::ops::Range;
use std::path::PathBuf;

use adwave::Progress;
use rayon::prelude::*;

use super::totals::LevelSummary;
use super::{BLOCKS_AT_A_TIME, StageContext};
use crate::error::TilesError;
use crate::files::RandomAccessFile;
use crate::index::vertex_rows::VertexRows;

/// The norms of all bands at all vertices, in one file per tile, in units of the layout.
pub(crate) struct BandNorms {
    rows: VertexRows,
}

impl BandNorms {
    pub(crate) fn new(paths: Vec<PathBuf>, n_levels: usize, vertices_per_tile: usize) -> Self {
        Self { rows: VertexRows::new(paths, 4 * n_levels, vertices_per_tile) }
    }

    /// Appends the norms of some vertices, a row per vertex with the levels from fine to coarse.
    pub(crate) fn read(&self, vertices: Range<usize>, norms: &mut Vec<f32>) -> Result<(), TilesError> {
        let mut push =
            |bytes: &[u8]| norms.extend(bytes.as_chunks::<4>().0.iter().map(|&l| f32::from_le_bytes(l)));
        self.rows.visit(vertices, &mut push)
    }
}

/// The bands of all tiles, as the maps of a tile need them.
#[derive(Clone, Copy)]
pub(crate) struct BandResults<'a> {
    pub(crate) norms: &'a BandNorms,
    pub(crate) levels: &'a [LevelSummary],
}

/// Passes the output rows of the blocks `interior` with their saliency to `write`, in order. `rows` has them without
/// it.
pub(crate) fn write_saliency(
    context: &StageContext<'_>,
    interior: Range<usize>,
    rows: &RandomAccessFile,
    bands: BandResults<'_>,
    progress: Progress<'_>,
    mut write: impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let first_record = context.blocks.first_record(interior.start);
    let row_bytes = context.row_bytes();
    let interior: Vec<usize> = interior.collect();
    for group in interior.chunks(BLOCKS_AT_A_TIME) {
        progress.check()?;
        let block_rows = |&block: &usize| {
            let [start, end] =
                [block, block + 1].map(|block| context.blocks.first_record(block) - first_record);
            let mut rows = rows.read(start * row_bytes as u64, (end - start) as usize * row_bytes)?;
            if context.params.saliency.is_some() {
                set_saliency(context, block, bands, &mut rows)?;
            }
            Ok(rows)
        };
        let group_rows: Vec<Vec<u8>> = group.par_iter().map(block_rows).collect::<Result<_, TilesError>>()?;
        group_rows.iter().try_for_each(|rows| write(rows))?;
    }
    Ok(())
}

/// Sets the last field of the rows of a block to the saliency of its vertices.
fn set_saliency(
    context: &StageContext<'_>,
    block: usize,
    bands: BandResults<'_>,
    rows: &mut [u8],
) -> Result<(), TilesError> {
    let StageContext { shape, blocks, .. } = *context;
    let (unit, row_bytes, n_levels) = (shape.layout.unit(), context.row_bytes(), bands.levels.len());
    let mut norms = Vec::new();
    bands.norms.read(blocks.vertices(block), &mut norms)?;
    let records = blocks.read_records(block)?;
    for ((vertex, record), row) in blocks.with_vertices(&records).zip(rows.chunks_exact_mut(row_bytes)) {
        let map_value = |vertex: usize| {
            // Λ(x) = Σ_j α_j·|W_f(j,x)| (eq. 17)
            let terms = bands.levels.iter().zip(&norms[vertex * n_levels..]);
            terms.map(|(level, &l)| level.alpha * unit * f64::from(l)).sum::<f64>() as f32
        };
        let saliency = vertex.map_or_else(|| blocks.outsider_value(record), map_value);
        let bytes = saliency.to_le_bytes();
        row[row_bytes - bytes.len()..].copy_from_slice(&bytes);
    }
    Ok(())
}
