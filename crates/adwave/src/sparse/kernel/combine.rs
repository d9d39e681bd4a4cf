//! Sums of the vectors of a pass, or of their normal components, into the bands.

use super::{MAX_DEPTH, PassTerm, TilePass, VectorNumber, fma};

/// Number of vertices whose vectors stay in the first-level cache while the bands are accumulated one after
/// another.
const COMBINED_TOGETHER: usize = 32;

/// Number of values whose sums stay in registers while the vectors are added one after another.
const SUMMED_TOGETHER: usize = 16;

/// Number of such groups of values of up to four channels.
const GROUPS: usize = 4 * COMBINED_TOGETHER / SUMMED_TOGETHER;

/// Values of a vector at some vertices in double precision, one vertex after another without gaps.
type VectorParts = [[f64; SUMMED_TOGETHER]; GROUPS];

/// Adds `Σ_i coefficients[i]·vectors[first + i]` to each band at the interior vertices, or sets the band to it if it is
/// new, in double precision; returns `Σ_x μ(x)|band(x)|²` of each band for which it is requested.
///
/// Each vector is brought into double precision, or to its normal component, once for all bands.
#[inline(always)]
pub(super) fn combine<T: VectorNumber, const L: usize, const D: usize, const FMA: bool>(
    pass: &mut TilePass<'_, '_, T>,
    vectors: &[&[[T; L]]],
    n_own: usize,
) -> Vec<f64> {
    let (stride, at) = (pass.stride, pass.at);
    let width = if pass.normals.is_empty() { D } else { 1 };
    let first = pass.terms.iter().map(|term| term.first).min().unwrap_or(0);
    let end = pass.terms.iter().map(|term| term.first + term.coefficients.len()).max().unwrap_or(0);
    let mut squares = vec![0.0; pass.terms.len()];
    let mut parts = [[[0.0; SUMMED_TOGETHER]; GROUPS]; MAX_DEPTH + 1];
    let mut gathered = [0.0; 4 * COMBINED_TOGETHER];
    // Loops instead of closures, because a closure would be compiled without the instruction set of the surrounding
    // function.
    for from in (0..n_own).step_by(COMBINED_TOGETHER) {
        let to = (from + COMBINED_TOGETHER).min(n_own);
        for (parts, vector) in parts[first..end].iter_mut().zip(&vectors[first..end]) {
            let parts = parts.as_flattened_mut();
            if pass.normals.is_empty() {
                for (part, v) in parts.as_chunks_mut::<D>().0.iter_mut().zip(&vector[from..to]) {
                    for c in 0..D {
                        part[c] = v[c].to_f64();
                    }
                }
            } else {
                for ((part, v), n) in parts.iter_mut().zip(&vector[from..to]).zip(&pass.normals[from..to]) {
                    let [a, b, c] = [v[0].to_f64(), v[1].to_f64(), v[2].to_f64()];
                    *part = fma::<FMA>(a, n[0], fma::<FMA>(b, n[1], c * n[2]));
                }
            }
        }
        for ((term, out), square) in pass.terms.iter().zip(&mut *pass.outs).zip(&mut squares) {
            let out = &mut out[from * stride..to * stride];
            let parts = &parts[term.first..];
            let sum: &[f64] = if stride == width {
                add_terms::<FMA>(term, parts, out);
                out
            } else {
                // Some of the channels of the band.
                let gathered = &mut gathered[..(to - from) * width];
                for (to, out) in gathered.chunks_exact_mut(width).zip(out.chunks_exact(stride)) {
                    to.copy_from_slice(&out[at..at + width]);
                }
                add_terms::<FMA>(term, parts, gathered);
                for (from, out) in gathered.chunks_exact(width).zip(out.chunks_exact_mut(stride)) {
                    out[at..at + width].copy_from_slice(from);
                }
                gathered
            };
            if term.is_weighed {
                let weights = &pass.weights[from..to];
                if pass.normals.is_empty() {
                    for (weight, row) in weights.iter().zip(sum.as_chunks::<D>().0) {
                        let own: f64 = row.iter().map(|s| s * s).sum();
                        *square += weight * own;
                    }
                } else {
                    for (weight, s) in weights.iter().zip(sum) {
                        *square += weight * s * s;
                    }
                }
            }
        }
    }
    squares
}

/// Adds the terms to the values of a band.
#[inline(always)]
fn add_terms<const FMA: bool>(term: &PassTerm, parts: &[VectorParts], out: &mut [f64]) {
    let (whole, rest) = out.as_chunks_mut::<SUMMED_TOGETHER>();
    let n_whole = whole.len();
    for (i, out) in whole.iter_mut().enumerate() {
        let start = if term.is_new { [0.0; SUMMED_TOGETHER] } else { *out };
        *out = with_terms::<FMA>(term, parts, i, start);
    }
    if !rest.is_empty() {
        let mut start = [0.0; SUMMED_TOGETHER];
        if !term.is_new {
            start[..rest.len()].copy_from_slice(rest);
        }
        rest.copy_from_slice(&with_terms::<FMA>(term, parts, n_whole, start)[..rest.len()]);
    }
}

/// The sum of `start` and the terms for one group of values.
#[inline(always)]
fn with_terms<const FMA: bool>(
    term: &PassTerm,
    parts: &[VectorParts],
    group: usize,
    start: [f64; SUMMED_TOGETHER],
) -> [f64; SUMMED_TOGETHER] {
    let mut sum = start;
    for (&a, parts) in term.coefficients.iter().zip(parts) {
        let part = &parts[group];
        for c in 0..SUMMED_TOGETHER {
            sum[c] = fma::<FMA>(a, part[c], sum[c]);
        }
    }
    sum
}
