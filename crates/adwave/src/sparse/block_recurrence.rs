//! The recurrence for a block of channels, in the form that suits their number.

use super::SignalView;
use super::kernel::MAX_LANES;
use super::recurrence::{Continuation, Recurrence, RowOutput, Sum};
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion};
use super::wide_recurrence::{WIDE_FROM, WideOperator, WideRecurrence};
use crate::{Cancelled, Progress};
use std::ops::Range;

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for a block of channels.
pub(crate) enum BlockRecurrence<'a> {
    /// Up to four channels, in tiles.
    Tiled(Recurrence<'a>),
    /// Up to 32 channels, row by row.
    Wide(WideRecurrence<'a>),
}

impl<'a> BlockRecurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f` for some `channels` of a signal, for `n_sums` sums. Tiles are asked for only if
    /// the block is not wide.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(
        operator: WideOperator<'a>,
        tiled: impl FnOnce() -> Result<&'a TiledDiffusion, Cancelled>,
        signal: SignalView<'_>,
        channels: Range<usize>,
        n_sums: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let SignalView { values, n_channels } = signal;
        if is_wide(n_channels) {
            let wide = WideRecurrence::new(operator, signal, channels, n_sums, progress)?;
            return Ok(Self::Wide(wide));
        }
        let tiled = Recurrence::new(tiled()?, operator.weights, values, n_channels, channels, progress)?;
        Ok(Self::Tiled(tiled))
    }

    /// Sets the output for each row of a sum; wide blocks keep all channels.
    ///
    /// # Panics
    /// If the component along normals is asked of a wide block.
    #[must_use]
    pub(crate) fn with_kept(self, kept: RowOutput<'a>) -> Self {
        match self {
            Self::Tiled(tiled) => Self::Tiled(tiled.with_kept(kept)),
            Self::Wide(wide) => {
                assert!(matches!(kept, RowOutput::Channels), "normals need three channels");
                Self::Wide(wide)
            }
        }
    }

    /// Best number of steps per pass.
    pub(crate) fn steps_per_pass(&self) -> usize {
        match self {
            Self::Tiled(tiled) => tiled.steps_per_pass(),
            Self::Wide(wide) => wide.steps_per_pass(),
        }
    }

    /// Highest k so far.
    pub(crate) fn k(&self) -> usize {
        match self {
            Self::Tiled(tiled) => tiled.k(),
            Self::Wide(wide) => wide.k(),
        }
    }

    /// Squared norm `Σ_x μ(x)|u(x)|²`.
    pub(crate) fn square(&self) -> f64 {
        match self {
            Self::Tiled(tiled) => tiled.square(),
            Self::Wide(wide) => wide.square(),
        }
    }

    /// True if any value of u is not 0.
    pub(crate) fn is_nonzero(&self) -> bool {
        match self {
            Self::Tiled(tiled) => tiled.is_nonzero(),
            Self::Wide(wide) => wide.is_nonzero(),
        }
    }

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet; a cancelled recurrence
    /// cannot be continued.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        match self {
            Self::Tiled(tiled) => tiled.advance(n_steps, sums, next, progress),
            Self::Wide(wide) => wide.advance(n_steps, sums, next, progress),
        }
    }
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
