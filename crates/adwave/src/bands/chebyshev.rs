//! Evaluates several polynomials of Φ₁ by one Chebyshev recurrence, each until its error is provably small relative
//! to its own value.

use super::series::{Growth, Series, TruncationBound};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::parallel::{self, SERIAL};
use crate::sparse::{
    Continuation, MAX_CHANNELS, RowOutput, SignalView, Sum, SumOutputs, TiledDiffusion, Weighing,
    WeightedOperator, WideRecurrence, channel_blocks, copied, is_wide, start_recurrence,
};
use crate::{Cancelled, Progress};
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
    /// Largest relative error of any result, apart from rounding.
    pub(crate) error_bound: f64,
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
}

/// Target degree of each pass of an evaluation. A series is inspected between passes to find where to truncate it.
/// Series evaluated in two calls get the bits of a single call if the second call takes the same passes as the
/// first.
#[derive(Debug, Default)]
pub(crate) struct PassPlan {
    /// Highest degree requested for each pass, for each block of channels.
    highest: Vec<Vec<usize>>,
    call: CallOrder,
}

/// Call that takes the passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum CallOrder {
    #[default]
    First,
    Second,
    /// The second call needs terms that the first did not, so a single call would have taken other passes.
    Differs,
}

impl PassPlan {
    /// Marks the next call as the second.
    pub(crate) fn repeat(&mut self) {
        self.call = CallOrder::Second;
    }

    /// True if the second call gave up.
    pub(crate) fn differ(&self) -> bool {
        self.call == CallOrder::Differs
    }

    /// Target degree of a pass in a call that needs terms up to degree `own`; `None` if this does not fit the first
    /// call.
    fn aim(&mut self, block: usize, pass: usize, own: usize) -> Option<usize> {
        if self.call == CallOrder::First {
            self.highest.resize(self.highest.len().max(block + 1), Vec::new());
            self.highest[block].push(own);
            return Some(own);
        }
        let first = self.highest[block].get(pass).copied().filter(|&first| own <= first);
        if first.is_none() {
            self.call = CallOrder::Differs;
        }
        first
    }
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
        Ok(Self { diffusion, tiled: OnceLock::new(), weights, growth })
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
            _ if is_wide(n_channels) => WideRecurrence::bytes(self.diffusion.n_vertices(), n_channels),
            Some(tiled) => tiled.vector_bytes(n_channels.min(MAX_CHANNELS)),
            None => TiledDiffusion::forecast_bytes(&self.diffusion, n_channels.min(MAX_CHANNELS)),
        };
        self.diffusion.bytes() + tiles + weights + vectors
    }

    /// Upper bound of [`working_bytes`](Self::working_bytes), without the diffusion operator, before it is
    /// prepared.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion, n_channels: usize) -> u64 {
        let weights = size_of_val(diffusion.stationary()) as u64;
        let vectors = if is_wide(n_channels) {
            WideRecurrence::bytes(diffusion.n_vertices(), n_channels)
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
        let Polynomials { series, guard, passes, output: kept } = polynomials;
        let operator = WeightedOperator { diffusion: &self.diffusion, weights: self.weights() };
        let mut outcome = EvaluationInfo::default();
        let mut worst = vec![WorstError::default(); series.len()];
        let mut guarded = zeros(if guard.is_empty() { 0 } else { signal.values.len() });
        let guard_degree = guard.len().saturating_sub(1);
        let outputs = SumOutputs { n_sums: series.len() + usize::from(!guard.is_empty()), rows: kept };
        for (block, channels) in channel_blocks(signal.n_channels).enumerate() {
            let tiled = || self.tiled(progress);
            let mut recurrence = start_recurrence(operator, tiled, signal, channels, outputs, progress)?;
            let start = recurrence.square().sqrt();
            let mut cuts: Vec<SeriesCut> = series.iter().map(SeriesCut::new).collect();
            let mut guard_norm = 0.0;
            for pass in 0.. {
                let highest = cuts.iter().map(|cut| cut.degree).fold(guard_degree, usize::max);
                let Some(aim) = passes.aim(block, pass, highest) else { return Ok(outcome) };
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
                    sums.push(Sum { coefficients: guard, out: &mut guarded, weighing, square: 0.0 });
                }
                let next = if k + n_steps < last { Continuation::Continues } else { Continuation::Ends };
                recurrence.advance(n_steps, &mut sums, next, progress)?;
                let norms: Vec<f64> = sums.iter().map(|sum| sum.square.sqrt()).collect();
                if completes_guard && !guard.is_empty() {
                    guard_norm = norms[series.len()];
                }
                for (cut, norm) in cuts.iter_mut().zip(norms) {
                    cut.decide(k + n_steps, start, norm, accuracy);
                }
                if next == Continuation::Ends {
                    break;
                }
            }
            let k = recurrence.k() as u64;
            outcome.degree = outcome.degree.max(k);
            outcome.products += k + 1;
            outcome.terms += cuts.iter().map(|cut| (cut.degree as u64).min(k) + 1).sum::<u64>();
            if recurrence.is_nonzero() {
                for (worst, cut) in worst.iter_mut().zip(&cuts) {
                    let (missing, relative) = cut.missing(start, guard_norm);
                    worst.relative = worst.relative.max(relative);
                    worst.falls_short |= cut.series.rest != TruncationBound::default()
                        && relative > accuracy
                        && missing > ROUNDING * cut.series.total * start;
                }
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
}

/// Largest error of a series over all blocks of channels.
#[derive(Clone, Copy, Default)]
struct WorstError {
    relative: f64,
    falls_short: bool,
}

/// Degree at which a series is truncated.
struct SeriesCut<'a> {
    series: &'a Series,
    degree: usize,
    /// Lower bound of the norm of the value, once it is known.
    least: Option<f64>,
}

impl<'a> SeriesCut<'a> {
    fn new(series: &'a Series) -> Self {
        Self { series, degree: series.degree(), least: None }
    }

    /// Requests the norm of the sum of the terms up to `k` if it can decide the truncation.
    fn weighing_after(&self, k: usize) -> Weighing {
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

    /// Chooses the degree, given the norm `norm` of the sum of the terms up to `k`.
    fn decide(&mut self, k: usize, start: f64, norm: f64, accuracy: f64) {
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
            self.degree = self.series.degree_within(accuracy * least / start, k);
        }
    }

    /// Bound of the truncation error, absolute and relative to the value.
    fn missing(&self, start: f64, guard_norm: f64) -> (f64, f64) {
        let guarded = self.series.rest.guarded * guard_norm;
        let missing = (self.series.tail[self.degree] + self.series.rest.always) * start + guarded;
        let least = (self.least.unwrap_or(0.0) - guarded).max(0.0);
        (missing, if missing == 0.0 { 0.0 } else { missing / least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::operator::{OperatorParams, local_operator, surface_diffusion};
    use crate::shape::{Graph, PreparedGeometry, Shape};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};

    /// A cycle of `n` vertices, each connected to the next `width` vertices.
    fn ring_geometry(n: u32, width: u32) -> PreparedGeometry {
        let edge = |u: u32| (1..=width).map(move |e| (u, (u + e) % n, 1.0 + f64::from((u + e) % 3)));
        let edges: Vec<_> = (0..n).flat_map(edge).collect();
        let shape = Shape::Graph(Graph::new(n as usize, &edges).expect("edges of the graph"));
        PreparedGeometry::new(&shape, OperatorParams::default().weld, Progress::none())
            .expect("nobody stops it")
    }

    /// The walk on such a cycle.
    fn ring(n: u32, width: u32) -> Arc<Diffusion> {
        let (geometry, params) = (ring_geometry(n, width), OperatorParams::default());
        let operator = local_operator(&geometry, &params, Progress::none()).expect("nobody stops it");
        Arc::new(Diffusion::new(operator, Progress::none()).expect("nobody stops it"))
    }

    fn evaluate(
        prepared: &ChebyshevEvaluator,
        signal: &[f64],
        d: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<f64>>, Cancelled> {
        let series: Vec<Series> =
            [(0, 1), (8, 16), (64, 128)].map(|(a, b)| Series::band(a, b, Growth::Bounded)).to_vec();
        let mut bands = vec![vec![0.0; signal.len()]; series.len()];
        let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
        let passes = &mut PassPlan::default();
        let polynomials = Polynomials { series: &series, guard: &[], passes, output: RowOutput::Channels };
        let signal = SignalView { values: signal, n_channels: d };
        prepared.evaluate(signal, polynomials, 0.0, &mut outs, progress)?; // all terms
        Ok(bands)
    }

    #[test]
    fn tiles_in_place_and_apart_give_the_bits_of_the_recurrence_one_step_at_a_time() {
        // Cycles with 2 neighbors have small halos; those with 140 have halos larger than two vectors.
        for (n, width, d) in [(20_000, 1, 3), (9000, 3, 5), (1500, 140, 2), (700, 2, 1)] {
            let diffusion = ring(n, width);
            let signal: Vec<f64> = (0..n as usize * d).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
            let fused =
                ChebyshevEvaluator::new(Arc::clone(&diffusion), Progress::none()).expect("nobody stops it");
            let mut plain = ChebyshevEvaluator::new(diffusion, Progress::none()).expect("nobody stops it");
            let tiles = plain.tiled(Progress::none()).expect("nobody stops it").with_tiles(n as usize, 1);
            plain.tiled = OnceLock::from(tiles);
            let found = evaluate(&fused, &signal, d, Progress::none()).expect("nobody stops it");
            assert!(found == evaluate(&plain, &signal, d, Progress::none()).expect("nobody stops it"), "{n}");
            // Again, with vectors that an earlier call returned to the pool.
            assert!(found == evaluate(&fused, &signal, d, Progress::none()).expect("nobody stops it"), "{n}");
        }
    }

    #[test]
    fn wide_blocks_agree_with_narrow_ones_on_any_number_of_threads() {
        /// Rounding of up to 128 steps of values up to 101.
        const ROUNDING: f64 = 1e-10;
        let params = OperatorParams::default();
        let heat = surface_diffusion(&ring_geometry(3000, 9), &params, Progress::none());
        let heat = heat.expect("nobody stops it").diffusion;
        assert!((0..3000).any(|x| heat.diagonal(x) != 0.5), "the steps of heat are not lazy");
        for diffusion in [ring(3000, 9), Arc::new(heat)] {
            let prepared = ChebyshevEvaluator::new(diffusion, Progress::none()).expect("nobody stops it");
            for d in [16, 20, 33, 70] {
                let signal: Vec<f64> = (0..3000 * d).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
                let wide = evaluate(&prepared, &signal, d, Progress::none()).expect("nobody stops it");
                for channel in [0, 1, d / 2, d - 1] {
                    let alone: Vec<f64> = signal.iter().skip(channel).step_by(d).copied().collect();
                    let narrow = evaluate(&prepared, &alone, 1, Progress::none()).expect("nobody stops it");
                    for (wide, narrow) in wide.iter().zip(&narrow) {
                        let of_wide = wide.iter().skip(channel).step_by(d);
                        let worst =
                            of_wide.zip(narrow).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
                        assert!(worst < ROUNDING, "{d} channels: {worst}");
                    }
                }
                let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
                let again = pool.install(|| evaluate(&prepared, &signal, d, Progress::none()));
                assert!(wide == again.expect("nobody stops it"), "{d} channels by three threads");
            }
        }
    }

    #[test]
    fn a_single_wide_sum_takes_one_step_at_a_time_with_the_same_result() {
        const ROUNDING: f64 = 1e-10;
        let prepared = ChebyshevEvaluator::new(ring(2000, 5), Progress::none()).expect("nobody stops it");
        let signal: Vec<f64> = (0..2000 * 24).map(|i| f64::from((i * 17 + i / 5) % 89)).collect();
        let all = evaluate(&prepared, &signal, 24, Progress::none()).expect("nobody stops it");
        for (level, (a, b)) in [(0, 1), (8, 16), (64, 128)].into_iter().enumerate() {
            let series = [Series::band(a, b, Growth::Bounded)];
            let mut band = vec![0.0; signal.len()];
            let passes = &mut PassPlan::default();
            let polynomials =
                Polynomials { series: &series, guard: &[], passes, output: RowOutput::Channels };
            let view = SignalView { values: &signal, n_channels: 24 };
            prepared
                .evaluate(view, polynomials, 0.0, &mut [&mut band], Progress::none())
                .expect("nobody stops it");
            let worst = band.iter().zip(&all[level]).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
            assert!(worst < ROUNDING, "band {level}: {worst}");
        }
    }

    #[test]
    fn a_call_that_is_told_to_stop_does_so_at_once() {
        /// Far more time than an idle machine needs; the whole computation takes many times as long.
        const AT_ONCE: Duration = Duration::from_secs(2);
        let diffusion = ring(300_000, 3);
        let signal: Vec<f64> = (0..900_000).map(|i| f64::from((i * 31) % 101)).collect();
        let mut n_stopped = 0;
        for delay in [0, 3, 11, 29, 71, 113] {
            let (stop, told) = (AtomicBool::new(false), std::sync::Mutex::new(None));
            let progress = Progress::none().with_cancel(&stop);
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(Duration::from_millis(delay));
                    *told.lock().expect("a clock") = Some(Instant::now());
                    stop.store(true, Ordering::Relaxed);
                });
                let outcome = loop {
                    // Repeated, because a fast machine finishes before it is cancelled.
                    let prepared = ChebyshevEvaluator::new(Arc::clone(&diffusion), progress);
                    let done = prepared.and_then(|prepared| evaluate(&prepared, &signal, 3, progress));
                    if let Err(cancelled) = done {
                        break cancelled;
                    }
                };
                assert_eq!(outcome, Cancelled);
                let told = told.lock().expect("a clock").expect("told before it stops");
                assert!(told.elapsed() < AT_ONCE, "{:?} after it was told to stop", told.elapsed());
                n_stopped += 1;
            });
        }
        assert_eq!(n_stopped, 6);
    }

    #[test]
    fn a_second_call_gives_up_where_it_wants_more_than_the_first() {
        let mut passes = PassPlan::default();
        assert_eq!(
            [passes.aim(0, 0, 30), passes.aim(0, 1, 20), passes.aim(1, 0, 9)],
            [Some(30), Some(20), Some(9)]
        );
        passes.repeat();
        assert_eq!((passes.aim(0, 0, 12), passes.aim(0, 1, 20)), (Some(30), Some(20)));
        assert!(!passes.differ());
        assert_eq!(passes.aim(1, 0, 10), None); // a single call would have aimed at 10
        assert!(passes.differ());
    }

    #[test]
    fn what_is_prepared_can_be_shared_between_threads() {
        fn shared<T: Send + Sync + 'static>() {}
        shared::<ChebyshevEvaluator>();
        shared::<Arc<ChebyshevEvaluator>>();
    }
}
