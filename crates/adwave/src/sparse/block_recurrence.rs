//! The recurrence for a block of channels, in the form that suits their number.

use super::SignalView;
use super::kernel::WideNumber;
use super::recurrence::{Continuation, Recurrence, RowOutput, Sum};
use super::single::SingleWeights;
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion};
use super::wide_recurrence::{WIDE_FROM, WideRecurrence};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};
use std::ops::Range;

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for a block of channels: up to four in tiles, or up to 32 row
/// by row, 64 in single precision.
pub(crate) trait BlockRecurrence {
    /// Best number of steps per pass.
    fn steps_per_pass(&self) -> usize;

    /// Highest k so far.
    fn k(&self) -> usize;

    /// Squared norm `Σ_x μ(x)|u(x)|²`.
    fn square(&self) -> f64;

    /// Bound of the rounding error of `Σ_k coefficients[k]·T_k(Y)u` after the steps so far, relative to `‖u‖`, where it
    /// exceeds that of double precision; else 0.
    fn rounding(&self, _coefficients: &[f64]) -> f64 {
        0.0
    }

    /// True if any value of u is not 0.
    fn is_nonzero(&self) -> bool;

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet. Checks for cancellation
    /// before each part of the vertices; a cancelled recurrence cannot be continued.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled>;
}

/// Diffusion operator, and the weights μ of the norm that bounds errors.
#[derive(Clone, Copy)]
pub(crate) struct WeightedOperator<'a> {
    pub(crate) diffusion: &'a Diffusion,
    pub(crate) weights: &'a [f64],
    /// The operator in single precision, if the recurrence is to use it.
    pub(crate) single: Option<&'a SingleWeights>,
}

/// Starts the recurrence at `T_0 u = u = (I − Φ₁)f` for some `channels` of a signal and `n_sums` sums with rows as in
/// `output`. Tiles are asked for only if the block is not wide.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// If components along normals are asked of a signal that has not three channels.
pub(crate) fn start_recurrence<'a>(
    operator: WeightedOperator<'a>,
    tiled: impl FnOnce() -> Result<&'a TiledDiffusion, Cancelled>,
    signal: SignalView<'_>,
    channels: Range<usize>,
    outputs: SumOutputs<'a>,
    progress: Progress<'_>,
) -> Result<Box<dyn BlockRecurrence + 'a>, Cancelled> {
    let SignalView { values, n_channels } = signal;
    let SumOutputs { n_sums, rows } = outputs;
    if is_wide(n_channels) {
        assert!(matches!(rows, RowOutput::Channels), "components along normals need three channels");
        return Ok(match operator.single {
            Some(single) => {
                Box::new(WideRecurrence::new_single(operator, single, signal, channels, progress)?)
            }
            None => Box::new(WideRecurrence::new(operator, signal, channels, n_sums, progress)?),
        });
    }
    let tiled = Recurrence::new(tiled()?, operator.weights, values, n_channels, channels, progress)?;
    Ok(Box::new(tiled.with_kept(rows)))
}

/// Sums that a recurrence accumulates: their number, and the rows of each.
#[derive(Clone, Copy)]
pub(crate) struct SumOutputs<'a> {
    pub(crate) n_sums: usize,
    pub(crate) rows: RowOutput<'a>,
}

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

/// Number format of the vectors of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BlockPrecision {
    /// 64 bits.
    Double,
    /// 32 bits, with a bound of the rounding error.
    Single,
}
