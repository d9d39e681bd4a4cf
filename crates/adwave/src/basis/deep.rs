//! Deep levels of a block: all levels after the last shallow one, by one Chebyshev recurrence.
//!
//! With `Y = 2Φ₁ᵀ − I` and the columns v after n₀ steps, the columns after n steps are `Σ_k c_k T_k(Y)v`, where c
//! are the coefficients of `((1+y)/2)^(n−n₀)`. About `4√(n−n₀)` products serve all levels. The terms reach one ring
//! further with every product, while the walk itself barely spreads, so for few steps walking is cheaper.

use super::binomial::chebyshev_of_power;
use super::local_columns::{LANES, Lanes, LocalColumns, row_times};
use super::sweep::BlockSweep;
use super::transpose::Group;
use super::{BasisError, BasisParams};
use crate::operator::Diffusion;

/// Number of steps up to which levels are computed step by step: the active set of the walk still fits into a
/// core's cache.
const SHALLOW_STEPS: u64 = 64;

/// Smallest number of steps for which a recurrence pays off. On the Stanford bunny it takes 1.4 times as long as
/// walking for 64 steps, 1.1 times for 192, and less than half for 448.
const MIN_STEPS: u64 = 256;

/// Largest ratio of values of π for a recurrence. Φ₁ᵀ is symmetric only in the weights 1/π, so errors can grow by
/// the square root of this ratio.
const MAX_RATIO_OF_PI: f64 = 1e6;

/// Number of products between two new active sets; each set includes one ring per product.
const STRETCH: u64 = 8;

/// Number of levels to compute step by step.
pub(super) fn n_shallow(diffusion: &Diffusion, steps: &[u64]) -> usize {
    let n_shallow = steps.partition_point(|&n| n <= SHALLOW_STEPS);
    let start = if n_shallow == 0 { 0 } else { steps[n_shallow - 1] };
    let worth_while = steps.last().is_some_and(|&last| last - start >= MIN_STEPS);
    if worth_while && diffusion.is_reversible() && is_even(diffusion.stationary()) {
        n_shallow
    } else {
        steps.len()
    }
}

fn is_even(stationary: &[f64]) -> bool {
    let (least, most) =
        stationary.iter().fold((f64::INFINITY, 0.0_f64), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    most <= MAX_RATIO_OF_PI * least
}

/// Computes the columns after each of `steps` from those after `done`, into `columns.sums`.
pub(super) fn recur(
    walk: &BlockSweep<'_>,
    columns: &mut LocalColumns,
    steps: &[u64],
    done: u64,
    floor: f32,
) -> Result<(), BasisError> {
    let tail = tail(walk.params);
    let coefficients: Vec<Vec<f64>> = steps.iter().map(|&n| chebyshev_of_power(n - done, tail)).collect();
    let degree = coefficients.iter().map(Vec::len).max().unwrap_or(1) as u64 - 1;
    columns.sums.resize(steps.len(), vec![[0.0; LANES]; columns.active.len()]);
    columns.other.fill([0.0; LANES]);
    let mut fresh_for = 0;
    for k in 0..=degree {
        for (sum, coefficients) in columns.sums.iter_mut().zip(&coefficients) {
            if let Some(&c) = coefficients.get(k as usize) {
                walk.arch.dispatch(AddScaled { sum, term: &columns.now, coefficient: c as f32 });
            }
        }
        if k == degree {
            break;
        }
        if fresh_for == 0 {
            fresh_for = STRETCH.min(degree - k);
            walk.regrow(columns, floor, fresh_for)?;
        }
        fresh_for -= 1;
        let mut older = std::mem::take(&mut columns.other);
        let (starts, groups) = columns.matrix();
        walk.arch.dispatch(ColumnRecurrence {
            starts,
            groups,
            now: &columns.now,
            older: &mut older,
            is_first: k == 0,
        });
        columns.other = std::mem::replace(&mut columns.now, older);
    }
    Ok(())
}

/// Truncation error allowed in a sum: a hundredth of the tolerance, but not less than single precision resolves.
fn tail(params: &BasisParams) -> f64 {
    (0.01 * params.drop_tolerance).clamp(1e-9, 1e-6)
}

/// Computes `older ← T_{k+1} = 2Y·T_k − T_{k−1}`; for the first step `T_1 = Y·T_0`.
struct ColumnRecurrence<'a> {
    starts: &'a [u32],
    groups: &'a [Group],
    now: &'a [Lanes],
    older: &'a mut [Lanes],
    is_first: bool,
}

impl pulp::NullaryFnOnce for ColumnRecurrence<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { starts, groups, now, older, is_first } = self;
        let (of_product, of_now, of_older) = if is_first { (2.0, 1.0, 0.0) } else { (4.0, 2.0, 1.0) };
        for ((row, here), range) in older.iter_mut().zip(now).zip(starts.windows(2)) {
            let product = row_times(&groups[range[0] as usize..range[1] as usize], now);
            for l in 0..LANES {
                row[l] = of_product * product[l] - of_now * here[l] - of_older * row[l];
            }
        }
    }
}

/// Computes `sum += coefficient·term`.
struct AddScaled<'a> {
    sum: &'a mut [Lanes],
    term: &'a [Lanes],
    coefficient: f32,
}

impl pulp::NullaryFnOnce for AddScaled<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sum, term, coefficient } = self;
        for (s, t) in sum.as_flattened_mut().iter_mut().zip(term.as_flattened()) {
            *s += coefficient * t;
        }
    }
}
