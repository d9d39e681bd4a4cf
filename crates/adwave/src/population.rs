//! Statistics over the welded vertices that take part in the diffusion.

use crate::operator::KeptMeasure;
use crate::{Decomposer, parallel};
use std::borrow::Cow;

/// The places of a domain without the masked ones, weighted by the measure that the operator keeps: 1 each for a walk,
/// areas for heat on the surface.
pub(crate) struct Population<'a> {
    masked: Option<Cow<'a, [bool]>>,
    areas: Option<&'a [f64]>,
    total: f64,
}

impl<'a> Population<'a> {
    pub(crate) fn new(decomposer: &'a Decomposer) -> Self {
        let mut masked = decomposer.mask_flags().map(Cow::Borrowed);
        let n_welded = decomposer.n_places();
        if let Some(mut outsiders) = decomposer.domain().outsiders() {
            let flags = masked.iter().flat_map(|flags| flags.iter());
            outsiders.iter_mut().zip(flags).for_each(|(out, masked)| *out |= masked);
            masked = Some(Cow::Owned(outsiders));
        }
        let n = masked.as_ref().map_or(n_welded, |masked| masked.iter().filter(|&&masked| !masked).count());
        // The areas of masked vertices are 0. If no vertex has an area, all have the same weight.
        let areas = match decomposer.operator().kept_measure() {
            KeptMeasure::Domain => decomposer.place_measure(),
            KeptMeasure::Count => None,
        };
        let total = areas.map_or(0.0, |areas| parallel::sum(n_welded, |x| areas[x]));
        if total <= 0.0 {
            return Self { masked, areas: None, total: n as f64 };
        }
        Self { masked, areas, total }
    }

    /// True if all vertices have the same weight.
    pub(crate) fn is_even(&self) -> bool {
        self.masked.is_none() && self.areas.is_none()
    }

    /// Weight of a vertex.
    pub(crate) fn weight(&self, x: usize) -> f64 {
        self.areas.map_or(1.0, |areas| areas[x])
    }

    /// Sum of the weights.
    pub(crate) fn total(&self) -> f64 {
        self.total
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
