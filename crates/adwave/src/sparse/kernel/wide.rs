//! Loops over rows of many channels, in double or single precision: 8 to 64 lanes, one after another in memory, so that
//! an entry of the operator reads whole cache lines and its weight is loaded once for all of them.

use super::number::{GROUP, VectorNumber};
use super::{FUSED, InstructionSet, fma};
use crate::pages::prefetch;
use std::ops::Range;

/// Number of entries by which rows are prefetched: neighbors are scattered over memory, which no hardware prefetcher
/// follows.
const AHEAD: usize = 8;

/// Number format of the vectors of a wide block.
pub(crate) trait WideNumber: VectorNumber {
    /// Largest number of channels of a block.
    const MAX_LANES: usize;
    /// Number of values of a cache line.
    const PER_LINE: usize;

    /// Computes the rows from `first` on, as many as `out` has, for `lanes` channels.
    fn multiply(
        target: InstructionSet,
        lanes: usize,
        rows: WideRows<'_, Self>,
        product: WideProduct<'_, Self>,
        first: usize,
        out: &mut [Self],
    );

    /// Adds terms to the rows of a sum; returns `Σ_x μ(x)|sum(x)|²`.
    fn combine(target: InstructionSet, lanes: usize, terms: WideTerms<'_, Self>, out: &mut [f64]) -> f64;
}

/// Implements [`WideNumber`] for a primitive type and its numbers of lanes.
macro_rules! wide_number {
    ($type:ident, $per_line:literal, [$($lanes:literal),*]) => {
        impl WideNumber for $type {
            const MAX_LANES: usize = 4 * $per_line;
            const PER_LINE: usize = $per_line;

            fn multiply(
                target: InstructionSet,
                lanes: usize,
                rows: WideRows<'_, Self>,
                product: WideProduct<'_, Self>,
                first: usize,
                out: &mut [Self],
            ) {
                match lanes {
                    $($lanes => multiply::<Self, $lanes>(target, rows, product, first, out),)*
                    _ => unreachable!("a block has no {lanes} lanes"),
                }
            }

            fn combine(
                target: InstructionSet,
                lanes: usize,
                terms: WideTerms<'_, Self>,
                out: &mut [f64],
            ) -> f64 {
                match lanes {
                    $($lanes => combine::<Self, $lanes>(target, terms, out),)*
                    _ => unreachable!("a block has no {lanes} lanes"),
                }
            }
        }
    };
}

wide_number!(f64, 8, [8, 16, 24, 32]);
wide_number!(f32, 16, [16, 32, 48, 64]);

/// Rows of Φ₁ without its diagonal.
#[derive(Clone, Copy)]
pub(crate) struct WideRows<'a, T> {
    /// Start of each row, and the end of the last.
    pub(crate) offsets: &'a [usize],
    pub(crate) columns: &'a [u32],
    /// Entries in the format of the vectors.
    pub(crate) weights: &'a [T],
    /// Entries in double precision, for the first difference.
    pub(crate) exact_weights: &'a [f64],
    /// True if every row of Φ₁ has the diagonal ½, or no entries at all.
    pub(crate) is_lazy: bool,
}

/// Product of some consecutive rows of Φ₁ with a block.
#[derive(Clone, Copy)]
pub(crate) enum WideProduct<'a, T> {
    /// `scale·u = scale·(I − Φ₁)f` of the values f of all vertices, computed in double precision.
    Difference { signal: &'a [f64], scale: f64 },
    /// `T_{k+1} = scale·(Φ₁ − ½)T_k − T_{k−1}`, where the rows of the output hold `T_{k−1}` unless it is given.
    Step { before: Option<&'a [T]>, now: &'a [T], scale: f64 },
}

/// Terms of some rows that are added to a sum.
#[derive(Clone, Copy)]
pub(crate) struct WideTerms<'a, T> {
    /// One coefficient per vector.
    pub(crate) coefficients: &'a [f64],
    /// The rows of each vector, rows × lanes.
    pub(crate) vectors: &'a [&'a [T]],
    /// Weight μ of each row.
    pub(crate) weights: &'a [f64],
    /// True if the sum starts here.
    pub(crate) is_new: bool,
    /// First channel of the block in the sum, number of channels of the block and of the sum.
    pub(crate) at: usize,
    pub(crate) width: usize,
    pub(crate) stride: usize,
}

fn combine<T: WideNumber, const L: usize>(
    target: InstructionSet,
    terms: WideTerms<'_, T>,
    out: &mut [f64],
) -> f64 {
    match target {
        InstructionSet::Portable => combine_rows::<T, L, FUSED>(terms, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor; AVX-512 implies them.
        InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { combine_avx2::<T, L>(terms, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn combine_avx2<T: WideNumber, const L: usize>(terms: WideTerms<'_, T>, out: &mut [f64]) -> f64 {
    combine_rows::<T, L, true>(terms, out)
}

#[inline(always)]
fn combine_rows<T: WideNumber, const L: usize, const FMA: bool>(
    terms: WideTerms<'_, T>,
    out: &mut [f64],
) -> f64 {
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
                sum[c] = fma::<FMA>(a, v[c].to_f64(), sum[c]);
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

fn multiply<T: WideNumber, const L: usize>(
    target: InstructionSet,
    rows: WideRows<'_, T>,
    product: WideProduct<'_, T>,
    first: usize,
    out: &mut [T],
) {
    match target {
        InstructionSet::Portable => body::<T, L, FUSED>(rows, product, first, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor.
        InstructionSet::Avx2 => unsafe { avx2::<T, L>(rows, product, first, out) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX-512F and AVX-512VL on this processor, which imply AVX2 and
        // FMA.
        InstructionSet::Avx512 => unsafe { avx512::<T, L>(rows, product, first, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<T: WideNumber, const L: usize>(
    rows: WideRows<'_, T>,
    product: WideProduct<'_, T>,
    first: usize,
    out: &mut [T],
) {
    body::<T, L, true>(rows, product, first, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn avx512<T: WideNumber, const L: usize>(
    rows: WideRows<'_, T>,
    product: WideProduct<'_, T>,
    first: usize,
    out: &mut [T],
) {
    body::<T, L, true>(rows, product, first, out);
}

#[inline(always)]
fn body<T: WideNumber, const L: usize, const FMA: bool>(
    rows: WideRows<'_, T>,
    product: WideProduct<'_, T>,
    first: usize,
    out: &mut [T],
) {
    let out = out.as_chunks_mut::<L>().0;
    match product {
        WideProduct::Difference { signal, scale } => {
            difference::<T, L, FMA>(rows, signal.as_chunks::<L>().0, scale, first, out);
        }
        WideProduct::Step { before, now, scale } => {
            let before = before.map(|before| before.as_chunks::<L>().0);
            let input = StepInput { before, now: now.as_chunks::<L>().0, scale: T::rounded(scale, 1.0) };
            if rows.is_lazy {
                step::<T, L, FMA, true>(rows, input, first, out);
            } else {
                step::<T, L, FMA, false>(rows, input, first, out);
            }
        }
    }
}

#[inline(always)]
fn difference<T: WideNumber, const L: usize, const FMA: bool>(
    rows: WideRows<'_, T>,
    signal: &[[f64; L]],
    scale: f64,
    first: usize,
    out: &mut [[T; L]],
) {
    for (x, out) in (first..).zip(out) {
        let range = rows.offsets[x]..rows.offsets[x + 1];
        let here = signal[x];
        let mut sum = [0.0; L];
        for e in range {
            fetch_ahead(rows.columns, signal, e + AHEAD);
            let (there, w) = (&signal[rows.columns[e] as usize], rows.exact_weights[e]);
            for c in 0..L {
                sum[c] = fma::<FMA>(w, here[c] - there[c], sum[c]);
            }
        }
        for (out, v) in out.iter_mut().zip(sum) {
            *out = T::rounded(v, scale);
        }
    }
}

/// `T_{k−1}`, unless the output holds it, and `T_k`.
#[derive(Clone, Copy)]
struct StepInput<'a, T, const L: usize> {
    before: Option<&'a [[T; L]]>,
    now: &'a [[T; L]],
    scale: T,
}

#[inline(always)]
fn step<T: WideNumber, const L: usize, const FMA: bool, const LAZY: bool>(
    rows: WideRows<'_, T>,
    input: StepInput<'_, T, L>,
    first: usize,
    out: &mut [[T; L]],
) {
    let StepInput { before, now, scale } = input;
    let (minus_quarter, half) = (T::rounded(-0.25, 1.0), T::rounded(0.5, 1.0));
    for (x, out) in (first..).zip(out) {
        let range = rows.offsets[x]..rows.offsets[x + 1];
        let mut sum = before.map_or(*out, |before| before[x]);
        for v in &mut sum {
            *v = v.times(minus_quarter);
        }
        let here = if LAZY { [T::default(); L] } else { now[x] };
        if !LAZY {
            for c in 0..L {
                sum[c] = half.times_plus::<FMA>(here[c], sum[c]);
            }
        }
        if T::IS_GROUPED {
            let mut start = range.start;
            while start < range.end {
                let end = (start + GROUP).min(range.end);
                let mut part = [T::default(); L];
                add_entries::<T, L, FMA, LAZY>(rows, start..end, now, &here, &mut part);
                for c in 0..L {
                    sum[c] = sum[c].plus(part[c]);
                }
                start = end;
            }
        } else {
            add_entries::<T, L, FMA, LAZY>(rows, range, now, &here, &mut sum);
        }
        for (out, v) in out.iter_mut().zip(sum) {
            *out = scale.times(v);
        }
    }
}

/// Adds the products of some entries of a row.
#[inline(always)]
fn add_entries<T: WideNumber, const L: usize, const FMA: bool, const LAZY: bool>(
    rows: WideRows<'_, T>,
    entries: Range<usize>,
    now: &[[T; L]],
    here: &[T; L],
    sum: &mut [T; L],
) {
    for e in entries {
        fetch_ahead(rows.columns, now, e + AHEAD);
        let (there, w) = (&now[rows.columns[e] as usize], rows.weights[e]);
        for c in 0..L {
            let moved = if LAZY { there[c] } else { there[c].minus(here[c]) };
            sum[c] = w.times_plus::<FMA>(moved, sum[c]);
        }
    }
}

/// Prefetches the row of an entry, if there is such an entry.
#[inline(always)]
fn fetch_ahead<T: WideNumber, const L: usize>(columns: &[u32], x: &[[T; L]], e: usize) {
    if let Some(&column) = columns.get(e) {
        prefetch(x, column as usize);
    }
}
