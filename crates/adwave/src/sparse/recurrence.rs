//! Chebyshev polynomials of the walk applied to a block of channels, and sums of them.

use super::kernel::{self, Pass, Term};
use super::tiled_diffusion::{MAX_CHANNELS, Pool, TiledDiffusion, difference};
use super::tiles::{Index, Tile, Tiles};
use rayon::prelude::*;

/// A sum `Σ_k a_k T_k(Y)u` that is being added up.
pub(crate) struct Sum<'a> {
    /// a_0 … a_d.
    pub(crate) coefficients: &'a [f64],
    /// n_vertices × n_channels of the whole signal, of which the block's channels are written.
    pub(crate) out: &'a mut [f64],
    /// Whether it is to be weighed after the next pass.
    pub(crate) weighing: Weighing,
    /// `Σ_x μ(x)|sum(x)|²` after the last pass that weighed it.
    pub(crate) square: f64,
}

/// Whether the norm of a sum is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weighing {
    /// It is.
    Weighed,
    /// It is not.
    Unweighed,
}

/// Whether the recurrence goes on after a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// More steps will follow.
    Continues,
    /// These were the last steps.
    Ends,
}

/// `T_k(Y)u` for rising k, `Y = 2Φ₁ − I`, for up to four channels.
pub(crate) struct Recurrence<'a> {
    walk: &'a TiledDiffusion,
    now: Vec<f64>,
    before: Vec<f64>,
    next_now: Vec<f64>,
    next_before: Vec<f64>,
    pool: Pool,
    /// μ.
    weights: &'a [f64],
    /// `Σ_x μ(x)|u(x)|²`.
    square: f64,
    moves: bool,
    k: usize,
    width: usize,
    at: usize,
    stride: usize,
}

impl<'a> Recurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f` for the channels `at .. at + width` of `signal`, which has `n_channels`. Norms are
    /// weighted by `weights`.
    pub(crate) fn new(
        walk: &'a TiledDiffusion,
        weights: &'a [f64],
        signal: &[f64],
        n_channels: usize,
        (at, width): (usize, usize),
    ) -> Self {
        assert!((1..=MAX_CHANNELS).contains(&width) && at + width <= n_channels, "a block of the channels");
        let len = walk.n_vertices() * width;
        let mut now = walk.take(len);
        let (square, moves) = difference(walk.diffusion(), weights, signal, n_channels, at, &mut now);
        Self {
            walk,
            now,
            before: walk.take(len),
            next_now: walk.take(len),
            next_before: walk.take(len),
            pool: Pool::new(),
            weights,
            square,
            moves,
            k: 0,
            width,
            at,
            stride: n_channels,
        }
    }

    pub(crate) fn k(&self) -> usize {
        self.k
    }

    /// `Σ_x μ(x)|u(x)|²`.
    pub(crate) fn square(&self) -> f64 {
        self.square
    }

    /// Whether u has any value but 0.
    pub(crate) fn moves(&self) -> bool {
        self.moves
    }

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet.
    pub(crate) fn advance(&mut self, n_steps: usize, sums: &mut [Sum<'_>], next: Next) {
        let walk = self.walk;
        match &walk.tiles {
            Tiles::Narrow(tiles) => self.pass(tiles, n_steps, sums, next),
            Tiles::Wide(tiles) => self.pass(tiles, n_steps, sums, next),
        }
        if n_steps > 0 {
            std::mem::swap(&mut self.now, &mut self.next_now);
            std::mem::swap(&mut self.before, &mut self.next_before);
            self.k += n_steps;
        }
    }

    fn pass<I: Index>(&mut self, tiles: &[Tile<I>], n_steps: usize, sums: &mut [Sum<'_>], next: Next) {
        let (k, own, width, stride, at) = (self.k, self.walk.own, self.width, self.stride, self.at);
        let is_first = k == 0;
        let from = if is_first { 0 } else { k + 1 };
        let mut terms = Vec::new();
        let mut outs: Vec<Vec<&mut [f64]>> = tiles.iter().map(|_| Vec::with_capacity(sums.len())).collect();
        for sum in &mut *sums {
            let to = sum.coefficients.len().min(k + n_steps + 1);
            if from < to {
                terms.push(Term {
                    coefficients: &sum.coefficients[from..to],
                    first: usize::from(!is_first),
                    is_new: is_first,
                    is_weighed: sum.weighing == Weighing::Weighed,
                });
                for (outs, out) in outs.iter_mut().zip(sum.out.chunks_mut(own * stride)) {
                    outs.push(out);
                }
            }
        }
        let (before, now, terms, pool, target) =
            (&self.before, &self.now, &terms, &self.pool, self.walk.target);
        let weights = self.weights;
        let squares: Vec<Vec<f64>> = tiles
            .par_iter()
            .zip(outs)
            .zip(self.next_now.par_chunks_mut(own * width))
            .zip(self.next_before.par_chunks_mut(own * width))
            .map(|(((tile, mut outs), next_now), next_before)| {
                let (next_now, next_before) = match next {
                    Next::Continues => (next_now, next_before),
                    Next::Ends => (&mut next_now[..0], &mut next_before[..0]),
                };
                let pass = Pass {
                    before,
                    now,
                    n_steps,
                    is_first,
                    next_before,
                    next_now,
                    terms,
                    weights: &weights[tile.first()..],
                    outs: &mut outs,
                    stride,
                    at,
                };
                let len = kernel::scratch_len(tile, n_steps, kernel::lanes(width));
                pool.with(len, |scratch| kernel::run(target, tile, width, pass, scratch))
            })
            .collect();
        // In the order of the tiles, so that the sum does not depend on who was first.
        for (i, sum) in sums.iter_mut().filter(|sum| from < sum.coefficients.len()).enumerate() {
            sum.square = squares.iter().map(|tile| tile[i]).sum();
        }
    }
}

impl Drop for Recurrence<'_> {
    fn drop(&mut self) {
        for vector in [&mut self.now, &mut self.before, &mut self.next_now, &mut self.next_before] {
            self.walk.give(std::mem::take(vector));
        }
    }
}
