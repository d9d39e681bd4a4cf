//! Heat along the lines of one axis, any time at once: by sums of the places around each for short times ([`Taps`]), by
//! solves for longer ones ([`Poles`]), and by the mean once nothing else is left.

use super::poles::{Approximation, Ends, Poles, ROUNDING, Work};
use super::taps::{COLUMNS, LineRows, TapBuffers, Taps};
use crate::{Cancelled, Progress, parallel};
use std::sync::{Mutex, PoisonError};

/// Lines that are solved together.
pub(super) const TOGETHER: usize = 8;

/// Fewest blocks of lines, one after another in memory, that go to the threads as they are: enough for all.
const FEWEST_BLOCKS: usize = 64;

/// Most values of such a block: larger ones leave the cache between two axes, and keep a thread too long to stop it.
const LARGEST_BLOCK: usize = 1 << 20;

/// Values of the blocks that a thread takes at a time.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Pieces of rows that are listed at a time.
const PIECES: usize = 1 << 18;

/// Time after which a line of n places is its mean, in n²: the slowest wave decays by exp(−4s/n²) or faster, here to
/// 4·10⁻¹⁸.
const LEVELED: f64 = 10.0;

/// Places on each side up to which sums take less time than the solves of a pair of poles.
const TAPS_OF_PAIR: usize = 7;

/// The lines of values along one axis.
pub(crate) struct Lines<'a> {
    /// Places of a line.
    n: usize,
    /// Distance between the values of adjacent places, which is also the number of lines side by side.
    inner: usize,
    kind: LineKind<'a>,
}

/// Connection of the places of a line.
#[derive(Clone, Copy)]
pub(crate) enum LineKind<'a> {
    /// Places at equal distances; the ends reflect.
    Even,
    /// Places at equal distances; the last is beside the first.
    Ring,
    /// The weights of the places before and after each, `1/(m·d)` with the measure m of the place and the distance d; 0
    /// beyond the ends. Norms are weighted by the measure.
    Uneven(&'a [[f64; 2]]),
}

/// Diffusion along lines for a time, prepared.
pub(crate) struct LineHeat {
    method: LineMethod,
    error: f64,
}

enum LineMethod {
    Mean,
    Taps(Taps),
    Poles(Poles),
}

impl LineHeat {
    /// Bound of the error relative to the norm of the input.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }
}

/// Buffers of a thread, which it keeps from block to block.
#[derive(Default)]
pub(crate) struct LineBuffers {
    taps: TapBuffers,
    /// Lines in tiles of [`TOGETHER`].
    tiles: Vec<f64>,
    work: Work,
}

impl LineBuffers {
    /// Diffuses lines of n places side by side.
    fn diffuse_rows(&mut self, heat: &LineHeat, n: usize, rows: &mut impl LineRows) {
        if let LineMethod::Taps(taps) = &heat.method {
            return taps.diffuse_rows(&mut self.taps, n, rows);
        }
        self.tiles.resize(rows.row(0).len().div_ceil(TOGETHER) * n * TOGETHER, 0.0);
        for at in 0..n {
            let tiles = self.tiles.chunks_exact_mut(n * TOGETHER);
            for (row, tile) in rows.row(at).chunks(TOGETHER).zip(tiles) {
                tile[at * TOGETHER..][..row.len()].copy_from_slice(row);
            }
        }
        self.diffuse_tiles(heat, n);
        for at in 0..n {
            let tiles = self.tiles.chunks_exact(n * TOGETHER);
            for (row, tile) in rows.row_mut(at).chunks_mut(TOGETHER).zip(tiles) {
                row.copy_from_slice(&tile[at * TOGETHER..][..row.len()]);
            }
        }
    }

    /// Diffuses lines of n places that lie one after another, `given` or `lines` itself.
    fn diffuse_lines(&mut self, heat: &LineHeat, n: usize, given: Option<&[f64]>, lines: &mut [f64]) {
        if let LineMethod::Taps(taps) = &heat.method {
            return taps.diffuse_lines(&mut self.taps, n, given, lines);
        }
        self.tiles.resize(n * TOGETHER, 0.0);
        for (k, lines) in lines.chunks_mut(TOGETHER * n).enumerate() {
            let width = lines.len() / n;
            let given = given.map_or(&*lines, |given| &given[k * TOGETHER * n..][..lines.len()]);
            for at in 0..n {
                (0..width).for_each(|lane| self.tiles[at * TOGETHER + lane] = given[lane * n + at]);
            }
            self.diffuse_tiles(heat, n);
            for at in 0..n {
                (0..width).for_each(|lane| lines[lane * n + at] = self.tiles[at * TOGETHER + lane]);
            }
        }
    }

    fn diffuse_tiles(&mut self, heat: &LineHeat, n: usize) {
        for tile in self.tiles.chunks_exact_mut(n * TOGETHER) {
            match &heat.method {
                LineMethod::Poles(poles) => poles.run(&mut self.work, tile),
                LineMethod::Mean => level(tile),
                LineMethod::Taps(_) => unreachable!("taps take rows and lines as they are"),
            }
        }
    }
}

/// Some of the lines of a block, from `first` on in each row of `inner` values.
struct BlockRows<'a> {
    given: Option<&'a [f64]>,
    block: &'a mut [f64],
    inner: usize,
    first: usize,
    width: usize,
}

impl LineRows for BlockRows<'_> {
    fn row(&self, at: usize) -> &[f64] {
        &self.given.unwrap_or(self.block)[at * self.inner + self.first..][..self.width]
    }

    fn row_mut(&mut self, at: usize) -> &mut [f64] {
        &mut self.block[at * self.inner + self.first..][..self.width]
    }
}

/// [`BlockRows`] of a thread that has its pieces of the rows.
struct PieceRows<'a> {
    given: Option<&'a [f64]>,
    pieces: Vec<&'a mut [f64]>,
    inner: usize,
    first: usize,
}

impl LineRows for PieceRows<'_> {
    fn row(&self, at: usize) -> &[f64] {
        let start = at * self.inner + self.first;
        self.given.map_or(&*self.pieces[at], |given| &given[start..start + self.pieces[at].len()])
    }

    fn row_mut(&mut self, at: usize) -> &mut [f64] {
        self.pieces[at]
    }
}

impl<'a> Lines<'a> {
    /// The lines of `n` places whose values are `inner` apart.
    pub(crate) fn new(n: usize, inner: usize, kind: LineKind<'a>) -> Self {
        Self { n, inner, kind }
    }

    /// Heat for the time s, in squared spacings or in units of the inverse weights, in the least time that keeps to
    /// `accuracy`, or else the most exact one.
    pub(crate) fn heat(&self, time: f64, accuracy: f64) -> LineHeat {
        // On a ring of two places both sides of a place are the other one.
        let is_ring = matches!(self.kind, LineKind::Ring) && self.n > 2;
        let time = if matches!(self.kind, LineKind::Ring) && !is_ring { 2.0 * time } else { time };
        let is_even = !matches!(self.kind, LineKind::Uneven(_));
        if is_even && time >= LEVELED * (self.n as f64).powi(2) {
            return LineHeat { method: LineMethod::Mean, error: ROUNDING * self.n as f64 };
        }
        let largest_weight = match self.kind {
            LineKind::Uneven(sides) => {
                sides.iter().flatten().fold(0.0, |most: f64, weight| most.max(*weight))
            }
            LineKind::Even | LineKind::Ring => 1.0,
        };
        let approximation = Approximation::choose(time * largest_weight, accuracy);
        let error = approximation.error_after(time * largest_weight);
        if is_even {
            let taps = Taps::new(time, accuracy, TAPS_OF_PAIR * approximation.n_pairs(), self.n, is_ring);
            if let Some(taps) = taps.filter(|taps| taps.error() <= accuracy.max(error)) {
                return LineHeat { error: taps.error(), method: LineMethod::Taps(taps) };
            }
        }
        let weights: Vec<[f64; 2]> = match self.kind {
            LineKind::Uneven(sides) => sides.iter().map(|side| side.map(|weight| time * weight)).collect(),
            LineKind::Even | LineKind::Ring => vec![[time; 2]; self.n],
        };
        let ends = match is_even {
            true if is_ring => Ends::Joined,
            true => Ends::Reflecting,
            false => Ends::Weighted,
        };
        LineHeat { method: LineMethod::Poles(Poles::new(approximation, weights, ends)), error }
    }

    /// Number of values of a block of lines, one after another in memory.
    fn block(&self) -> usize {
        self.n * self.inner
    }

    /// Diffuses all lines of `given`, or of `values` itself if there is none, into `values`; lines side by side go to
    /// different threads.
    fn diffuse_columns(
        &self,
        heat: &LineHeat,
        given: Option<&[f64]>,
        values: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let Self { n, inner, .. } = *self;
        let spare: Mutex<Vec<LineBuffers>> = Mutex::default();
        let lock = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        // Few lines side by side are shared by all threads.
        let columns = inner.div_ceil(rayon::current_num_threads()).next_multiple_of(TOGETHER).min(COLUMNS);
        for (block, values) in values.chunks_exact_mut(n * inner).enumerate() {
            let given = given.map(|given| &given[block * n * inner..][..n * inner]);
            let mut rows: Vec<_> =
                values.chunks_exact_mut(inner).map(|row| row.chunks_mut(columns)).collect();
            let (n_groups, at_a_time) = (inner.div_ceil(columns), (PIECES / n).max(1));
            for first in (0..n_groups).step_by(at_a_time) {
                let group = |group: usize| {
                    let pieces = Vec::with_capacity(n);
                    PieceRows { given, pieces, inner, first: group * columns }
                };
                let mut groups: Vec<_> = (first..n_groups.min(first + at_a_time)).map(group).collect();
                for row in &mut rows {
                    groups.iter_mut().zip(row).for_each(|(group, piece)| group.pieces.push(piece));
                }
                let n_rows = groups.len() * n;
                parallel::try_each(groups, n_rows, progress, |mut group| {
                    let mut buffers = lock().pop().unwrap_or_default();
                    buffers.diffuse_rows(heat, n, &mut group);
                    lock().push(buffers);
                    Ok(())
                })?;
            }
        }
        Ok(())
    }

    /// Diffuses all lines of some blocks of n × inner values, `given` or `blocks` itself, on the calling thread.
    pub(crate) fn diffuse_blocks(
        &self,
        heat: &LineHeat,
        buffers: &mut LineBuffers,
        given: Option<&[f64]>,
        blocks: &mut [f64],
    ) {
        let Self { n, inner, .. } = *self;
        if inner == 1 {
            return buffers.diffuse_lines(heat, n, given, blocks);
        }
        for (k, block) in blocks.chunks_exact_mut(n * inner).enumerate() {
            let given = given.map(|given| &given[k * n * inner..][..n * inner]);
            for first in (0..inner).step_by(COLUMNS) {
                let width = COLUMNS.min(inner - first);
                buffers.diffuse_rows(heat, n, &mut BlockRows { given, block, inner, first, width });
            }
        }
    }
}

/// Diffuses `given` into `values` along some axes, from the one whose values are farthest apart to the one whose values are
/// closest, in as few passes over memory as the blocks of their lines allow.
pub(super) fn diffuse_axes(
    mut axes: &[(Lines<'_>, LineHeat)],
    given: &[f64],
    values: &mut [f64],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut given = Some(given);
    while let [(lines, heat), rest @ ..] = axes {
        let block = lines.block();
        let go_whole = values.len() / block >= FEWEST_BLOCKS && block <= LARGEST_BLOCK;
        if lines.inner > 1 && !go_whole {
            lines.diffuse_columns(heat, given.take(), values, progress)?;
            axes = rest;
            continue;
        }
        // Lines that lie together are diffused in place, along all axes that are left.
        let n_blocks = (VALUES_AT_A_TIME / block).max(1);
        return parallel::try_visit_rows(values, block, n_blocks, progress, |first, rows| {
            let mut buffers = LineBuffers::default();
            let mut given = given.map(|given| &given[first * block..][..rows.len()]);
            if let [(lines, heat)] = axes {
                return lines.diffuse_blocks(heat, &mut buffers, given, rows);
            }
            for rows in rows.chunks_exact_mut(block) {
                let mut given = given.as_mut().map(|given| given.split_off(..block).expect("a block"));
                for (lines, heat) in axes {
                    lines.diffuse_blocks(heat, &mut buffers, given.take(), rows);
                }
            }
        });
    }
    Ok(())
}

/// Replaces the lines of a tile, n × [`TOGETHER`], by their means; constants stay to the last bit.
fn level(tile: &mut [f64]) {
    let values = tile.as_chunks_mut::<TOGETHER>().0;
    let (first, n) = (values[0], values.len() as f64);
    let mut mean = [0.0; TOGETHER];
    for values in values.iter() {
        for ((mean, value), first) in mean.iter_mut().zip(values).zip(&first) {
            *mean += (value - first) / n;
        }
    }
    values.fill(std::array::from_fn(|lane| first[lane] + mean[lane]));
}
