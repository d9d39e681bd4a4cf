//! Axis-aligned bounding boxes.

use serde::{Deserialize, Serialize};

/// An axis-aligned box. The empty box has `min` above `max`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoundingBox {
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
}

/// Relative margin that covers the rounding of distances.
const ROUNDING: f64 = 1e-9;

impl BoundingBox {
    pub(crate) const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    pub(crate) fn from_point(position: [f64; 3]) -> Self {
        Self { min: position, max: position }
    }

    /// The smallest box that contains all of `boxes`.
    pub(crate) fn union(boxes: impl IntoIterator<Item = Self>) -> Self {
        boxes.into_iter().fold(Self::EMPTY, |mut sum, bounds| {
            sum.include(&bounds);
            sum
        })
    }

    pub(crate) fn include(&mut self, other: &Self) {
        for c in 0..3 {
            self.min[c] = self.min[c].min(other.min[c]);
            self.max[c] = self.max[c].max(other.max[c]);
        }
    }

    /// The box of all points within `radius` of this one, with a margin for rounding.
    pub(crate) fn expand_by(&self, radius: f64) -> Self {
        let margin = |c: f64| radius + ROUNDING * (radius + c.abs());
        Self { min: self.min.map(|c| c - margin(c)), max: self.max.map(|c| c + margin(c)) }
    }

    pub(crate) fn intersects(&self, other: &Self) -> bool {
        (0..3).all(|c| self.min[c] <= other.max[c] && other.min[c] <= self.max[c])
    }

    /// Distance from a point to the box; 0 inside.
    pub(crate) fn distance_to(&self, point: [f64; 3]) -> f64 {
        let gap = |c: usize| (self.min[c] - point[c]).max(point[c] - self.max[c]).max(0.0);
        (0..3).map(|c| gap(c) * gap(c)).sum::<f64>().sqrt()
    }

    /// Length of the longest side; 0 if the box is empty.
    pub(crate) fn longest_side(&self) -> f64 {
        (0..3).map(|c| self.max[c] - self.min[c]).fold(0.0, f64::max)
    }
}
