//! The operator in single precision, and a bound of the rounding errors of a recurrence with it.
//!
//! Let ε = 2⁻²⁴ and `γ_n = nε/(1 − nε)`. In a row of m entries, summed in g = ⌈m/[`GROUP`]⌉ groups, the product of an entry is
//! rounded once as a weight, at most [`GROUP`] times in its group and g times with the groups (`higham2002`, chapter 3). As
//! all entries are at least 0 and sum to at most s per row, they have norm at most s in the norm of π, even applied to
//! absolute values. So a step from vectors of norm at most V is off by at most c·V, with `c = 4·(s·γ_{GROUP+g+1} + γ_g/4)` if
//! all diagonals are ½; else the difference to the value of the row itself is rounded as well, and
//! `c = 4·(2s·γ_{GROUP+g+2} + ¾·γ_{g+1})`.
//!
//! The error of step i reaches `T_k(Y)u` through `U_{k−i}(Y)`, whose norm is at most k − i + 1, and u was rounded once. With
//! `V = ‖u‖/(1 − ε − c·K(K+1)/2)` for K steps, `Σ_k a_k T_k(Y)u` is off by at most
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

/// Rows of Φ₁ without its diagonal in single precision.
#[derive(Debug)]
pub(crate) struct SingleWeights {
    pub(crate) weights: Vec<f32>,
    /// The error c of a step, relative to the norm of the vectors.
    per_step: f64,
    /// Error of a step by underflow in the norm of μ, in units of the vectors.
    underflow: f64,
}

impl SingleWeights {
    /// Rounds the entries of an operator that is reversible and positive at all vertices; `None` if an entry is negative or
    /// too small for single precision. `weights` are those of the norm. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(
        diffusion: &Diffusion,
        weights: &[f64],
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        const ENTRIES_AT_A_TIME: usize = 1 << 14;
        const ROWS_AT_A_TIME: usize = 1 << 12;
        let values = diffusion.weights();
        let mut rounded: Vec<f32> = zeros(values.len());
        let fits = |w: f64| w == 0.0 || w >= f64::from(f32::MIN_POSITIVE);
        let parts =
            parallel::try_map_rows(&mut rounded, 1, ENTRIES_AT_A_TIME, progress, |first, rounded| {
                for (rounded, &w) in rounded.iter_mut().zip(&values[first..]) {
                    *rounded = w as f32;
                }
                values[first..first + rounded.len()].iter().all(|&w| fits(w))
            })?;
        if parts.contains(&false) {
            return Ok(None);
        }
        let most = parallel::try_map_chunks(
            weights.len(),
            ROWS_AT_A_TIME,
            progress,
            || (),
            |(), rows| {
                let row = |x: usize| (diffusion.row(x).0.len(), diffusion.row(x).1.iter().sum::<f64>());
                rows.map(row).fold((0, 0.0), |(n, s): (usize, f64), row| (n.max(row.0), s.max(row.1)))
            },
        )?;
        let (n_entries, sum) =
            most.into_iter().fold((0, 0.0), |(n, s): (usize, f64), row| (n.max(row.0), s.max(row.1)));
        let n_groups = n_entries.div_ceil(GROUP);
        let gamma = |n: usize| n as f64 * EPSILON / (1.0 - n as f64 * EPSILON);
        let per_step = if diffusion.stays_half() {
            4.0 * (sum * gamma(GROUP + n_groups + 1) + 0.25 * gamma(n_groups))
        } else {
            4.0 * (2.0 * sum * gamma(GROUP + n_groups + 2) + 0.75 * gamma(n_groups + 1))
        };
        let total = parallel::try_sum(weights.len(), progress, |x| weights[x])?;
        let underflow = 4.0 * (n_entries + n_groups + 2) as f64 * UNDERFLOW * total.sqrt();
        Ok(Some(Self { weights: rounded, per_step, underflow }))
    }

    /// Bound of the rounding error of `Σ_k coefficients[k]·T_k(Y)u`, relative to `‖u‖`, for a recurrence of `n_steps` that
    /// starts at a vector of norm `start`; infinite if the bound of the vectors fails.
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

    /// Bytes of memory.
    pub(crate) fn bytes(&self) -> u64 {
        size_of_val(self.weights.as_slice()) as u64
    }
}
