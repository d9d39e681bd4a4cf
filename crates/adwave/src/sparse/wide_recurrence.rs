//! The recurrence of [`Recurrence`](super::recurrence::Recurrence) for 8 to 32 channels at once, without tiles.
//!
//! A row of a block is whole cache lines, so a product reads each of them once per entry and nothing else, and needs no
//! halo. On graphs whose neighborhoods are large or irregular, tiles repeat most rows; this form does not.

use super::SignalView;
use super::block_recurrence::{BlockRecurrence, WeightedOperator};
use super::kernel::{
    InstructionSet, MAX_LANES, WideProduct, WideRows, WideTerms, combine_wide, multiply_wide,
};
use super::recurrence::{Continuation, Sum};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 512;

/// Number of sums from which several vectors are kept and added together, because the sums would otherwise take longer
/// than the products.
const MANY_SUMS: usize = 3;

/// Number of vectors that are then added together.
const STEPS_TOGETHER: usize = 4;

/// Number of channels from which blocks are wide.
pub(crate) const WIDE_FROM: usize = 16;

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for 8 to 32 channels.
pub(crate) struct WideRecurrence<'a> {
    rows: WideRows<'a>,
    target: InstructionSet,
    weights: &'a [f64],
    /// `T_{k−1}u` and `T_k u`, n_vertices × lanes.
    before: Vec<f64>,
    now: Vec<f64>,
    spare: Vec<Vec<f64>>,
    steps_per_pass: usize,
    square: f64,
    moves: bool,
    k: usize,
    channels: ChannelBlock,
}

/// Channels of a signal that are processed together.
#[derive(Clone, Copy)]
struct ChannelBlock {
    at: usize,
    width: usize,
    /// Number of values per row of the block: the width, rounded up to whole cache lines.
    lanes: usize,
    /// Number of channels of the signal.
    stride: usize,
}

impl ChannelBlock {
    fn new(channels: Range<usize>, n_channels: usize) -> Self {
        let (at, width) = (channels.start, channels.len());
        assert!((1..=MAX_LANES).contains(&width) && at + width <= n_channels, "a block of the channels");
        Self { at, width, lanes: width.next_multiple_of(8), stride: n_channels }
    }
}

impl<'a> WideRecurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f` for some `channels` of `signal`; `n_sums` sums will be accumulated.
    pub(crate) fn new(
        operator: WeightedOperator<'a>,
        signal: SignalView<'_>,
        channels: Range<usize>,
        n_sums: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let WeightedOperator { diffusion, weights } = operator;
        let SignalView { values: signal, n_channels } = signal;
        let channels = ChannelBlock::new(channels, n_channels);
        let neighbors = diffusion.neighbors();
        let rows = WideRows {
            offsets: neighbors.offsets(),
            columns: neighbors.columns(),
            weights: diffusion.weights(),
            is_lazy: diffusion.stays_half(),
        };
        let target = InstructionSet::detect();
        let ChannelBlock { at, width, lanes, stride } = channels;
        let n = diffusion.n_vertices();
        let mut block: Vec<f64> = zeros(n * lanes);
        parallel::try_visit_rows(&mut block, lanes, ROWS_AT_A_TIME, progress, |first, rows| {
            for (row, x) in rows.chunks_exact_mut(lanes).zip(first..) {
                row[..width].copy_from_slice(&signal[x * stride + at..][..width]);
            }
        })?;
        let mut now: Vec<f64> = zeros(n * lanes);
        let parts = parallel::try_map_rows(&mut now, lanes, ROWS_AT_A_TIME, progress, |first, u| {
            multiply_wide(target, lanes, rows, WideProduct::Difference { signal: &block }, first, u);
            let square = |(u, w): (&[f64], &f64)| w * u.iter().map(|v| v * v).sum::<f64>();
            let square: f64 = u.chunks_exact(lanes).zip(&weights[first..]).map(square).sum();
            (square, u.iter().any(|&v| v != 0.0))
        })?;
        let (square, moves) =
            parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m));
        parallel::try_visit_rows(&mut block, lanes, ROWS_AT_A_TIME, progress, |_, rows| rows.fill(0.0))?;
        Ok(Self {
            rows,
            target,
            weights,
            before: block,
            now,
            spare: Vec::new(),
            steps_per_pass: if n_sums < MANY_SUMS { 1 } else { STEPS_TOGETHER },
            square,
            moves,
            k: 0,
            channels,
        })
    }

    /// Upper bound of the bytes of memory of a recurrence for `n_channels` channels of `n` vertices: the vectors of a
    /// pass of several steps, and the one before.
    pub(crate) fn bytes(n: usize, n_channels: usize) -> u64 {
        8 * (n * (STEPS_TOGETHER + 1) * n_channels.next_multiple_of(8).min(MAX_LANES)) as u64
    }

    /// Computes the last step of a pass and adds its terms to the sums, chunk by chunk: `vectors` are those of the
    /// terms from `first_term` on, but for the last, which is computed into `last`.
    fn multiply_and_add(
        &self,
        product: WideProduct<'_>,
        first_term: usize,
        vectors: &[&[f64]],
        last: &mut [f64],
        sums: &mut [Sum<'_>],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let ChannelBlock { lanes, stride, .. } = self.channels;
        let n = last.len() / lanes;
        let n_terms = vectors.len() + 1;
        let mut jobs: Vec<ChunkJob<'_>> = last
            .chunks_mut(ROWS_AT_A_TIME * lanes)
            .enumerate()
            .map(|(chunk, last)| ChunkJob { first: chunk * ROWS_AT_A_TIME, last, outs: Vec::new() })
            .collect();
        let terms = distribute(sums, first_term, n_terms, stride, &mut jobs);
        let squares = parallel::try_map_owned(jobs, n, progress, |mut job| {
            multiply_wide(self.target, lanes, self.rows, product, job.first, job.last);
            let start = job.first * lanes;
            let mut rows: Vec<&[f64]> =
                vectors.iter().map(|vector| &vector[start..start + job.last.len()]).collect();
            rows.push(job.last);
            self.combine(&terms, &rows, job.first, &mut job.outs)
        })?;
        set_squares(sums, first_term, &squares);
        Ok(())
    }

    /// Adds the term 0 alone.
    fn add_first(&self, sums: &mut [Sum<'_>], progress: Progress<'_>) -> Result<(), Cancelled> {
        let ChannelBlock { lanes, stride, .. } = self.channels;
        let n = self.now.len() / lanes;
        let mut jobs: Vec<ChunkJob<'_>> = (0..n)
            .step_by(ROWS_AT_A_TIME)
            .map(|first| ChunkJob { first, last: &mut [], outs: Vec::new() })
            .collect();
        let terms = distribute(sums, 0, 1, stride, &mut jobs);
        let squares = parallel::try_map_owned(jobs, n, progress, |mut job| {
            let end = (job.first + ROWS_AT_A_TIME).min(n);
            let rows = &self.now[job.first * lanes..end * lanes];
            self.combine(&terms, &[rows], job.first, &mut job.outs)
        })?;
        set_squares(sums, 0, &squares);
        Ok(())
    }

    /// Adds the terms of some rows from `first` on to the outputs; returns the squared norms of their rows.
    fn combine(
        &self,
        terms: &[WideTerm<'_>],
        rows: &[&[f64]],
        first: usize,
        outs: &mut [&mut [f64]],
    ) -> Vec<f64> {
        let ChannelBlock { at, width, lanes, stride } = self.channels;
        let mut squares = vec![0.0; terms.len()];
        for ((term, out), square) in terms.iter().zip(outs).zip(&mut squares) {
            let WideTerm { coefficients, is_new, .. } = *term;
            let weights = &self.weights[first..];
            let terms = WideTerms { coefficients, vectors: rows, weights, is_new, at, width, stride };
            *square = combine_wide(self.target, lanes, terms, out);
        }
        squares
    }
}

impl BlockRecurrence for WideRecurrence<'_> {
    fn steps_per_pass(&self) -> usize {
        self.steps_per_pass
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
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let first_term = if self.k == 0 { 0 } else { self.k + 1 };
        if n_steps == 0 {
            return if self.k == 0 { self.add_first(sums, progress) } else { Ok(()) };
        }
        // Vectors that the sums need and that neither of the last two is.
        let mut kept: Vec<Vec<f64>> = Vec::new();
        for step in 1..=n_steps {
            let k = self.k + step;
            let scale = if k == 1 { 2.0 } else { 4.0 };
            // T_{k−2} is overwritten unless a sum of this pass needs it. Before the first step it is 0.
            let is_needed = k >= 2 && k - 2 >= first_term;
            let old = std::mem::take(&mut self.before);
            let (mut new, kept_old) = if is_needed {
                (self.spare.pop().unwrap_or_else(|| zeros(old.len())), Some(old))
            } else {
                (old, None)
            };
            let before = kept_old.as_deref();
            let product = WideProduct::Step { before, now: &self.now, scale };
            let (lanes, rows, target) = (self.channels.lanes, self.rows, self.target);
            if step < n_steps {
                parallel::try_visit_rows(&mut new, lanes, ROWS_AT_A_TIME, progress, |first, out| {
                    multiply_wide(target, lanes, rows, product, first, out);
                })?;
            } else {
                let others = kept.iter().map(Vec::as_slice).chain(before);
                let mut vectors: Vec<&[f64]> = others.collect();
                if k > first_term {
                    vectors.push(&self.now);
                }
                self.multiply_and_add(product, first_term, &vectors, &mut new, sums, progress)?;
            }
            kept.extend(kept_old);
            self.before = std::mem::replace(&mut self.now, new);
        }
        if next == Continuation::Continues {
            self.spare.append(&mut kept);
        }
        self.k += n_steps;
        Ok(())
    }
}

/// Rows that a thread processes at a time: the last vector of a pass, if it is to be computed, and the sums.
struct ChunkJob<'a> {
    first: usize,
    last: &'a mut [f64],
    outs: Vec<&'a mut [f64]>,
}

/// Coefficients of the vectors of a pass.
struct WideTerm<'a> {
    coefficients: &'a [f64],
    is_new: bool,
}

/// Coefficients of the terms from `first_term` on of the sums that have any, whose outputs are given to the jobs.
fn distribute<'a>(
    sums: &'a mut [Sum<'_>],
    first_term: usize,
    n_terms: usize,
    stride: usize,
    jobs: &mut [ChunkJob<'a>],
) -> Vec<WideTerm<'a>> {
    let mut terms = Vec::new();
    for sum in sums {
        let end = sum.coefficients.len().min(first_term + n_terms);
        if first_term < end {
            terms
                .push(WideTerm { coefficients: &sum.coefficients[first_term..end], is_new: first_term == 0 });
            for (job, out) in jobs.iter_mut().zip(sum.out.chunks_mut(ROWS_AT_A_TIME * stride)) {
                job.outs.push(out);
            }
        }
    }
    terms
}

/// Sums the squares of the chunks in their order, so that the result does not depend on the scheduling.
fn set_squares(sums: &mut [Sum<'_>], first_term: usize, squares: &[Vec<f64>]) {
    for (i, sum) in sums.iter_mut().filter(|sum| first_term < sum.coefficients.len()).enumerate() {
        sum.square = squares.iter().map(|chunk| chunk[i]).sum();
    }
}
