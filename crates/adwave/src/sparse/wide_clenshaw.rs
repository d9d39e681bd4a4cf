//! Sum of a polynomial of each of several signals by one recurrence, for up to 32 channels at once without tiles.

use super::SignalView;
use super::kernel::{InstructionSet, WideNumber, WideProduct};
use super::wide_recurrence::{ChannelBlock, CopiedBlock, ROWS_AT_A_TIME, rows_in};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// A signal and the coefficients of its polynomial in `T_k(2Φ₁ − I)`.
#[derive(Clone, Copy)]
pub(crate) struct ClenshawTerm<'a> {
    pub(crate) signal: SignalView<'a>,
    pub(crate) coefficients: &'a [f64],
}

/// Computes `(I − Φ₁)·Σ_k T_k(Y) u_k`, `Y = 2Φ₁ − I`, `u_k = Σ_j coefficients_j[k]·signal_j` for some channels, into
/// those channels of `out` (n_vertices × n_channels): `b_k = u_k + 2Y b_{k+1} − b_{k+2}` from the highest term down
/// (`clenshaw1955`).
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub(crate) fn wide_clenshaw(
    diffusion: &Diffusion,
    terms: &[ClenshawTerm<'_>],
    channels: Range<usize>,
    out: &mut [f64],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let Some(first_term) = terms.first() else { return Ok(()) };
    let (n, target) = (diffusion.n_vertices(), InstructionSet::detect());
    let channels = ChannelBlock::new::<f64>(channels, first_term.signal.n_channels);
    let ChannelBlock { at, width, lanes, stride } = channels;
    let rows = rows_in(diffusion, diffusion.weights());
    let mut blocks: Vec<(Vec<f64>, &[f64])> = Vec::with_capacity(terms.len());
    for term in terms {
        blocks.push((CopiedBlock::new(term.signal.values, channels, n, progress)?.values, term.coefficients));
    }
    let highest = terms.iter().map(|term| term.coefficients.len()).max().unwrap_or(0).saturating_sub(1);
    let (mut b1, mut b2): (Vec<f64>, Vec<f64>) = (zeros(n * lanes), zeros(n * lanes));
    for k in (0..=highest).rev() {
        progress.step((highest - k) as u64, highest as u64 + 1)?;
        // The last term has Y instead of 2Y.
        let scale = if k == 0 { 2.0 } else { 4.0 };
        let product = WideProduct::Step { before: None, now: &b1, scale };
        parallel::try_visit_rows(&mut b2, lanes, ROWS_AT_A_TIME, progress, |first, out| {
            if k == 0 {
                for b2 in &mut *out {
                    *b2 *= 2.0;
                }
            }
            f64::multiply(target, lanes, rows, product, first, out);
            for (block, coefficients) in &blocks {
                let Some(a) = coefficients.get(k) else { continue };
                for (out, h) in out.iter_mut().zip(&block[first * lanes..]) {
                    *out += a * h;
                }
            }
        })?;
        std::mem::swap(&mut b1, &mut b2);
    }
    let product = WideProduct::Difference { signal: &b1, scale: 1.0 };
    parallel::try_visit_rows(&mut b2, lanes, ROWS_AT_A_TIME, progress, |first, out| {
        f64::multiply(target, lanes, rows, product, first, out);
    })?;
    parallel::try_visit_rows(out, stride, ROWS_AT_A_TIME, progress, |first, out| {
        for (row, sum) in out.chunks_exact_mut(stride).zip(b2[first * lanes..].chunks_exact(lanes)) {
            row[at..at + width].copy_from_slice(&sum[..width]);
        }
    })
}
