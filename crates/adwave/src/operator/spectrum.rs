//! A bound of the largest eigenvalue of a Laplacian.

use crate::parallel;
use crate::rows::Pattern;
use crate::{Cancelled, Progress};

/// At least the largest eigenvalue of M⁻¹L: no product of the recurrence may grow.
///
/// `λ ≤ max_{w(x,y)>0} (L(x,x)/M(x) + L(y,y)/M(y))` (`anderson1985`), which is at most twice the largest L(x,x)/M(x).
pub(super) fn largest_eigenvalue(
    pattern: &Pattern,
    weights: &[f64],
    mass: &[f64],
    stiffness: &[f64],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let rate = |x: usize| if mass[x] > 0.0 { stiffness[x] / mass[x] } else { 0.0 };
    let n = mass.len();
    let chunks = parallel::try_map_chunks(n, 1 << 13, progress, || (), |(), range| {
        let pair = |x: usize| {
            let entries = pattern.range(x);
            let others = pattern.of(x).iter().zip(&weights[entries]).filter(|(_, w)| **w > 0.0);
            others.map(|(&y, _)| rate(x) + rate(y as usize)).fold(0.0, f64::max)
        };
        range.map(pair).fold(0.0, f64::max)
    })?;
    Ok(chunks.into_iter().fold(0.0, f64::max))
}
