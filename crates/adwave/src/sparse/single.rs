//! The operator in single precision, and a bound of the rounding errors of a recurrence with it.
//!
//! Let ε = 2⁻²⁴ and `γ_n = nε/(1 − nε)`. Tiles and wide rows sum the m entries of a row in the same way: g =
//! ⌈m/[`GROUP`]⌉ groups of at most h = min(m, [`GROUP`]) entries, each added to the sum of the row. The product of an
//! entry is rounded once as a weight, at most h times in its group, with fused multiply-adds or without, and g times
//! with the groups (`higham2002`, chapter 3); `T_{k−1}/4`, where the sum of the row starts, g times. As all entries are
//! at least 0 and sum to at most s per row, they have norm at most s in the norm of π, even applied to absolute values.
//! So a step from vectors of norm at most V is off by at most c·V, with `c = 4·(s·γ_{h+g+1} + γ_g/4)` if all diagonals
//! are ½; else the difference to the value of the row itself is rounded as well, and
//! `c = 4·(2s·γ_{h+g+2} + ¾·γ_{g+1})`.
//!
//! The error of step i reaches `T_k(Y)u` through `U_{k−i}(Y)`, whose norm is at most k − i + 1, and u was rounded once.
//! With `V = ‖u‖/(1 − ε − c·K(K+1)/2)` for K steps, `Σ_k a_k T_k(Y)u` is off by at most
//! `Σ_k |a_k|·(ε·‖u‖ + c·V·k(k+1)/2)`. Sums over k are kept in double precision.

use super::kernel::GROUP;
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};

/// Unit roundoff of single precision.
const EPSILON: f64 = f32::EPSILON as f64 / 2.0;

/// Half of the smallest positive number: error of a product that underflows.
const UNDERFLOW: f64 = 7.1e-46;

/// Factor that covers the norm of u, which is measured after rounding, and the arithmetic of the bound.
const MARGIN: f64 = 1.0 + 1e-6;

/// Power of 2 by which a signal with the largest absolute value `largest` is multiplied: its values are then between −1
/// and 1, and its first difference between −2 and 2.
pub(super) fn scale_of(largest: f64) -> f64 {
    let exponent = if largest > 0.0 { largest.log2().ceil() } else { 0.0 };
    (-exponent.clamp(-1000.0, 1000.0)).exp2()
}

/// Bound of the rounding errors of an operator in single precision.
#[derive(Debug)]
pub(crate) struct SingleBound {
    /// The error c of a step, relative to the norm of the vectors.
    per_step: f64,
    /// Error of a step by underflow in the norm of μ, in units of the vectors.
    underflow: f64,
}

/// Largest number and largest sum of the entries of a row, and a flag that all of them are in the range of single
/// precision.
#[derive(Clone, Copy)]
struct RowExtremes {
    n_entries: usize,
    sum: f64,
    fit: bool,
}

impl RowExtremes {
    const NONE: Self = Self { n_entries: 0, sum: 0.0, fit: true };

    fn with(self, other: Self) -> Self {
        Self {
            n_entries: self.n_entries.max(other.n_entries),
            sum: self.sum.max(other.sum),
            fit: self.fit && other.fit,
        }
    }
}

impl SingleBound {
    /// The bound of an operator that is reversible and positive at all vertices; `None` if an entry is negative or too
    /// small for single precision. `weights` are those of the norm. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(
        diffusion: &Diffusion,
        weights: &[f64],
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        const ROWS_AT_A_TIME: usize = 1 << 12;
        let fits = |w: f64| w == 0.0 || w >= f64::from(f32::MIN_POSITIVE);
        let row = |x: usize| {
            let entries = diffusion.row(x).1;
            let (sum, fit) = (entries.iter().sum::<f64>(), entries.iter().all(|&w| fits(w)));
            RowExtremes { n_entries: entries.len(), sum, fit }
        };
        let chunks = parallel::try_map_chunks(
            weights.len(),
            ROWS_AT_A_TIME,
            progress,
            || (),
            |(), rows| rows.map(row).fold(RowExtremes::NONE, RowExtremes::with),
        )?;
        let RowExtremes { n_entries, sum, fit } =
            chunks.into_iter().fold(RowExtremes::NONE, RowExtremes::with);
        if !fit {
            return Ok(None);
        }
        let (n_together, n_groups) = (n_entries.min(GROUP), n_entries.div_ceil(GROUP));
        let gamma = |n: usize| n as f64 * EPSILON / (1.0 - n as f64 * EPSILON);
        let per_step = if diffusion.stays_half() {
            4.0 * (sum * gamma(n_together + n_groups + 1) + 0.25 * gamma(n_groups))
        } else {
            4.0 * (2.0 * sum * gamma(n_together + n_groups + 2) + 0.75 * gamma(n_groups + 1))
        };
        let total = parallel::try_sum(weights.len(), progress, |x| weights[x])?;
        let underflow = 4.0 * (n_entries + n_groups + 2) as f64 * UNDERFLOW * total.sqrt();
        Ok(Some(Self { per_step, underflow }))
    }

    /// Bound of the rounding error of `Σ_k coefficients[k]·T_k(Y)u`, relative to `‖u‖`, for a recurrence of `n_steps`
    /// that starts at a vector of norm `start`; infinite if the bound of the vectors fails.
    pub(crate) fn rounding(&self, coefficients: &[f64], n_steps: usize, start: f64) -> f64 {
        let per_step = self.per_step + if start > 0.0 { self.underflow / start } else { 0.0 };
        let growth = |k: usize| 0.5 * k as f64 * (k + 1) as f64;
        let left = 1.0 - EPSILON - per_step * growth(n_steps);
        if left <= 0.0 {
            return f64::INFINITY;
        }
        let terms = coefficients.iter().take(n_steps + 1).enumerate();
        MARGIN * terms.map(|(k, a)| a.abs() * (EPSILON + per_step / left * growth(k))).sum::<f64>()
    }
}

/// The entries of Φ₁ without its diagonal in single precision, row by row. O(entries).
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub(super) fn rounded_weights(diffusion: &Diffusion, progress: Progress<'_>) -> Result<Vec<f32>, Cancelled> {
    const ENTRIES_AT_A_TIME: usize = 1 << 14;
    let values = diffusion.weights();
    let mut rounded: Vec<f32> = zeros(values.len());
    parallel::try_visit_rows(&mut rounded, 1, ENTRIES_AT_A_TIME, progress, |first, rounded| {
        for (rounded, &w) in rounded.iter_mut().zip(&values[first..]) {
            *rounded = w as f32;
        }
    })?;
    Ok(rounded)
}
