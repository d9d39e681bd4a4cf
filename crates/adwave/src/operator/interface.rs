//! The interface between bands and an operator: any operator that takes steps has bands with a proven error.
//!
//! The series of the bands and the bounds of their errors require nothing of an operator beyond [`Operator`]: the
//! number of its rows, the weights of the norm, the meaning of n steps, and vectors `T_k(Y)u` that [`Steps`] adds to
//! sums. A call goes through the interface once per pass of several products, never per row. An operator that takes any
//! number of steps at once, such as the solver of a grid, is a [`Leap`] instead.

use super::difference_steps::DifferenceSteps;
use super::{Diffusion, DiffusionError, Semigroup};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress};
use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// Largest number of channels that products of an operator without a form of its own process together.
const CHANNELS_TOGETHER: usize = 8;

/// One step of diffusion, Φ₁, n_rows × n_rows: that of a lazy random walk (entries ≥ 0, rows with sum 1), of heat, or
/// of vectors that turn on their way ([`Invariant::Nothing`]).
///
/// Three functions suffice: the number of rows, `(I − Φ₁)x`, and the promise that the operator is reversible or not. An
/// operator that stores its rows is a [`Diffusion`]; one that is given by a function of the row is a
/// [`RowFunction`](super::RowFunction). [`Transform::from_operator`](crate::bands::Transform::from_operator) and
/// [`Decomposer::with_operator`](crate::Decomposer::with_operator) take any.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule, Transform};
/// use adwave::operator::Operator;
/// use adwave::{Cancelled, Progress};
///
/// /// Walk on a ring of places: stay with 1/2, go to either side with 1/4. It stores nothing.
/// #[derive(Debug)]
/// struct Ring(usize);
///
/// impl Operator for Ring {
///     fn n_rows(&self) -> usize {
///         self.0
///     }
///
///     fn is_reversible(&self) -> bool {
///         true
///     }
///
///     fn difference(&self, x: &[f64], n_channels: usize, out: &mut [f64], _: Progress<'_>) -> Result<(), Cancelled> {
///         for i in 0..self.0 {
///             let [before, after] = [(i + self.0 - 1) % self.0, (i + 1) % self.0];
///             for c in 0..n_channels {
///                 let at = |row: usize| x[row * n_channels + c];
///                 out[i * n_channels + c] = 0.25 * (at(i) - at(before)) + 0.25 * (at(i) - at(after));
///             }
///         }
///         Ok(())
///     }
/// }
///
/// // Wave k of a ring is an eigenvector to λ = cos²(πk/n), so W_f(2) = (λ − λ²)f.
/// let (n, k) = (60, 3);
/// let angle = |part: f64| std::f64::consts::PI * k as f64 * part / n as f64;
/// let wave: Vec<f64> = (0..n).map(|i| angle(2.0 * i as f64).cos()).collect();
/// let transform = Transform::from_operator(Ring(n), &BandsParams::default())?;
/// let (mut fine, mut coarse) = (vec![0.0; n], vec![0.0; n]);
/// let schedule = Schedule::dyadic(2)?;
/// transform.wavelets_into(&wave, 1, &schedule, &mut [&mut fine, &mut coarse], Progress::none())?;
/// let lambda = angle(1.0).cos().powi(2);
/// assert!((coarse[0] - (lambda - lambda * lambda)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Operator: Debug + Send + Sync {
    /// Number of rows.
    fn n_rows(&self) -> usize;

    /// Computes `(I − Φ₁)x = Σ_y Φ₁(·,y)(x − x_y)` into `out`; both are n_rows × n_channels, row-major.
    ///
    /// Sums of differences keep the relative accuracy of bands of smooth signals, and give exactly 0 for constants.
    /// Long products should check `progress`, so that a call can be cancelled.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled>;

    /// True if Φ₁ is self-adjoint under [`weights`](Self::weights), `μ(x)Φ₁(x,y) = μ(y)Φ₁(y,x)`, with eigenvalues in
    /// [0, 1]. Bands then take one recurrence, and fractional steps are possible; else they take every product.
    fn is_reversible(&self) -> bool;

    /// Computes `Φ₁x` into `out`.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn multiply(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        self.difference(x, n_channels, out, progress)?;
        for (out, x) in out.iter_mut().zip(x) {
            *out = x - *out;
        }
        Ok(())
    }

    /// The stationary distribution μ, in whose norm errors are relative to the bands.
    fn weights(&self) -> RowWeights<'_> {
        RowWeights::Uniform
    }

    /// Meaning of n steps.
    fn semigroup(&self) -> Semigroup {
        Semigroup::Steps
    }

    /// Root mean square length of a step, in model units.
    fn step_length(&self) -> f64 {
        1.0
    }

    /// Number of channels that [`start`](Self::start) takes at a time, 1 to `n_left`, where `n_left` of `n_channels`
    /// are left.
    fn width(&self, _n_channels: usize, n_left: usize, _precision: BlockPrecision) -> usize {
        CHANNELS_TOGETHER.min(n_left)
    }

    /// Bytes of memory of the operator with the vectors of a block of a signal of `n_channels` in a number format.
    fn bytes(&self, n_channels: usize, _precision: BlockPrecision) -> u64 {
        const VECTORS: usize = 4;
        (VECTORS * size_of::<f64>() * self.n_rows() * CHANNELS_TOGETHER.min(n_channels)) as u64
    }

    /// Builds the data that the first call for a signal of few channels would build.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn prepare(&self, _progress: Progress<'_>) -> Result<(), Cancelled> {
        Ok(())
    }

    /// Bound of the rounding error of `Σ_k coefficients[k]·T_k(Y)u` in single precision, relative to `‖u‖ = 1`, after
    /// `n_steps`; `None` if [`start`](Self::start) takes no [`BlockPrecision::Single`].
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn single_rounding(
        &self,
        _coefficients: &[f64],
        _n_steps: usize,
        _progress: Progress<'_>,
    ) -> Result<Option<f64>, Cancelled> {
        Ok(None)
    }

    /// The operator as stored rows, if it has them. Explicit basis functions need them.
    fn rows(&self) -> Option<&Arc<Diffusion>> {
        None
    }

    /// The operator as rows that are stored now, of one that can say them; those that it has already if it has any.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn stored_rows(&self, _progress: Progress<'_>) -> Result<Option<Arc<Diffusion>>, Cancelled> {
        Ok(self.rows().cloned())
    }

    /// This operator without the flagged places, which keep their values and which no step reaches or leaves. The
    /// weights of the others say how it diffuses among them. `squared_length(x, y)` is the squared length of a step in
    /// model units. `None` if the operator cannot leave places out. An operator with [`rows`](Self::rows) need not
    /// implement this, because its rows can.
    ///
    /// # Errors
    /// [`DiffusionError`] unless there is one flag per row; or if the call is cancelled.
    fn masked(
        &self,
        _masked: &[bool],
        _squared_length: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        _progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        Ok(None)
    }

    /// This operator with steps that favor places with similar values of a guide, n_rows ×
    /// [`channels_at_place`](Self::channels_at_place), as [`Diffusion::weigh_by_guide`] does for scalars. An operator
    /// of scalars need not implement this: a walk between its neighbors is weighed in its place.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn weighed_by_guide(
        &self,
        _guide: &[f64],
        _reach: f64,
        _progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, Cancelled> {
        Ok(None)
    }

    /// Measure whose integrals the operator keeps, by which means over the places are weighted: the domain's for heat,
    /// and the number of places for a walk.
    fn kept_measure(&self) -> KeptMeasure {
        match self.semigroup() {
            Semigroup::Heat { .. } => KeptMeasure::Domain,
            Semigroup::Steps | Semigroup::PlainSteps => KeptMeasure::Count,
        }
    }

    /// Signals that the operator leaves unchanged.
    fn invariant(&self) -> Invariant {
        Invariant::Constants
    }

    /// Number of channels that belong together at a place: 1 for scalars, 2 for vectors in a tangent frame. A signal
    /// has a multiple of it, and blocks of channels are not split within a place.
    fn channels_at_place(&self) -> usize {
        1
    }

    /// True if the promises above hold by construction. Otherwise a product with three vectors checks them when bands are
    /// prepared.
    fn keeps_promises(&self) -> bool {
        false
    }

    /// The way to take many steps at once, if there is one that is faster than products. Bands then use it.
    fn leap(&self) -> Option<&dyn Leap> {
        None
    }

    /// Starts the recurrence `T_{k+1}(Y)u = 2Y·T_k(Y)u − T_{k−1}(Y)u`, `Y = 2Φ₁ − I`, at `u = (I − Φ₁)f` for a block of
    /// the channels of f.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn start<'a>(
        &'a self,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Box<dyn Steps + 'a>, Cancelled> {
        Ok(Box::new(DifferenceSteps::new(self, block, progress)?))
    }
}

/// Any number of steps at once, as of a separable or an implicit solver.
pub trait Leap: Sync {
    /// Computes n steps of `x` (n_rows × n_channels, row-major) into `out`, n whole or not, in the sense of
    /// [`Operator::semigroup`]. Returns a bound of `‖error‖ / ‖x‖` in the norm of [`Operator::weights`], at most
    /// `accuracy` where that can be reached, and as small as possible elsewhere. Constants are kept to the last bit if
    /// the operator keeps them.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        n_channels: usize,
        accuracy: f64,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled>;
}

/// Measure whose integrals an operator keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KeptMeasure {
    /// Each place counts 1.
    Count,
    /// The measure of the domain, such as areas.
    Domain,
}

/// Signals that an operator leaves unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Invariant {
    /// Constants: rows sum to 1.
    Constants,
    /// No signal that is known: vectors turn on their way.
    Nothing,
}

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, and sums of them.
pub trait Steps {
    /// Best number of steps per pass.
    fn steps_per_pass(&self) -> usize;

    /// Highest k so far.
    fn k(&self) -> usize;

    /// Squared norm `Σ_x μ(x)|u(x)|²`.
    fn square(&self) -> f64;

    /// Bound of the rounding error of `Σ_k coefficients[k]·T_k(Y)u` after the steps so far, relative to `‖u‖`, where it
    /// exceeds that of double precision; else 0.
    fn rounding(&self, _coefficients: &[f64]) -> f64 {
        0.0
    }

    /// True if any value of u is not 0.
    fn is_nonzero(&self) -> bool;

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet. Checks for cancellation
    /// before each part of the vertices; a cancelled recurrence cannot be continued.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled>;
}

/// Weights μ of the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowWeights<'a> {
    /// Every row has the weight 1/n_rows; none is stored.
    Uniform,
    /// One weight > 0 for each row.
    Each(&'a [f64]),
}

impl RowWeights<'_> {
    /// Weight of row `x` of `n_rows`.
    #[inline]
    pub fn weight(self, x: usize, n_rows: usize) -> f64 {
        match self {
            Self::Uniform => 1.0 / n_rows as f64,
            Self::Each(weights) => weights[x],
        }
    }
}

/// Channels of a signal for which a recurrence starts, and the requested sums.
#[derive(Clone, Debug)]
pub struct SignalBlock<'a> {
    /// The whole signal, n_rows × n_channels, row-major.
    pub values: &'a [f64],
    /// Number of channels of the whole signal.
    pub n_channels: usize,
    /// Channels of the block, in the number given by [`Operator::width`].
    pub channels: Range<usize>,
    /// Weights of the norms.
    pub weights: RowWeights<'a>,
    /// Number of sums that each pass adds to.
    pub n_sums: usize,
    /// Rows of each sum.
    pub output: RowOutput<'a>,
    /// Number format of the vectors.
    pub precision: BlockPrecision,
}

/// Number format of the vectors of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockPrecision {
    /// 64 bits.
    Double,
    /// 32 bits, with a bound of the rounding error.
    Single,
}

/// A sum `Σ_k a_k T_k(Y)u` that is being accumulated.
#[derive(Debug)]
pub struct Sum<'a> {
    /// Coefficients a_0 … a_d.
    pub coefficients: &'a [f64],
    /// Output, n_vertices × n_channels of the whole signal, of which the channels of the block are written (by the term
    /// 0, whatever they were); n_vertices for normal components.
    pub out: &'a mut [f64],
    /// Request for the norm after the next pass.
    pub weighing: Weighing,
    /// Squared norm `Σ_x μ(x)|sum(x)|²` after the last pass that computed it.
    pub square: f64,
}

/// Request for the norm of a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Weighing {
    /// The norm is computed.
    Weighed,
    /// The norm is not computed.
    Unweighed,
}

/// Output for each row of a sum.
#[derive(Clone, Copy, Debug)]
pub enum RowOutput<'a> {
    /// All channels.
    Channels,
    /// Component along the normal of the vertex, for three channels.
    AlongNormals(&'a [[f64; 3]]),
}

/// Continuation of the recurrence after a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuation {
    /// More steps follow.
    Continues,
    /// The steps of this pass are the last.
    Ends,
}

/// Error of a method that needs the rows of an operator without rows.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "{needed_by} needs the rows of the operator, and this one gives none (`Operator::rows`); store them as a `Diffusion`"
)]
pub struct NoRows {
    /// The method, with an article.
    pub needed_by: &'static str,
}

impl ClassifiedError for NoRows {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}
