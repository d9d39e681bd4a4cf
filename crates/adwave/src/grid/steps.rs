//! The Chebyshev recurrence of heat on a grid, over the places with data.

// Functions that are compiled for the vectors of the machine must be inlined into the place that chooses these.
#![allow(clippy::inline_always)]

use super::runs::{Run, Runs};
use crate::operator::{Continuation, SignalBlock, Steps, Sum, Weighing};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Steps after which norms are computed.
const STEPS_PER_PASS: usize = 4;

/// The vectors `T_k(Y)u` of the places with data for increasing k. Each step reads and writes every vector once, and adds
/// its term to the sums while it is in cache.
pub(super) struct RunSteps<'a> {
    runs: &'a Runs,
    portions: Vec<Range<usize>>,
    n_places: usize,
    /// Vectors `T_k u` and `T_{k−1} u`, places with data × width.
    now: Vec<f64>,
    before: Vec<f64>,
    square: f64,
    moves: bool,
    k: usize,
    /// First channel of the block, and number of channels of the block and of the signal.
    at: usize,
    width: usize,
    n_channels: usize,
}

/// A part of a step.
struct Portion<'a, 'b> {
    runs: &'a [Run],
    /// `T_{k−1} u` of these runs, which becomes `T_{k+1} u`.
    next: &'a mut [f64],
    /// Parts of the sums, from this place on.
    outs: Vec<&'b mut [f64]>,
    first_place: usize,
}

/// Term that a step adds to a sum, and whether the squares of the sum are added up afterwards.
#[derive(Clone, Copy)]
struct Term {
    coefficient: Option<f64>,
    is_weighed: bool,
}

/// A vector of the recurrence.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    /// `T_0 u`, which is there already.
    Zero,
    /// `T_1 u = u − 2(I − Φ₁)u`.
    One,
    /// `T_{k+1} u = 2T_k u − 4(I − Φ₁)T_k u − T_{k−1} u`.
    Later,
}

impl<'a> RunSteps<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    pub(super) fn new(
        runs: &'a Runs,
        n_places: usize,
        block: &SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let (n_channels, at, width) = (block.n_channels, block.channels.start, block.channels.len());
        let before = runs.gather(block.values, n_channels, block.channels.clone(), progress)?;
        let mut now = zeros(before.len());
        runs.compact_difference(&before, width, &mut now, progress)?;
        let square = parallel::try_sum(now.len(), progress, |i| now[i] * now[i])? / n_places as f64;
        let moves = now.iter().any(|v| *v != 0.0);
        let portions = runs.portions(width);
        Ok(Self { runs, portions, n_places, now, before, square, moves, k: 0, at, width, n_channels })
    }

    /// Computes the next vector, or leaves the first, and adds its terms to the sums; then the sums of squares of those
    /// that are weighed.
    fn step(
        &mut self,
        order: Order,
        sums: &mut [Sum<'_>],
        terms: &[Term],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let Self { runs, portions, now, before, width, n_channels, .. } = self;
        let (target, now): (&mut [f64], &[f64]) =
            if order == Order::Zero { (now, &[]) } else { (before, now) };
        let (mut target, mut outs): (&mut [f64], Vec<&mut [f64]>) =
            (target, sums.iter_mut().map(|sum| &mut *sum.out).collect());
        let (mut items, mut first_place) = (Vec::with_capacity(portions.len()), 0);
        for portion in portions.iter() {
            let of_portion = &runs.list[portion.clone()];
            let end = runs.list.get(portion.end).map_or(self.n_places, |run| run.place);
            let n_kept = of_portion.iter().map(|run| run.len).sum::<usize>();
            let (next, rest) = target.split_at_mut(n_kept * *width);
            target = rest;
            let (heads, rests) =
                outs.into_iter().map(|out| out.split_at_mut((end - first_place) * *n_channels)).unzip();
            outs = rests;
            items.push(Portion { runs: of_portion, next, outs: heads, first_place });
            first_place = end;
        }
        let (at, width, n_channels) = (self.at, *width, *n_channels);
        let arch = pulp::Arch::new();
        let work = |portion: Portion<'_, '_>| {
            let step = PortionStep { portion, runs, now, order, terms, at, width, n_channels };
            arch.dispatch(step)
        };
        let squares = parallel::try_map_owned(items, runs.n_kept, progress, work)?;
        for (i, sum) in sums.iter_mut().enumerate().filter(|(i, _)| terms[*i].is_weighed) {
            sum.square = squares.iter().map(|squares| squares[i]).sum::<f64>() / self.n_places as f64;
        }
        if order != Order::Zero {
            std::mem::swap(&mut self.now, &mut self.before);
            self.k += 1;
        }
        Ok(())
    }
}

impl Steps for RunSteps<'_> {
    fn steps_per_pass(&self) -> usize {
        STEPS_PER_PASS
    }

    fn k(&self) -> usize {
        self.k
    }

    fn square(&self) -> f64 {
        self.square
    }

    fn is_nonzero(&self) -> bool {
        self.moves
    }

    fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        _next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let first = if self.k == 0 { 0 } else { self.k + 1 };
        let last = self.k + n_steps;
        let is_added_to: Vec<bool> = sums.iter().map(|sum| first < sum.coefficients.len()).collect();
        for (sum, _) in sums.iter_mut().zip(&is_added_to).filter(|(_, is_added_to)| **is_added_to) {
            sum.square = 0.0;
        }
        for k in first..=last {
            let term = |(sum, is_added_to): (&Sum<'_>, &bool)| Term {
                coefficient: sum.coefficients.get(k).copied(),
                is_weighed: k == last && *is_added_to && sum.weighing == Weighing::Weighed,
            };
            let terms: Vec<Term> = sums.iter().zip(&is_added_to).map(term).collect();
            let order = match k {
                0 => Order::Zero,
                1 => Order::One,
                _ => Order::Later,
            };
            self.step(order, sums, &terms, progress)?;
        }
        Ok(())
    }
}

/// [`RunSteps::step`] on a part of the places, with the vectors of this machine. Returns sums of squares.
struct PortionStep<'a, 'b> {
    portion: Portion<'a, 'b>,
    runs: &'a Runs,
    now: &'a [f64],
    order: Order,
    terms: &'a [Term],
    at: usize,
    width: usize,
    n_channels: usize,
}

impl pulp::NullaryFnOnce for PortionStep<'_, '_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn call(self) -> Vec<f64> {
        let Self { portion, runs, now, order, terms, at, width, n_channels } = self;
        let Portion { runs: of_portion, mut next, mut outs, first_place } = portion;
        if order == Order::Zero {
            // Places without data.
            for place in outs.iter_mut().flat_map(|out| out.chunks_exact_mut(n_channels)) {
                place[at..at + width].fill(0.0);
            }
        }
        let mut squares = vec![0.0; terms.len()];
        let longest = of_portion.iter().map(|run| run.len).max().unwrap_or(0);
        let mut difference = vec![0.0; if order == Order::Zero { 0 } else { longest * width }];
        for run in of_portion {
            let (values, rest) = next.split_at_mut(run.len * width);
            next = rest;
            if order != Order::Zero {
                runs.run_difference(run, now, width, &mut difference);
                let here = now[run.start * width..].iter().zip(&difference);
                for (value, (now, difference)) in values.iter_mut().zip(here) {
                    *value = match order {
                        Order::One => now - 2.0 * difference,
                        _ => 2.0 * now - 4.0 * difference - *value,
                    };
                }
            }
            for ((out, term), square) in outs.iter_mut().zip(terms).zip(&mut squares) {
                let out = &mut out[(run.place - first_place) * n_channels..][..run.len * n_channels];
                if n_channels == width {
                    add(term, values, out, square);
                } else {
                    let places = out.chunks_exact_mut(n_channels).zip(values.chunks_exact(width));
                    places.for_each(|(out, values)| add(term, values, &mut out[at..at + width], square));
                }
            }
        }
        squares
    }
}

/// Adds a term to a part of a sum, and the squares of this part.
#[inline(always)]
fn add(term: &Term, values: &[f64], out: &mut [f64], square: &mut f64) {
    if let Some(a) = term.coefficient {
        out.iter_mut().zip(values).for_each(|(out, value)| *out += a * value);
    }
    if term.is_weighed {
        *square += out.iter().map(|v| v * v).sum::<f64>();
    }
}
