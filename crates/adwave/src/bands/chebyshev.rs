//! Several polynomials of Φ₁ by one Chebyshev recurrence, each until its error is proven small beside its own value.

use super::series::{Growth, Series};
use crate::operator::Diffusion;
use crate::sparse::{MAX_CHANNELS, Next, Recurrence, Sum, Walk};
use crate::{Cancelled, Progress};

/// What an evaluation took and what it promises.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Highest term of any series.
    pub(crate) degree: u64,
    /// Products with Φ₁ over all blocks of channels.
    pub(crate) products: u64,
    /// Largest relative error of any result, but for rounding.
    pub(crate) error_bound: f64,
}

/// Weights μ of the norm `‖g‖² = Σ_x μ(x)|g(x)|²` in which errors are bounded, and how `‖T_k(Y)‖` grows in it.
///
/// Under its stationary law a reversible walk is symmetric with a spectrum in [0, 1], so `‖T_k(Y)‖ ≤ 1`. Vertices
/// without area have π = 0: the walk leaves them for vertices R with π > 0 and never comes back, `Y = [Y_R 0; B 0]`. There
/// `T_k(Y) = B·(T_k(Y_R) − T_k(0))/Y_R + T_k(0)`, and `|T_k(y) − T_k(0)| ≤ 1.2k|y|`. With `μ(x) = min_y π(y)/(B(x,y)·m(y))`,
/// m(y) the number of such x that lead to y, B has a norm of at most 1, so that `‖T_k(Y)‖ ≤ 2 + 1.2k`.
pub(crate) fn norm_weights(diffusion: &Diffusion) -> (Vec<f64>, Growth) {
    let mut weights = diffusion.stationary().to_vec();
    let transient: Vec<usize> =
        (0..weights.len()).filter(|&x| weights[x] == 0.0 && !diffusion.row(x).0.is_empty()).collect();
    if transient.is_empty() {
        return (weights, Growth::Bounded);
    }
    let mut n_leading = vec![0_u32; weights.len()];
    for &x in &transient {
        for &y in diffusion.row(x).0 {
            n_leading[y as usize] += 1;
        }
    }
    for &x in &transient {
        let (columns, values) = diffusion.row(x);
        let bound =
            columns.iter().zip(values).filter(|(_, b)| **b > 0.0).map(|(&y, b)| {
                diffusion.stationary()[y as usize] / (2.0 * b * f64::from(n_leading[y as usize]))
            });
        let least = bound.fold(f64::INFINITY, f64::min);
        weights[x] = if least.is_finite() { least } else { 0.0 };
    }
    (weights, Growth::Linear)
}

/// `‖g‖` over the channels `at .. at + width` of `n_channels`.
fn norm(weights: &[f64], g: &[f64], n_channels: usize, at: usize, width: usize) -> f64 {
    let square = |x: usize| {
        let row = &g[x * n_channels + at..][..width];
        weights[x] * row.iter().map(|v| v * v).sum::<f64>()
    };
    crate::reduce::sum(weights.len(), square).sqrt()
}

/// `series[j](Φ₁)·(I − Φ₁)·signal` into `outs[j]`, all n_vertices × n_channels, each with a relative error of at most
/// `accuracy` in the norm of `weights`.
///
/// A series is cut where its tail times `‖u‖` is at most `accuracy` times a lower bound of the norm of its value, which is
/// known as soon as its sum so far exceeds what is missing. So the degree follows the signal: it is lower for a smooth one.
/// A value that all but vanishes beside u gets all terms that double precision can tell apart.
pub(crate) fn evaluate(
    walk: &Walk<'_>,
    weights: &[f64],
    signal: &[f64],
    n_channels: usize,
    series: &[Series],
    accuracy: f64,
    outs: &mut [&mut [f64]],
    progress: Progress<'_>,
) -> Result<Outcome, Cancelled> {
    let mut outcome = Outcome::default();
    for at in (0..n_channels).step_by(MAX_CHANNELS) {
        let width = MAX_CHANNELS.min(n_channels - at);
        let mut recurrence = Recurrence::new(walk, signal, n_channels, at, width);
        let start = norm(weights, recurrence.now(), width, 0, width);
        let mut cuts: Vec<Cut> = series.iter().map(Cut::new).collect();
        let nothing_moves = recurrence.now().iter().all(|&u| u == 0.0);
        loop {
            let last = if nothing_moves { 0 } else { cuts.iter().map(|cut| cut.degree).max().unwrap_or(0) };
            progress.step(recurrence.k() as u64, last as u64)?;
            let left = last - recurrence.k().min(last);
            let n_passes = left.div_ceil(walk.steps_per_pass());
            // Passes of equal length: a short last one would cost as much memory traffic as a long one.
            let n_steps = if n_passes == 0 { 0 } else { left.div_ceil(n_passes) };
            let mut sums: Vec<Sum<'_>> = cuts
                .iter()
                .zip(&mut *outs)
                .map(|(cut, out)| Sum { coefficients: &cut.series.coefficients[..=cut.degree], out })
                .collect();
            let next = if recurrence.k() + n_steps < last { Next::Continues } else { Next::Ends };
            recurrence.advance(n_steps, &mut sums, next);
            let k = recurrence.k();
            for (cut, out) in cuts.iter_mut().zip(&*outs) {
                if cut.is_due(k) {
                    cut.decide(k, start, norm(weights, out, n_channels, at, width), accuracy);
                }
            }
            if k >= last {
                break;
            }
        }
        let k = recurrence.k() as u64;
        outcome.degree = outcome.degree.max(k);
        outcome.products += k + 1;
        if !nothing_moves {
            for (cut, out) in cuts.iter().zip(&*outs) {
                let bound = cut.error_bound(start, || norm(weights, out, n_channels, at, width));
                outcome.error_bound = outcome.error_bound.max(bound);
            }
        }
    }
    Ok(outcome)
}

/// Where a series is cut.
struct Cut<'a> {
    series: &'a Series,
    degree: usize,
    /// A lower bound of the norm of the value, once one is known.
    least: Option<f64>,
}

impl<'a> Cut<'a> {
    fn new(series: &'a Series) -> Self {
        Self { series, degree: series.degree(), least: None }
    }

    /// Whether a look at the sum so far, of the terms up to `k`, may tell where to cut.
    fn is_due(&self, k: usize) -> bool {
        // ‖value‖ ≤ total·‖u‖: before the tail is well below that, nothing can be said.
        self.least.is_none() && k < self.degree && self.series.tail[k] < 0.25 * self.series.total
    }

    fn decide(&mut self, k: usize, start: f64, so_far: f64, accuracy: f64) {
        let missing = self.series.tail[k] * start;
        if missing < 0.5 * so_far {
            let least = so_far - missing;
            self.least = Some(least);
            self.degree = self.series.degree_within(accuracy * least / start, k);
        }
    }

    fn error_bound(&self, start: f64, value: impl Fn() -> f64) -> f64 {
        let missing = self.series.tail[self.degree] * start;
        if missing == 0.0 {
            return 0.0;
        }
        missing / self.least.unwrap_or_else(|| (value() - missing).max(0.0))
    }
}
