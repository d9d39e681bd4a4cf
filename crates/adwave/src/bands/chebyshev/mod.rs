//! Evaluates several polynomials of Φ₁ by one Chebyshev recurrence, each until its error is provably small relative
//! to its own value.

mod cut;
mod plan;
#[cfg(test)]
mod tests;

use super::Precision;
use super::params::FINEST_SINGLE;
use super::series::{Growth, Series, TruncationBound};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::parallel::{self, SERIAL};
use crate::sparse::{
    BlockPrecision, Continuation, MAX_CHANNELS, RowOutput, SignalView, SingleWeights, Sum, SumOutputs,
    TiledDiffusion, Weighing, WeightedOperator, WideRecurrence, block_width, copied, is_wide,
    start_recurrence,
};
use crate::{Cancelled, Progress};
use cut::SeriesCut;
pub(crate) use plan::PassPlan;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

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
    /// Adds another evaluation of the same request. The caller handles what `other` missed.
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

/// A diffusion operator prepared for the recurrence. It is built once, evaluates any number of signals, and can be
/// used by several threads at a time.
#[derive(Debug)]
pub(crate) struct ChebyshevEvaluator {
    diffusion: Arc<Diffusion>,
    /// The operator in tiles, cut by the first call with few channels.
    tiled: OnceLock<TiledDiffusion>,
    /// The operator in single precision, rounded by the first call that asks for it; `None` if it has none.
    single: OnceLock<Option<SingleWeights>>,
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
    /// Prepares `diffusion`; the first call with few channels does the rest. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(diffusion: Arc<Diffusion>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let (weights, growth) = norm_weights(&diffusion, progress)?;
        Ok(Self { diffusion, tiled: OnceLock::new(), single: OnceLock::new(), weights, growth })
    }

    /// The operator in tiles. O(entries) for the first call.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn tiled(&self, progress: Progress<'_>) -> Result<&TiledDiffusion, Cancelled> {
        if let Some(tiled) = self.tiled.get() {
            return Ok(tiled);
        }
        // If two threads arrive here at once, one of them works in vain.
        let tiled = TiledDiffusion::new(Arc::clone(&self.diffusion), progress)?;
        Ok(self.tiled.get_or_init(|| tiled))
    }

    /// The operator in single precision, if its rounding errors can be bounded. O(entries) for the first call.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn single(&self, progress: Progress<'_>) -> Result<Option<&SingleWeights>, Cancelled> {
        if let Some(single) = self.single.get() {
            return Ok(single.as_ref());
        }
        let single = match self.growth {
            Growth::Bounded => SingleWeights::new(&self.diffusion, self.weights(), progress)?,
            Growth::Linear => None,
        };
        Ok(self.single.get_or_init(|| single).as_ref())
    }

    /// Weights μ of the norm.
    fn weights(&self) -> &[f64] {
        self.weights.as_deref().unwrap_or(self.diffusion.stationary())
    }

    /// Bytes that an evaluation of some series needs for a signal of `n_channels` channels beyond the signal and its
    /// results: the prepared data, including the diffusion operator, and the vectors of the recurrence.
    pub(crate) fn working_bytes(&self, n_channels: usize) -> u64 {
        let weights = self.weights.as_ref().map_or(0, |weights| size_of_val(&weights[..]) as u64);
        let tiles = self.tiled.get().map_or(0, TiledDiffusion::bytes);
        let vectors = match self.tiled.get() {
            _ if is_wide(n_channels) => WideRecurrence::<f64>::bytes(self.diffusion.n_vertices(), n_channels),
            Some(tiled) => tiled.vector_bytes(n_channels.min(MAX_CHANNELS)),
            None => TiledDiffusion::forecast_bytes(&self.diffusion, n_channels.min(MAX_CHANNELS)),
        };
        let single = self.single.get().and_then(Option::as_ref).map_or(0, SingleWeights::bytes);
        self.diffusion.bytes() + tiles + weights + single + vectors
    }

    /// Upper bound of [`working_bytes`](Self::working_bytes), without the diffusion operator, before it is
    /// prepared.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        let weights = size_of_val(diffusion.stationary()) as u64;
        let vectors = if is_wide(n_channels) {
            WideRecurrence::<f64>::bytes(diffusion.n_vertices(), n_channels)
        } else {
            TiledDiffusion::forecast_bytes(diffusion, n_channels.min(MAX_CHANNELS))
        };
        weights + vectors
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
        let mut single = self.single_for(signal, series, precision, accuracy, progress)?;
        let (mut at, mut number) = (0, 0);
        while at < signal.n_channels {
            let format = if single.is_some() { BlockPrecision::Single } else { BlockPrecision::Double };
            let width = block_width(signal.n_channels, signal.n_channels - at, format);
            let block = Block { channels: at..at + width, number, single };
            let polynomials = Polynomials { series, guard, passes: &mut *passes, output, precision };
            let target = BlockTarget { accuracy, outs: &mut *outs, guarded: &mut guarded };
            let Some(done) = self.evaluate_block(signal, polynomials, block, target, progress)? else {
                return Ok(outcome);
            };
            number += 1;
            if single.is_some() && precision == Precision::Auto && done.exceeds(accuracy) {
                // The bound is known only now, and that of the other blocks will be about the same.
                single = None;
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

    /// The operator in single precision if an evaluation is to use it: it is asked for, or nothing that is known before
    /// shows that its errors exceed the accuracy.
    fn single_for(
        &self,
        signal: SignalView<'_>,
        series: &[Series],
        precision: Precision,
        accuracy: f64,
        progress: Progress<'_>,
    ) -> Result<Option<&SingleWeights>, Cancelled> {
        if precision == Precision::Double || !is_wide(signal.n_channels) {
            return Ok(None);
        }
        if precision == Precision::Auto && accuracy < FINEST_SINGLE {
            return Ok(None);
        }
        let Some(single) = self.single(progress)? else { return Ok(None) };
        // ‖value‖ ≤ total·‖u‖, so these are lower bounds of the degree and of the relative error.
        let may_suffice = |series: &Series| {
            let degree = series.degree_within(accuracy * series.total, 0);
            single.rounding(&series.coefficients, degree, 1.0) <= accuracy * series.total
        };
        let is_tried = precision == Precision::Single || series.iter().all(may_suffice);
        Ok(is_tried.then_some(single))
    }

    /// [`evaluate`](Self::evaluate) for a block of channels; `None` if the passes differ from those of the first call.
    fn evaluate_block(
        &self,
        signal: SignalView<'_>,
        polynomials: Polynomials<'_>,
        block: Block<'_>,
        target: BlockTarget<'_, '_>,
        progress: Progress<'_>,
    ) -> Result<Option<BlockInfo>, Cancelled> {
        let Polynomials { series, guard, passes, output: rows, .. } = polynomials;
        let BlockTarget { accuracy, outs, guarded } = target;
        // In single precision the other half is for rounding.
        let truncated = if block.single.is_some() { 0.5 * accuracy } else { accuracy };
        let (diffusion, weights) = (&*self.diffusion, self.weights());
        let operator = WeightedOperator { diffusion, weights, single: block.single };
        let guard_degree = guard.len().saturating_sub(1);
        let outputs = SumOutputs { n_sums: series.len() + usize::from(!guard.is_empty()), rows };
        let tiled = || self.tiled(progress);
        let block_is_double = block.single.is_none();
        let mut recurrence = start_recurrence(operator, tiled, signal, block.channels, outputs, progress)?;
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
                    weighing: cut.weighing_after(k + n_steps),
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
            let norms: Vec<f64> = sums.iter().map(|sum| sum.square.sqrt()).collect();
            if completes_guard && !guard.is_empty() {
                guard_norm = norms[series.len()];
            }
            for (cut, norm) in cuts.iter_mut().zip(norms) {
                if k == 0 || k < cut.degree {
                    cut.norm = norm;
                }
                cut.decide(k + n_steps, start, norm, truncated);
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
            single_products: if block.single.is_some() { k } else { 0 },
            ..EvaluationInfo::default()
        };
        let mut errors = vec![WorstError::default(); series.len()];
        if recurrence.is_nonzero() {
            for (error, cut) in errors.iter_mut().zip(&cuts) {
                let rounding = start * recurrence.rounding(&cut.series.coefficients[..=cut.degree]);
                let (missing, relative) = cut.missing(start, guard_norm, rounding);
                // Squares of values below 1e-154 or beyond 1e154 say nothing.
                let has_norm = block_is_double || start.is_normal();
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
struct Block<'a> {
    channels: Range<usize>,
    /// Number of the block in the plan of the passes.
    number: usize,
    /// The operator in single precision, if the block is to use it.
    single: Option<&'a SingleWeights>,
}

/// Accuracy of a block, and where its results go.
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
