//! One step of the recurrence for the rows of a tile, by the number of neighbors of the rows.

use super::super::tiles::{DegreeRun, Index};
use super::{fma, get, get_mut, range};

/// `T_{k−1}`, `T_k` and the buffer for `T_{k+1}` at the vertices of a tile.
pub(super) struct StepVectors<'a, const L: usize> {
    pub(super) before: &'a [[f64; L]],
    pub(super) now: &'a [[f64; L]],
    pub(super) next: &'a mut [[f64; L]],
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
pub(super) struct WeightRows<'a> {
    /// Start of each row, and the end of the last.
    pub(super) offsets: &'a [usize],
    pub(super) weights: &'a [f64],
}

/// Columns and weights of consecutive rows, one row after another.
#[derive(Clone, Copy)]
pub(super) struct RowEntries<'a, I> {
    pub(super) columns: &'a [I],
    pub(super) weights: &'a [f64],
}

impl<I> RowEntries<'_, I> {
    /// The first `n` entries, and the others.
    #[inline(always)]
    fn split_at(self, n: usize) -> (Self, Self) {
        let (columns, other_columns) = self.columns.split_at(n);
        let (weights, other_weights) = self.weights.split_at(n);
        (Self { columns, weights }, Self { columns: other_columns, weights: other_weights })
    }
}

/// Copies the weights of the rows of `runs` to `to`, in the order of the runs. In the operator they are in vertex
/// order, and those of the rings are scattered over memory, which no prefetcher follows. The copies gain nothing from
/// wider instructions, so this is compiled for the base instructions alone.
#[inline(never)]
pub(super) fn gather<const CHECKED: bool>(
    mut rows: impl TileRows,
    runs: &[DegreeRun],
    matrix: WeightRows<'_>,
    mut to: &mut [f64],
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
                        *to = *row.first_chunk().expect("a row of this degree");
                    },)*
                    _ => for r in 0..n_rows {
                        let start = *get::<_, CHECKED>(offsets, rows.vertex::<CHECKED>(r));
                        these[r * degree..][..degree].copy_from_slice(range::<_, CHECKED>(weights, start, degree));
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
pub(super) fn step<I: Index, const L: usize, const FMA: bool, const CHECKED: bool, const LAZY: bool>(
    mut rows: impl TileRows,
    runs: &[DegreeRun],
    mut entries: RowEntries<'_, I>,
    vectors: &mut StepVectors<'_, L>,
    scale: f64,
) {
    for run in runs {
        let (degree, n_rows) = (run.degree as usize, run.n_rows as usize);
        let these;
        (these, entries) = entries.split_at(n_rows * degree);
        if !FMA {
            // Old processors: the same bits in a fraction of the code.
            any::<I, L, FMA, CHECKED, LAZY>(rows, *run, these, vectors, scale);
            rows = rows.after(n_rows);
            continue;
        }
        macro_rules! unrolled {
            ($($degree:literal)*) => {
                match degree {
                    $($degree => fixed::<I, $degree, L, FMA, CHECKED, LAZY>(rows, these, vectors, scale),)*
                    _ => any::<I, L, FMA, CHECKED, LAZY>(rows, *run, these, vectors, scale),
                }
            };
        }
        unrolled!(2 3 4 5 6 7 8 9 10);
        rows = rows.after(n_rows);
    }
}

/// Start value of a row's sum, and the value at its own vertex, which a lazy walk does not need.
#[inline(always)]
fn start<const L: usize, const FMA: bool, const CHECKED: bool, const LAZY: bool>(
    before: &[[f64; L]],
    now: &[[f64; L]],
    row: usize,
) -> ([f64; L], [f64; L]) {
    let mut sum = get::<_, CHECKED>(before, row).map(|v| -0.25 * v);
    if LAZY {
        return (sum, [0.0; L]);
    }
    let here = *get::<_, CHECKED>(now, row);
    for c in 0..L {
        sum[c] = fma::<FMA>(0.5, here[c], sum[c]);
    }
    (sum, here)
}

#[inline(always)]
fn fixed<
    I: Index,
    const DEGREE: usize,
    const L: usize,
    const FMA: bool,
    const CHECKED: bool,
    const LAZY: bool,
>(
    rows: impl TileRows,
    entries: RowEntries<'_, I>,
    vectors: &mut StepVectors<'_, L>,
    scale: f64,
) {
    let RowEntries { columns, weights } = entries;
    let StepVectors { before, now, next } = vectors;
    let entries = columns.as_chunks::<DEGREE>().0.iter().zip(weights.as_chunks::<DEGREE>().0);
    for (r, (columns, weights)) in entries.enumerate() {
        let row = rows.get::<CHECKED>(r);
        let (mut sum, here) = start::<L, FMA, CHECKED, LAZY>(before, now, row);
        for e in 0..DEGREE {
            let there = get::<_, CHECKED>(now, columns[e].get());
            for c in 0..L {
                let moved = if LAZY { there[c] } else { there[c] - here[c] };
                sum[c] = fma::<FMA>(weights[e], moved, sum[c]);
            }
        }
        *get_mut::<_, CHECKED>(next, row) = sum.map(|v| scale * v);
    }
}

#[inline(always)]
fn any<I: Index, const L: usize, const FMA: bool, const CHECKED: bool, const LAZY: bool>(
    rows: impl TileRows,
    run: DegreeRun,
    entries: RowEntries<'_, I>,
    vectors: &mut StepVectors<'_, L>,
    scale: f64,
) {
    let RowEntries { columns, weights } = entries;
    let StepVectors { before, now, next } = vectors;
    let (degree, n_rows) = (run.degree as usize, run.n_rows as usize);
    for r in 0..n_rows {
        let row = rows.get::<CHECKED>(r);
        let (mut sum, here) = start::<L, FMA, CHECKED, LAZY>(before, now, row);
        for (column, &w) in columns[r * degree..][..degree].iter().zip(&weights[r * degree..][..degree]) {
            let there = get::<_, CHECKED>(now, column.get());
            for c in 0..L {
                let moved = if LAZY { there[c] } else { there[c] - here[c] };
                sum[c] = fma::<FMA>(w, moved, sum[c]);
            }
        }
        *get_mut::<_, CHECKED>(next, row) = sum.map(|v| scale * v);
    }
}
