//! Loops over rows of many channels: 8 to 32 lanes, one after another in memory, so that an entry of the operator reads
//! whole cache lines and its weight is loaded once for all of them.

use super::{FUSED, InstructionSet, fma};

/// Largest number of channels of a block.
pub(crate) const MAX_LANES: usize = 32;

/// Number of entries by which rows are prefetched: neighbors are scattered over memory, which no hardware prefetcher
/// follows.
const AHEAD: usize = 8;

/// Rows of Φ₁ without its diagonal.
#[derive(Clone, Copy)]
pub(crate) struct WideRows<'a> {
    /// Start of each row, and the end of the last.
    pub(crate) offsets: &'a [usize],
    pub(crate) columns: &'a [u32],
    pub(crate) weights: &'a [f64],
    /// True if every row of Φ₁ has the diagonal ½, or no entries at all.
    pub(crate) is_lazy: bool,
}

/// Product of some consecutive rows of Φ₁ with a block.
#[derive(Clone, Copy)]
pub(crate) enum WideProduct<'a> {
    /// `u = (I − Φ₁)f` of the values f of all vertices.
    Difference { signal: &'a [f64] },
    /// `T_{k+1} = scale·(Φ₁ − ½)T_k − T_{k−1}`, where the rows of the output hold `T_{k−1}` unless it is given.
    Step { before: Option<&'a [f64]>, now: &'a [f64], scale: f64 },
}

/// Terms of some rows that are added to a sum.
#[derive(Clone, Copy)]
pub(crate) struct WideTerms<'a> {
    /// One coefficient per vector.
    pub(crate) coefficients: &'a [f64],
    /// The rows of each vector, rows × lanes.
    pub(crate) vectors: &'a [&'a [f64]],
    /// Weight μ of each row.
    pub(crate) weights: &'a [f64],
    /// True if the sum starts here.
    pub(crate) is_new: bool,
    /// First channel of the block in the sum, number of channels of the block and of the sum.
    pub(crate) at: usize,
    pub(crate) width: usize,
    pub(crate) stride: usize,
}

/// Adds terms to the rows of a sum; returns `Σ_x μ(x)|sum(x)|²`.
pub(crate) fn combine_wide(
    target: InstructionSet,
    lanes: usize,
    terms: WideTerms<'_>,
    out: &mut [f64],
) -> f64 {
    match lanes {
        8 => combine::<8>(target, terms, out),
        16 => combine::<16>(target, terms, out),
        24 => combine::<24>(target, terms, out),
        32 => combine::<32>(target, terms, out),
        _ => unreachable!("a block has 8, 16, 24 or 32 lanes, not {lanes}"),
    }
}

fn combine<const L: usize>(target: InstructionSet, terms: WideTerms<'_>, out: &mut [f64]) -> f64 {
    match target {
        InstructionSet::Portable => combine_rows::<L, FUSED>(terms, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor; AVX-512 implies them.
        InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { combine_avx2::<L>(terms, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn combine_avx2<const L: usize>(terms: WideTerms<'_>, out: &mut [f64]) -> f64 {
    combine_rows::<L, true>(terms, out)
}

#[inline(always)]
fn combine_rows<const L: usize, const FMA: bool>(terms: WideTerms<'_>, out: &mut [f64]) -> f64 {
    let WideTerms { coefficients, vectors, weights, is_new, at, width, stride } = terms;
    let mut square = 0.0;
    for (r, out) in out.chunks_exact_mut(stride).enumerate() {
        let out = &mut out[at..at + width];
        let mut sum = [0.0; L];
        if !is_new {
            match out.first_chunk::<L>() {
                Some(whole) => sum = *whole,
                None => sum[..width].copy_from_slice(out),
            }
        }
        for (&a, vector) in coefficients.iter().zip(vectors) {
            let v = &vector.as_chunks::<L>().0[r];
            for c in 0..L {
                sum[c] = fma::<FMA>(a, v[c], sum[c]);
            }
        }
        match out.first_chunk_mut::<L>() {
            Some(whole) => *whole = sum,
            None => out.copy_from_slice(&sum[..width]),
        }
        let mut own = 0.0;
        for v in sum {
            own = fma::<FMA>(v, v, own);
        }
        square = fma::<FMA>(weights[r], own, square);
    }
    square
}

/// Computes the rows from `first` on, as many as `out` has, for `lanes` channels.
pub(crate) fn multiply_wide(
    target: InstructionSet,
    lanes: usize,
    rows: WideRows<'_>,
    product: WideProduct<'_>,
    first: usize,
    out: &mut [f64],
) {
    match lanes {
        8 => multiply::<8>(target, rows, product, first, out),
        16 => multiply::<16>(target, rows, product, first, out),
        24 => multiply::<24>(target, rows, product, first, out),
        32 => multiply::<32>(target, rows, product, first, out),
        _ => unreachable!("a block has 8, 16, 24 or 32 lanes, not {lanes}"),
    }
}

fn multiply<const L: usize>(
    target: InstructionSet,
    rows: WideRows<'_>,
    product: WideProduct<'_>,
    first: usize,
    out: &mut [f64],
) {
    match target {
        InstructionSet::Portable => body::<L, FUSED>(rows, product, first, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor.
        InstructionSet::Avx2 => unsafe { avx2::<L>(rows, product, first, out) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX-512F and AVX-512VL on this processor, which imply AVX2 and FMA.
        InstructionSet::Avx512 => unsafe { avx512::<L>(rows, product, first, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<const L: usize>(rows: WideRows<'_>, product: WideProduct<'_>, first: usize, out: &mut [f64]) {
    body::<L, true>(rows, product, first, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn avx512<const L: usize>(rows: WideRows<'_>, product: WideProduct<'_>, first: usize, out: &mut [f64]) {
    body::<L, true>(rows, product, first, out);
}

#[inline(always)]
fn body<const L: usize, const FMA: bool>(
    rows: WideRows<'_>,
    product: WideProduct<'_>,
    first: usize,
    out: &mut [f64],
) {
    let out = out.as_chunks_mut::<L>().0;
    match product {
        WideProduct::Difference { signal } => {
            difference::<L, FMA>(rows, signal.as_chunks::<L>().0, first, out);
        }
        WideProduct::Step { before, now, scale } => {
            let before = before.map(|before| before.as_chunks::<L>().0);
            let input = StepInput { before, now: now.as_chunks::<L>().0, scale };
            if rows.is_lazy {
                step::<L, FMA, true>(rows, input, first, out);
            } else {
                step::<L, FMA, false>(rows, input, first, out);
            }
        }
    }
}

#[inline(always)]
fn difference<const L: usize, const FMA: bool>(
    rows: WideRows<'_>,
    signal: &[[f64; L]],
    first: usize,
    out: &mut [[f64; L]],
) {
    for (x, out) in (first..).zip(out) {
        let range = rows.offsets[x]..rows.offsets[x + 1];
        let here = signal[x];
        let mut sum = [0.0; L];
        for e in range {
            fetch_ahead(rows.columns, signal, e + AHEAD);
            let (there, w) = (&signal[rows.columns[e] as usize], rows.weights[e]);
            for c in 0..L {
                sum[c] = fma::<FMA>(w, here[c] - there[c], sum[c]);
            }
        }
        *out = sum;
    }
}

/// `T_{k−1}`, unless the output holds it, and `T_k`.
#[derive(Clone, Copy)]
struct StepInput<'a, const L: usize> {
    before: Option<&'a [[f64; L]]>,
    now: &'a [[f64; L]],
    scale: f64,
}

#[inline(always)]
fn step<const L: usize, const FMA: bool, const LAZY: bool>(
    rows: WideRows<'_>,
    input: StepInput<'_, L>,
    first: usize,
    out: &mut [[f64; L]],
) {
    let StepInput { before, now, scale } = input;
    for (x, out) in (first..).zip(out) {
        let range = rows.offsets[x]..rows.offsets[x + 1];
        let mut sum = before.map_or(*out, |before| before[x]);
        for v in &mut sum {
            *v *= -0.25;
        }
        let here = if LAZY { [0.0; L] } else { now[x] };
        if !LAZY {
            for c in 0..L {
                sum[c] = fma::<FMA>(0.5, here[c], sum[c]);
            }
        }
        for e in range {
            fetch_ahead(rows.columns, now, e + AHEAD);
            let (there, w) = (&now[rows.columns[e] as usize], rows.weights[e]);
            for c in 0..L {
                let moved = if LAZY { there[c] } else { there[c] - here[c] };
                sum[c] = fma::<FMA>(w, moved, sum[c]);
            }
        }
        for (out, v) in out.iter_mut().zip(sum) {
            *out = scale * v;
        }
    }
}

/// Prefetches the row of an entry, if there is such an entry.
#[inline(always)]
fn fetch_ahead<const L: usize>(columns: &[u32], x: &[[f64; L]], e: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(row) = columns.get(e).and_then(|&column| x.get(column as usize)) {
        for line in row.as_chunks::<8>().0 {
            let start: *const [f64; 8] = line;
            // SAFETY: the instruction is a hint; it neither reads nor writes for the program, whatever the address.
            unsafe {
                use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
                _mm_prefetch::<_MM_HINT_T0>(start.cast());
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (columns, x, e);
}
