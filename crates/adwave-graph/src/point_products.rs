//! Products of points with blocks of others in single precision, compared with a threshold while they are in registers.

use pulp::{Simd, WithSimd};

/// Queries of a tile; a tile has two vectors of others for each.
pub(crate) const TILE: usize = 6;

/// Queries as tiles of [`TILE`] points, and others coordinate by coordinate.
pub(crate) struct NearVisit<'a, F> {
    /// Negative coordinates, n_tiles × n_dimensions × [`TILE`].
    pub(crate) queries: &'a [f32],
    /// Coordinates of the others and then the halves of their squared norms, (n_dimensions + 1) × `n_others`.
    pub(crate) others: &'a [f32],
    /// Number of others, a multiple of all vector lengths.
    pub(crate) n_others: usize,
    /// Threshold of each query; those that are left out have −∞.
    pub(crate) thresholds: &'a mut [f32],
    /// Called with a query, another and their product if it is at most the threshold; returns the new threshold.
    pub(crate) each: F,
}

impl<F: FnMut(usize, usize, f32) -> f32> WithSimd for NearVisit<'_, F> {
    type Output = ();

    #[expect(
        clippy::inline_always,
        reason = "the instructions of the dispatch apply to what is inlined into it"
    )]
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { queries, others, n_others, thresholds, mut each } = self;
        let width = 2 * S::F32_LANES;
        let n_dimensions = others.len() / n_others - 1;
        let mut values = [[0.0_f32; MOST_LANES]; TILE];
        for at in (0..n_others).step_by(width) {
            for (tile, coordinates) in queries.chunks_exact(TILE * n_dimensions).enumerate() {
                let thresholds = &mut thresholds[tile * TILE..][..TILE];
                if thresholds.iter().all(|&threshold| threshold == f32::NEG_INFINITY) {
                    continue;
                }
                let sums = tile_sums(simd, coordinates, &others[at..], n_others);
                let mut is_any = false;
                for (sums, &threshold) in sums.iter().zip(&*thresholds) {
                    let threshold = simd.splat_f32s(threshold);
                    for &sum in sums {
                        let mask = simd.less_than_or_equal_f32s(sum, threshold);
                        is_any |= simd.first_true_m32s(mask) < S::F32_LANES;
                    }
                }
                if !is_any {
                    continue;
                }
                for (values, sums) in values.iter_mut().zip(sums) {
                    let (vectors, _) = S::as_mut_simd_f32s(&mut values[..width]);
                    vectors.copy_from_slice(&sums);
                }
                for (q, values) in values.iter().enumerate() {
                    for (i, &value) in values[..width].iter().enumerate() {
                        if value <= thresholds[q] {
                            thresholds[q] = each(tile * TILE + q, at + i, value);
                        }
                    }
                }
            }
        }
    }
}

/// Largest number of single-precision numbers of two vectors.
const MOST_LANES: usize = 32;

/// `½‖y‖² − x·y` for the queries x of a tile and two vectors of others y.
#[expect(clippy::inline_always, reason = "the instructions of the dispatch apply to what is inlined into it")]
#[inline(always)]
fn tile_sums<S: Simd>(simd: S, queries: &[f32], others: &[f32], n_others: usize) -> [[S::f32s; 2]; TILE] {
    let vectors = |row: usize| {
        let (vectors, _) = S::as_simd_f32s(&others[row * n_others..][..2 * S::F32_LANES]);
        [vectors[0], vectors[1]]
    };
    let (queries, _) = queries.as_chunks::<TILE>();
    let mut sums = [vectors(queries.len()); TILE];
    for (row, coordinates) in queries.iter().enumerate() {
        let others = vectors(row);
        for (sums, &x) in sums.iter_mut().zip(coordinates) {
            let x = simd.splat_f32s(x);
            for (sum, y) in sums.iter_mut().zip(others) {
                *sum = simd.mul_add_e_f32s(x, y, *sum);
            }
        }
    }
    sums
}
