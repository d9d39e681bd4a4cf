//! Scaling coefficients S_f by repeated products with Φ₁: exact up to rounding, one product per step.

use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::sparse::{copied, try_apply};
use crate::{Cancelled, Progress};

/// The smoothed signals `Φ₁ⁿ f` for each `n` of `steps` (increasing), n_vertices × n_channels each. O(entries ×
/// channels × last n).
///
/// # Errors
/// [`Cancelled`] if `progress` cancels the call.
///
/// # Panics
/// If `signal` does not have n_vertices × n_channels values.
pub fn smooth(
    diffusion: &Diffusion,
    signal: &[f64],
    n_channels: usize,
    steps: &[u64],
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    let total = steps.last().copied().unwrap_or(0);
    let mut levels = Vec::with_capacity(steps.len());
    let (mut now, mut next) = (copied(signal, n_channels, progress)?, zeros(signal.len()));
    let mut done = 0;
    for &n in steps {
        while done < n {
            progress.step(done, total)?;
            try_apply(diffusion, &now, &mut next, n_channels, progress)?;
            std::mem::swap(&mut now, &mut next);
            done += 1;
        }
        levels.push(copied(&now, n_channels, progress)?);
    }
    progress.step(total, total)?;
    Ok(levels)
}
