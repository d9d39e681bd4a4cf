//! Statistics over the welded vertices that take part in the diffusion.

use crate::{Decomposer, parallel};

/// The welded vertices of a shape but for the masked ones.
pub(crate) struct Population<'a> {
    masked: Option<&'a [bool]>,
    n: usize,
}

impl<'a> Population<'a> {
    pub(crate) fn new(decomposer: &'a Decomposer) -> Self {
        let masked = decomposer.mask_flags();
        let n_welded = decomposer.geometry().n_vertices();
        let n = masked.map_or(n_welded, |masked| masked.iter().filter(|&&masked| !masked).count());
        Self { masked, n }
    }

    pub(crate) fn is_masked(&self, x: usize) -> bool {
        self.masked.is_some_and(|masked| masked[x])
    }

    /// Mean of |value|.
    pub(crate) fn mean(&self, values: &[f64]) -> f64 {
        self.mean_of(values.len(), |x| values[x])
    }

    /// Mean of |value(x)| over all `n` welded vertices `x` that are not masked.
    pub(crate) fn mean_of(&self, n: usize, value: impl Fn(usize) -> f64 + Sync) -> f64 {
        let term = |x: usize| if self.is_masked(x) { 0.0 } else { value(x).abs() };
        parallel::sum(n, term) / self.n as f64
    }

    /// Largest |value|.
    pub(crate) fn max(&self, values: &[f64]) -> f64 {
        parallel::max(values.len(), 0.0, |x| if self.is_masked(x) { 0.0 } else { values[x].abs() })
    }
}
