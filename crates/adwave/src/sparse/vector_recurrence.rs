//! The recurrence of a diffusion of directions: several steps of a tile while its vectors and entries stay in cache.
//!
//! As for scalars a pass over the tiles takes several steps, for which each tile needs as many rings of vertices around
//! it. The entries lie in the order of the tiles, with their turns; those that several tiles need are repeated.

use super::kernel::{InstructionSet, MAX_DEPTH, TurnedRows, turned_step};
use super::tiled_diffusion::{VectorPool, best_depth};
use super::tiles::{Index, TileList, TileView, Tiles, halo_shares};
use super::vector_diffusion::VectorDiffusion;
use crate::operator::{Continuation, Operator, RowOutput, RowWeights, SignalBlock, Steps, Sum, Weighing};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};

/// Number of interior vertices of a tile. An entry takes twice the memory of a scalar one, so that tiles are smaller than
/// those of scalars.
const OWN: usize = 4096;

/// Number of rows that are copied or weighted together.
const ROWS_AT_A_TIME: usize = 2048;

/// Tiles of an operator of directions.
#[derive(Debug)]
pub(super) struct VectorTiles {
    tiles: Tiles,
    own: usize,
    depth: usize,
    target: InstructionSet,
    /// `2Φ₁(x,y)·R_xy` of the rows of each tile.
    entries: Vec<[f64; 2]>,
    /// `1 − 2Σ_y Φ₁(x,y)` of the rows of each tile.
    diagonals: Vec<f64>,
    /// Start of the entries and of the rows of each tile, and the end of the last.
    starts: Vec<[usize; 2]>,
    scratch: VectorPool<f64>,
}

impl VectorTiles {
    /// Cuts the operator into tiles. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(super) fn new(operator: &VectorDiffusion, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let scalars = operator.scalars();
        let own = OWN.min(scalars.n_vertices() / 16).max(256);
        let depth = best_depth(&halo_shares(scalars, own, MAX_DEPTH, progress)?);
        Self::cut(operator, own, depth, progress)
    }

    fn cut(
        operator: &VectorDiffusion,
        own: usize,
        depth: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let tiles = Tiles::new(operator.scalars(), own, depth, progress)?;
        let (entries, diagonals, starts) = match &tiles {
            Tiles::Narrow(tiles) => turned_entries(operator, tiles, progress)?,
            Tiles::Wide(tiles) => turned_entries(operator, tiles, progress)?,
        };
        let (target, scratch) = (InstructionSet::detect(), VectorPool::default());
        Ok(Self { tiles, own, depth, target, entries, diagonals, starts, scratch })
    }

    /// Bytes of memory.
    pub(super) fn bytes(&self) -> u64 {
        self.tiles.bytes() + (size_of_val(&self.entries[..]) + size_of_val(&self.diagonals[..])) as u64
    }
}

/// Entries, diagonals and starts of all tiles, as [`VectorTiles`] has them.
type TurnedEntries = (Vec<[f64; 2]>, Vec<f64>, Vec<[usize; 2]>);

/// The entries of the rows of all tiles with their turns.
fn turned_entries<I: Index>(
    operator: &VectorDiffusion,
    tiles: &TileList<I>,
    progress: Progress<'_>,
) -> Result<TurnedEntries, Cancelled> {
    let mut starts = vec![[0, 0]];
    for tile in tiles.iter() {
        let [entries, rows] = starts[starts.len() - 1];
        starts.push([entries + tile.columns().len(), rows + tile.n_within(tile.depth() - 1)]);
    }
    let [n_entries, n_rows] = starts[starts.len() - 1];
    let (mut entries, mut diagonals): (Vec<[f64; 2]>, Vec<f64>) = (zeros(n_entries), zeros(n_rows));
    let (mut rest, mut rest_of_rows) = (&mut entries[..], &mut diagonals[..]);
    let mut jobs = Vec::with_capacity(tiles.len());
    for (tile, range) in tiles.iter().zip(starts.windows(2)) {
        let (of_tile, after) = rest.split_at_mut(range[1][0] - range[0][0]);
        let (rows, after_rows) = rest_of_rows.split_at_mut(range[1][1] - range[0][1]);
        jobs.push((tile, of_tile, rows));
        (rest, rest_of_rows) = (after, after_rows);
    }
    let (weights, turns) = (operator.scalars().weights(), operator.turns());
    parallel::try_map_owned(jobs, operator.n_rows(), progress, |(tile, entries, diagonals)| {
        let own = tile.rows().iter().map(|row| tile.first() + row.get());
        let rows = own.chain(tile.halo().iter().map(|&x| x as usize));
        let mut rest = entries;
        for (x, diagonal) in rows.zip(diagonals) {
            let range = tile.offsets()[x]..tile.offsets()[x + 1];
            let (row, after) = rest.split_at_mut(range.len());
            rest = after;
            *diagonal = 1.0;
            for ((entry, &w), &[c, s]) in row.iter_mut().zip(&weights[range.clone()]).zip(&turns[range]) {
                *entry = [2.0 * w * c, 2.0 * w * s];
                *diagonal -= 2.0 * w;
            }
        }
    })?;
    Ok((entries, diagonals, starts))
}

/// The vectors `T_k(Y)u` of one direction for each vertex, for increasing k, `Y = 2Φ₁ − I`.
pub(super) struct VectorRecurrence<'a> {
    tiles: &'a VectorTiles,
    weights: RowWeights<'a>,
    /// `T_k u` and `T_{k−1} u`.
    now: Vec<[f64; 2]>,
    before: Vec<[f64; 2]>,
    /// Room for the next ones, while other tiles read these.
    next_now: Vec<[f64; 2]>,
    next_before: Vec<[f64; 2]>,
    square: f64,
    moves: bool,
    k: usize,
    /// First channel of the block, and number of channels of a row of a sum.
    at: usize,
    stride: usize,
}

/// Terms that a pass adds to a sum.
struct PassTerm<'a> {
    /// Coefficients from the first new term on.
    coefficients: &'a [f64],
    is_weighed: bool,
}

/// A tile with the parts of the vectors and sums that a pass writes.
struct TileJob<'a, I> {
    /// Number of the tile.
    number: usize,
    tile: TileView<'a, I>,
    outs: Vec<&'a mut [f64]>,
    next_before: &'a mut [[f64; 2]],
    next_now: &'a mut [[f64; 2]],
}

impl<'a> VectorRecurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    ///
    /// # Panics
    /// Unless the block has the two channels of one direction.
    pub(super) fn new(
        operator: &'a VectorDiffusion,
        tiles: &'a VectorTiles,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let SignalBlock { values, n_channels, channels, weights, output, .. } = block;
        assert!(channels.len() == 2 && matches!(output, RowOutput::Channels), "one direction at a time");
        let (n, at) = (operator.n_rows(), channels.start);
        let (mut before, mut now): (Vec<[f64; 2]>, _) = (zeros(n), zeros::<[f64; 2]>(n));
        parallel::try_visit_rows(&mut before, 1, ROWS_AT_A_TIME, progress, |first, rows| {
            for (x, row) in (first..).zip(rows) {
                row.copy_from_slice(&values[x * n_channels + at..][..2]);
            }
        })?;
        operator.difference(before.as_flattened(), 2, now.as_flattened_mut(), progress)?;
        let square = parallel::try_sum(n, progress, |x| weights.weight(x, n) * square_of(&now[x]))?;
        let moves = now.iter().any(|z| *z != [0.0; 2]);
        Ok(Self {
            tiles,
            weights,
            now,
            before,
            next_now: Vec::new(),
            next_before: Vec::new(),
            square,
            moves,
            k: 0,
            at,
            stride: n_channels,
        })
    }

    fn pass<I: Index>(
        &mut self,
        tiles: &TileList<I>,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let (n, own, stride) = (self.now.len(), self.tiles.own, self.stride);
        let goes_on = n_steps > 0 && next == Continuation::Continues;
        if goes_on && self.next_now.is_empty() {
            (self.next_now, self.next_before) = (zeros(n), zeros(n));
        }
        let from = if self.k == 0 { 0 } else { self.k + 1 };
        let to = self.k + n_steps + 1;
        let mut terms = Vec::new();
        let mut outs: Vec<Vec<&mut [f64]>> = tiles.iter().map(|_| Vec::with_capacity(sums.len())).collect();
        for sum in sums.iter_mut().filter(|sum| from < sum.coefficients.len().min(to)) {
            let coefficients = &sum.coefficients[from..to.min(sum.coefficients.len())];
            terms.push(PassTerm { coefficients, is_weighed: sum.weighing == Weighing::Weighed });
            outs.iter_mut().zip(sum.out.chunks_mut(own * stride)).for_each(|(outs, out)| outs.push(out));
        }
        let n_next = if goes_on { n } else { 0 };
        let mut next_before = self.next_before[..n_next].chunks_mut(own);
        let mut next_now = self.next_now[..n_next].chunks_mut(own);
        let jobs: Vec<TileJob<'_, I>> = tiles
            .iter()
            .zip(outs)
            .enumerate()
            .map(|(number, (tile, outs))| TileJob {
                number,
                tile,
                outs,
                next_before: next_before.next().unwrap_or_default(),
                next_now: next_now.next().unwrap_or_default(),
            })
            .collect();
        let reading = PassReading {
            tiles: self.tiles,
            weights: self.weights,
            now: &self.now,
            before: &self.before,
            terms: &terms,
            n_steps,
            is_first: self.k == 0,
            at: self.at,
            stride,
        };
        let scratch = &self.tiles.scratch;
        let squares = parallel::try_map_owned(jobs, n, progress, |job| {
            scratch.use_scratch(reading.scratch_len(job.tile), |scratch| reading.run(job, scratch))
        })?;
        // In the order of the tiles, so that the sum does not depend on the scheduling.
        for (i, sum) in sums.iter_mut().filter(|sum| from < sum.coefficients.len().min(to)).enumerate() {
            sum.square = squares.iter().map(|tile| tile[i]).sum();
        }
        Ok(())
    }
}

/// Data that all tiles of a pass read.
struct PassReading<'a> {
    tiles: &'a VectorTiles,
    weights: RowWeights<'a>,
    now: &'a [[f64; 2]],
    before: &'a [[f64; 2]],
    terms: &'a [PassTerm<'a>],
    n_steps: usize,
    is_first: bool,
    at: usize,
    stride: usize,
}

impl PassReading<'_> {
    /// Numbers of the vectors of two steps of a tile.
    fn scratch_len<I: Index>(&self, tile: TileView<'_, I>) -> usize {
        4 * tile.n_within(self.n_steps)
    }

    /// Takes the steps of a tile; returns the squared norms of its parts of the sums that are weighed, and 0 for others.
    fn run<I: Index>(&self, job: TileJob<'_, I>, scratch: &mut [f64]) -> Vec<f64> {
        let TileJob { number, tile, mut outs, next_before, next_now } = job;
        let (first, n_own, n) = (tile.first(), tile.n_own(), tile.n_within(self.n_steps));
        let scratch = &mut scratch[..self.scratch_len(tile)];
        let (now, before) = scratch.split_at_mut(2 * n);
        let [mut now, mut before]: [&mut [[f64; 2]]; 2] = [now, before].map(|part| part.as_chunks_mut().0);
        let [from, to] = [number, number + 1].map(|tile| self.tiles.starts[tile]);
        let (entries, diagonals) =
            (&self.tiles.entries[from[0]..to[0]], &self.tiles.diagonals[from[1]..to[1]]);
        for (local, whole) in [(&mut *now, self.now), (&mut *before, self.before)] {
            local[..n_own].copy_from_slice(&whole[first..first + n_own]);
            for (z, &x) in local[n_own..].iter_mut().zip(tile.halo()) {
                *z = whole[x as usize];
            }
        }
        if self.is_first {
            self.add(0, &now[..n_own], &mut outs);
        }
        for step in 0..self.n_steps {
            let is_first = self.is_first && step == 0;
            let n_rings = self.n_steps - 1 - step;
            let rows = TurnedRows { tile, n_rings, entries, diagonals, is_first };
            turned_step(self.tiles.target, rows, now, before);
            std::mem::swap(&mut now, &mut before);
            self.add(step + usize::from(self.is_first), &now[..n_own], &mut outs);
        }
        if !next_now.is_empty() {
            next_now.copy_from_slice(&now[..n_own]);
            next_before.copy_from_slice(&before[..n_own]);
        }
        let n_rows = self.now.len();
        let square = |(term, out): (&PassTerm<'_>, &&mut [f64])| {
            let rows = out.chunks_exact(self.stride).enumerate().filter(|_| term.is_weighed);
            rows.map(|(x, row)| {
                self.weights.weight(first + x, n_rows) * square_of(&[row[self.at], row[self.at + 1]])
            })
            .sum()
        };
        self.terms.iter().zip(&outs).map(square).collect()
    }

    /// Adds a term of a pass to the sums that have it; the first of all sets them.
    fn add(&self, term: usize, vectors: &[[f64; 2]], outs: &mut [&mut [f64]]) {
        let is_new = self.is_first && term == 0;
        for (of_sum, out) in self.terms.iter().zip(outs) {
            let Some(&a) = of_sum.coefficients.get(term) else { continue };
            for (row, z) in out.chunks_exact_mut(self.stride).zip(vectors) {
                for (out, v) in row[self.at..self.at + 2].iter_mut().zip(z) {
                    *out = if is_new { a * v } else { *out + a * v };
                }
            }
        }
    }
}

fn square_of(z: &[f64; 2]) -> f64 {
    z[0] * z[0] + z[1] * z[1]
}

impl Steps for VectorRecurrence<'_> {
    fn steps_per_pass(&self) -> usize {
        self.tiles.depth
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
        let tiles = self.tiles;
        match &tiles.tiles {
            Tiles::Narrow(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
            Tiles::Wide(tiles) => self.pass(tiles, n_steps, sums, next, progress)?,
        }
        if n_steps > 0 {
            if next == Continuation::Continues {
                std::mem::swap(&mut self.now, &mut self.next_now);
                std::mem::swap(&mut self.before, &mut self.next_before);
            }
            self.k += n_steps;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::{BlockPrecision, DifferenceSteps, Diffusion};
    use std::sync::Arc;

    /// A grid of `side` × `side` vertices with unequal weights and turns.
    fn operator(side: usize) -> VectorDiffusion {
        let n = side * side;
        let neighbors = |x: usize| {
            let (i, j) = (x % side, x / side);
            let mut found = Vec::new();
            for (di, dj) in
                [(0, 0), (1, 0), (0, 1), (1, 1), (side - 1, 0), (0, side - 1), (side - 1, side - 1)]
            {
                found.push((i + di) % side + (j + dj) % side * side);
            }
            found.sort_unstable();
            found
        };
        let (mut offsets, mut columns, mut weights) = (vec![0], Vec::new(), Vec::new());
        for x in 0..n {
            for y in neighbors(x) {
                columns.push(y as u32);
                weights.push(if x == y { 0.5 } else { 0.5 / 6.0 });
            }
            offsets.push(columns.len());
        }
        let scalars = Arc::new(Diffusion::from_rows(&offsets, &columns, &weights).unwrap());
        let mut turns = Vec::new();
        for x in 0..n {
            for &y in scalars.row(x).0 {
                let angle = (0.7 * x as f64).sin() - (0.7 * f64::from(y)).sin();
                let (sin, cos) = angle.sin_cos();
                turns.push([cos, sin]);
            }
        }
        VectorDiffusion::new(scalars, turns, Vec::new())
    }

    #[test]
    fn tiles_of_any_size_take_the_steps_of_whole_vectors() {
        let operator = operator(21);
        let n = operator.n_rows();
        let signal: Vec<f64> = (0..4 * n).map(|i| ((i * 7919) % 1013) as f64 / 1013.0).collect();
        let coefficients: Vec<Vec<f64>> =
            [11, 4, 1].map(|n| (0..n).map(|k| 1.0 / (1.0 + f64::from(k))).collect()).to_vec();
        let block = |at: usize| SignalBlock {
            values: &signal,
            n_channels: 4,
            channels: at..at + 2,
            weights: operator.weights(),
            n_sums: 3,
            output: RowOutput::Channels,
            precision: BlockPrecision::Double,
        };
        let run = |steps: &mut dyn Steps, passes: &[usize]| {
            let mut outs = vec![vec![0.0; 4 * n]; 3];
            let mut squares = [0.0; 3];
            for (i, &n_steps) in passes.iter().enumerate() {
                let mut sums: Vec<Sum<'_>> = outs
                    .iter_mut()
                    .zip(&coefficients)
                    .map(|(out, coefficients)| Sum {
                        coefficients,
                        out,
                        weighing: Weighing::Weighed,
                        square: f64::NAN,
                    })
                    .collect();
                let is_last = i + 1 == passes.len();
                let next = if is_last { Continuation::Ends } else { Continuation::Continues };
                steps.advance(n_steps, &mut sums, next, Progress::none()).unwrap();
                for (square, sum) in squares.iter_mut().zip(&sums).filter(|(_, sum)| !sum.square.is_nan()) {
                    *square = sum.square;
                }
            }
            assert_eq!(steps.k(), passes.iter().sum::<usize>());
            (outs, squares)
        };
        for (at, target) in
            [(0, InstructionSet::detect()), (2, InstructionSet::detect()), (0, InstructionSet::Portable)]
        {
            let mut whole = DifferenceSteps::new(&operator, block(at), Progress::none()).unwrap();
            let expected = run(&mut whole, &[10]);
            for (own, depth, passes) in
                [(40, 3, &[3, 3, 3, 1][..]), (97, 5, &[5, 5]), (441, 1, &[1; 10]), (64, 4, &[0, 4, 2, 4])]
            {
                let tiles = VectorTiles::cut(&operator, own, depth, Progress::none()).unwrap();
                let tiles = VectorTiles { target, ..tiles };
                let mut steps =
                    VectorRecurrence::new(&operator, &tiles, block(at), Progress::none()).unwrap();
                assert!((steps.square() / whole.square() - 1.0).abs() < 1e-13 && steps.is_nonzero());
                let found = run(&mut steps, passes);
                for k in 0..3 {
                    let apart = found.0[k].iter().zip(&expected.0[k]).map(|(a, b)| (a - b).abs());
                    assert!(apart.fold(0.0, f64::max) < 1e-13, "{own} {depth} sum {k}");
                    assert!((found.1[k] / expected.1[k] - 1.0).abs() < 1e-12, "{own} {depth} square {k}");
                }
            }
        }
    }
}
