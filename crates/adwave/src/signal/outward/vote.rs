//! Whether what surrounds a center turns its front or its back to it.

use crate::vector::{dot, norm, subtract};

/// How clearly most of an open part must look away from its center, of what looks at all.
const CLEAR: f64 = 0.02;

/// A part whose normals are this nearly at right angles to the way from its center is flat.
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

    /// Whether nothing looks away from the center or at it.
    pub(super) fn is_flat(&self) -> bool {
        self.looking <= FLAT * self.size
    }

    /// 1 where the normals point away from the center, −1 where they point at it, of a part that encloses a volume.
    pub(super) fn of_closed(&self) -> Option<f64> {
        (self.signed.abs() > FLAT * self.size).then(|| self.signed.signum())
    }

    /// The same of an open part, where it is clear.
    pub(super) fn of_open(&self) -> Option<f64> {
        (!self.is_flat() && self.signed.abs() > CLEAR * self.looking).then(|| self.signed.signum())
    }
}
