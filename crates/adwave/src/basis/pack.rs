//! From dense columns to sparse rows: entries below the tolerance are dropped, the rest of each row divided by its sum.

use super::local_columns::{LANES, Lanes};

/// Entries that are looked at together: where all are dropped, or all kept, none is looked at by itself.
const RUN: usize = 16;

/// Rows whose lane sums are added in single precision before they go into the double ones.
const ROWS_A_SUM: usize = 64;

/// The sparse rows of one block at one level.
#[derive(Debug, Default)]
pub(super) struct PackedRows {
    /// Number of entries of each row of the block.
    pub(super) counts: Vec<u32>,
    /// Columns, row after row; only the first `nnz()` are meant.
    pub(super) columns: Vec<u32>,
    /// Values, row after row; only the first `nnz()` are meant.
    pub(super) values: Vec<f32>,
}

impl PackedRows {
    pub(super) fn nnz(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).sum()
    }
}

/// Columns over the active vertices, at one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns<'a> {
    /// Active vertices by rising index.
    pub(super) active: &'a [u32],
    /// The lanes at each.
    pub(super) rows: &'a [Lanes],
}

/// What a level keeps of the rows of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Entries of each lane.
    pub(super) counts: [u32; LANES],
    /// What they sum to.
    pub(super) sums: [f64; LANES],
    /// What the entries of each lane sum to, kept or not.
    pub(super) masses: [f64; LANES],
}

/// Counts and sums what a level keeps: positive values of at least `tolerance`.
pub(super) fn kept(arch: pulp::Arch, rows: &[Lanes], tolerance: f32) -> Kept {
    arch.dispatch(Count { rows, floor: smallest_kept(tolerance) })
}

/// The tolerance itself, or the smallest positive number: a stored entry is never 0.
fn smallest_kept(tolerance: f32) -> f32 {
    tolerance.max(f32::from_bits(1))
}

struct Count<'a> {
    rows: &'a [Lanes],
    floor: f32,
}

impl pulp::NullaryFnOnce for Count<'_> {
    type Output = Kept;

    #[inline(always)]
    fn call(self) -> Kept {
        let Self { rows, floor } = self;
        let mut kept = Kept { counts: [0; LANES], sums: [0.0; LANES], masses: [0.0; LANES] };
        for some in rows.chunks(ROWS_A_SUM) {
            let (mut sums, mut masses) = ([0.0_f32; LANES], [0.0_f32; LANES]);
            for row in some {
                for l in 0..LANES {
                    let is_kept = row[l] >= floor;
                    kept.counts[l] += u32::from(is_kept);
                    sums[l] += if is_kept { row[l] } else { 0.0 };
                    masses[l] += row[l];
                }
            }
            for l in 0..LANES {
                kept.sums[l] += f64::from(sums[l]);
                kept.masses[l] += f64::from(masses[l]);
            }
        }
        kept
    }
}

/// Packs the first `n_lanes` lanes into `out`; `lanes_first` is scratch.
pub(super) fn pack(
    arch: pulp::Arch,
    columns: Columns<'_>,
    n_lanes: usize,
    tolerance: f32,
    kept: &Kept,
    lanes_first: &mut Vec<f32>,
    out: &mut PackedRows,
) {
    out.counts.clear();
    out.counts.extend_from_slice(&kept.counts[..n_lanes]);
    // A run is written whole before it is known how much of it stays.
    let room = out.nnz() + RUN;
    if out.columns.len() < room {
        out.columns.resize(room, 0);
        out.values.resize(room, 0.0);
    }
    let stride = columns.active.len().next_multiple_of(RUN);
    if lanes_first.len() < stride * LANES {
        lanes_first.resize(stride * LANES, 0.0);
    }
    arch.dispatch(Pack {
        active: columns.active,
        rows: columns.rows,
        n_lanes,
        stride,
        floor: smallest_kept(tolerance),
        kept,
        lanes_first,
        out,
    });
}

struct Pack<'a> {
    active: &'a [u32],
    rows: &'a [Lanes],
    n_lanes: usize,
    stride: usize,
    floor: f32,
    kept: &'a Kept,
    lanes_first: &'a mut [f32],
    out: &'a mut PackedRows,
}

impl pulp::NullaryFnOnce for Pack<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { active, rows, n_lanes, stride, floor, kept, lanes_first, out } = self;
        transpose(rows, stride, lanes_first);
        let mut at = 0;
        for l in 0..n_lanes {
            let scale = (1.0 / kept.sums[l]) as f32;
            let (runs, _) = lanes_first[l * stride..(l + 1) * stride].as_chunks::<RUN>();
            let (whole, rest) = active.as_chunks::<RUN>();
            for (run, names) in runs.iter().zip(whole) {
                at = pack_run(run, names, floor, scale, out, at);
            }
            if !rest.is_empty() {
                let mut names = [0; RUN];
                names[..rest.len()].copy_from_slice(rest);
                at = pack_run(&runs[runs.len() - 1], &names, floor, scale, out, at);
            }
        }
    }
}

/// `lanes_first[l·stride + k] = rows[k][l]`, with zeros up to the stride.
#[inline(always)]
fn transpose(rows: &[Lanes], stride: usize, lanes_first: &mut [f32]) {
    let mut k = 0;
    while k < rows.len() {
        let mut tile = [[0.0_f32; RUN]; LANES];
        for (i, row) in rows[k..].iter().take(RUN).enumerate() {
            for l in 0..LANES {
                tile[l][i] = row[l];
            }
        }
        for (l, run) in tile.iter().enumerate() {
            lanes_first[l * stride + k..][..RUN].copy_from_slice(run);
        }
        k += RUN;
    }
}

/// Appends the kept entries of a run at `at`; where the next ones go.
#[inline(always)]
fn pack_run(
    run: &[f32; RUN],
    names: &[u32; RUN],
    floor: f32,
    scale: f32,
    out: &mut PackedRows,
    at: usize,
) -> usize {
    let mut n_kept = 0_u32;
    for &v in run {
        n_kept += u32::from(v >= floor);
    }
    if n_kept == 0 {
        return at;
    }
    let columns = out.columns[at..].first_chunk_mut::<RUN>().expect("room for a run more");
    let values = out.values[at..].first_chunk_mut::<RUN>().expect("room for a run more");
    if n_kept == RUN as u32 {
        *columns = *names;
        for (value, &v) in values.iter_mut().zip(run) {
            *value = v * scale;
        }
    } else {
        // Written always, counted only where kept: no branch that a processor could guess wrongly.
        let mut next = 0;
        for (&v, &name) in run.iter().zip(names) {
            columns[next % RUN] = name;
            values[next % RUN] = v * scale;
            next += usize::from(v >= floor);
        }
    }
    at + n_kept as usize
}
