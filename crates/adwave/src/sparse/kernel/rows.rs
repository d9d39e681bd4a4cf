//! Product with compressed rows without tiles.

use super::{FUSED, InstructionSet, fma};

/// Rows of a walk from `first` on, as many as the output has, and the block of channels to which they are applied.
pub(crate) struct RowProduct<'a> {
    /// Start of each row, and the end of the last.
    pub(crate) offsets: &'a [usize],
    pub(crate) columns: &'a [u32],
    pub(crate) weights: &'a [f64],
    pub(crate) first: usize,
    /// Input values, n_vertices × D.
    pub(crate) x: &'a [f64],
}

impl RowProduct<'_> {
    /// Checks the sizes that the unchecked loops rely on.
    fn assert_consistent<const D: usize>(&self, n_rows: usize) -> usize {
        let n = self.x.len() / D;
        assert!(self.first + n_rows <= n && n < self.offsets.len());
        assert_eq!(self.columns.len(), self.weights.len());
        n
    }
}

/// Computes `out = x + Σ_y w·(x_y − x)` for `D` channels.
pub(crate) fn apply_rows<const D: usize>(target: InstructionSet, rows: &RowProduct<'_>, out: &mut [f64]) {
    match target {
        InstructionSet::Portable => body::<D, FUSED, true>(rows, out),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor.
        InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { avx2::<D>(rows, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<const D: usize>(rows: &RowProduct<'_>, out: &mut [f64]) {
    body::<D, true, false>(rows, out);
}

#[inline(always)]
fn body<const D: usize, const FMA: bool, const CHECKED: bool>(rows: &RowProduct<'_>, out: &mut [f64]) {
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

/// Number of entries by which vertices are prefetched. Neighbors are scattered over memory, which no hardware
/// prefetcher follows; prefetching about 80 rows of a mesh ahead saves a quarter of the time of a product.
const AHEAD: usize = 512;

/// Prefetches the vertices of `n` columns from `at` on.
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
    for c in 0..D {
        moved[c] += here[c];
    }
    moved
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
    for c in 0..D {
        moved[c] += here[c];
    }
    moved
}

#[inline(always)]
fn vertex<const D: usize, const CHECKED: bool>(x: &[[f64; D]], column: u32) -> &[f64; D] {
    if CHECKED {
        &x[column as usize]
    } else {
        debug_assert!((column as usize) < x.len());
        // SAFETY: a `Diffusion` has no column beyond its rows, which its constructors check, and `body` has checked
        // that x is as long as the rows.
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
        let rows = RowProduct { offsets: &offsets, columns: &columns, weights: &weights, first: 0, x: &x };
        let (mut safe, mut fast, mut chosen) = (vec![0.0; 36], vec![0.0; 36], vec![0.0; 36]);
        body::<3, true, true>(&rows, &mut safe);
        body::<3, true, false>(&rows, &mut fast);
        assert_eq!(safe, fast);
        apply_rows::<3>(InstructionSet::detect(), &rows, &mut chosen);
        for (a, b) in safe.iter().zip(&chosen) {
            assert!((a - b).abs() <= 1e-15 * a.abs().max(1.0), "{a} and {b}");
        }
    }
}
