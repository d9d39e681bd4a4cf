//! The recurrence for a block of channels, in the form that suits their number.

use super::SignalView;
use super::kernel::MAX_LANES;
use super::recurrence::{Continuation, Recurrence, RowOutput, Sum};
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion};
use super::wide_recurrence::{WIDE_FROM, WideRecurrence};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};
use std::ops::Range;

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for a block of channels: up to four in tiles, or up to 32 row
/// by row.
pub(crate) trait BlockRecurrence {
    /// Best number of steps per pass.
    fn steps_per_pass(&self) -> usize;

    /// Highest k so far.
    fn k(&self) -> usize;

    /// Squared norm `Σ_x μ(x)|u(x)|²`.
    fn square(&self) -> f64;

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
        return Ok(Box::new(WideRecurrence::new(operator, signal, channels, n_sums, progress)?));
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

/// Blocks in which `n_channels` are processed.
pub(crate) fn channel_blocks(n_channels: usize) -> impl Iterator<Item = Range<usize>> {
    let most = if is_wide(n_channels) {
        // Blocks of equal width: a last block of few channels would cost as much as a full one.
        n_channels.div_ceil(n_channels.div_ceil(MAX_LANES)).next_multiple_of(8)
    } else {
        MAX_CHANNELS
    };
    (0..n_channels).step_by(most).map(move |at| at..(at + most).min(n_channels))
}
