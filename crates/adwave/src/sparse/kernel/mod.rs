//! The inner loops, compiled for several processors and chosen at run time.
//!
//! Each loop is written once, over arrays of `L` channels that become one register. It is compiled with and without
//! fused multiply-add: processors with it give other last bits than those without, but each gives its own the same on
//! any number of threads. `CHECKED` variants index with bounds checks; they are the safe twins of the others.
#![allow(unsafe_code)]
// What is not inlined into a function that has AVX is compiled without AVX.
#![allow(clippy::inline_always)]

mod pages;
mod rows;
#[cfg(test)]
mod tests;

pub(crate) use pages::zeros;
pub(crate) use rows::{Rows, apply_rows};

use super::tiles::{Index, Run, Tile};

/// Steps that a tile can take in one pass.
pub(crate) const MAX_DEPTH: usize = 12;

/// Which instructions the loops may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// Whatever the build was made for.
    Portable,
    /// AVX2 and fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 with 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Target {
    /// The best that this processor has.
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

/// Whether the build itself has fused multiply-add; without it `mul_add` would be a slow function.
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
        // SAFETY: callers pass CHECKED = false only for a tile and vectors that `steps` has found to fit together: each
        // index is one of a tile's rows or columns, which `Tile::checked` has compared with the tile's length.
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

/// A term that is added to a band: its coefficients for the vectors of a pass.
pub(super) struct Term<'a> {
    /// For the vectors `first ..` of the pass.
    pub(super) coefficients: &'a [f64],
    /// The first vector that counts: 0 at the very start of a recurrence, else 1.
    pub(super) first: usize,
    /// Whether the band starts here.
    pub(super) is_new: bool,
    /// Whether `Σ_x μ(x)|out(x)|²` is asked for.
    pub(super) is_weighed: bool,
}

/// `T_{k−1}`, `T_k` and where `T_{k+1}` goes, of the vertices of a tile.
struct Vectors<'a, const L: usize> {
    before: &'a [[f64; L]],
    now: &'a [[f64; L]],
    next: &'a mut [[f64; L]],
}

/// One step for the rows of `runs`: `next = scale·(Σ w·now[y] − before)`.
#[inline(always)]
fn step<I: Index, const L: usize, const FMA: bool, const CHECKED: bool>(
    tile: &Tile<I>,
    runs: &[Run],
    vectors: &mut Vectors<'_, L>,
    scale: f64,
) {
    let (mut rows, mut columns, mut weights) = (tile.rows(), tile.columns(), tile.weights());
    for run in runs {
        let n_entries = run.n_rows * run.degree;
        let (these, r) = (&rows[..run.n_rows], &rows[run.n_rows..]);
        let (c, cs) = (&columns[..n_entries], &columns[n_entries..]);
        let (w, ws) = (&weights[..n_entries], &weights[n_entries..]);
        (rows, columns, weights) = (r, cs, ws);
        macro_rules! unrolled {
            ($($degree:literal)*) => {
                match run.degree {
                    $($degree => fixed::<I, $degree, L, FMA, CHECKED>(these, c, w, vectors, scale),)*
                    degree => any::<I, L, FMA, CHECKED>(degree, these, c, w, vectors, scale),
                }
            };
        }
        unrolled!(2 3 4 5 6 7 8 9 10);
    }
}

#[inline(always)]
fn fixed<I: Index, const DEGREE: usize, const L: usize, const FMA: bool, const CHECKED: bool>(
    rows: &[I],
    columns: &[I],
    weights: &[f64],
    vectors: &mut Vectors<'_, L>,
    scale: f64,
) {
    let Vectors { before, now, next } = vectors;
    let entries = columns.as_chunks::<DEGREE>().0.iter().zip(weights.as_chunks::<DEGREE>().0);
    for (row, (columns, weights)) in rows.iter().zip(entries) {
        let mut sum = get::<_, CHECKED>(before, row.get()).map(|v| -v);
        for e in 0..DEGREE {
            let there = get::<_, CHECKED>(now, columns[e].get());
            for c in 0..L {
                sum[c] = fma::<FMA>(weights[e], there[c], sum[c]);
            }
        }
        *get_mut::<_, CHECKED>(next, row.get()) = sum.map(|v| scale * v);
    }
}

#[inline(always)]
fn any<I: Index, const L: usize, const FMA: bool, const CHECKED: bool>(
    degree: usize,
    rows: &[I],
    columns: &[I],
    weights: &[f64],
    vectors: &mut Vectors<'_, L>,
    scale: f64,
) {
    let Vectors { before, now, next } = vectors;
    for (r, row) in rows.iter().enumerate() {
        let entries = r * degree..(r + 1) * degree;
        let mut sum = get::<_, CHECKED>(before, row.get()).map(|v| -v);
        for (column, &w) in columns[entries.clone()].iter().zip(&weights[entries]) {
            let there = get::<_, CHECKED>(now, column.get());
            for c in 0..L {
                sum[c] = fma::<FMA>(w, there[c], sum[c]);
            }
        }
        *get_mut::<_, CHECKED>(next, row.get()) = sum.map(|v| scale * v);
    }
}

/// `out = Σ_i coefficients[i]·vectors[first + i]`, added to what is there unless the band is new, for the own vertices;
/// `Σ_x μ(x)|out(x)|²` where it is asked for.
#[inline(always)]
fn combine<const N: usize, const L: usize, const D: usize, const FMA: bool>(
    term: &Term<'_>,
    vectors: &[&[[f64; L]]],
    out: &mut [f64],
    (stride, at): (usize, usize),
    weights: &[f64],
) -> f64 {
    let a: [f64; N] = std::array::from_fn(|i| term.coefficients[i]);
    let n = out.len() / stride;
    let v: [&[[f64; L]]; N] = std::array::from_fn(|i| &vectors[term.first + i][..n]);
    let weights = &weights[..n];
    let mut square = 0.0;
    for (x, out) in out.chunks_exact_mut(stride).enumerate() {
        let out: &mut [f64] = &mut out[at..at + D];
        let mut sum = [0.0; L];
        if !term.is_new {
            sum[..D].copy_from_slice(out);
        }
        for i in 0..N {
            for c in 0..L {
                sum[c] = fma::<FMA>(a[i], v[i][x][c], sum[c]);
            }
        }
        out.copy_from_slice(&sum[..D]);
        if term.is_weighed {
            let own: f64 = sum[..D].iter().map(|s| s * s).sum();
            square += weights[x] * own;
        }
    }
    square
}

#[inline(always)]
fn combine_all<const L: usize, const D: usize, const FMA: bool>(
    pass: &mut Pass<'_, '_>,
    vectors: &[&[[f64; L]]],
) -> Vec<f64> {
    let (place, weights) = ((pass.stride, pass.at), pass.weights);
    let mut squares = Vec::with_capacity(pass.terms.len());
    // A loop and no closure: a closure would be compiled without the instructions of the function around it.
    for (term, out) in pass.terms.iter().zip(&mut *pass.outs) {
        macro_rules! unrolled {
            ($($n:literal)*) => {
                match term.coefficients.len() {
                    $($n => combine::<$n, L, D, FMA>(term, vectors, out, place, weights),)*
                    n => unreachable!("{n} terms in one pass"),
                }
            };
        }
        squares.push(unrolled!(1 2 3 4 5 6 7 8 9 10 11 12 13));
    }
    squares
}

/// What a pass over a tile reads and writes. `D` channels in rows of `L ≥ D`.
pub(super) struct Pass<'a, 'b> {
    /// `T_{k−1}` and `T_k` of all vertices, n_vertices × D.
    pub(super) before: &'a [f64],
    pub(super) now: &'a [f64],
    /// Steps to take, at least 1 unless k is 0.
    pub(super) n_steps: usize,
    /// Whether this is the very first pass: `T_1 = ½(2Y T_0 − 0)`.
    pub(super) is_first: bool,
    /// The own vertices' part of `T_{k+n−1}` and `T_{k+n}`; empty when nobody needs them.
    pub(super) next_before: &'b mut [f64],
    pub(super) next_now: &'b mut [f64],
    /// One for each band, at least one coefficient each.
    pub(super) terms: &'a [Term<'a>],
    /// μ of the own vertices.
    pub(super) weights: &'a [f64],
    /// The own vertices' part of each band, rows of `stride`, written at `at .. at + D`.
    pub(super) outs: &'a mut [&'b mut [f64]],
    pub(super) stride: usize,
    pub(super) at: usize,
}

/// Values that a pass over `tile` keeps at hand, in f64.
pub(super) fn scratch_len<I: Index>(tile: &Tile<I>, n_steps: usize, lanes: usize) -> usize {
    (n_steps + 2) * tile.n_within(n_steps) * lanes + ALIGNMENT
}

/// Rows start at multiples of 64 bytes, so that none lies across two cache lines.
const ALIGNMENT: usize = 8;

#[inline(always)]
fn steps<I: Index, const L: usize, const D: usize, const FMA: bool, const CHECKED: bool>(
    tile: &Tile<I>,
    mut pass: Pass<'_, '_>,
    scratch: &mut [f64],
) -> Vec<f64> {
    let n_steps = pass.n_steps;
    let n = tile.n_within(n_steps);
    let skip = scratch.as_ptr().align_offset(64).min(ALIGNMENT);
    let scratch = scratch[skip..].as_chunks_mut::<L>().0;
    let mut vectors: [&mut [[f64; L]]; MAX_DEPTH + 2] = std::array::from_fn(|_| Default::default());
    for (vector, chunk) in vectors.iter_mut().zip(scratch.chunks_exact_mut(n.max(1))).take(n_steps + 2) {
        *vector = chunk;
    }
    assert!(vectors[..n_steps + 2].iter().all(|vector| vector.len() >= n), "scratch for the tile");
    gather::<I, L, D>(tile, pass.now, n, vectors[1]);
    if n_steps > 0 {
        if pass.is_first {
            vectors[0][..tile.n_within(n_steps - 1)].fill([0.0; L]);
        } else {
            gather::<I, L, D>(tile, pass.before, tile.n_within(n_steps - 1), vectors[0]);
        }
    }
    for i in 1..=n_steps {
        let (old, new) = vectors.split_at_mut(i + 1);
        let scale = if pass.is_first && i == 1 { 0.5 } else { 1.0 };
        let runs = tile.runs_within(n_steps - i);
        let mut vectors = Vectors { before: &*old[i - 1], now: &*old[i], next: &mut *new[0] };
        step::<I, L, FMA, CHECKED>(tile, runs, &mut vectors, scale);
    }
    let read: [&[[f64; L]]; MAX_DEPTH + 1] = std::array::from_fn(|i| &*vectors[i + 1]);
    let squares = combine_all::<L, D, FMA>(&mut pass, &read);
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

/// Copies the values of the tile's first `n` vertices.
#[inline(always)]
fn gather<I: Index, const L: usize, const D: usize>(
    tile: &Tile<I>,
    from: &[f64],
    n: usize,
    to: &mut [[f64; L]],
) {
    let from = from.as_chunks::<D>().0;
    let n_own = tile.n_own();
    for (to, from) in to.iter_mut().zip(&from[tile.first()..tile.first() + n_own]) {
        to[..D].copy_from_slice(from);
        to[D..].fill(0.0);
    }
    for (to, &x) in to[n_own..n].iter_mut().zip(tile.halo()) {
        to[..D].copy_from_slice(&from[x as usize]);
        to[D..].fill(0.0);
    }
}

/// Takes the pass over the tile for `width` channels, 1 … 4, and weighs the bands that are to be weighed.
pub(super) fn run<I: Index>(
    target: Target,
    tile: &Tile<I>,
    width: usize,
    pass: Pass<'_, '_>,
    scratch: &mut [f64],
) -> Vec<f64> {
    match target {
        Target::Portable => by_width::<I, FUSED, false>(tile, width, pass, scratch),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Target::detect` has found AVX2 and FMA on this processor.
        Target::Avx2 => unsafe { avx2(tile, width, pass, scratch) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Target::detect` has found AVX-512F and AVX-512VL on this processor, which imply AVX2 and FMA.
        Target::Avx512 => unsafe { avx512(tile, width, pass, scratch) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<I: Index>(tile: &Tile<I>, width: usize, pass: Pass<'_, '_>, scratch: &mut [f64]) -> Vec<f64> {
    by_width::<I, true, false>(tile, width, pass, scratch)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn avx512<I: Index>(tile: &Tile<I>, width: usize, pass: Pass<'_, '_>, scratch: &mut [f64]) -> Vec<f64> {
    by_width::<I, true, false>(tile, width, pass, scratch)
}

/// Rows of the scratch for `width` channels.
pub(super) fn lanes(width: usize) -> usize {
    width.next_power_of_two()
}

#[inline(always)]
fn by_width<I: Index, const FMA: bool, const CHECKED: bool>(
    tile: &Tile<I>,
    width: usize,
    pass: Pass<'_, '_>,
    scratch: &mut [f64],
) -> Vec<f64> {
    match width {
        1 => steps::<I, 1, 1, FMA, CHECKED>(tile, pass, scratch),
        2 => steps::<I, 2, 2, FMA, CHECKED>(tile, pass, scratch),
        3 => steps::<I, 4, 3, FMA, CHECKED>(tile, pass, scratch),
        4 => steps::<I, 4, 4, FMA, CHECKED>(tile, pass, scratch),
        _ => unreachable!("a block has 1 to 4 channels, not {width}"),
    }
}
