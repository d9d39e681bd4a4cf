//! Inner loops, compiled for several instruction sets and selected at run time.
//!
//! Each loop is written once, over arrays of `L` channels that become one register, and compiled with and without
//! fused multiply-add. Processors with it round differently from those without, but each gives the same bits on any
//! number of threads. `CHECKED` variants index with bounds checks; they are the safe twins of the others.
#![allow(unsafe_code)]
// A function that is not inlined into one that has AVX is compiled without AVX.
#![allow(clippy::inline_always)]

mod combine;
mod number;
mod rows;
mod step;
#[cfg(test)]
mod tests;
mod turned;
mod wide;

pub(crate) use number::{GROUP, VectorNumber};
pub(crate) use rows::{RowProduct, apply_rows};
pub(crate) use turned::{TurnedRows, turned_step};
pub(crate) use wide::{WideNumber, WideProduct, WideRows, WideTerms};

use super::tiles::{DegreeRun, Index, TileView};
use combine::combine;
use step::{InteriorRows, RingRows, RowEntries, StepVectors, WeightRows, gather, step};

/// Largest number of steps that a tile takes in one pass.
pub(crate) const MAX_DEPTH: usize = 12;

/// Instruction set of the loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InstructionSet {
    /// The instructions that the build targets.
    Portable,
    /// AVX2 and fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 with 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// The best instruction set of this processor.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }
}

/// True if the build itself has fused multiply-add; without it `mul_add` would be a slow function.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

#[inline(always)]
fn fma<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn get<T, const CHECKED: bool>(slice: &[T], i: usize) -> &T {
    if CHECKED {
        &slice[i]
    } else {
        debug_assert!(i < slice.len());
        // SAFETY: callers pass CHECKED = false only for a tile and vectors whose sizes `steps` has checked. Each
        // index is a row, a column or a halo vertex of a tile, which `Tile::validate` has compared with the tile's
        // rings and with the operator, or a row within a run.
        unsafe { slice.get_unchecked(i) }
    }
}

#[inline(always)]
fn get_mut<T, const CHECKED: bool>(slice: &mut [T], i: usize) -> &mut T {
    if CHECKED {
        &mut slice[i]
    } else {
        debug_assert!(i < slice.len());
        // SAFETY: as in `get`.
        unsafe { slice.get_unchecked_mut(i) }
    }
}

/// The slice `slice[start..][..len]`.
#[inline(always)]
fn range<T, const CHECKED: bool>(slice: &[T], start: usize, len: usize) -> &[T] {
    if CHECKED {
        &slice[start..][..len]
    } else {
        debug_assert!(start + len <= slice.len());
        // SAFETY: as in `get`. The number of a row's entries in the operator equals that of its run, which
        // `Tile::validate` has compared; a `TileView` belongs to a tile and the operator with which it was
        // compared.
        unsafe { slice.get_unchecked(start..start + len) }
    }
}

/// A term added to a band: its coefficients for the vectors of a pass.
pub(super) struct PassTerm {
    /// Coefficients of the vectors `first ..` of the pass.
    pub(super) coefficients: Vec<f64>,
    /// First vector that counts: 0 at the very start of a recurrence, else 1.
    pub(super) first: usize,
    /// True if the band starts here.
    pub(super) is_new: bool,
    /// True if `Σ_x μ(x)|out(x)|²` is requested.
    pub(super) is_weighed: bool,
}

/// Entries of the rows of a tile, in the format of the vectors.
#[derive(Clone, Copy)]
pub(super) enum TileEntries<'a, T> {
    /// Entries of all rows of the operator, of which a pass gathers those of the tile.
    Operator(&'a [T]),
    /// Entries of the tile in its order, as [`gather_tile`] copies them.
    Tile(&'a [T]),
}

/// Location of the vectors before a pass, n_vertices × D.
#[derive(Clone, Copy)]
pub(super) enum PassInput<'a, T> {
    /// `T_{k−1}` and `T_k` of all vertices.
    Whole { before: &'a [T], now: &'a [T] },
    /// Values at the tile's halo, as copied by [`copy_halo`]; those at its interior vertices are in the output
    /// buffers.
    Copied { before: &'a [T], now: &'a [T] },
}

/// Input and output of a pass over a tile: `D` channels in rows of `L ≥ D`.
pub(super) struct TilePass<'a, 'b, T> {
    pub(super) input: PassInput<'a, T>,
    pub(super) entries: TileEntries<'a, T>,
    /// Number of steps, at least 1 unless k is 0.
    pub(super) n_steps: usize,
    /// True for the very first pass: `T_1 = ½(2Y T_0 − 0)`.
    pub(super) is_first: bool,
    /// True if every row of Φ₁ has the diagonal ½, or no entries at all.
    pub(super) is_lazy: bool,
    /// Interior part of `T_{k+n−1}` and `T_{k+n}`; empty if they are not needed.
    pub(super) next_before: &'b mut [T],
    pub(super) next_now: &'b mut [T],
    /// One term per band, with at least one coefficient each.
    pub(super) terms: &'a [PassTerm],
    /// Weights μ of the interior vertices.
    pub(super) weights: &'a [f64],
    /// Interior part of each band, in rows of `stride`, written at `at .. at + D`.
    pub(super) outs: &'a mut [&'b mut [f64]],
    pub(super) stride: usize,
    pub(super) at: usize,
    /// Normals of the interior vertices, if a band is its component along them (one number per vertex); else empty.
    pub(super) normals: &'a [[f64; 3]],
}

/// Number of values that a pass over `tile` needs as scratch memory.
pub(super) fn scratch_len<I: Index, T>(tile: TileView<'_, I>, n_steps: usize, lanes: usize) -> usize {
    let vectors = (0..n_steps + 2).map(|i| n_rows(tile, n_steps, i)).sum::<usize>() * lanes;
    let weights = n_entries(tile.own_runs()) + n_entries(tile.ring_runs(n_steps.saturating_sub(1)));
    vectors + weights.next_multiple_of(lanes) + ALIGNMENT / size_of::<T>()
}

fn n_entries(runs: &[DegreeRun]) -> usize {
    runs.iter().map(|run| run.degree as usize * run.n_rows as usize).sum()
}

/// Number of vertices of the tile at which `T_{k−1+i}` is needed in a pass of `n_steps`.
#[inline(always)]
fn n_rows<I: Index>(tile: TileView<'_, I>, n_steps: usize, i: usize) -> usize {
    match i {
        0 => tile.n_within(n_steps.saturating_sub(1)),
        _ => tile.n_within(n_steps + 1 - i),
    }
}

/// Alignment of rows in bytes, so that none crosses a cache line.
const ALIGNMENT: usize = 64;

#[inline(always)]
fn steps<I: Index, T: VectorNumber, const L: usize, const D: usize, const FMA: bool, const CHECKED: bool>(
    tile: TileView<'_, I>,
    mut pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    let n_steps = pass.n_steps;
    let skip = scratch.as_ptr().align_offset(ALIGNMENT).min(ALIGNMENT / size_of::<T>());
    let mut rest = scratch[skip..].as_chunks_mut::<L>().0;
    let mut vectors: [&mut [[T; L]]; MAX_DEPTH + 2] = std::array::from_fn(|_| Default::default());
    for (i, vector) in vectors.iter_mut().enumerate().take(n_steps + 2) {
        (*vector, rest) = rest.split_at_mut(n_rows(tile, n_steps, i));
    }
    let (own, first) = (tile.n_own() * D, tile.first() * D);
    let (own_before, own_now) = match pass.input {
        PassInput::Whole { before, now } => (&before[first..], &now[first..]),
        PassInput::Copied { .. } => (&*pass.next_before, &*pass.next_now),
    };
    let (halo_before, halo_now) = match pass.input {
        PassInput::Whole { before, now } => (HaloValues::Gathered(before), HaloValues::Gathered(now)),
        PassInput::Copied { before, now } => (HaloValues::Copied(before), HaloValues::Copied(now)),
    };
    fill::<I, T, L, D>(tile, &own_now[..own], halo_now, vectors[1]);
    if n_steps > 0 {
        if pass.is_first {
            vectors[0].fill([T::default(); L]);
        } else {
            fill::<I, T, L, D>(tile, &own_before[..own], halo_before, vectors[0]);
        }
    }
    let own_rows = InteriorRows { rows: tile.rows(), first: tile.first() };
    let ring_rows = RingRows { first: tile.n_own(), halo: tile.halo() };
    let n_own_entries = n_entries(tile.own_runs());
    let (own_columns, ring_columns) = tile.columns().split_at(n_own_entries);
    let (own_weights, ring_weights) = match pass.entries {
        TileEntries::Tile(weights) => weights.split_at(n_own_entries),
        TileEntries::Operator(weights) => {
            let (own, rings) = rest.as_flattened_mut().split_at_mut(n_own_entries);
            if n_steps > 0 {
                let rows = weight_rows(tile, weights);
                gather::<_, _, CHECKED>(own_rows, tile.own_runs(), rows, own);
                gather::<_, _, CHECKED>(ring_rows, tile.ring_runs(n_steps - 1), rows, rings);
            }
            (&*own, &*rings)
        }
    };
    for i in 1..=n_steps {
        let (old, new) = vectors.split_at_mut(i + 1);
        let scale = T::rounded(if pass.is_first && i == 1 { 2.0 } else { 4.0 }, 1.0);
        let mut vectors = StepVectors { before: &*old[i - 1], now: &*old[i], next: &mut *new[0] };
        // The unchecked loops rely on this: rows are within n − i rings, columns within n − i + 1.
        assert!(
            vectors.next.len() == tile.n_within(n_steps - i) && vectors.before.len() >= vectors.next.len()
        );
        assert!(vectors.now.len() == tile.n_within(n_steps + 1 - i));
        let (own_runs, ring_runs) = (tile.own_runs(), tile.ring_runs(n_steps - i));
        let own = RowEntries { columns: own_columns, weights: own_weights };
        let rings = RowEntries { columns: ring_columns, weights: ring_weights };
        if pass.is_lazy {
            step::<I, T, L, FMA, CHECKED, true>(own_rows, own_runs, own, &mut vectors, scale);
            step::<I, T, L, FMA, CHECKED, true>(ring_rows, ring_runs, rings, &mut vectors, scale);
        } else {
            step::<I, T, L, FMA, CHECKED, false>(own_rows, own_runs, own, &mut vectors, scale);
            step::<I, T, L, FMA, CHECKED, false>(ring_rows, ring_runs, rings, &mut vectors, scale);
        }
    }
    let read: [&[[T; L]]; MAX_DEPTH + 1] = std::array::from_fn(|i| &*vectors[i + 1]);
    let squares = combine::<T, L, D, FMA>(&mut pass, &read, tile.n_own());
    if !pass.next_now.is_empty() && n_steps > 0 {
        for (out, v) in pass.next_now.as_chunks_mut::<D>().0.iter_mut().zip(read[n_steps]) {
            out.copy_from_slice(&v[..D]);
        }
        for (out, v) in pass.next_before.as_chunks_mut::<D>().0.iter_mut().zip(read[n_steps - 1]) {
            out.copy_from_slice(&v[..D]);
        }
    }
    squares
}

/// The entries of the operator of a tile by vertex.
///
/// # Panics
/// Unless there is one for each neighbor.
#[inline(always)]
fn weight_rows<'a, I: Index, T>(tile: TileView<'a, I>, weights: &'a [T]) -> WeightRows<'a, T> {
    assert_eq!(tile.offsets().last(), Some(&weights.len()), "an entry for each neighbor");
    WeightRows { offsets: tile.offsets(), weights }
}

/// Number of entries of all rows of a tile.
pub(super) fn n_tile_entries<I: Index>(tile: TileView<'_, I>) -> usize {
    n_entries(tile.own_runs()) + n_entries(tile.ring_runs(tile.depth() - 1))
}

/// Copies the entries of all rows of the tile in its order, and rounds them.
pub(super) fn gather_tile<I: Index, T: VectorNumber>(tile: TileView<'_, I>, weights: &[f64], to: &mut [T]) {
    let rows = weight_rows(tile, weights);
    let (own, rings) = to.split_at_mut(n_entries(tile.own_runs()));
    let own_rows = InteriorRows { rows: tile.rows(), first: tile.first() };
    let ring_rows = RingRows { first: tile.n_own(), halo: tile.halo() };
    gather::<_, _, true>(own_rows, tile.own_runs(), rows, own);
    gather::<_, _, true>(ring_rows, tile.ring_runs(tile.depth() - 1), rows, rings);
}

/// Location of the values at the rings.
#[derive(Clone, Copy)]
enum HaloValues<'a, T> {
    /// Values among those at all vertices.
    Gathered(&'a [T]),
    /// Values in the order of the tile.
    Copied(&'a [T]),
}

/// Copies the values at the tile's first vertices, as many as fit in `to`: the interior, then the rings.
#[inline(always)]
fn fill<I: Index, T: VectorNumber, const L: usize, const D: usize>(
    tile: TileView<'_, I>,
    own: &[T],
    halo: HaloValues<'_, T>,
    to: &mut [[T; L]],
) {
    let (to_own, to_halo) = to.split_at_mut(tile.n_own());
    for (to, from) in to_own.iter_mut().zip(own.as_chunks::<D>().0) {
        *to = padded(from);
    }
    match halo {
        HaloValues::Gathered(values) => {
            let values = values.as_chunks::<D>().0;
            assert!(tile.halo().len() >= to_halo.len());
            for (to, &x) in to_halo.iter_mut().zip(tile.halo()) {
                *to = padded(&values[x as usize]);
            }
        }
        HaloValues::Copied(values) => {
            assert!(values.len() >= to_halo.len() * D);
            for (to, from) in to_halo.iter_mut().zip(values.as_chunks::<D>().0) {
                *to = padded(from);
            }
        }
    }
}

/// A row of `L` lanes that begins with the given values.
#[inline(always)]
fn padded<T: VectorNumber, const L: usize, const D: usize>(from: &[T; D]) -> [T; L] {
    let mut row = [T::default(); L];
    row[..D].copy_from_slice(from);
    row
}

/// Copies the values at the tile's halo, as many as fit in `to`, n × `width`.
pub(super) fn copy_halo<I: Index, T: Copy>(tile: TileView<'_, I>, width: usize, from: &[T], to: &mut [T]) {
    fn copy<T: Copy, const D: usize>(halo: &[u32], from: &[T], to: &mut [T]) {
        let from = from.as_chunks::<D>().0;
        for (to, &x) in to.as_chunks_mut::<D>().0.iter_mut().zip(halo) {
            *to = from[x as usize];
        }
    }
    match width {
        1 => copy::<T, 1>(tile.halo(), from, to),
        2 => copy::<T, 2>(tile.halo(), from, to),
        3 => copy::<T, 3>(tile.halo(), from, to),
        4 => copy::<T, 4>(tile.halo(), from, to),
        _ => unreachable!("a block has 1 to 4 channels, not {width}"),
    }
}

/// Runs the pass over the tile for `width` channels, 1 … 4, and computes the requested norms.
pub(super) fn run<I: Index, T: VectorNumber>(
    target: InstructionSet,
    tile: TileView<'_, I>,
    width: usize,
    pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    match width {
        1 => run_width::<I, T, 1, 1>(target, tile, pass, scratch),
        2 => run_width::<I, T, 2, 2>(target, tile, pass, scratch),
        3 => run_width::<I, T, 4, 3>(target, tile, pass, scratch),
        4 => run_width::<I, T, 4, 4>(target, tile, pass, scratch),
        _ => unreachable!("a block has 1 to 4 channels, not {width}"),
    }
}

/// [`run`] for `D` channels in `L` lanes.
///
/// Each width and instruction set is a function of its own: as one function for all of them they take far longer to
/// compile.
fn run_width<I: Index, T: VectorNumber, const L: usize, const D: usize>(
    target: InstructionSet,
    tile: TileView<'_, I>,
    pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    match target {
        InstructionSet::Portable => steps::<I, T, L, D, FUSED, false>(tile, pass, scratch),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor.
        InstructionSet::Avx2 => unsafe { avx2::<I, T, L, D>(tile, pass, scratch) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX-512F and AVX-512VL on this processor, which imply AVX2 and
        // FMA.
        InstructionSet::Avx512 => unsafe { avx512::<I, T, L, D>(tile, pass, scratch) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<I: Index, T: VectorNumber, const L: usize, const D: usize>(
    tile: TileView<'_, I>,
    pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    steps::<I, T, L, D, true, false>(tile, pass, scratch)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn avx512<I: Index, T: VectorNumber, const L: usize, const D: usize>(
    tile: TileView<'_, I>,
    pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    steps::<I, T, L, D, true, false>(tile, pass, scratch)
}

/// Number of lanes of a scratch row for `width` channels.
pub(super) fn lanes(width: usize) -> usize {
    width.next_power_of_two()
}
