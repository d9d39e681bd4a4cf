//! One step of the recurrence for the rows of a tile, by the number of neighbors of the rows.

use super::super::tiles::{DegreeRun, Index};
use super::{GROUP, VectorNumber, get, get_mut, range};

/// `T_{k−1}`, `T_k` and the buffer for `T_{k+1}` at the vertices of a tile.
pub(super) struct StepVectors<'a, T, const L: usize> {
    pub(super) before: &'a [[T; L]],
    pub(super) now: &'a [[T; L]],
    pub(super) next: &'a mut [[T; L]],
}

/// Rows of a tile, in the order of its runs.
pub(super) trait TileRows: Copy {
    /// The rows without the first `n`.
    fn after(self, n: usize) -> Self;
    /// The number of row `r` in the tile.
    fn get<const CHECKED: bool>(self, r: usize) -> usize;
    /// Vertex of row `r` in the operator.
    fn vertex<const CHECKED: bool>(self, r: usize) -> usize;
}

/// Interior rows of a tile, in any order.
#[derive(Clone, Copy)]
pub(super) struct InteriorRows<'a, I> {
    pub(super) rows: &'a [I],
    /// The vertex of row 0.
    pub(super) first: usize,
}

impl<I: Index> TileRows for InteriorRows<'_, I> {
    #[inline(always)]
    fn after(self, n: usize) -> Self {
        Self { rows: &self.rows[n..], ..self }
    }

    #[inline(always)]
    fn get<const CHECKED: bool>(self, r: usize) -> usize {
        get::<_, CHECKED>(self.rows, r).get()
    }

    #[inline(always)]
    fn vertex<const CHECKED: bool>(self, r: usize) -> usize {
        self.first + self.get::<CHECKED>(r)
    }
}

/// Rows of the halo rings, in the order of the tile.
#[derive(Clone, Copy)]
pub(super) struct RingRows<'a> {
    pub(super) first: usize,
    /// The vertices from row `first` on.
    pub(super) halo: &'a [u32],
}

impl TileRows for RingRows<'_> {
    #[inline(always)]
    fn after(self, n: usize) -> Self {
        Self { first: self.first + n, halo: &self.halo[n..] }
    }

    #[inline(always)]
    fn get<const CHECKED: bool>(self, r: usize) -> usize {
        self.first + r
    }

    #[inline(always)]
    fn vertex<const CHECKED: bool>(self, r: usize) -> usize {
        *get::<_, CHECKED>(self.halo, r) as usize
    }
}

/// Weights of the rows of Φ₁ by vertex.
#[derive(Clone, Copy)]
pub(super) struct WeightRows<'a, T> {
    /// Start of each row, and the end of the last.
    pub(super) offsets: &'a [usize],
    pub(super) weights: &'a [T],
}

/// Columns and weights of consecutive rows, one row after another.
#[derive(Clone, Copy)]
pub(super) struct RowEntries<'a, I, T> {
    pub(super) columns: &'a [I],
    pub(super) weights: &'a [T],
}

impl<I, T> RowEntries<'_, I, T> {
    /// The first `n` entries, and the others.
    #[inline(always)]
    fn split_at(self, n: usize) -> (Self, Self) {
        let (columns, other_columns) = self.columns.split_at(n);
        let (weights, other_weights) = self.weights.split_at(n);
        (Self { columns, weights }, Self { columns: other_columns, weights: other_weights })
    }
}

/// Copies the weights of the rows of `runs` to `to`, in the order of the runs, and rounds them if `to` is in single
/// precision. In the operator they are in vertex order, and those of the rings are scattered over memory, which no
/// prefetcher follows. The copies gain nothing from wider instructions, so this is compiled for the base instructions
/// alone.
#[inline(never)]
pub(super) fn gather<S: VectorNumber, T: VectorNumber, const CHECKED: bool>(
    mut rows: impl TileRows,
    runs: &[DegreeRun],
    matrix: WeightRows<'_, S>,
    mut to: &mut [T],
) {
    let WeightRows { offsets, weights } = matrix;
    for run in runs {
        let (degree, n_rows) = (run.degree as usize, run.n_rows as usize);
        let these;
        (these, to) = to.split_at_mut(n_rows * degree);
        macro_rules! unrolled {
            ($($degree:literal)*) => {
                match degree {
                    $($degree => for (r, to) in these.as_chunks_mut::<$degree>().0.iter_mut().enumerate() {
                        let start = *get::<_, CHECKED>(offsets, rows.vertex::<CHECKED>(r));
                        let row = range::<_, CHECKED>(weights, start, $degree);
                        let row: &[S; $degree] = row.first_chunk().expect("a row of this degree");
                        for e in 0..$degree {
                            to[e] = T::rounded(row[e].to_f64(), 1.0);
                        }
                    },)*
                    _ => for r in 0..n_rows {
                        let start = *get::<_, CHECKED>(offsets, rows.vertex::<CHECKED>(r));
                        let row = range::<_, CHECKED>(weights, start, degree);
                        for (to, &w) in these[r * degree..][..degree].iter_mut().zip(row) {
                            *to = T::rounded(w.to_f64(), 1.0);
                        }
                    },
                }
            };
        }
        unrolled!(2 3 4 5 6 7 8 9 10);
        rows = rows.after(n_rows);
    }
}

/// Takes one step for the rows of `runs`: `2Y T_k − T_{k−1}`, `Y = 2Φ₁ − I`.
///
/// For a lazy walk, whose Φ₁ has the diagonal ½, this is `next = scale·(Σ w·now[y] − ¼·before)` with `w = Φ₁(x,y)`;
/// for any other Φ₁ it is `scale·(Σ w·(now[y] − now[x]) + ½·now[x] − ¼·before)`. The factor 4 is in the scale,
/// because a power of two rounds nothing.
#[inline(always)]
pub(super) fn step<
    I: Index,
    T: VectorNumber,
    const L: usize,
    const FMA: bool,
    const CHECKED: bool,
    const LAZY: bool,
>(
    mut rows: impl TileRows,
    runs: &[DegreeRun],
    mut entries: RowEntries<'_, I, T>,
    vectors: &mut StepVectors<'_, T, L>,
    scale: T,
) {
    for run in runs {
        let (degree, n_rows) = (run.degree as usize, run.n_rows as usize);
        let these;
        (these, entries) = entries.split_at(n_rows * degree);
        if !FMA {
            // Old processors: the same bits in a fraction of the code.
            any::<I, T, L, FMA, CHECKED, LAZY>(rows, *run, these, vectors, scale);
            rows = rows.after(n_rows);
            continue;
        }
        macro_rules! unrolled {
            ($($degree:literal)*) => {
                match degree {
                    $($degree => fixed::<I, T, $degree, L, FMA, CHECKED, LAZY>(rows, these, vectors, scale),)*
                    _ => any::<I, T, L, FMA, CHECKED, LAZY>(rows, *run, these, vectors, scale),
                }
            };
        }
        unrolled!(2 3 4 5 6 7 8 9 10);
        rows = rows.after(n_rows);
    }
}

/// The values times `scale`. A loop, because a closure would be compiled without the instruction set of the caller.
#[inline(always)]
fn multiple<T: VectorNumber, const L: usize>(values: &[T; L], scale: T) -> [T; L] {
    let mut result = *values;
    for value in &mut result {
        *value = scale.times(*value);
    }
    result
}

/// Start value of a row's sum, and the value at its own vertex, which a lazy walk does not need.
#[inline(always)]
fn start<T: VectorNumber, const L: usize, const FMA: bool, const CHECKED: bool, const LAZY: bool>(
    before: &[[T; L]],
    now: &[[T; L]],
    row: usize,
) -> ([T; L], [T; L]) {
    let (minus_quarter, half) = (T::rounded(-0.25, 1.0), T::rounded(0.5, 1.0));
    let mut sum = multiple(get::<_, CHECKED>(before, row), minus_quarter);
    if LAZY {
        return (sum, [T::default(); L]);
    }
    let here = *get::<_, CHECKED>(now, row);
    for c in 0..L {
        sum[c] = half.times_plus::<FMA>(here[c], sum[c]);
    }
    (sum, here)
}

/// Adds the product of an entry with the value there, or with its difference to the value `here` unless the walk is
/// lazy.
#[inline(always)]
fn add_entry<T: VectorNumber, const L: usize, const FMA: bool, const LAZY: bool>(
    w: T,
    there: &[T; L],
    here: &[T; L],
    sum: &mut [T; L],
) {
    for c in 0..L {
        let moved = if LAZY { there[c] } else { there[c].minus(here[c]) };
        sum[c] = w.times_plus::<FMA>(moved, sum[c]);
    }
}

/// Adds the sum of a group to that of its row, and clears it.
#[inline(always)]
fn add_group<T: VectorNumber, const L: usize>(group: &mut [T; L], sum: &mut [T; L]) {
    for c in 0..L {
        sum[c] = sum[c].plus(group[c]);
    }
    *group = [T::default(); L];
}

#[inline(always)]
fn fixed<
    I: Index,
    T: VectorNumber,
    const DEGREE: usize,
    const L: usize,
    const FMA: bool,
    const CHECKED: bool,
    const LAZY: bool,
>(
    rows: impl TileRows,
    entries: RowEntries<'_, I, T>,
    vectors: &mut StepVectors<'_, T, L>,
    scale: T,
) {
    let RowEntries { columns, weights } = entries;
    let StepVectors { before, now, next } = vectors;
    let entries = columns.as_chunks::<DEGREE>().0.iter().zip(weights.as_chunks::<DEGREE>().0);
    for (r, (columns, weights)) in entries.enumerate() {
        let row = rows.get::<CHECKED>(r);
        let (mut sum, here) = start::<T, L, FMA, CHECKED, LAZY>(before, now, row);
        let mut group = [T::default(); L];
        for e in 0..DEGREE {
            let there = get::<_, CHECKED>(now, columns[e].get());
            let part = if T::IS_GROUPED { &mut group } else { &mut sum };
            add_entry::<T, L, FMA, LAZY>(weights[e], there, &here, part);
            if T::IS_GROUPED && (e % GROUP == GROUP - 1 || e == DEGREE - 1) {
                add_group(&mut group, &mut sum);
            }
        }
        *get_mut::<_, CHECKED>(next, row) = multiple(&sum, scale);
    }
}

#[inline(always)]
fn any<I: Index, T: VectorNumber, const L: usize, const FMA: bool, const CHECKED: bool, const LAZY: bool>(
    rows: impl TileRows,
    run: DegreeRun,
    entries: RowEntries<'_, I, T>,
    vectors: &mut StepVectors<'_, T, L>,
    scale: T,
) {
    let RowEntries { columns, weights } = entries;
    let StepVectors { before, now, next } = vectors;
    let (degree, n_rows) = (run.degree as usize, run.n_rows as usize);
    let together = if T::IS_GROUPED { GROUP } else { degree.max(1) };
    for r in 0..n_rows {
        let row = rows.get::<CHECKED>(r);
        let (mut sum, here) = start::<T, L, FMA, CHECKED, LAZY>(before, now, row);
        let (columns, weights) = (&columns[r * degree..][..degree], &weights[r * degree..][..degree]);
        for (columns, weights) in columns.chunks(together).zip(weights.chunks(together)) {
            let mut group = [T::default(); L];
            let part = if T::IS_GROUPED { &mut group } else { &mut sum };
            for (column, &w) in columns.iter().zip(weights) {
                let there = get::<_, CHECKED>(now, column.get());
                add_entry::<T, L, FMA, LAZY>(w, there, &here, part);
            }
            if T::IS_GROUPED {
                add_group(&mut group, &mut sum);
            }
        }
        *get_mut::<_, CHECKED>(next, row) = multiple(&sum, scale);
    }
}
