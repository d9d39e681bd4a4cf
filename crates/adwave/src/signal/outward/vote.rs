//! Vote on whether the surface around a center turns its front or its back to it.

use crate::vector::{dot, norm, subtract};

/// Smallest majority that orients an open part: the sum over its pieces, relative to the sum of the magnitudes.
const CLEAR: f64 = 0.02;

/// Sine of the angle to the directions from its center below which a part counts as flat.
const FLAT: f64 = 1e-6;

/// Sums over the pieces of one part: `A·n·(x − c)`, its magnitude, and `A·|x − c|`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vote {
    signed: f64,
    looking: f64,
    size: f64,
}

impl Vote {
    /// Adds a piece at `x` with the area times the normal `n`.
    pub(super) fn add(&mut self, x: &[f64; 3], n: &[f64; 3], center: &[f64; 3]) {
        let from = subtract(x, center);
        let looks = dot(n, &from);
        self.signed += looks;
        self.looking += looks.abs();
        self.size += norm(n) * norm(&from);
    }

    /// True if nothing faces the center or away from it.
    pub(super) fn is_flat(&self) -> bool {
        self.looking <= FLAT * self.size
    }

    /// Sign of a part that encloses a volume: 1 if the normals point away from the center, −1 if towards it.
    pub(super) fn closed_sign(&self) -> Option<f64> {
        (self.signed.abs() > FLAT * self.size).then(|| self.signed.signum())
    }

    /// Sign of an open part, if it is clear.
    pub(super) fn open_sign(&self) -> Option<f64> {
        (!self.is_flat() && self.signed.abs() > CLEAR * self.looking).then(|| self.signed.signum())
    }
}
