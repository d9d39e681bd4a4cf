//! Evaluates several polynomials of Φ₁ by one Chebyshev recurrence, each until its error is provably small relative
//! to its own value.

mod cut;
mod plan;
#[cfg(test)]
mod tests;

use super::Precision;
use super::params::FINEST_SINGLE;
use super::series::{Growth, Series, TruncationBound};
use crate::operator::{
    BlockPrecision, Continuation, Diffusion, Operator, RowOutput, RowWeights, SignalBlock, Sum, Weighing,
};
use crate::pages::zeros;
use crate::parallel::{self, SERIAL};
use crate::sparse::{SignalView, copied};
use crate::{Cancelled, Progress};
use cut::SeriesCut;
pub(crate) use plan::PassPlan;
use std::ops::Range;
use std::sync::Arc;

/// Cost and accuracy of an evaluation.
#[derive(Clone, Debug, Default)]
pub(crate) struct EvaluationInfo {
    /// Highest degree of any evaluated series.
    pub(crate) degree: u64,
    /// Products with Φ₁ over all blocks of channels.
    pub(crate) products: u64,
    /// Terms added, over all series and blocks.
    pub(crate) terms: u64,
    /// Largest relative error of any result, apart from rounding in double precision.
    pub(crate) error_bound: f64,
    /// Products, of those above, that were computed in single precision.
    pub(crate) single_products: u64,
    /// Index and relative error of each series of fractional steps that missed the accuracy; they do not count for
    /// the other fields.
    pub(crate) missed: Vec<(usize, f64)>,
}

impl EvaluationInfo {
    /// Adds another evaluation of the same request. The caller handles the series that missed the accuracy in `other`.
    pub(super) fn add(&mut self, other: &Self) {
        self.degree = self.degree.max(other.degree);
        self.products += other.products;
        self.terms += other.terms;
        self.single_products += other.single_products;
        self.error_bound = self.error_bound.max(other.error_bound);
    }
}

/// Polynomials of Φ₁ that one evaluation computes together.
#[derive(Debug)]
pub(crate) struct Polynomials<'a> {
    /// One series per output.
    pub(crate) series: &'a [Series],
    /// The polynomial whose norm multiplies [`TruncationBound::guarded`](super::series::TruncationBound), for series
    /// that have such a part; else empty.
    pub(crate) guard: &'a [f64],
    /// Passes of this call, or of the call that it must repeat.
    pub(crate) passes: &'a mut PassPlan,
    /// Rows of each output.
    pub(crate) output: RowOutput<'a>,
    /// Number format of the vectors. Single precision needs an empty guard.
    pub(crate) precision: Precision,
}

/// Rounding error of a polynomial of fractional steps, relative to `Σ|a_k|·‖u‖`; no accuracy below it is required.
const ROUNDING: f64 = 1e-15;

/// Rounding error of a step in single precision, relative to the vectors, that no operator stays below: three roundings
/// of numbers that sum to 1. Where the accuracy excludes even this, nothing is prepared for single precision.
const LEAST_PER_STEP: f64 = 3.0 * f32::EPSILON as f64 / 2.0;

/// An operator with the norm in which the recurrence bounds errors. It is built once, evaluates any number of signals,
/// and can be used by several threads at a time.
#[derive(Debug)]
pub(crate) struct ChebyshevEvaluator {
    operator: Arc<dyn Operator>,
    /// Weights μ of the norm that bounds errors, if it is not π.
    weights: Option<Vec<f64>>,
    pub(crate) growth: Growth,
}

/// Weights μ of the norm `‖g‖² = Σ_x μ(x)|g(x)|²` in which errors are bounded, and how `‖T_k(Y)‖` grows in it.
///
/// Under its stationary distribution a reversible walk is symmetric with a spectrum in [0, 1], so `‖T_k(Y)‖ ≤ 1`.
/// Vertices without area have π = 0: the walk leaves them for the vertices R with π > 0 and never returns, so
/// `Y = [Y_R 0; B 0]`. For those rows `T_k(Y) = B·(T_k(Y_R) − T_k(0))/Y_R + T_k(0)`, and
/// `|T_k(y) − T_k(0)| ≤ 1.2k|y|`. With `μ(x) = min_y π(y)/(B(x,y)·m(y))`, where m(y) is the number of such x that
/// lead to y, B has norm at most 1, so `‖T_k(Y)‖ ≤ 2 + 1.2k`.
fn norm_weights(
    diffusion: &Diffusion,
    progress: Progress<'_>,
) -> Result<(Option<Vec<f64>>, Growth), Cancelled> {
    let stationary = diffusion.stationary();
    let is_transient = |&x: &usize| stationary[x] == 0.0 && !diffusion.row(x).0.is_empty();
    let chunks = parallel::try_map_chunks(
        stationary.len(),
        SERIAL,
        progress,
        || (),
        |(), range| range.filter(is_transient).collect::<Vec<_>>(),
    )?;
    let transient = chunks.concat();
    if transient.is_empty() {
        return Ok((None, Growth::Bounded));
    }
    let mut n_leading: Vec<u32> = zeros(stationary.len());
    for &x in &transient {
        progress.check()?;
        for &y in diffusion.row(x).0 {
            n_leading[y as usize] += 1;
        }
    }
    let mut weights = copied(stationary, 1, progress)?;
    for &x in &transient {
        progress.check()?;
        let (columns, values) = diffusion.row(x);
        let bound = columns
            .iter()
            .zip(values)
            .filter(|(_, b)| **b > 0.0)
            .map(|(&y, b)| stationary[y as usize] / (2.0 * b * f64::from(n_leading[y as usize])));
        let least = bound.fold(f64::INFINITY, f64::min);
        weights[x] = if least.is_finite() { least } else { 0.0 };
    }
    Ok((Some(weights), Growth::Linear))
}

impl ChebyshevEvaluator {
    /// Prepares `operator`; the first call does the rest. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(operator: Arc<dyn Operator>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        // All weights of an operator without rows are positive.
        let (weights, growth) = match operator.rows() {
            Some(diffusion) => norm_weights(diffusion, progress)?,
            None => (None, Growth::Bounded),
        };
        Ok(Self { operator, weights, growth })
    }

    /// Weights μ of the norm.
    fn weights(&self) -> RowWeights<'_> {
        self.weights.as_deref().map_or(self.operator.weights(), RowWeights::Each)
    }

    /// True if the recurrence can be computed in single precision with a bound of its rounding errors. O(entries) for
    /// the first call.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn has_single(&self, progress: Progress<'_>) -> Result<bool, Cancelled> {
        Ok(self.growth == Growth::Bounded && self.operator.single_rounding(&[], 0, progress)?.is_some())
    }

    /// Bytes that an evaluation of some series needs for a signal of `n_channels` channels beyond the signal and its
    /// results: the prepared data, including the operator, and the vectors of the recurrence.
    pub(crate) fn working_bytes(&self, n_channels: usize, format: BlockPrecision) -> u64 {
        let weights = self.weights.as_ref().map_or(0, |weights| size_of_val(&weights[..]) as u64);
        self.operator.bytes(n_channels, format) + weights
    }

    /// Computes `series[j](Φ₁)·(I − Φ₁)·signal` into `outs[j]`, each n_vertices × n_channels, with a relative error
    /// of at most `accuracy` in the norm of `weights`. With normals, each output is the component along the normal
    /// (n_vertices values), with that error relative to its own norm.
    ///
    /// A series is truncated at the first degree whose tail times `‖u‖` is at most `accuracy` times a lower bound
    /// of the norm of its value. The bound is known as soon as the partial sum clearly exceeds the remainder, so
    /// the degree follows the signal and is lower for smooth signals. A value that is nearly zero relative to u
    /// gets all terms that double precision can distinguish.
    ///
    /// If the passes differ from those of the first call, the content of `outs` is unspecified.
    pub(crate) fn evaluate(
        &self,
        signal: SignalView<'_>,
        polynomials: Polynomials<'_>,
        accuracy: f64,
        outs: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, Cancelled> {
        let Polynomials { series, guard, passes, output, precision } = polynomials;
        let mut outcome = EvaluationInfo::default();
        let mut worst = vec![WorstError::default(); series.len()];
        let mut guarded = zeros(if guard.is_empty() { 0 } else { signal.values.len() });
        assert!(
            guard.is_empty() || precision == Precision::Double,
            "a guard is measured in double precision"
        );
        let mut format = self.format_for(series, precision, accuracy, progress)?;
        let (mut at, mut number) = (0, 0);
        while at < signal.n_channels {
            let width = self.operator.width(signal.n_channels, signal.n_channels - at, format);
            let block = Block { channels: at..at + width, number, format };
            let polynomials = Polynomials { series, guard, passes: &mut *passes, output, precision };
            let target = BlockTarget { accuracy, outs: &mut *outs, guarded: &mut guarded };
            let Some(done) = self.evaluate_block(signal, polynomials, block, target, progress)? else {
                return Ok(outcome);
            };
            number += 1;
            if format == BlockPrecision::Single && precision == Precision::Auto && done.exceeds(accuracy) {
                // The bound is known only now, and that of the other blocks will be about the same.
                format = BlockPrecision::Double;
                continue;
            }
            at += width;
            outcome.add(&done.info);
            for (worst, error) in worst.iter_mut().zip(&done.errors) {
                worst.relative = worst.relative.max(error.relative);
                worst.falls_short |= error.falls_short;
            }
        }
        for (at, worst) in worst.iter().enumerate() {
            if worst.falls_short {
                outcome.missed.push((at, worst.relative));
            } else {
                outcome.error_bound = outcome.error_bound.max(worst.relative);
            }
        }
        Ok(outcome)
    }

    /// Number format of an evaluation: single precision if it is asked for, or if nothing known beforehand shows that
    /// its errors exceed the accuracy.
    pub(super) fn format_for(
        &self,
        series: &[Series],
        precision: Precision,
        accuracy: f64,
        progress: Progress<'_>,
    ) -> Result<BlockPrecision, Cancelled> {
        // ‖value‖ ≤ total·‖u‖, so these are lower bounds of the degree and of the relative error.
        let most = |series: &Series| accuracy * series.total;
        let degree = |series: &Series| series.degree_within(most(series), 0);
        let is_out = |series: &Series| {
            let k = degree(series);
            let terms = series.coefficients[..=k].iter().zip(0_u32..);
            let growth = |k: u32| f64::from(k) * f64::from(k + 1);
            let least: f64 = terms.map(|(a, k)| a.abs() * growth(k) * LEAST_PER_STEP / 2.0).sum();
            least > most(series)
        };
        let is_auto = precision == Precision::Auto;
        if precision == Precision::Double
            || is_auto && (accuracy < FINEST_SINGLE || series.iter().any(is_out))
            || !self.has_single(progress)?
        {
            return Ok(BlockPrecision::Double);
        }
        for series in series.iter().filter(|_| is_auto) {
            let rounding = self.operator.single_rounding(&series.coefficients, degree(series), progress)?;
            if !rounding.is_some_and(|rounding| rounding <= most(series)) {
                return Ok(BlockPrecision::Double);
            }
        }
        Ok(BlockPrecision::Single)
    }

    /// [`evaluate`](Self::evaluate) for a block of channels; `None` if the passes differ from those of the first call.
    fn evaluate_block(
        &self,
        signal: SignalView<'_>,
        polynomials: Polynomials<'_>,
        block: Block,
        target: BlockTarget<'_, '_>,
        progress: Progress<'_>,
    ) -> Result<Option<BlockInfo>, Cancelled> {
        let Polynomials { series, guard, passes, output, precision } = polynomials;
        let BlockTarget { accuracy, outs, guarded } = target;
        // In single precision the other half is for rounding.
        let is_single = block.format == BlockPrecision::Single;
        let truncated = if is_single { 0.5 * accuracy } else { accuracy };
        let guard_degree = guard.len().saturating_sub(1);
        let signal_block = SignalBlock {
            values: signal.values,
            n_channels: signal.n_channels,
            channels: block.channels,
            weights: self.weights(),
            n_sums: series.len() + usize::from(!guard.is_empty()),
            output,
            precision: block.format,
        };
        let mut recurrence = self.operator.start(signal_block, progress)?;
        let start = recurrence.square().sqrt();
        let mut cuts: Vec<SeriesCut> = series.iter().map(SeriesCut::new).collect();
        let mut guard_norm = 0.0;
        for pass in 0.. {
            let highest = cuts.iter().map(|cut| cut.degree).fold(guard_degree, usize::max);
            let Some(aim) = passes.aim(block.number, pass, highest) else { return Ok(None) };
            let [last, aim] = [highest, aim].map(|k| if recurrence.is_nonzero() { k } else { 0 });
            let k = recurrence.k();
            progress.step(k as u64, last as u64)?;
            let left = aim - k.min(aim);
            // Passes have equal length, because a short last pass would cost as much memory traffic as a long
            // one.
            let n_steps =
                left.div_ceil(left.div_ceil(recurrence.steps_per_pass()).max(1)).min(last - k.min(last));
            let mut sums: Vec<Sum<'_>> = cuts
                .iter()
                .zip(&mut *outs)
                .map(|(cut, out)| Sum {
                    coefficients: &cut.series.coefficients[..=cut.degree],
                    out,
                    weighing: if is_single && cut.is_completed_within(k + 1..=k + n_steps) {
                        Weighing::Weighed
                    } else {
                        cut.weighing_after(k + n_steps)
                    },
                    square: 0.0,
                })
                .collect();
            let completes_guard = (k + 1..=k + n_steps).contains(&guard_degree);
            if !guard.is_empty() {
                let weighing = if completes_guard { Weighing::Weighed } else { Weighing::Unweighed };
                sums.push(Sum { coefficients: guard, out: &mut *guarded, weighing, square: 0.0 });
            }
            let next = if k + n_steps < last { Continuation::Continues } else { Continuation::Ends };
            recurrence.advance(n_steps, &mut sums, next, progress)?;
            let norms: Vec<Option<f64>> = sums
                .iter()
                .map(|sum| (sum.weighing == Weighing::Weighed).then(|| sum.square.sqrt()))
                .collect();
            if completes_guard && !guard.is_empty() {
                guard_norm = norms[series.len()].unwrap_or(0.0);
            }
            for (cut, norm) in cuts.iter_mut().zip(norms) {
                let Some(norm) = norm.filter(|_| k == 0 || k < cut.degree) else { continue };
                cut.norm = norm;
                let rounding = start * recurrence.rounding(&cut.series.coefficients[..=cut.degree]);
                if precision == Precision::Auto && cut.must_miss(k + n_steps, start, rounding, accuracy) {
                    let errors = vec![WorstError { relative: f64::INFINITY, falls_short: false }];
                    return Ok(Some(BlockInfo { info: EvaluationInfo::default(), errors }));
                }
                cut.decide(k + n_steps, start, norm, rounding, truncated);
            }
            if next == Continuation::Ends {
                break;
            }
        }
        let k = recurrence.k() as u64;
        let info = EvaluationInfo {
            degree: k,
            products: k + 1,
            terms: cuts.iter().map(|cut| (cut.degree as u64).min(k) + 1).sum(),
            single_products: if is_single { k } else { 0 },
            ..EvaluationInfo::default()
        };
        let mut errors = vec![WorstError::default(); series.len()];
        if recurrence.is_nonzero() {
            for (error, cut) in errors.iter_mut().zip(&cuts) {
                let rounding = start * recurrence.rounding(&cut.series.coefficients[..=cut.degree]);
                let (missing, relative) = cut.missing(start, guard_norm, rounding);
                // Squares of values below 1e-154 or beyond 1e154 say nothing.
                let has_norm = !is_single || start.is_normal();
                error.relative = if has_norm { relative } else { f64::INFINITY };
                error.falls_short = cut.series.rest != TruncationBound::default()
                    && relative > accuracy
                    && missing > ROUNDING * cut.series.total * start;
            }
        }
        Ok(Some(BlockInfo { info, errors }))
    }
}

/// Channels that are evaluated together.
struct Block {
    channels: Range<usize>,
    /// Number of the block in the plan of the passes.
    number: usize,
    format: BlockPrecision,
}

/// Accuracy of a block, and the destination of its results.
struct BlockTarget<'a, 'b> {
    accuracy: f64,
    outs: &'a mut [&'b mut [f64]],
    guarded: &'a mut [f64],
}

/// Cost of a block, and the errors of its series.
struct BlockInfo {
    info: EvaluationInfo,
    errors: Vec<WorstError>,
}

impl BlockInfo {
    /// True if an error bound exceeds the accuracy.
    fn exceeds(&self, accuracy: f64) -> bool {
        self.errors.iter().any(|error| error.relative.is_nan() || error.relative > accuracy)
    }
}

/// Largest error of a series over all blocks of channels.
#[derive(Clone, Copy, Default)]
struct WorstError {
    relative: f64,
    falls_short: bool,
}
