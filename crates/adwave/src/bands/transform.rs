//! The diffusion operator prepared for the bands of many signals.

use super::chebyshev::{ChebyshevEvaluator, EvaluationInfo, PassPlan, Polynomials};
use super::error::{check_buffer, check_factors, check_signal};
use super::real_series::{self, InterpolationGrid, LADDER};
use super::series::{Growth, Series};
use super::{BandsError, BandsInfo, BandsParams, Engine, Precision, Schedule, heat_series, plain_series};
use crate::operator::{
    BlockPrecision, Diffusion, Invariant, Leap, NoRows, Operator, RowOutput, RowWeights, Semigroup,
};
use crate::pages::zeros;
use crate::parallel;
use crate::sparse::{PreparedDiffusion, SignalView};
use crate::{Cancelled, Progress};
use std::sync::{Arc, OnceLock};

/// Levels with a factor each.
#[derive(Clone, Copy)]
pub(super) struct LevelFactors<'a> {
    pub(super) schedule: &'a Schedule,
    pub(super) factors: &'a [f64],
}

/// Error bound beyond which single precision is refused although it was asked for: the largest accuracy of bands.
const WORST_SINGLE: f64 = 0.1;

/// A diffusion operator prepared to split signals into bands, in the analysis order (the order of its rows).
///
/// It owns its data and is cheap to clone. Clones share the operator and the tiles of its products, which the first
/// call with Chebyshev series builds.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule, Transform};
/// use adwave::{Progress, operator::Diffusion};
/// let diffusion = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.5, 0.5, 0.5, 0.5])?;
/// let transform = Transform::new(diffusion, &BandsParams::default())?;
/// let (mut first, mut second) = ([0.0; 2], [0.0; 2]);
/// let schedule = Schedule::dyadic(2)?;
/// transform.wavelets_into(&[1.0, 3.0], 1, &schedule, &mut [&mut first, &mut second], Progress::none())?;
/// assert_eq!((first, second), ([-1.0, 1.0], [0.0, 0.0])); // one step already takes the mean
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Transform {
    operator: Arc<dyn Operator>,
    params: BandsParams,
    engine: Engine,
    /// Evaluator of the Chebyshev recurrence and the norm of its errors, built by the first call that needs it.
    prepared: Arc<OnceLock<ChebyshevEvaluator>>,
}

impl Transform {
    /// Takes ownership of `diffusion`. O(1); the first call builds the tiles in O(entries).
    ///
    /// # Errors
    /// [`BandsError::Accuracy`] if the accuracy is out of range.
    pub fn new(diffusion: impl Into<Arc<Diffusion>>, params: &BandsParams) -> Result<Self, BandsError> {
        let operator: Arc<dyn Operator> = Arc::new(PreparedDiffusion::new(diffusion.into()));
        let (params, engine) = (params.validate()?, engine(&*operator, params));
        Ok(Self { operator, params, engine, prepared: Arc::default() })
    }

    /// Prepares any operator that can be multiplied with vectors. Its promises are tested by a product with three
    /// vectors: that constants are kept ([`Operator::invariant`]), and, if it is reversible, that it is self-adjoint
    /// and neither expands nor reverses a vector. These conditions are necessary, not sufficient; the bounds of the
    /// errors rest on the promise.
    ///
    /// Explicit basis functions need stored rows ([`Operator::rows`]). [`Operator`] has an example.
    ///
    /// # Errors
    /// [`BandsError::Accuracy`] if the accuracy is out of range, [`BandsError::WrongNumber`] or
    /// [`BandsError::BadOperator`] if the operator contradicts itself.
    pub fn from_operator(
        operator: impl Operator + 'static,
        params: &BandsParams,
    ) -> Result<Self, BandsError> {
        Self::from_shared_operator(Arc::new(operator), params)
    }

    /// [`from_operator`](Self::from_operator) for an operator that others use as well.
    ///
    /// # Errors
    /// As for [`from_operator`](Self::from_operator).
    pub fn from_shared_operator(
        operator: Arc<dyn Operator>,
        params: &BandsParams,
    ) -> Result<Self, BandsError> {
        let params = params.validate()?;
        if !operator.keeps_promises() {
            check_operator(&*operator)?;
        }
        let engine = engine(&*operator, &params);
        Ok(Self { operator, params, engine, prepared: Arc::default() })
    }

    /// This operator with other parameters; the tiles are shared. O(1).
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn with_params(&self, params: &BandsParams) -> Result<Self, BandsError> {
        let (params, engine) = (params.validate()?, engine(&*self.operator, params));
        Ok(Self { params, engine, ..self.clone() })
    }

    /// Builds the data that the first call would build. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn prepare(&self, progress: Progress<'_>) -> Result<(), Cancelled> {
        if self.engine == Engine::Chebyshev {
            self.evaluator(progress)?;
            self.operator.prepare(progress)?;
        }
        Ok(())
    }

    pub(super) fn evaluator(&self, progress: Progress<'_>) -> Result<&ChebyshevEvaluator, Cancelled> {
        if let Some(prepared) = self.prepared.get() {
            return Ok(prepared);
        }
        // If two threads arrive here at once, one of them works in vain.
        let prepared = ChebyshevEvaluator::new(Arc::clone(&self.operator), progress)?;
        Ok(self.prepared.get_or_init(|| prepared))
    }

    /// The operator.
    pub fn operator(&self) -> &Arc<dyn Operator> {
        &self.operator
    }

    /// The rows of the operator. `needed_by` names the method that needs them, with an article, for the error.
    ///
    /// # Errors
    /// [`NoRows`] if the operator has none.
    pub fn rows(&self, needed_by: &'static str) -> Result<&Arc<Diffusion>, NoRows> {
        self.operator.rows().ok_or(NoRows { needed_by })
    }

    /// Method in use.
    pub(super) fn engine(&self) -> Engine {
        self.engine
    }

    /// Accuracy, method and memory limit.
    pub fn params(&self) -> &BandsParams {
        &self.params
    }

    /// Computes `W_f(j) = (Φ₁^{n_{j−1}} − Φ₁^{n_j}) f` (eq. 11), j = 1 … J, into `wavelets[j − 1]`, each n_vertices
    /// × n_channels, row-major.
    ///
    /// The relative error of each band is at most [`BandsParams::accuracy`]. Constants give exact zeros.
    ///
    /// # Errors
    /// [`BandsError`] if the signal or an output has the wrong length, a value is not finite, fractional powers are
    /// requested of an operator that is not reversible or miss the accuracy, or the call is cancelled.
    pub fn wavelets_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        wavelets: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        self.wavelets_into_with(signal, n_channels, schedule, wavelets, None, progress)
    }

    /// [`wavelets_into`](Self::wavelets_into) with a vector as long as the signal that may be overwritten.
    pub(super) fn wavelets_into_with(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        wavelets: &mut [&mut [f64]],
        spare: Option<&mut [f64]>,
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        self.check_signal(signal, n_channels)?;
        let len = wavelets.len() * signal.len();
        let wrong = wavelets.iter().find(|w| w.len() != signal.len());
        check_buffer(wrong.map_or(len, |w| w.len() * wavelets.len()), schedule.n_levels() * signal.len())?;
        self.check_steps(schedule)?;
        let steps = schedule.steps_from_zero();
        let stages = self.stages(schedule);
        self.check_precision(schedule, progress)?;
        let outcome = if let Some(leap) = self.leap() {
            let view = SignalView { values: signal, n_channels };
            match self.wavelets_by_leaps(leap, view, schedule, wavelets, spare, progress) {
                Err(BandsError::Missed { .. }) if self.operator.is_reversible() => {
                    return self
                        .with_series()
                        .wavelets_into(signal, n_channels, schedule, wavelets, progress);
                }
                found => found?,
            }
        } else if stages.len() > 1 {
            self.staged_wavelets(&stages, signal, n_channels, wavelets, progress)?
        } else if self.engine == Engine::Chebyshev {
            let prepared = self.evaluator(progress)?;
            let series = |level: usize, rung| self.band(&steps[level..level + 2], rung, prepared.growth);
            self.escalate(prepared, signal, n_channels, series, wavelets, progress)?
        } else {
            let steps = whole_steps_from_zero(schedule)?;
            for wavelet in &mut *wavelets {
                wavelet.fill(0.0);
            }
            self.sum_powers(signal, n_channels, &steps, progress, |level, now| {
                add(1.0, now, wavelets[level], n_channels);
            })?
        };
        Ok(self.info(&outcome, n_channels).with_stages(stages.len(), signal.len()))
    }

    /// Computes `Σ_j factors[j−1]·W_f(j)` into `out`, n_vertices × n_channels, by a single polynomial of Φ₁. A
    /// filter with one gain per band is `f + Σ_j (gain_j − 1)·W_f(j)` (eq. 18).
    ///
    /// The relative error is at most [`BandsParams::accuracy`].
    ///
    /// # Errors
    /// As for [`wavelets_into`](Self::wavelets_into).
    pub fn weighted_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        factors: &[f64],
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        self.check_signal(signal, n_channels)?;
        check_factors(factors, schedule)?;
        check_buffer(out.len(), signal.len())?;
        self.check_steps(schedule)?;
        let steps = schedule.steps_from_zero();
        let stages = self.stages(schedule);
        self.check_precision(schedule, progress)?;
        let outcome = if let Some(leap) = self.leap() {
            let (view, levels) =
                (SignalView { values: signal, n_channels }, LevelFactors { schedule, factors });
            match self.weighted_by_leaps(leap, view, levels, out, progress) {
                Err(BandsError::Missed { .. }) if self.operator.is_reversible() => {
                    return self
                        .with_series()
                        .weighted_into(signal, n_channels, schedule, factors, out, progress);
                }
                found => found?,
            }
        } else if stages.len() > 1 {
            self.staged_sum(&stages, signal, n_channels, factors, out, progress)?
        } else if self.engine == Engine::Chebyshev {
            let prepared = self.evaluator(progress)?;
            let series = |_, rung| {
                let band = |level: usize| self.band(&steps[level..level + 2], rung, prepared.growth);
                let bands = parallel::map_items(self.operator.n_rows(), steps.len() - 1, band);
                Series::combination(&bands, factors, prepared.growth)
            };
            self.escalate(prepared, signal, n_channels, series, &mut [out], progress).map_err(|error| {
                match error {
                    BandsError::Missed { level, accuracy, reached } => BandsError::Missed {
                        level: schedule.first_real().unwrap_or(level),
                        accuracy,
                        reached,
                    },
                    other => other,
                }
            })?
        } else {
            let steps = whole_steps_from_zero(schedule)?;
            out.fill(0.0);
            self.sum_powers(signal, n_channels, &steps, progress, |level, now| {
                add(factors[level], now, out, n_channels);
            })?
        };
        Ok(self.info(&outcome, n_channels).with_stages(stages.len(), signal.len()))
    }

    /// Checks a signal in the order of the rows, and that its channels come in groups of those that belong together.
    pub(crate) fn check_signal(&self, signal: &[f64], n_channels: usize) -> Result<(), BandsError> {
        check_signal(signal, self.operator.n_rows(), n_channels)?;
        let together = self.operator.channels_at_place();
        if !n_channels.is_multiple_of(together) {
            return Err(BandsError::ChannelGroups { n_channels, together });
        }
        Ok(())
    }

    /// This transform by series of products, for bands whose accuracy leaps do not reach.
    fn with_series(&self) -> Self {
        Self { engine: Engine::Chebyshev, ..self.clone() }
    }

    /// The operator's own way to take many steps, if it is used.
    pub(super) fn leap(&self) -> Option<&dyn Leap> {
        self.operator.leap().filter(|_| self.engine == Engine::Leaps)
    }

    /// Checks that the levels have whole numbers of steps if the walk is not lazy.
    pub(super) fn check_steps(&self, schedule: &Schedule) -> Result<(), BandsError> {
        if self.operator.semigroup() == Semigroup::PlainSteps {
            whole_steps_from_zero(schedule)?;
        }
        Ok(())
    }

    /// Checks that single precision, if it is asked for, applies.
    pub(super) fn check_precision(
        &self,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<(), BandsError> {
        if self.params.precision != Precision::Single {
            return Ok(());
        }
        let is_fractional = self.operator.semigroup() == Semigroup::Steps && schedule.first_real().is_some();
        let reason = if self.engine != Engine::Chebyshev {
            "the operator is not reversible, or is applied power by power"
        } else if is_fractional {
            "a level has a fractional number of steps"
        } else if self.is_staged(schedule) {
            "the diffusion is so long that it is cut into stages"
        } else if !self.evaluator(progress)?.has_single(progress)? {
            "the operator has no such products, an entry is negative or below 1e-38, or vertices without area lead to others"
        } else {
            return Ok(());
        };
        Err(BandsError::NotSingle { reason })
    }

    /// Refuses results of single precision, if it was asked for, whose error bound is too large to mean anything.
    pub(super) fn check_rounding(&self, outcome: &EvaluationInfo) -> Result<(), BandsError> {
        if self.params.precision == Precision::Single
            && outcome.single_products > 0
            && outcome.error_bound > WORST_SINGLE
        {
            return Err(BandsError::NotSingle { reason: "the bound of its error exceeds 0.1 of a band" });
        }
        Ok(())
    }

    /// This operator with vectors in double precision.
    pub(crate) fn in_double(&self) -> Self {
        Self { params: BandsParams { precision: Precision::Double, ..self.params }, ..self.clone() }
    }

    /// Series of the band between two numbers of steps. For fractional powers it interpolates, with the remainder
    /// bounded as in `trefethen2013`, chapter 11.
    pub(super) fn band(&self, pair: &[f64], rung: InterpolationGrid, growth: Growth) -> Series {
        match self.operator.semigroup() {
            Semigroup::Steps => real_series::band(pair[0], pair[1], rung, self.params.accuracy, growth),
            Semigroup::PlainSteps => plain_series::band(pair[0] as u64, pair[1] as u64, growth),
            Semigroup::Heat { rate, dispersion } => {
                heat_series::band(rate * pair[0], rate * pair[1], dispersion, growth)
            }
        }
    }

    /// Computes `series(i, rung)(Φ₁)·(I − Φ₁)·signal` into `outs[i]`, raising the degree until the accuracy is
    /// reached. Series of whole steps do not depend on the rung and are done after the first.
    pub(super) fn escalate(
        &self,
        prepared: &ChebyshevEvaluator,
        signal: &[f64],
        n_channels: usize,
        series: impl Fn(usize, InterpolationGrid) -> Series + Sync,
        outs: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        let accuracy = self.params.accuracy;
        let mut sum = EvaluationInfo::default();
        let mut missed: Vec<(usize, f64)> = (0..outs.len()).map(|i| (i, f64::INFINITY)).collect();
        for rung in LADDER {
            // The last rungs cost O(m²) per band before the first product, which would check for cancellation.
            let made = |&(i, _): &(usize, f64)| {
                if progress.is_cancelled() { Err(Cancelled) } else { Ok(series(i, rung)) }
            };
            let these = parallel::map_items(self.operator.n_rows(), missed.len(), |i| made(&missed[i]));
            let these = these.into_iter().collect::<Result<Vec<Series>, _>>()?;
            let is_guarded = these.iter().any(|s| s.rest.guarded > 0.0);
            let guard = if is_guarded { rung.guard() } else { Vec::new() };
            let precision = if is_guarded { Precision::Double } else { self.params.precision };
            let mut wanted = missed.iter().map(|&(i, _)| i).peekable();
            let mut outs: Vec<&mut [f64]> = outs
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| wanted.next_if_eq(i).is_some())
                .map(|(_, out)| &mut **out)
                .collect();
            let passes = &mut PassPlan::default();
            let polynomials =
                Polynomials { series: &these, guard: &guard, passes, output: RowOutput::Channels, precision };
            let signal = SignalView { values: signal, n_channels };
            let outcome = prepared.evaluate(signal, polynomials, accuracy, &mut outs, progress)?;
            self.check_rounding(&outcome)?;
            sum.add(&outcome);
            missed = outcome.missed.into_iter().map(|(at, reached)| (missed[at].0, reached)).collect();
            if missed.is_empty() {
                return Ok(sum);
            }
        }
        let (at, reached) = missed[0];
        Err(BandsError::Missed { level: at + 1, accuracy, reached })
    }

    /// Calls `each(level, Φ₁ⁱu)` for i = 0 … n_J − 1, with levels counted from 0. `W_f(j)` is a sum of these, so it
    /// has the relative accuracy of u, which a difference of two S_f would not have.
    fn sum_powers(
        &self,
        signal: &[f64],
        n_channels: usize,
        steps: &[u64],
        progress: Progress<'_>,
        mut each: impl FnMut(usize, &[f64]),
    ) -> Result<EvaluationInfo, Cancelled> {
        let total = steps[steps.len() - 1];
        let (mut now, mut next): (Vec<f64>, Vec<f64>) = (zeros(signal.len()), zeros(signal.len()));
        self.operator.difference(signal, n_channels, &mut now, progress)?;
        for (level, range) in steps.windows(2).enumerate() {
            for i in range[0]..range[1] {
                progress.step(i, total)?;
                if i > 0 {
                    self.operator.multiply(&now, n_channels, &mut next, progress)?;
                    std::mem::swap(&mut now, &mut next);
                }
                each(level, &now); // W_f(j) = Σ_{n_{j−1} ≤ i < n_j} Φ₁ⁱu, u = (I − Φ₁)f (eq. 11)
            }
        }
        progress.step(total, total)?;
        Ok(EvaluationInfo { degree: total - 1, products: total, terms: total, ..EvaluationInfo::default() })
    }

    pub(super) fn info(&self, outcome: &EvaluationInfo, n_channels: usize) -> BandsInfo {
        let &EvaluationInfo { degree, products, terms, error_bound, single_products, .. } = outcome;
        let (precision, format) = if single_products > 0 {
            (Precision::Single, BlockPrecision::Single)
        } else {
            (Precision::Double, BlockPrecision::Double)
        };
        BandsInfo {
            precision,
            engine: self.engine,
            degree,
            products,
            terms,
            error_bound,
            bytes: self.bytes_in(n_channels, format),
        }
    }

    /// Upper bound of the bytes that a transform of `diffusion` needs beyond the signal, its bands and the
    /// operator.
    pub fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        if diffusion.is_reversible() {
            let weights = size_of_val(diffusion.stationary()) as u64;
            weights + PreparedDiffusion::forecast_bytes(diffusion, n_channels)
        } else {
            Self::powers_bytes(diffusion.n_vertices(), n_channels)
        }
    }

    /// [`forecast_bytes`](Self::forecast_bytes) for this operator.
    pub fn forecast(&self, n_channels: usize) -> u64 {
        match self.operator.rows() {
            Some(diffusion) => {
                let single = if self.engine == Engine::Chebyshev && self.params.may_be_single() {
                    PreparedDiffusion::forecast_single_bytes(diffusion, n_channels)
                } else {
                    0
                };
                Self::forecast_bytes(diffusion, n_channels) + single
            }
            None => self.operator.bytes(n_channels, BlockPrecision::Double),
        }
    }

    /// Bytes that a call needs beyond the signal and its bands, including prepared data and the operator.
    pub fn working_bytes(&self, n_channels: usize) -> u64 {
        let format = match self.params.precision {
            Precision::Single => BlockPrecision::Single,
            Precision::Auto | Precision::Double => BlockPrecision::Double,
        };
        self.bytes_in(n_channels, format)
    }

    /// [`working_bytes`](Self::working_bytes) with vectors in a number format.
    fn bytes_in(&self, n_channels: usize, format: BlockPrecision) -> u64 {
        match self.prepared.get() {
            Some(prepared) if self.engine == Engine::Chebyshev => prepared.working_bytes(n_channels, format),
            _ => {
                let rows = self.operator.rows().map_or(0, |diffusion| diffusion.bytes());
                rows + Self::powers_bytes(self.operator.n_rows(), n_channels)
            }
        }
    }

    /// Bytes of the two alternating vectors of repeated products.
    fn powers_bytes(n_rows: usize, n_channels: usize) -> u64 {
        2 * 8 * (n_rows * n_channels) as u64
    }
}

/// Method that `params` imply for an operator.
fn engine(operator: &dyn Operator, params: &BandsParams) -> Engine {
    if operator.leap().is_some() && matches!(params.engine, Engine::Auto | Engine::Leaps) {
        return Engine::Leaps;
    }
    let needs_series = operator.semigroup() != Semigroup::Steps;
    if needs_series || operator.is_reversible() && params.engine != Engine::Powers {
        Engine::Chebyshev
    } else {
        Engine::Powers
    }
}

/// Checks the promises of an operator, as far as a product with three vectors shows them.
fn check_operator(operator: &dyn Operator) -> Result<(), BandsError> {
    /// Rounding of a sum over all rows, relative to the norms of the vectors.
    const ROUNDING: f64 = 1e-9;
    let (n, weights) = (operator.n_rows(), operator.weights());
    if let RowWeights::Each(weights) = weights {
        let (n_given, expected) = (weights.len(), n);
        if n_given != expected {
            return Err(BandsError::WrongNumber {
                what: "weights of the operator's rows",
                n_given,
                expected,
            });
        }
        let is_wrong = |w: &f64| !(w.is_finite() && *w > 0.0);
        if operator.rows().is_none() && weights.iter().any(is_wrong) {
            return Err(BandsError::BadOperator {
                reason: "the weight of a row is not a finite number above 0",
            });
        }
    }
    // A constant, and two vectors of values between −1 and 1, each with the channels that belong together.
    let k = operator.channels_at_place();
    let value = |i: usize| {
        let hash = (i as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        if i % (3 * k) < k { 1.0 } else { (hash >> 11) as f64 * (-52_f64).exp2() - 1.0 }
    };
    let width = 3 * k;
    let x: Vec<f64> = parallel::collect(width * n, value);
    let mut d: Vec<f64> = zeros(width * n);
    operator.difference(&x, width, &mut d, Progress::none())?;
    if let Some(at) = d.iter().position(|v| !v.is_finite()) {
        let (vertex, channel) = (at / width, at % width);
        return Err(BandsError::NotFinite { vertex, channel, value: d[at] });
    }
    let inner = |y: &[f64], a: usize, b: usize| {
        parallel::sum(n, |row| {
            let (x, y) = (&x[width * row + k * a..][..k], &y[width * row + k * b..][..k]);
            weights.weight(row, n) * x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>()
        })
    };
    let (product, norm) = (|a, b| inner(&d, a, b), |a| inner(&x, a, a));
    let size = norm(0);
    let keeps_constants = operator.invariant() == Invariant::Constants;
    let change = |row: usize| d[width * row..][..k].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let reason = if keeps_constants && parallel::max(n, 0.0, change) > ROUNDING {
        "the difference (I − Φ₁)x of a constant x is not 0: rows must sum to 1"
    } else if !operator.is_reversible() {
        return Ok(());
    } else if (product(1, 2) - product(2, 1)).abs() > ROUNDING * size {
        "it is said to be reversible and is not self-adjoint under its weights"
    } else if [1, 2].iter().any(|&a| !(-ROUNDING * size..=norm(a) + ROUNDING * size).contains(&product(a, a)))
    {
        "it is said to be reversible and has eigenvalues outside of [0, 1]: walks must stay with 1/2 or more"
    } else {
        return Ok(());
    };
    Err(BandsError::BadOperator { reason })
}

/// Steps of a schedule from 0, for methods that take whole steps only.
pub(super) fn whole_steps_from_zero(schedule: &Schedule) -> Result<Vec<u64>, BandsError> {
    let Some(steps) = schedule.whole_steps() else {
        let level = schedule.first_real().expect("a level of a fractional power");
        let steps = schedule.steps()[level - 1];
        return Err(BandsError::NotWhole { level, steps });
    };
    Ok(std::iter::once(0).chain(steps).collect())
}

/// Computes `out += factor·now`.
pub(super) fn add(factor: f64, now: &[f64], out: &mut [f64], n_channels: usize) {
    parallel::visit_rows(out, n_channels, super::bands::VERTICES_AT_A_TIME, |first, out| {
        for (out, v) in out.iter_mut().zip(&now[first * n_channels..]) {
            *out += factor * v;
        }
    });
}
