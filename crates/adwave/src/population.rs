//! Statistics over the welded vertices that take part in the diffusion.

use crate::operator::Semigroup;
use crate::{Decomposer, parallel};
use std::borrow::Cow;

/// The welded vertices of a shape without the masked ones, with weight 1 each for a walk, and weighted by area for
/// heat on the surface.
pub(crate) struct Population<'a> {
    masked: Option<Cow<'a, [bool]>>,
    areas: Option<&'a [f64]>,
    total: f64,
}

impl<'a> Population<'a> {
    pub(crate) fn new(decomposer: &'a Decomposer) -> Self {
        let mut masked = decomposer.mask_flags().map(Cow::Borrowed);
        let n_welded = decomposer.geometry().n_vertices();
        if let Some(mut outsiders) = decomposer.geometry().participation().outsiders() {
            let flags = masked.iter().flat_map(|flags| flags.iter());
            outsiders.iter_mut().zip(flags).for_each(|(out, masked)| *out |= masked);
            masked = Some(Cow::Owned(outsiders));
        }
        let n = masked.as_ref().map_or(n_welded, |masked| masked.iter().filter(|&&masked| !masked).count());
        // The areas of masked vertices are 0. If no vertex has an area, all have the same weight.
        let total = parallel::sum(n_welded, |x| decomposer.welded_areas()[x]);
        if !matches!(decomposer.operator().semigroup(), Semigroup::Heat { .. }) || total <= 0.0 {
            return Self { masked, areas: None, total: n as f64 };
        }
        Self { masked, areas: Some(decomposer.welded_areas()), total }
    }

    /// True if all vertices have the same weight.
    pub(crate) fn is_even(&self) -> bool {
        self.masked.is_none() && self.areas.is_none()
    }

    /// Weight of a vertex.
    pub(crate) fn weight(&self, x: usize) -> f64 {
        self.areas.map_or(1.0, |areas| areas[x])
    }

    pub(crate) fn is_masked(&self, x: usize) -> bool {
        self.masked.as_ref().is_some_and(|masked| masked[x])
    }

    /// Weighted mean of |value|.
    pub(crate) fn mean(&self, values: &[f64]) -> f64 {
        self.mean_over(values.len(), |x| values[x])
    }

    /// Weighted mean of |value(x)| over all `n` welded vertices `x` that are not masked.
    pub(crate) fn mean_over(&self, n: usize, value: impl Fn(usize) -> f64 + Sync) -> f64 {
        let term = |x: usize| if self.is_masked(x) { 0.0 } else { self.weight(x) * value(x).abs() };
        parallel::sum(n, term) / self.total
    }

    /// Largest |value|.
    pub(crate) fn max(&self, values: &[f64]) -> f64 {
        parallel::max(values.len(), 0.0, |x| if self.is_masked(x) { 0.0 } else { values[x].abs() })
    }
}
