//! What a caller may ask of the bands, and what is reported back.

use super::BandsError;

/// The smallest relative error of a band that double precision can promise.
pub const FINEST_ACCURACY: f64 = 1e-13;

/// How the bands are computed. All ways agree within the stated accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// [`Chebyshev`](Self::Chebyshev) where the operator is reversible, else [`Powers`](Self::Powers).
    #[default]
    Auto,
    /// One product a step: exact to rounding, for any operator.
    Powers,
    /// One recurrence for all levels, about `√(n·ln(1/accuracy))` products for n steps. Takes a reversible operator; for others
    /// powers are used all the same.
    Chebyshev,
}

/// How accurately, and within which memory, a signal is split into bands.
///
/// ```
/// use adwave::bands::BandsParams;
/// assert_eq!(BandsParams::default().accuracy, 1e-10);
/// assert!(BandsParams::default().with_accuracy(1e-5).check().is_ok());
/// assert!(BandsParams::default().with_accuracy(0.0).check().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandsParams {
    /// The largest relative error `‖error of W_f(j)‖ / ‖W_f(j)‖` of each band, norms weighted by the stationary distribution;
    /// 1e-13 … 0.1. What rounding the signal itself to double precision costs comes on top.
    pub accuracy: f64,
    /// The method; for tests and benchmarks.
    pub engine: Engine,
    /// Refuse what needs more bytes than this.
    pub max_bytes: Option<u64>,
}

impl Default for BandsParams {
    fn default() -> Self {
        Self { accuracy: 1e-10, engine: Engine::Auto, max_bytes: None }
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

    /// Sets the memory beyond which a call is refused, in bytes.
    #[must_use]
    pub fn with_max_bytes(self, max_bytes: u64) -> Self {
        Self { max_bytes: Some(max_bytes), ..self }
    }

    /// The parameters, if the accuracy can be promised.
    pub(super) fn checked(&self) -> Result<Self, BandsError> {
        self.check().map(|()| *self)
    }

    /// Checks that the accuracy can be promised.
    ///
    /// # Errors
    /// [`BandsError::Accuracy`] when it is NaN, below 1e-13 or above 0.1.
    pub fn check(&self) -> Result<(), BandsError> {
        // Written so that NaN fails.
        if self.accuracy >= FINEST_ACCURACY && self.accuracy <= 0.1 {
            Ok(())
        } else {
            Err(BandsError::Accuracy { accuracy: self.accuracy })
        }
    }
}

/// How the bands were computed.
#[derive(Clone, Debug, PartialEq)]
pub struct BandsInfo {
    /// The method that was used, never [`Engine::Auto`].
    pub engine: Engine,
    /// The highest power of Φ₁, or degree of a Chebyshev series, that was applied to W_f(1).
    pub degree: u64,
    /// Products with Φ₁ for each block of up to four channels, summed over the blocks.
    pub products: u64,
    /// Terms added into the bands for each block of up to four channels, summed over the bands and the blocks.
    pub terms: u64,
    /// Bound of the largest `‖error of W_f(j)‖ / ‖W_f(j)‖` over the bands, but for rounding; 0 for powers. It exceeds the
    /// stated accuracy only where a band all but vanishes beside W_f(1).
    pub error_bound: f64,
    /// Bytes of memory used beyond the signal and the bands, what is prepared included.
    pub bytes: u64,
}
