//! One step of the recurrence of directions for the rows of a tile.

use super::{FUSED, InstructionSet, fma, get, get_mut, range};
use crate::sparse::tiles::{Index, TileView};

/// Rows of a tile with entries that turn: those of the interior, then those of the rings 1 … `n_rings`.
#[derive(Clone, Copy)]
pub(crate) struct TurnedRows<'a, I> {
    pub(crate) tile: TileView<'a, I>,
    pub(crate) n_rings: usize,
    /// `2Φ₁(x,y)·R_xy` as complex numbers, in the order of the tile.
    pub(crate) entries: &'a [[f64; 2]],
    /// `1 − 2Σ_y Φ₁(x,y)` of each row, in the order of the tile.
    pub(crate) diagonals: &'a [f64],
    /// True for `T_1 = Y·T_0`; later `T_{k+1} = 2Y·T_k − T_{k−1}`.
    pub(crate) is_first: bool,
}

impl<I: Index> TurnedRows<'_, I> {
    /// Checks the sizes that the unchecked loops rely on.
    fn assert_consistent(&self, now: &[[f64; 2]], before: &[[f64; 2]]) {
        let tile = self.tile;
        assert!(now.len() >= tile.n_within(self.n_rings + 1) && before.len() >= tile.n_within(self.n_rings));
        assert!(self.diagonals.len() >= tile.n_within(self.n_rings));
        let runs = tile.own_runs().iter().chain(tile.ring_runs(self.n_rings));
        let n_entries: usize = runs.map(|run| run.degree as usize * run.n_rows as usize).sum();
        assert!(self.entries.len() >= n_entries && tile.columns().len() >= n_entries);
    }
}

/// Overwrites `before`, `T_{k−1}`, by `T_{k+1}` in the rows; `now` is `T_k` there and in a further ring.
pub(crate) fn turned_step<I: Index>(
    target: InstructionSet,
    rows: TurnedRows<'_, I>,
    now: &[[f64; 2]],
    before: &mut [[f64; 2]],
) {
    match target {
        InstructionSet::Portable => body::<I, FUSED, true>(rows, now, before),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `InstructionSet::detect` has found AVX2 and FMA on this processor.
        InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { avx2(rows, now, before) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<I: Index>(rows: TurnedRows<'_, I>, now: &[[f64; 2]], before: &mut [[f64; 2]]) {
    body::<I, true, false>(rows, now, before);
}

#[inline(always)]
fn body<I: Index, const FMA: bool, const CHECKED: bool>(
    rows: TurnedRows<'_, I>,
    now: &[[f64; 2]],
    before: &mut [[f64; 2]],
) {
    rows.assert_consistent(now, before);
    let (tile, columns) = (rows.tile, rows.tile.columns());
    let (mut row, mut entry) = (0, 0);
    let runs = tile.own_runs().iter().chain(tile.ring_runs(rows.n_rings));
    for run in runs {
        let degree = run.degree as usize;
        for _ in 0..run.n_rows {
            // Rows of the rings are numbered in their order.
            let x = if row < tile.n_own() { get::<_, CHECKED>(tile.rows(), row).get() } else { row };
            let own = range::<_, CHECKED>(rows.entries, entry, degree);
            let columns = range::<_, CHECKED>(columns, entry, degree);
            let [real, imaginary] = match degree {
                5 => fixed::<I, 5, FMA, CHECKED>(own, columns, now),
                6 => fixed::<I, 6, FMA, CHECKED>(own, columns, now),
                7 => fixed::<I, 7, FMA, CHECKED>(own, columns, now),
                _ => any::<I, FMA, CHECKED>(own, columns, now),
            };
            let (a, here) = (*get::<_, CHECKED>(rows.diagonals, row), *get::<_, CHECKED>(now, x));
            let moved = [
                fma::<FMA>(a, here[0], real[0] - imaginary[1]),
                fma::<FMA>(a, here[1], real[1] + imaginary[0]),
            ];
            let next = get_mut::<_, CHECKED>(before, x);
            for c in 0..2 {
                next[c] = if rows.is_first { moved[c] } else { fma::<FMA>(2.0, moved[c], -next[c]) };
            }
            row += 1;
            entry += degree;
        }
    }
}

/// Sums of the neighbors times the real and times the imaginary parts of the entries.
#[inline(always)]
fn any<I: Index, const FMA: bool, const CHECKED: bool>(
    entries: &[[f64; 2]],
    columns: &[I],
    now: &[[f64; 2]],
) -> [[f64; 2]; 2] {
    let mut sums = [[0.0; 2]; 2];
    for (&entry, y) in entries.iter().zip(columns) {
        add::<FMA>(&mut sums, entry, *get::<_, CHECKED>(now, y.get()));
    }
    sums
}

#[inline(always)]
fn fixed<I: Index, const DEGREE: usize, const FMA: bool, const CHECKED: bool>(
    entries: &[[f64; 2]],
    columns: &[I],
    now: &[[f64; 2]],
) -> [[f64; 2]; 2] {
    let entries: &[[f64; 2]; DEGREE] = entries.first_chunk().expect("a row of this degree");
    let columns: &[I; DEGREE] = columns.first_chunk().expect("a row of this degree");
    let mut sums = [[0.0; 2]; 2];
    for e in 0..DEGREE {
        add::<FMA>(&mut sums, entries[e], *get::<_, CHECKED>(now, columns[e].get()));
    }
    sums
}

#[inline(always)]
fn add<const FMA: bool>(sums: &mut [[f64; 2]; 2], entry: [f64; 2], there: [f64; 2]) {
    for (sum, factor) in sums.iter_mut().zip(entry) {
        for c in 0..2 {
            sum[c] = fma::<FMA>(factor, there[c], sum[c]);
        }
    }
}
