//! Parameters of the bands, and information about their computation.

use super::BandsError;
use crate::named_values;

/// Smallest relative error of a band that double precision can guarantee.
pub const FINEST_ACCURACY: f64 = 1e-13;

/// Relative error that single precision reaches only for a few steps on a graph with few neighbors; finer accuracies
/// take double precision.
pub(super) const FINEST_SINGLE: f64 = 1e-7;

/// Method of computing the bands. All methods agree within the stated accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Engine {
    /// [`Leaps`](Self::Leaps) if the operator has a way to take many steps; else [`Chebyshev`](Self::Chebyshev) if it
    /// is reversible, else [`Powers`](Self::Powers).
    #[default]
    Auto,
    /// One product per step: exact up to rounding, for any operator.
    Powers,
    /// One recurrence for all levels: about `√(n·ln(1/accuracy))` products for n steps. Requires a reversible
    /// operator; others use [`Powers`](Self::Powers).
    Chebyshev,
    /// One call of the operator's own way to take many steps ([`Leap`](crate::operator::Leap)) for each level.
    /// Operators without such a way, and reversible ones whose leaps miss the accuracy because of rounding, use
    /// [`Chebyshev`](Self::Chebyshev) or [`Powers`](Self::Powers).
    Leaps,
}

/// Number format in which a signal is multiplied with Φ₁. Powers, fractional steps of a walk and very long diffusions
/// always use double precision, and sums are kept in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// Single precision if the bound of its error keeps to the accuracy, else double.
    #[default]
    Auto,
    /// Single precision, whatever the accuracy; [`BandsInfo::error_bound`] is the accuracy that was reached.
    Single,
    /// Double precision.
    Double,
}

named_values!(Precision, "precision", {
    Auto => "auto", "single if its error bound keeps to the accuracy, else double";
    Single => "single", "32 bits, with a bound of the error";
    Double => "double", "64 bits";
});

/// Accuracy and memory limit for splitting a signal into bands.
///
/// ```
/// use adwave::bands::BandsParams;
/// assert_eq!(BandsParams::default().accuracy, 1e-10);
/// assert!(BandsParams::default().with_accuracy(1e-5).check().is_ok());
/// assert!(BandsParams::default().with_accuracy(0.0).check().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BandsParams {
    /// Largest relative error `‖error of W_f(j)‖ / ‖W_f(j)‖` of each band, in the norm weighted by the stationary
    /// distribution; in 1e-13 … 0.1. The effect of rounding the signal itself to double precision comes on top.
    pub accuracy: f64,
    /// Method, for tests and benchmarks.
    pub engine: Engine,
    /// Number format of the vectors.
    pub precision: Precision,
    /// Memory limit in bytes; a call that needs more is refused.
    pub max_bytes: Option<u64>,
}

impl Default for BandsParams {
    fn default() -> Self {
        Self { accuracy: 1e-10, engine: Engine::Auto, precision: Precision::Auto, max_bytes: None }
    }
}

impl BandsParams {
    /// Sets the largest relative error of each band.
    #[must_use]
    pub fn with_accuracy(self, accuracy: f64) -> Self {
        Self { accuracy, ..self }
    }

    /// Sets the method.
    #[must_use]
    pub fn with_engine(self, engine: Engine) -> Self {
        Self { engine, ..self }
    }

    /// Sets the number format of the vectors.
    #[must_use]
    pub fn with_precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// Number of channels to pass in one call if a signal has many: 64, the width of a block, if the block may be in
    /// single precision, else 32.
    #[must_use]
    pub fn channels_together(&self) -> usize {
        if self.may_be_single() { 64 } else { 32 }
    }

    /// True if the vectors of some signal may be in single precision.
    pub(super) fn may_be_single(&self) -> bool {
        match self.precision {
            Precision::Single => true,
            Precision::Auto => self.accuracy >= FINEST_SINGLE,
            Precision::Double => false,
        }
    }

    /// Sets the memory limit in bytes.
    #[must_use]
    pub fn with_max_bytes(self, max_bytes: u64) -> Self {
        Self { max_bytes: Some(max_bytes), ..self }
    }

    /// Returns the parameters if the accuracy is in its range.
    pub(super) fn validate(&self) -> Result<Self, BandsError> {
        self.check().map(|()| *self)
    }

    /// Checks that the accuracy is in its range.
    ///
    /// # Errors
    /// [`BandsError::Accuracy`] if it is NaN, below 1e-13 or above 0.1.
    pub fn check(&self) -> Result<(), BandsError> {
        // The comparison is written so that NaN fails.
        if self.accuracy >= FINEST_ACCURACY && self.accuracy <= 0.1 {
            Ok(())
        } else {
            Err(BandsError::Accuracy { accuracy: self.accuracy })
        }
    }
}

/// Method, cost and error bound of a computation of bands.
#[derive(Clone, Debug, PartialEq)]
pub struct BandsInfo {
    /// Method used, never [`Engine::Auto`].
    pub engine: Engine,
    /// Number format of the vectors, never [`Precision::Auto`]. Sums over terms are kept in double precision.
    pub precision: Precision,
    /// Highest power of Φ₁, or degree of a Chebyshev series, applied to W_f(1).
    pub degree: u64,
    /// Number of products with Φ₁ per block of up to four channels, summed over the blocks.
    pub products: u64,
    /// Number of terms added into the bands per block of up to four channels, summed over bands and blocks.
    pub terms: u64,
    /// Bound of the largest `‖error of W_f(j)‖ / ‖W_f(j)‖` over the bands, apart from rounding in double precision; 0
    /// for powers. It includes rounding in single precision. It exceeds the stated accuracy only if a band nearly
    /// vanishes relative to W_f(1), or if [`Precision::Single`] was asked for.
    pub error_bound: f64,
    /// Bytes of memory used beyond the signal and the bands, including prepared data.
    pub bytes: u64,
}

impl BandsInfo {
    /// Cost and error of two computations together.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            engine: self.engine,
            precision: if self.precision == Precision::Single { self.precision } else { other.precision },
            degree: self.degree.max(other.degree),
            products: self.products + other.products,
            terms: self.terms + other.terms,
            error_bound: self.error_bound.max(other.error_bound),
            bytes: self.bytes.max(other.bytes),
        }
    }
}
