//! Truncation of a series at the degree that its value needs.

use super::super::series::{Series, TruncationBound};
use crate::operator::Weighing;
use std::ops::RangeInclusive;

/// Error by truncation, relative to the bound of the rounding error, that does not matter.
const NEGLIGIBLE: f64 = 0.1;

/// Degree at which a series is truncated.
pub(super) struct SeriesCut<'a> {
    pub(super) series: &'a Series,
    pub(super) degree: usize,
    /// Lower bound of the norm of the value, once it is known.
    least: Option<f64>,
    /// Norm of the sum of the terms so far, where it is computed; it always is after the last term in single precision.
    pub(super) norm: f64,
}

impl<'a> SeriesCut<'a> {
    pub(super) fn new(series: &'a Series) -> Self {
        Self { series, degree: series.degree(), least: None, norm: 0.0 }
    }

    /// Requests the norm of the sum of the terms up to `k` if it can decide the truncation.
    pub(super) fn weighing_after(&self, k: usize) -> Weighing {
        let TruncationBound { always, guarded } = self.series.rest;
        let tail = self.series.tail[k.min(self.degree)] + always;
        // ‖value‖ ≤ total·‖u‖: until the tail is well below this bound the norm decides nothing. If nothing is
        // missing, there is nothing to decide.
        if self.least.is_none() && tail + guarded > 0.0 && tail < 0.25 * self.series.total {
            Weighing::Weighed
        } else {
            Weighing::Unweighed
        }
    }

    /// True if one of the terms is the last, or the only one is T_0.
    pub(super) fn is_completed_within(&self, terms: RangeInclusive<usize>) -> bool {
        terms.contains(&self.degree) || self.degree == 0
    }

    /// True if the error will exceed the accuracy whatever follows the terms up to `k`, of which `rounding` is the
    /// error.
    pub(super) fn must_miss(&self, k: usize, start: f64, rounding: f64, accuracy: f64) -> bool {
        let left = self.series.tail[k.min(self.degree)] + self.series.rest.always;
        rounding > accuracy * (self.norm + left * start + rounding)
    }

    /// Chooses the degree, given the norm `norm` of the sum of the terms up to `k` and the bound of their rounding
    /// error.
    pub(super) fn decide(&mut self, k: usize, start: f64, norm: f64, rounding: f64, accuracy: f64) {
        if self.weighing_after(k) == Weighing::Unweighed {
            return;
        }
        let k = k.min(self.degree);
        let missing = (self.series.tail[k] + self.series.rest.always) * start;
        if k == self.degree {
            self.least = Some((norm - missing).max(0.0));
        } else if missing < 0.5 * norm {
            let least = norm - missing;
            self.least = Some(least);
            // Terms far below the rounding error make nothing more accurate, unless all of them are asked for.
            let negligible = if accuracy > 0.0 { NEGLIGIBLE * rounding } else { 0.0 };
            let missing = (accuracy * least).max(negligible);
            self.degree = self.series.degree_within(missing / start, k);
        }
    }

    /// Bound of the error by truncation and by `rounding`, absolute and relative to the value.
    pub(super) fn missing(&self, start: f64, guard_norm: f64, rounding: f64) -> (f64, f64) {
        let guarded = self.series.rest.guarded * guard_norm;
        let missing = (self.series.tail[self.degree] + self.series.rest.always) * start + guarded + rounding;
        let least = if rounding > 0.0 {
            (self.norm - missing).max(0.0)
        } else {
            (self.least.unwrap_or(0.0) - guarded).max(0.0)
        };
        (missing, if missing == 0.0 { 0.0 } else { missing / least })
    }
}
