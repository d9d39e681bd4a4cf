//! Sums of the vectors of a pass, or of their normal components, into the bands.

use super::{MAX_DEPTH, PassTerm, TilePass, fma};

/// Number of vertices whose vectors stay in the first-level cache while the bands are accumulated one after
/// another.
const COMBINED_TOGETHER: usize = 64;

/// Interior vertices of a tile from `from` on, one per weight.
#[derive(Clone, Copy)]
struct WeightedVertices<'a> {
    from: usize,
    weights: &'a [f64],
}

/// Rows of a band, `stride` values each, of which those from `at` on are written.
struct BandRows<'a> {
    out: &'a mut [f64],
    stride: usize,
    at: usize,
}

/// Computes `out = Σ_i coefficients[i]·vectors[first + i]`, added to the present values unless the band is new, for
/// the interior vertices of `weighted`; adds `Σ_x μ(x)|out(x)|²` to `square` if requested.
#[inline(always)]
fn combine<const N: usize, const L: usize, const D: usize, const FMA: bool>(
    term: &PassTerm<'_>,
    vectors: &[&[[f64; L]]],
    weighted: WeightedVertices<'_>,
    output: BandRows<'_>,
    square: &mut f64,
) {
    let BandRows { out, stride, at } = output;
    let WeightedVertices { from, weights } = weighted;
    let a: [f64; N] = std::array::from_fn(|i| term.coefficients[i]);
    let n = weights.len();
    let v: [&[[f64; L]]; N] = std::array::from_fn(|i| &vectors[term.first + i][from..][..n]);
    for (x, out) in out.chunks_exact_mut(stride).enumerate().take(n) {
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
            *square += weights[x] * own;
        }
    }
}

#[inline(always)]
pub(super) fn combine_all<const L: usize, const D: usize, const FMA: bool>(
    pass: &mut TilePass<'_, '_>,
    vectors: &[&[[f64; L]]],
    n_own: usize,
) -> Vec<f64> {
    let (stride, at) = (pass.stride, pass.at);
    let mut squares = vec![0.0; pass.terms.len()];
    // Loops instead of closures, because a closure would be compiled without the instruction set of the surrounding
    // function.
    for from in (0..n_own).step_by(COMBINED_TOGETHER) {
        let to = (from + COMBINED_TOGETHER).min(n_own);
        let own = WeightedVertices { from, weights: &pass.weights[from..to] };
        for ((term, out), square) in pass.terms.iter().zip(&mut *pass.outs).zip(&mut squares) {
            let out = BandRows { out: &mut out[from * stride..to * stride], stride, at };
            macro_rules! unrolled {
                ($($n:literal)*) => {
                    match term.coefficients.len() {
                        $($n => combine::<$n, L, D, FMA>(term, vectors, own, out, square),)*
                        n => unreachable!("{n} terms in one pass"),
                    }
                };
            }
            unrolled!(1 2 3 4 5 6 7 8 9 10 11 12 13);
        }
    }
    squares
}

/// Number of vertices whose sums stay in registers while the vectors are added one after another.
const SUMMED_TOGETHER: usize = 16;

/// [`combine_all`] for normal components: `v·n` of each vector v is computed once for all bands.
#[inline(always)]
pub(super) fn combine_along<const L: usize, const FMA: bool>(
    pass: &mut TilePass<'_, '_>,
    vectors: &[&[[f64; L]]],
    n_own: usize,
) -> Vec<f64> {
    let mut squares = vec![0.0; pass.terms.len()];
    let mut parts = [[[0.0; SUMMED_TOGETHER]; COMBINED_TOGETHER / SUMMED_TOGETHER]; MAX_DEPTH + 1];
    for from in (0..n_own).step_by(COMBINED_TOGETHER) {
        let to = (from + COMBINED_TOGETHER).min(n_own);
        let (normals, weights) = (&pass.normals[from..to], &pass.weights[from..to]);
        for (parts, vector) in parts.iter_mut().zip(vectors) {
            for ((part, v), n) in parts.as_flattened_mut().iter_mut().zip(&vector[from..to]).zip(normals) {
                *part = fma::<FMA>(v[0], n[0], fma::<FMA>(v[1], n[1], v[2] * n[2]));
            }
        }
        for ((term, out), square) in pass.terms.iter().zip(&mut *pass.outs).zip(&mut squares) {
            let rows = out[from..to].chunks_mut(SUMMED_TOGETHER).zip(weights.chunks(SUMMED_TOGETHER));
            for (i, (out, weights)) in rows.enumerate() {
                let mut sum = [0.0; SUMMED_TOGETHER];
                if !term.is_new {
                    sum[..out.len()].copy_from_slice(out);
                }
                for (a, parts) in term.coefficients.iter().zip(&parts[term.first..]) {
                    for (sum, part) in sum.iter_mut().zip(&parts[i]) {
                        *sum = fma::<FMA>(*a, *part, *sum);
                    }
                }
                out.copy_from_slice(&sum[..out.len()]);
                if term.is_weighed {
                    for (weight, sum) in weights.iter().zip(&sum) {
                        *square += weight * sum * sum;
                    }
                }
            }
        }
    }
    squares
}
