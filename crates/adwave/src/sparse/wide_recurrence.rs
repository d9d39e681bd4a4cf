//! The recurrence of [`Recurrence`](super::recurrence::Recurrence) for 8 to 64 channels at once, without tiles, in
//! double or single precision.
//!
//! A row of a block is whole cache lines, so a product reads each of them once per entry and nothing else, and needs no
//! halo. On graphs whose neighborhoods are large or irregular, tiles repeat most rows; this form does not.

use super::kernel::{InstructionSet, WideNumber, WideProduct, WideRows, WideTerms};
use super::single::{SingleBound, scale_of};
use crate::operator::{Continuation, Diffusion, RowWeights, SignalBlock, Steps, Sum};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Number of rows that a thread processes at a time.
pub(super) const ROWS_AT_A_TIME: usize = 512;

/// Number of sums from which several vectors are kept and added together, because the sums would otherwise take longer
/// than the products.
const MANY_SUMS: usize = 3;

/// Number of vectors that are added together from [`MANY_SUMS`] sums on.
const STEPS_TOGETHER: usize = 4;

/// Number of channels from which blocks are wide.
pub(super) const WIDE_FROM: usize = 16;

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for 8 to 64 channels.
pub(super) struct WideRecurrence<'a, T> {
    rows: WideRows<'a, T>,
    bound: Option<&'a SingleBound>,
    target: InstructionSet,
    weights: &'a [f64],
    /// `T_{k−1}u` and `T_k u` times the scale, n_vertices × lanes.
    before: Vec<T>,
    now: Vec<T>,
    spare: Vec<Vec<T>>,
    /// Power of 2 by which the vectors are multiplied, so that single precision does not underflow.
    scale: f64,
    steps_per_pass: usize,
    /// Squared norm of u times the square of the scale.
    square: f64,
    moves: bool,
    k: usize,
    channels: ChannelBlock,
}

/// Channels of a signal that are processed together.
#[derive(Clone, Copy)]
pub(super) struct ChannelBlock {
    pub(super) at: usize,
    pub(super) width: usize,
    /// Number of values per row of the block: the width, rounded up to whole cache lines.
    pub(super) lanes: usize,
    /// Number of channels of the signal.
    pub(super) stride: usize,
}

impl ChannelBlock {
    pub(super) fn new<T: WideNumber>(channels: Range<usize>, n_channels: usize) -> Self {
        let (at, width) = (channels.start, channels.len());
        assert!((1..=T::MAX_LANES).contains(&width) && at + width <= n_channels, "a block of the channels");
        Self { at, width, lanes: width.next_multiple_of(T::PER_LINE), stride: n_channels }
    }
}

/// Values of the channels of a block, n_vertices × lanes, and the largest of them.
pub(super) struct CopiedBlock {
    pub(super) values: Vec<f64>,
    largest: f64,
}

impl CopiedBlock {
    pub(super) fn new(
        signal: &[f64],
        channels: ChannelBlock,
        n: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let ChannelBlock { at, width, lanes, stride } = channels;
        let mut values: Vec<f64> = zeros(n * lanes);
        let largest = parallel::try_map_rows(&mut values, lanes, ROWS_AT_A_TIME, progress, |first, rows| {
            let mut largest = 0.0;
            for (row, x) in rows.chunks_exact_mut(lanes).zip(first..) {
                row[..width].copy_from_slice(&signal[x * stride + at..][..width]);
                largest = row.iter().fold(largest, |most: f64, v| most.max(v.abs()));
            }
            largest
        })?;
        Ok(Self { values, largest: largest.into_iter().fold(0.0, f64::max) })
    }
}

impl<'a> WideRecurrence<'a, f64> {
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    pub(super) fn new(
        diffusion: &'a Diffusion,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let rows = rows_in(diffusion, diffusion.weights());
        let (weights, n_sums) = (each_weight(block.weights), block.n_sums);
        let channels = ChannelBlock::new::<f64>(block.channels, block.n_channels);
        let n = diffusion.n_vertices();
        let mut block = CopiedBlock::new(block.values, channels, n, progress)?.values;
        let mut recurrence = Self::start(rows, weights, channels, &block, 1.0, progress)?;
        let clear = |_, rows: &mut [f64]| rows.fill(0.0);
        parallel::try_visit_rows(&mut block, channels.lanes, ROWS_AT_A_TIME, progress, clear)?;
        recurrence.before = block;
        recurrence.steps_per_pass = if n_sums < MANY_SUMS { 1 } else { STEPS_TOGETHER };
        Ok(recurrence)
    }
}

impl<'a> WideRecurrence<'a, f32> {
    /// Starts at u as in double precision, and rounds it.
    pub(super) fn new_single(
        diffusion: &'a Diffusion,
        entries: &'a [f32],
        bound: &'a SingleBound,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let rows = rows_in(diffusion, entries);
        let weights = each_weight(block.weights);
        let channels = ChannelBlock::new::<f32>(block.channels, block.n_channels);
        let n = diffusion.n_vertices();
        let block = CopiedBlock::new(block.values, channels, n, progress)?;
        let scale = scale_of(block.largest);
        let mut recurrence = Self::start(rows, weights, channels, &block.values, scale, progress)?;
        drop(block);
        recurrence.before = zeros(n * channels.lanes);
        recurrence.bound = Some(bound);
        Ok(recurrence)
    }
}

/// The weight of each row.
///
/// # Panics
/// If all rows have the same.
fn each_weight(weights: RowWeights<'_>) -> &[f64] {
    let RowWeights::Each(weights) = weights else { panic!("a diffusion has a weight for each row") };
    weights
}

/// The rows of an operator with entries in the format of the vectors.
pub(super) fn rows_in<'a, T>(diffusion: &'a Diffusion, weights: &'a [T]) -> WideRows<'a, T> {
    let neighbors = diffusion.neighbors();
    WideRows {
        offsets: neighbors.offsets(),
        columns: neighbors.columns(),
        weights,
        exact_weights: diffusion.weights(),
        is_lazy: diffusion.stays_half(),
    }
}

impl<'a, T: WideNumber> WideRecurrence<'a, T> {
    /// The recurrence at k = 0, without `T_{−1}`.
    fn start(
        rows: WideRows<'a, T>,
        weights: &'a [f64],
        channels: ChannelBlock,
        block: &[f64],
        scale: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let (target, lanes) = (InstructionSet::detect(), channels.lanes);
        let mut now: Vec<T> = zeros(block.len());
        let parts = parallel::try_map_rows(&mut now, lanes, ROWS_AT_A_TIME, progress, |first, u| {
            T::multiply(target, lanes, rows, WideProduct::Difference { signal: block, scale }, first, u);
            let square = |(u, w): (&[T], &f64)| w * u.iter().map(|v| v.to_f64() * v.to_f64()).sum::<f64>();
            let square: f64 = u.chunks_exact(lanes).zip(&weights[first..]).map(square).sum();
            (square, u.iter().any(|&v| v.to_f64() != 0.0))
        })?;
        let (square, moves) =
            parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m));
        Ok(Self {
            rows,
            bound: None,
            target,
            weights,
            before: Vec::new(),
            now,
            spare: Vec::new(),
            scale,
            steps_per_pass: STEPS_TOGETHER,
            square,
            moves,
            k: 0,
            channels,
        })
    }

    /// Upper bound of the bytes of memory of a recurrence for `n_channels` channels of `n` vertices: the vectors of a
    /// pass of several steps, and the one before.
    pub(super) fn bytes(n: usize, n_channels: usize) -> u64 {
        let lanes = n_channels.next_multiple_of(T::PER_LINE).min(T::MAX_LANES);
        (size_of::<T>() * n * (STEPS_TOGETHER + 1) * lanes) as u64
    }

    /// Computes the last step of a pass and adds its terms to the sums, chunk by chunk: `vectors` are those of the
    /// terms from `first_term` on, but for the last, which is computed into `last`.
    fn multiply_and_add(
        &self,
        product: WideProduct<'_, T>,
        first_term: usize,
        vectors: &[&[T]],
        last: &mut [T],
        sums: &mut [Sum<'_>],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let lanes = self.channels.lanes;
        let n = last.len() / lanes;
        let n_terms = vectors.len() + 1;
        let mut jobs: Vec<ChunkJob<'_, T>> = last
            .chunks_mut(ROWS_AT_A_TIME * lanes)
            .enumerate()
            .map(|(chunk, last)| ChunkJob { first: chunk * ROWS_AT_A_TIME, last, outs: Vec::new() })
            .collect();
        let terms = self.distribute(sums, first_term, n_terms, &mut jobs);
        let squares = parallel::try_map_owned(jobs, n, progress, |mut job| {
            T::multiply(self.target, lanes, self.rows, product, job.first, job.last);
            let start = job.first * lanes;
            let mut rows: Vec<&[T]> =
                vectors.iter().map(|vector| &vector[start..start + job.last.len()]).collect();
            rows.push(job.last);
            self.combine(&terms, &rows, job.first, &mut job.outs)
        })?;
        set_squares(sums, first_term, &squares);
        Ok(())
    }

    /// Adds the term 0 alone.
    fn add_first(&self, sums: &mut [Sum<'_>], progress: Progress<'_>) -> Result<(), Cancelled> {
        let lanes = self.channels.lanes;
        let n = self.now.len() / lanes;
        let mut jobs: Vec<ChunkJob<'_, T>> = (0..n)
            .step_by(ROWS_AT_A_TIME)
            .map(|first| ChunkJob { first, last: &mut [], outs: Vec::new() })
            .collect();
        let terms = self.distribute(sums, 0, 1, &mut jobs);
        let squares = parallel::try_map_owned(jobs, n, progress, |mut job| {
            let end = (job.first + ROWS_AT_A_TIME).min(n);
            let rows = &self.now[job.first * lanes..end * lanes];
            self.combine(&terms, &[rows], job.first, &mut job.outs)
        })?;
        set_squares(sums, 0, &squares);
        Ok(())
    }

    /// Adds the terms of some rows from `first` on to the outputs; returns the squared norms of their rows.
    fn combine(&self, terms: &[WideTerm], rows: &[&[T]], first: usize, outs: &mut [&mut [f64]]) -> Vec<f64> {
        let ChannelBlock { at, width, lanes, stride } = self.channels;
        let mut squares = vec![0.0; terms.len()];
        for ((term, out), square) in terms.iter().zip(outs).zip(&mut squares) {
            let (coefficients, is_new) = (&term.coefficients[..], term.is_new);
            let weights = &self.weights[first..];
            let terms = WideTerms { coefficients, vectors: rows, weights, is_new, at, width, stride };
            *square = T::combine(self.target, lanes, terms, out);
        }
        squares
    }

    /// Coefficients of the terms from `first_term` on of the sums that have any, whose outputs are given to the jobs.
    fn distribute<'j>(
        &self,
        sums: &'j mut [Sum<'_>],
        first_term: usize,
        n_terms: usize,
        jobs: &mut [ChunkJob<'j, T>],
    ) -> Vec<WideTerm> {
        let mut terms = Vec::new();
        for sum in sums {
            let end = sum.coefficients.len().min(first_term + n_terms);
            if first_term < end {
                let coefficients = &sum.coefficients[first_term..end];
                let coefficients = coefficients.iter().map(|a| a / self.scale).collect();
                terms.push(WideTerm { coefficients, is_new: first_term == 0 });
                let rows = sum.out.chunks_mut(ROWS_AT_A_TIME * self.channels.stride);
                for (job, out) in jobs.iter_mut().zip(rows) {
                    job.outs.push(out);
                }
            }
        }
        terms
    }
}

impl<T: WideNumber> Steps for WideRecurrence<'_, T> {
    fn steps_per_pass(&self) -> usize {
        self.steps_per_pass
    }

    fn k(&self) -> usize {
        self.k
    }

    fn square(&self) -> f64 {
        self.square / (self.scale * self.scale)
    }

    fn rounding(&self, coefficients: &[f64]) -> f64 {
        self.bound.map_or(0.0, |bound| bound.rounding(coefficients, self.k, self.square.sqrt()))
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
        let mut kept: Vec<Vec<T>> = Vec::new();
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
                    T::multiply(target, lanes, rows, product, first, out);
                })?;
            } else {
                let others = kept.iter().map(Vec::as_slice).chain(before);
                let mut vectors: Vec<&[T]> = others.collect();
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
struct ChunkJob<'a, T> {
    first: usize,
    last: &'a mut [T],
    outs: Vec<&'a mut [f64]>,
}

/// Coefficients of the vectors of a pass.
struct WideTerm {
    coefficients: Vec<f64>,
    is_new: bool,
}

/// Sums the squares of the chunks in their order, so that the result does not depend on the scheduling.
fn set_squares(sums: &mut [Sum<'_>], first_term: usize, squares: &[Vec<f64>]) {
    for (i, sum) in sums.iter_mut().filter(|sum| first_term < sum.coefficients.len()).enumerate() {
        sum.square = squares.iter().map(|chunk| chunk[i]).sum();
    }
}
