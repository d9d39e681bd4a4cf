//! Chebyshev polynomials of the diffusion operator applied to a block of channels, and sums of them.
//!
//! `T_{k+1}(Y)u = 2Y·T_k(Y)u − T_{k−1}(Y)u` with `Y = 2Φ₁ − I`. Several steps are taken in one pass over the tiles, in
//! place: first the values around every tile are copied, then each tile overwrites its own vertices' `T_{k−1}`, `T_k` by
//! `T_{k+n−1}`, `T_{k+n}`.

use super::kernel::{self, Input, Pass, Term};
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion, difference};
use super::tiles::{Index, Tiles, TilesOf, View};
use crate::operator::Semigroup;
use crate::parallel::SERIAL;
use crate::{Cancelled, Progress};
use rayon::prelude::*;

/// A sum `Σ_k a_k T_k(Y)u` that is being added up.
pub(crate) struct Sum<'a> {
    /// a_0 … a_d.
    pub(crate) coefficients: &'a [f64],
    /// n_vertices × n_channels of the whole signal, of which the block's channels are written; n_vertices where the parts along
    /// normals are kept.
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

/// What is kept of each row of a sum.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kept<'a> {
    /// All channels.
    Channels,
    /// The part along the normal of the vertex, of three channels.
    Along(&'a [[f64; 3]]),
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
    operator: &'a TiledDiffusion,
    /// `T_k u`, n_vertices × width.
    now: Vec<f64>,
    /// `T_{k−1} u`.
    before: Vec<f64>,
    scratch: Scratch,
    /// μ.
    weights: &'a [f64],
    /// `Σ_x μ(x)|u(x)|²`.
    square: f64,
    moves: bool,
    k: usize,
    width: usize,
    at: usize,
    stride: usize,
    normals: &'a [[f64; 3]],
}

/// What lets the next vectors be written while others still read the present ones. Taken when a second pass is needed.
enum Scratch {
    None,
    /// The values around each tile: of `T_k`, then of `T_{k−1}`.
    Around(Vec<f64>),
    /// Vectors of their own, where the tiles have more around them than inside.
    Next(Vec<f64>, Vec<f64>),
}

/// What a pass over one tile writes, besides the sums.
enum Output<'a> {
    Nothing,
    /// The own vertices' part of `T_{k−1}` and `T_k` and the values around.
    InPlace {
        before: &'a mut [f64],
        now: &'a mut [f64],
        around: &'a [f64],
    },
    Apart {
        before: &'a mut [f64],
        now: &'a mut [f64],
    },
}

impl<'a> Recurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f` for the channels `at .. at + width` of `signal`, which has `n_channels`. Norms are
    /// weighted by `weights`.
    pub(crate) fn new(
        operator: &'a TiledDiffusion,
        weights: &'a [f64],
        signal: &[f64],
        n_channels: usize,
        (at, width): (usize, usize),
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        assert!((1..=MAX_CHANNELS).contains(&width) && at + width <= n_channels, "a block of the channels");
        let len = operator.n_vertices() * width;
        let mut recurrence = Self {
            operator,
            now: operator.take(len),
            before: operator.take(len),
            scratch: Scratch::None,
            weights,
            square: 0.0,
            moves: false,
            k: 0,
            width,
            at,
            stride: n_channels,
            normals: &[],
        };
        let u = &mut recurrence.now[..len];
        (recurrence.square, recurrence.moves) =
            difference(operator.diffusion(), weights, signal, n_channels, at, u, progress)?;
        Ok(recurrence)
    }

    /// Of each sum `kept` is kept.
    ///
    /// # Panics
    /// Unless there are three channels and a normal at each vertex, where the parts along normals are.
    #[must_use]
    pub(crate) fn keeping(mut self, kept: Kept<'a>) -> Self {
        if let Kept::Along(normals) = kept {
            let n = self.operator.n_vertices();
            assert_eq!(
                (self.width, self.stride, normals.len()),
                (3, 3, n),
                "a vector and a normal at each vertex"
            );
            (self.normals, self.stride) = (normals, 1);
        }
        self
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

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet. Asks before each tile whether to
    /// go on; a recurrence that has been stopped is of no use any more.
    pub(crate) fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Next,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let operator = self.operator;
        match &operator.tiles {
            Tiles::Narrow(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
            Tiles::Wide(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
        }
        if n_steps > 0 {
            if let (Scratch::Next(now, before), Next::Continues) = (&mut self.scratch, next) {
                std::mem::swap(&mut self.now, now);
                std::mem::swap(&mut self.before, before);
            }
            self.k += n_steps;
        }
        Ok(())
    }

    fn pass<I: Index>(
        &mut self,
        tiles: &TilesOf<I>,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Next,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        if n_steps > 0 && next == Next::Continues {
            self.prepare_next(tiles, n_steps, progress)?;
        }
        let (k, own, width, stride, at) = (self.k, self.operator.own, self.width, self.stride, self.at);
        let is_first = k == 0;
        let is_lazy = self.operator.diffusion().semigroup() == Semigroup::Steps;
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
        let len = self.operator.n_vertices() * width;
        let (mut whole_before, mut whole_now): (&[f64], &[f64]) = (&[], &[]);
        let outputs: Vec<Output<'_>> = match (&mut self.scratch, next) {
            (Scratch::Around(around), Next::Continues) if n_steps > 0 => {
                let mut around = &around[..];
                let own =
                    self.before[..len].chunks_mut(own * width).zip(self.now[..len].chunks_mut(own * width));
                let output = |(tile, (before, now)): (_, (_, _))| {
                    let of_tile;
                    (of_tile, around) = around.split_at(n_around(tile, width));
                    Output::InPlace { before, now, around: of_tile }
                };
                tiles.iter().zip(own).map(output).collect()
            }
            (Scratch::Next(now, before), Next::Continues) if n_steps > 0 => {
                (whole_before, whole_now) = (&self.before[..len], &self.now[..len]);
                let own = before[..len].chunks_mut(own * width).zip(now[..len].chunks_mut(own * width));
                own.map(|(before, now)| Output::Apart { before, now }).collect()
            }
            _ => {
                (whole_before, whole_now) = (&self.before[..len], &self.now[..len]);
                tiles.iter().map(|_| Output::Nothing).collect()
            }
        };
        let (terms, pool, target, weights) =
            (&terms, &self.operator.pool, self.operator.target, self.weights);
        let normals = self.normals;
        let jobs: Vec<_> = tiles.iter().zip(outs).zip(outputs).collect();
        let squares = map_tiles(jobs, len / width, progress, |((tile, mut outs), output)| {
            let whole = Input::Whole { before: whole_before, now: whole_now };
            let (input, next_before, next_now): (_, &mut [f64], &mut [f64]) = match output {
                Output::Nothing => (whole, &mut [], &mut []),
                Output::Apart { before, now } => (whole, before, now),
                Output::InPlace { before, now, around } => {
                    let (around_now, around_before) = around.split_at(tile.halo().len() * width);
                    (Input::Copied { before: around_before, now: around_now }, before, now)
                }
            };
            let pass = Pass {
                input,
                n_steps,
                is_first,
                is_lazy,
                next_before,
                next_now,
                terms,
                weights: &weights[tile.first()..],
                outs: &mut outs,
                stride,
                at,
                normals: if normals.is_empty() { normals } else { &normals[tile.first()..] },
            };
            let len = kernel::scratch_len(tile, n_steps, kernel::lanes(width));
            pool.with(len, |scratch| kernel::run(target, tile, width, pass, scratch))
        })?;
        // In the order of the tiles, so that the sum does not depend on who was first.
        for (i, sum) in sums.iter_mut().filter(|sum| from < sum.coefficients.len()).enumerate() {
            sum.square = squares.iter().map(|tile| tile[i]).sum();
        }
        Ok(())
    }

    /// Makes room for the next vectors: copies what is around each tile, or takes vectors of their own.
    fn prepare_next<I: Index>(
        &mut self,
        tiles: &TilesOf<I>,
        n_steps: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let (operator, width) = (self.operator, self.width);
        let len = operator.n_vertices() * width;
        if let Scratch::None = self.scratch {
            self.scratch = if operator.is_in_place() {
                Scratch::Around(operator.take(operator.n_around * width))
            } else {
                Scratch::Next(operator.take(len), operator.take(len))
            };
        }
        let Scratch::Around(around) = &mut self.scratch else { return Ok(()) };
        let mut rest = &mut around[..];
        let mut jobs = Vec::with_capacity(tiles.len());
        for tile in tiles.iter() {
            let (of_tile, others) = rest.split_at_mut(n_around(tile, width));
            jobs.push((tile, of_tile));
            rest = others;
        }
        let (now, before, is_first) = (&self.now[..len], &self.before[..len], self.k == 0);
        map_tiles(jobs, len / width, progress, |(tile, around)| {
            let n = |rings| (tile.n_within(rings) - tile.n_own()) * width;
            let (around_now, around_before) = around.split_at_mut(tile.halo().len() * width);
            kernel::copy_halo(tile, width, now, &mut around_now[..n(n_steps)]);
            if !is_first {
                kernel::copy_halo(tile, width, before, &mut around_before[..n(n_steps - 1)]);
            }
        })?;
        Ok(())
    }
}

/// Values of `T_k` and `T_{k−1}` around a tile.
fn n_around<I: Index>(tile: View<'_, I>, width: usize) -> usize {
    tile.n_around() * width
}

/// `work(job)` for each tile's job, in their order, for an operator of `n` vertices.
fn map_tiles<T: Send, R: Send>(
    jobs: Vec<T>,
    n: usize,
    progress: Progress<'_>,
    work: impl Fn(T) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let asked = |job| progress.check().map(|()| work(job));
    if n <= SERIAL {
        jobs.into_iter().map(asked).collect()
    } else {
        jobs.into_par_iter().map(asked).collect()
    }
}

impl Drop for Recurrence<'_> {
    fn drop(&mut self) {
        let give = |vector: &mut Vec<f64>| self.operator.give(std::mem::take(vector));
        give(&mut self.now);
        give(&mut self.before);
        match &mut self.scratch {
            Scratch::None => {}
            Scratch::Around(around) => give(around),
            Scratch::Next(now, before) => {
                give(now);
                give(before);
            }
        }
    }
}
