//! Number of channels that a recurrence processes together.

use super::kernel::WideNumber;
use super::tiled_diffusion::MAX_CHANNELS;
use super::wide_recurrence::WIDE_FROM;
use crate::operator::BlockPrecision;

/// True if the blocks of a signal of `n_channels` are wide.
pub(crate) fn is_wide(n_channels: usize) -> bool {
    n_channels >= WIDE_FROM
}

/// Number of channels that are processed together where `n_left` are left, `n_channels` in all.
pub(crate) fn block_width(n_channels: usize, n_left: usize, precision: BlockPrecision) -> usize {
    if !is_wide(n_channels) {
        return MAX_CHANNELS.min(n_left);
    }
    let (most, line) = match precision {
        BlockPrecision::Double => (f64::MAX_LANES, f64::PER_LINE),
        BlockPrecision::Single => (f32::MAX_LANES, f32::PER_LINE),
    };
    // Blocks of equal width: a last block of few channels would cost as much as a full one.
    n_left.div_ceil(n_left.div_ceil(most)).next_multiple_of(line).min(n_left)
}
