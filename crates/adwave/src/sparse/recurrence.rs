//! Chebyshev polynomials of the diffusion operator applied to a block of channels, and sums of them.
//!
//! `T_{k+1}(Y)u = 2Y·T_k(Y)u − T_{k−1}(Y)u` with `Y = 2Φ₁ − I`. One pass over the tiles takes several steps, in
//! place: first the values around every tile are copied, then each tile overwrites `T_{k−1}`, `T_k` at its interior
//! vertices with `T_{k+n−1}`, `T_{k+n}`.

use super::kernel::{self, PassInput, PassTerm, TileEntries, TilePass, VectorNumber};
use super::single::{SingleBound, scale_of};
use super::tile_weights::TileWeights;
use super::tiled_diffusion::{DifferenceInput, MAX_CHANNELS, TiledDiffusion, VectorPool, difference};
use super::tiles::{Index, TileList, TileView, Tiles};
use crate::operator::{Continuation, RowOutput, RowWeights, SignalBlock, Steps, Sum, Weighing};
use crate::parallel;
use crate::{Cancelled, Progress};

/// The vectors `T_k(Y)u` for increasing k, `Y = 2Φ₁ − I`, for up to four channels, in double or single
/// precision.
pub(super) struct Recurrence<'a, T: VectorNumber> {
    operator: &'a TiledDiffusion,
    /// Entries of Φ₁ of the rows of each tile.
    entries: RecurrenceEntries<'a, T>,
    bound: Option<&'a SingleBound>,
    pool: &'a VectorPool<T>,
    /// Vector `T_k u` times the scale, n_vertices × width.
    now: Vec<T>,
    /// Vector `T_{k−1} u` times the scale.
    before: Vec<T>,
    scratch: NextVectors<T>,
    /// Power of 2 by which the vectors are multiplied, so that single precision neither overflows nor underflows.
    scale: f64,
    /// Weights μ of the norm.
    weights: &'a [f64],
    /// Squared norm `Σ_x μ(x)|u(x)|²` times the square of the scale.
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
enum NextVectors<T> {
    None,
    /// Values around each tile: of `T_k`, then of `T_{k−1}`.
    Around(Vec<T>),
    /// Separate vectors, if the tiles have more values around them than inside.
    Separate(Vec<T>, Vec<T>),
}

/// Output of a pass over one tile, besides the sums.
enum TileOutput<'a, T> {
    Nothing,
    /// Interior part of `T_{k−1}` and `T_k`, and the values around.
    InPlace {
        before: &'a mut [T],
        now: &'a mut [T],
        around: &'a [T],
    },
    Apart {
        before: &'a mut [T],
        now: &'a mut [T],
    },
}

/// Location of the entries of the rows of a tile.
#[derive(Clone, Copy)]
enum RecurrenceEntries<'a, T> {
    /// Entries in the operator.
    Operator(&'a [T]),
    Tiles(&'a TileWeights<T>),
}

impl<'a, T: VectorNumber> RecurrenceEntries<'a, T> {
    fn tile_entries(self, tile: usize) -> TileEntries<'a, T> {
        match self {
            Self::Operator(entries) => TileEntries::Operator(entries),
            Self::Tiles(weights) => TileEntries::Tile(weights.tile_entries(tile)),
        }
    }
}

impl<'a> Recurrence<'a, f64> {
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    ///
    /// # Panics
    /// Unless the weights are those of each row, and there are three channels and one normal per vertex for normal
    /// components.
    pub(super) fn new(
        operator: &'a TiledDiffusion,
        block: &SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let entries = RecurrenceEntries::Operator(operator.diffusion().weights());
        Self::allocated(operator, entries, &operator.double, block).start(block, progress)
    }
}

impl<'a> Recurrence<'a, f32> {
    /// Starts at u as in double precision, and rounds it.
    ///
    /// # Panics
    /// As for [`new`](Recurrence::new).
    pub(super) fn new_single(
        operator: &'a TiledDiffusion,
        weights: &'a TileWeights<f32>,
        bound: &'a SingleBound,
        block: &SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let entries = RecurrenceEntries::Tiles(weights);
        let mut recurrence = Self::allocated(operator, entries, &operator.single, block);
        recurrence.bound = Some(bound);
        recurrence.scale = scale_of(largest_value(block, progress)?);
        recurrence.start(block, progress)
    }
}

/// Largest absolute value in the channels of a block.
fn largest_value(block: &SignalBlock<'_>, progress: Progress<'_>) -> Result<f64, Cancelled> {
    const ROWS_AT_A_TIME: usize = 1 << 12;
    /// Number of maxima that are kept at once, so that they are not computed one after another.
    const TOGETHER: usize = 8;
    let SignalBlock { values, n_channels, channels, .. } = block;
    let largest = parallel::try_map_chunks(
        values.len() / n_channels,
        ROWS_AT_A_TIME,
        progress,
        || (),
        |(), rows| {
            let values = &values[rows.start * n_channels..rows.end * n_channels];
            if channels.len() < *n_channels {
                let block = values.chunks_exact(*n_channels).flat_map(|row| &row[channels.clone()]);
                return block.fold(0.0, |most: f64, v| most.max(v.abs()));
            }
            let (values, rest) = values.as_chunks::<TOGETHER>();
            let mut most = [0.0; TOGETHER];
            for values in values {
                for (most, v) in most.iter_mut().zip(values) {
                    *most = if v.abs() > *most { v.abs() } else { *most };
                }
            }
            most.iter().chain(rest).fold(0.0, |most: f64, v| most.max(v.abs()))
        },
    )?;
    Ok(largest.into_iter().fold(0.0, f64::max))
}

impl<'a, T: VectorNumber> Recurrence<'a, T> {
    /// The recurrence without u.
    fn allocated(
        operator: &'a TiledDiffusion,
        entries: RecurrenceEntries<'a, T>,
        pool: &'a VectorPool<T>,
        block: &SignalBlock<'a>,
    ) -> Self {
        let &SignalBlock { n_channels, ref channels, output, .. } = block;
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
        Self {
            operator,
            entries,
            bound: None,
            pool,
            now: pool.take(len),
            before: pool.take(len),
            scratch: NextVectors::None,
            scale: 1.0,
            weights,
            square: 0.0,
            moves: false,
            k: 0,
            width,
            at,
            stride,
            normals,
        }
    }

    /// Computes u.
    fn start(mut self, block: &SignalBlock<'_>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let SignalBlock { values, n_channels, channels, .. } = block;
        let len = self.operator.n_vertices() * self.width;
        let input = DifferenceInput {
            signal: values,
            n_channels: *n_channels,
            at: channels.start,
            scale: self.scale,
        };
        let u = &mut self.now[..len];
        (self.square, self.moves) = difference(self.operator.diffusion(), self.weights, input, u, progress)?;
        Ok(self)
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
                    coefficients: sum.coefficients[from..to].iter().map(|a| a / self.scale).collect(),
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
        let (mut whole_before, mut whole_now): (&[T], &[T]) = (&[], &[]);
        let outputs: Vec<TileOutput<'_, T>> = match (&mut self.scratch, next) {
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
        let (terms, target, weights) = (&terms, self.operator.target, self.weights);
        let (pool, normals, entries) = (self.pool, self.normals, self.entries);
        let jobs: Vec<_> = tiles.iter().enumerate().zip(outs).zip(outputs).collect();
        let squares =
            parallel::try_map_owned(jobs, len / width, progress, |(((number, tile), mut outs), output)| {
                let whole = PassInput::Whole { before: whole_before, now: whole_now };
                let (input, next_before, next_now): (_, &mut [T], &mut [T]) = match output {
                    TileOutput::Nothing => (whole, &mut [], &mut []),
                    TileOutput::Apart { before, now } => (whole, before, now),
                    TileOutput::InPlace { before, now, around } => {
                        let (around_now, around_before) = around.split_at(tile.halo().len() * width);
                        (PassInput::Copied { before: around_before, now: around_now }, before, now)
                    }
                };
                let pass = TilePass {
                    input,
                    entries: entries.tile_entries(number),
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
                let len = kernel::scratch_len::<_, T>(tile, n_steps, kernel::lanes(width));
                pool.use_scratch(len, |scratch| kernel::run(target, tile, width, pass, scratch))
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
                NextVectors::Around(self.pool.take(operator.n_around * width))
            } else {
                NextVectors::Separate(self.pool.take(len), self.pool.take(len))
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

impl<T: VectorNumber> Steps for Recurrence<'_, T> {
    fn steps_per_pass(&self) -> usize {
        self.operator.steps_per_pass()
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

impl<T: VectorNumber> Drop for Recurrence<'_, T> {
    fn drop(&mut self) {
        let give = |vector: &mut Vec<T>| self.pool.give(std::mem::take(vector));
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
