//! Chebyshev polynomials of the diffusion operator applied to a block of channels, and sums of them.
//!
//! `T_{k+1}(Y)u = 2Y·T_k(Y)u − T_{k−1}(Y)u` with `Y = 2Φ₁ − I`. One pass over the tiles takes several steps, in
//! place: first the values around every tile are copied, then each tile overwrites `T_{k−1}`, `T_k` at its interior
//! vertices with `T_{k+n−1}`, `T_{k+n}`.

use super::kernel::{self, PassInput, PassTerm, TilePass};
use super::tiled_diffusion::{MAX_CHANNELS, TiledDiffusion, difference};
use super::tiles::{Index, TileList, TileView, Tiles};
use crate::operator::{Continuation, RowOutput, RowWeights, SignalBlock, Steps, Sum, Weighing};
use crate::parallel;
use crate::{Cancelled, Progress};

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for up to four channels.
pub(super) struct Recurrence<'a> {
    operator: &'a TiledDiffusion,
    /// Vector `T_k u`, n_vertices × width.
    now: Vec<f64>,
    /// Vector `T_{k−1} u`.
    before: Vec<f64>,
    scratch: NextVectors,
    /// Weights μ of the norm.
    weights: &'a [f64],
    /// Squared norm `Σ_x μ(x)|u(x)|²`.
    square: f64,
    moves: bool,
    k: usize,
    width: usize,
    at: usize,
    stride: usize,
    normals: &'a [[f64; 3]],
}

/// Buffers that allow the next vectors to be written while others still read the present ones. Allocated when a
/// second pass is needed.
enum NextVectors {
    None,
    /// Values around each tile: of `T_k`, then of `T_{k−1}`.
    Around(Vec<f64>),
    /// Separate vectors, if the tiles have more values around them than inside.
    Separate(Vec<f64>, Vec<f64>),
}

/// Output of a pass over one tile, besides the sums.
enum TileOutput<'a> {
    Nothing,
    /// Interior part of `T_{k−1}` and `T_k`, and the values around.
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
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    ///
    /// # Panics
    /// Unless the weights are those of each row, and there are three channels and one normal per vertex for normal
    /// components.
    pub(super) fn new(
        operator: &'a TiledDiffusion,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let SignalBlock { values, n_channels, channels, output, .. } = block;
        let RowWeights::Each(weights) = block.weights else {
            panic!("a diffusion has a weight for each row")
        };
        let (at, width) = (channels.start, channels.len());
        assert!((1..=MAX_CHANNELS).contains(&width) && at + width <= n_channels, "a block of the channels");
        let len = operator.n_vertices() * width;
        let (normals, stride): (&[_], _) = match output {
            RowOutput::Channels => (&[], n_channels),
            RowOutput::AlongNormals(normals) => {
                let n = operator.n_vertices();
                assert_eq!(
                    (width, n_channels, normals.len()),
                    (3, 3, n),
                    "a vector and a normal at each vertex"
                );
                (normals, 1)
            }
        };
        let mut recurrence = Self {
            operator,
            now: operator.take(len),
            before: operator.take(len),
            scratch: NextVectors::None,
            weights,
            square: 0.0,
            moves: false,
            k: 0,
            width,
            at,
            stride,
            normals,
        };
        let u = &mut recurrence.now[..len];
        (recurrence.square, recurrence.moves) =
            difference(operator.diffusion(), weights, values, n_channels, at, u, progress)?;
        Ok(recurrence)
    }

    fn pass<I: Index>(
        &mut self,
        tiles: &TileList<I>,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        if n_steps > 0 && next == Continuation::Continues {
            self.prepare_next(tiles, n_steps, progress)?;
        }
        let (k, own, width, stride, at) = (self.k, self.operator.own, self.width, self.stride, self.at);
        let is_first = k == 0;
        let is_lazy = self.operator.diffusion().stays_half();
        let from = if is_first { 0 } else { k + 1 };
        let mut terms = Vec::new();
        let mut outs: Vec<Vec<&mut [f64]>> = tiles.iter().map(|_| Vec::with_capacity(sums.len())).collect();
        for sum in &mut *sums {
            let to = sum.coefficients.len().min(k + n_steps + 1);
            if from < to {
                terms.push(PassTerm {
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
        let outputs: Vec<TileOutput<'_>> = match (&mut self.scratch, next) {
            (NextVectors::Around(around), Continuation::Continues) if n_steps > 0 => {
                let mut around = &around[..];
                let own =
                    self.before[..len].chunks_mut(own * width).zip(self.now[..len].chunks_mut(own * width));
                let output = |(tile, (before, now)): (_, (_, _))| {
                    let of_tile;
                    (of_tile, around) = around.split_at(n_around(tile, width));
                    TileOutput::InPlace { before, now, around: of_tile }
                };
                tiles.iter().zip(own).map(output).collect()
            }
            (NextVectors::Separate(now, before), Continuation::Continues) if n_steps > 0 => {
                (whole_before, whole_now) = (&self.before[..len], &self.now[..len]);
                let own = before[..len].chunks_mut(own * width).zip(now[..len].chunks_mut(own * width));
                own.map(|(before, now)| TileOutput::Apart { before, now }).collect()
            }
            _ => {
                (whole_before, whole_now) = (&self.before[..len], &self.now[..len]);
                tiles.iter().map(|_| TileOutput::Nothing).collect()
            }
        };
        let (terms, pool, target, weights) =
            (&terms, &self.operator.pool, self.operator.target, self.weights);
        let normals = self.normals;
        let jobs: Vec<_> = tiles.iter().zip(outs).zip(outputs).collect();
        let squares = parallel::try_map_owned(jobs, len / width, progress, |((tile, mut outs), output)| {
            let whole = PassInput::Whole { before: whole_before, now: whole_now };
            let (input, next_before, next_now): (_, &mut [f64], &mut [f64]) = match output {
                TileOutput::Nothing => (whole, &mut [], &mut []),
                TileOutput::Apart { before, now } => (whole, before, now),
                TileOutput::InPlace { before, now, around } => {
                    let (around_now, around_before) = around.split_at(tile.halo().len() * width);
                    (PassInput::Copied { before: around_before, now: around_now }, before, now)
                }
            };
            let pass = TilePass {
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
            pool.use_free(len, |scratch| kernel::run(target, tile, width, pass, scratch))
        })?;
        // In the order of the tiles, so that the sum does not depend on the scheduling.
        for (i, sum) in sums.iter_mut().filter(|sum| from < sum.coefficients.len()).enumerate() {
            sum.square = squares.iter().map(|tile| tile[i]).sum();
        }
        Ok(())
    }

    /// Provides room for the next vectors: copies the values around each tile, or allocates separate vectors.
    fn prepare_next<I: Index>(
        &mut self,
        tiles: &TileList<I>,
        n_steps: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let (operator, width) = (self.operator, self.width);
        let len = operator.n_vertices() * width;
        if let NextVectors::None = self.scratch {
            self.scratch = if operator.is_in_place() {
                NextVectors::Around(operator.take(operator.n_around * width))
            } else {
                NextVectors::Separate(operator.take(len), operator.take(len))
            };
        }
        let NextVectors::Around(around) = &mut self.scratch else { return Ok(()) };
        let mut rest = &mut around[..];
        let mut jobs = Vec::with_capacity(tiles.len());
        for tile in tiles.iter() {
            let (of_tile, others) = rest.split_at_mut(n_around(tile, width));
            jobs.push((tile, of_tile));
            rest = others;
        }
        let (now, before, is_first) = (&self.now[..len], &self.before[..len], self.k == 0);
        parallel::try_map_owned(jobs, len / width, progress, |(tile, around)| {
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

impl Steps for Recurrence<'_> {
    fn steps_per_pass(&self) -> usize {
        self.operator.steps_per_pass()
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
        let operator = self.operator;
        match &operator.tiles {
            Tiles::Narrow(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
            Tiles::Wide(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
        }
        if n_steps > 0 {
            if let (NextVectors::Separate(now, before), Continuation::Continues) = (&mut self.scratch, next) {
                std::mem::swap(&mut self.now, now);
                std::mem::swap(&mut self.before, before);
            }
            self.k += n_steps;
        }
        Ok(())
    }
}

/// Number of values of `T_k` and `T_{k−1}` around a tile.
fn n_around<I: Index>(tile: TileView<'_, I>, width: usize) -> usize {
    tile.n_around() * width
}

impl Drop for Recurrence<'_> {
    fn drop(&mut self) {
        let give = |vector: &mut Vec<f64>| self.operator.give(std::mem::take(vector));
        give(&mut self.now);
        give(&mut self.before);
        match &mut self.scratch {
            NextVectors::None => {}
            NextVectors::Around(around) => give(around),
            NextVectors::Separate(now, before) => {
                give(now);
                give(before);
            }
        }
    }
}
