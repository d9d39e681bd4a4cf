//! The stages of a job, in order: sort (with the faces of a mesh), neighbors, bands or denoise, maps, join.

pub(crate) mod bands;
pub(crate) mod block_output;
pub(crate) mod denoise;
pub(crate) mod features;
pub(crate) mod join;
pub(crate) mod maps;
pub(crate) mod motion;
pub(crate) mod neighbors;
pub(crate) mod open_parts;
pub(crate) mod sort;
pub(crate) mod totals;

use crate::halo::HaloLimits;
use crate::index::blocks::Blocks;
use crate::index::neighbor_index::NeighborIndex;
use crate::layout::RecordLayout;
use crate::params::Params;
use crate::sources::input_shape::InputShape;
use crate::sources::mesh::result_row_bytes;

/// Number of blocks whose results are in memory together.
const BLOCKS_AT_A_TIME: usize = 64;

/// The job and its index, as the stages after the neighbors see them.
#[derive(Clone, Copy)]
pub(crate) struct StageContext<'a> {
    pub(crate) shape: &'a InputShape,
    pub(crate) params: &'a Params,
    pub(crate) blocks: &'a Blocks,
    pub(crate) neighbor_index: &'a NeighborIndex,
    pub(crate) limits: HaloLimits,
}

impl StageContext<'_> {
    /// Bytes of an output row: an output record of a cloud, or a result row of a mesh.
    pub(crate) fn row_bytes(&self) -> usize {
        output_row_bytes(self.shape, self.params)
    }
}

/// Bytes of an output row: an output record of a cloud, or a result row of a mesh.
pub(crate) fn output_row_bytes(shape: &InputShape, params: &Params) -> usize {
    match shape.layout {
        RecordLayout::Las(quantization) => quantization.record_bytes + params.field_bytes(),
        RecordLayout::Mesh(_) => result_row_bytes(params),
    }
}
