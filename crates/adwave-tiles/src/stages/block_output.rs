//! Output records of a tile, block by block, from the values of its vertices.

use std::ops::Range;

use adwave::Progress;
use rayon::prelude::*;

use super::totals::{BlockSums, NormSums, StepSums};
use super::{BLOCKS_AT_A_TIME, StageContext};
use crate::error::TilesError;
use crate::index::blocks::Blocks;
use crate::layout::RecordLayout;
use crate::sources::vertex_values::VertexValues;
use crate::sources::{cloud, mesh};

/// Output of one block.
pub(crate) struct BlockOutput {
    /// Output rows; the saliency is 0 until the maps stage.
    pub(crate) rows: Vec<u8>,
    /// Norms of all bands, as [`VertexValues::encode_norms`] writes them; empty for a job without maps.
    pub(crate) band_norms: Vec<u8>,
}

/// Values of the vertices of a tile with its halo.
pub(crate) struct TileValues {
    /// Positions, in units of the layout.
    pub(crate) points: Vec<[f64; 3]>,
    /// Values of [`Params::output_series`](crate::Params), or the change of the positions: three numbers per vertex.
    pub(crate) series_values: Vec<Vec<f64>>,
    /// Local indices of the interior.
    pub(crate) interior_range: Range<usize>,
    /// One entry per block of the interior.
    pub(crate) step_sums: Vec<StepSums>,
    /// True for vertices that were stopped because noise does not explain a longer move; empty if none was.
    pub(crate) is_far: Vec<bool>,
}

/// Local indices of a block in a tile whose interior begins with the block `first`.
pub(crate) fn block_range_in_tile(
    blocks: &Blocks,
    interior_range: &Range<usize>,
    first: usize,
    block: usize,
) -> Range<usize> {
    let (first, vertices) = (blocks.vertices(first).start, blocks.vertices(block));
    interior_range.start + vertices.start - first..interior_range.start + vertices.end - first
}

impl TileValues {
    /// Passes the output of the blocks `interior` to `write`, in order. Returns the sums of each block.
    pub(crate) fn write_blocks(
        &self,
        context: &StageContext<'_>,
        interior: Range<usize>,
        progress: Progress<'_>,
        write: &mut impl FnMut(&BlockOutput) -> Result<(), TilesError>,
    ) -> Result<Vec<BlockSums>, TilesError> {
        let first = interior.start;
        let all: Vec<usize> = interior.collect();
        let mut all_sums = Vec::with_capacity(all.len());
        for (group, steps) in all.chunks(BLOCKS_AT_A_TIME).zip(self.step_sums.chunks(BLOCKS_AT_A_TIME)) {
            progress.check()?;
            let outputs: Vec<(BlockOutput, BlockSums)> = group
                .par_iter()
                .zip(steps)
                .map(|(&block, &steps)| self.block_output(context, first, block, steps))
                .collect::<Result<_, TilesError>>()?;
            for (output, sums) in outputs {
                write(&output)?;
                all_sums.push(sums);
            }
        }
        Ok(all_sums)
    }

    fn block_output(
        &self,
        context: &StageContext<'_>,
        first_block: usize,
        block: usize,
        steps: StepSums,
    ) -> Result<(BlockOutput, BlockSums), TilesError> {
        let StageContext { shape, params, blocks, neighbor_index, .. } = *context;
        let unit = shape.layout.unit();
        let range = block_range_in_tile(blocks, &self.interior_range, first_block, block);
        let coordinates = 3 * range.start..3 * range.end;
        let series_values =
            self.series_values.iter().map(|values| values[coordinates.clone()].as_chunks::<3>().0).collect();
        let values = VertexValues::new(params, unit, series_values);
        let norm_sums = |vectors: &[[f64; 3]]| NormSums::from_vectors(vectors, neighbor_index.mean_length);
        let is_far = self.is_far.get(range.clone()).unwrap_or_default();
        let records = blocks.read_records(block)?;
        let sums = BlockSums {
            n_points: (records.len() / shape.layout.record_bytes()) as u64,
            moved: values.change.map_or_else(NormSums::default, norm_sums),
            n_far: is_far.iter().filter(|is| **is).count() as u64,
            bands: values.bands.iter().map(|band| norm_sums(band)).collect(),
            steps,
        };
        let band_norms = if params.has_maps() { values.encode_norms() } else { Vec::new() };
        let points = &self.points[range];
        let rows = match shape.layout {
            RecordLayout::Las(quantization) => {
                cloud::output_records(quantization, blocks, &records, points, &values)?
            }
            RecordLayout::Mesh(_) => mesh::result_rows(params, blocks, &records, points, &values, unit),
        };
        Ok((BlockOutput { rows, band_norms }, sums))
    }
}
