//! A product with the compressed rows as they are.

use super::{FUSED, Target, fma};

/// Rows `first ..` of a walk, as many as `out` has, and the block of channels they are applied to.
pub(crate) struct Rows<'a> {
    /// Where each row starts, and the end of the last.
    pub(crate) offsets: &'a [usize],
    pub(crate) columns: &'a [u32],
    pub(crate) weights: &'a [f64],
    pub(crate) first: usize,
    /// n_vertices × D.
    pub(crate) x: &'a [f64],
}

impl Rows<'_> {
    /// Asserts what the unchecked loops rely on for these rows.
    fn assert_consistent<const D: usize>(&self, n_rows: usize) -> usize {
        let n = self.x.len() / D;
        assert!(self.first + n_rows <= n && n < self.offsets.len());
        assert_eq!(self.columns.len(), self.weights.len());
        n
    }
}

/// `out = x + Σ_y w·(x_y − x)` for `D` channels.
pub(crate) fn apply_rows<const D: usize>(target: Target, rows: &Rows<'_>, out: &mut [f64]) {
    match target {
        Target::Portable => body::<D, FUSED, true>(rows, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Target::detect` has found AVX2 and FMA on this processor.
        Target::Avx2 | Target::Avx512 => unsafe { avx2::<D>(rows, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<const D: usize>(rows: &Rows<'_>, out: &mut [f64]) {
    body::<D, true, false>(rows, out);
}

#[inline(always)]
fn body<const D: usize, const FMA: bool, const CHECKED: bool>(rows: &Rows<'_>, out: &mut [f64]) {
    let out = out.as_chunks_mut::<D>().0;
    rows.assert_consistent::<D>(out.len());
    let x = rows.x.as_chunks::<D>().0;
    for (row, out) in (rows.first..).zip(out) {
        let range = rows.offsets[row]..rows.offsets[row + 1];
        let (columns, weights) = (&rows.columns[range.clone()], &rows.weights[range]);
        let here = x[row];
        if !CHECKED {
            fetch_ahead::<D>(rows.columns, x, rows.offsets[row] + AHEAD, columns.len());
        }
        macro_rules! unrolled {
            ($($degree:literal)*) => {
                match columns.len() {
                    $($degree => fixed::<$degree, D, FMA, CHECKED>(columns, weights, x, here),)*
                    _ => any::<D, FMA, CHECKED>(columns, weights, x, here),
                }
            };
        }
        *out = unrolled!(4 5 6 7 8);
    }
}

/// How many entries ahead vertices are asked for. Neighbors lie on several strands of memory that no hardware follows:
/// asking some 80 rows of a mesh ahead takes a quarter off the time of a product.
const AHEAD: usize = 512;

/// Asks for the vertices of `n` columns from `at` on, so that they are in the cache when their turn comes.
#[inline(always)]
fn fetch_ahead<const D: usize>(columns: &[u32], x: &[[f64; D]], at: usize, n: usize) {
    if let Some(columns) = columns.get(at..at + n) {
        for &column in columns {
            let there: *const [f64; D] = vertex::<D, false>(x, column);
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the instruction is a hint; it neither reads nor writes for the program, whatever the address.
            unsafe {
                use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
                _mm_prefetch::<_MM_HINT_T0>(there.cast());
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = there;
        }
    }
}

#[inline(always)]
fn fixed<const DEGREE: usize, const D: usize, const FMA: bool, const CHECKED: bool>(
    columns: &[u32],
    weights: &[f64],
    x: &[[f64; D]],
    here: [f64; D],
) -> [f64; D] {
    let columns: &[u32; DEGREE] = columns.first_chunk().expect("a row of this degree");
    let weights: &[f64; DEGREE] = weights.first_chunk().expect("a row of this degree");
    let mut moved = [0.0; D];
    for e in 0..DEGREE {
        let there = vertex::<D, CHECKED>(x, columns[e]);
        for c in 0..D {
            moved[c] = fma::<FMA>(weights[e], there[c] - here[c], moved[c]);
        }
    }
    std::array::from_fn(|c| here[c] + moved[c])
}

#[inline(always)]
fn any<const D: usize, const FMA: bool, const CHECKED: bool>(
    columns: &[u32],
    weights: &[f64],
    x: &[[f64; D]],
    here: [f64; D],
) -> [f64; D] {
    let mut moved = [0.0; D];
    for (&column, &w) in columns.iter().zip(weights) {
        let there = vertex::<D, CHECKED>(x, column);
        for c in 0..D {
            moved[c] = fma::<FMA>(w, there[c] - here[c], moved[c]);
        }
    }
    std::array::from_fn(|c| here[c] + moved[c])
}

#[inline(always)]
fn vertex<const D: usize, const CHECKED: bool>(x: &[[f64; D]], column: u32) -> &[f64; D] {
    if CHECKED {
        &x[column as usize]
    } else {
        debug_assert!((column as usize) < x.len());
        // SAFETY: a `Diffusion` has no column beyond its rows, which its constructors check, and `body` has found x to be
        // as long as the rows.
        unsafe { x.get_unchecked(column as usize) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unchecked_loops_give_the_bits_of_checked_ones() {
        // Rows of 0 … 11 entries.
        let (mut offsets, mut columns, mut weights) = (vec![0], Vec::new(), Vec::new());
        for row in 0..12_usize {
            for e in 0..row {
                columns.push(((row * 5 + e * 7) % 12) as u32);
                weights.push(1.0 / (2.0 + (row + e) as f64));
            }
            offsets.push(columns.len());
        }
        let x: Vec<f64> = (0..36).map(|i| f64::from(i * i % 17) + 0.1).collect();
        let rows = Rows { offsets: &offsets, columns: &columns, weights: &weights, first: 0, x: &x };
        let (mut safe, mut fast, mut chosen) = (vec![0.0; 36], vec![0.0; 36], vec![0.0; 36]);
        body::<3, true, true>(&rows, &mut safe);
        body::<3, true, false>(&rows, &mut fast);
        assert_eq!(safe, fast);
        apply_rows::<3>(Target::detect(), &rows, &mut chosen);
        for (a, b) in safe.iter().zip(&chosen) {
            assert!((a - b).abs() <= 1e-15 * a.abs().max(1.0), "{a} and {b}");
        }
    }
}
