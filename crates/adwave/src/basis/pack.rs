//! Converts dense columns to sparse rows: drops entries below the tolerance and divides the rest of each row by its
//! sum.

use super::local_columns::{LANES, Lanes};

/// Number of entries tested together; a run that is dropped or kept as a whole needs no test per entry.
const RUN: usize = 16;

/// Number of rows whose lane sums are added in single precision before they are added in double precision.
const ROWS_A_SUM: usize = 64;

/// The sparse rows of one block at one level.
#[derive(Debug, Default)]
pub(super) struct PackedRows {
    /// Number of entries of each row of the block.
    pub(super) counts: Vec<u32>,
    /// Columns, row after row; only the first `nnz()` are valid.
    pub(super) columns: Vec<u32>,
    /// Values, row after row; only the first `nnz()` are valid.
    pub(super) values: Vec<f32>,
}

impl PackedRows {
    pub(super) fn nnz(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).sum()
    }
}

/// Columns over the active vertices, at one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnBlock<'a> {
    /// Active vertices, in ascending order.
    pub(super) active: &'a [u32],
    /// Lanes at each active vertex.
    pub(super) rows: &'a [Lanes],
}

/// Number and sums of the entries that a level keeps, per lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptEntries {
    /// Number of kept entries of each lane.
    pub(super) counts: [u32; LANES],
    /// Sum of the kept entries of each lane.
    pub(super) sums: [f64; LANES],
    /// Sum of all entries of each lane, kept or not.
    pub(super) masses: [f64; LANES],
}

/// Counts and sums the entries that a level keeps: positive values of at least `tolerance`.
pub(super) fn count_kept(arch: pulp::Arch, rows: &[Lanes], tolerance: f32) -> KeptEntries {
    arch.dispatch(CountKept { rows, floor: smallest_kept(tolerance) })
}

/// The tolerance, or the smallest positive number if it is 0: a stored entry is never 0.
fn smallest_kept(tolerance: f32) -> f32 {
    tolerance.max(f32::from_bits(1))
}

struct CountKept<'a> {
    rows: &'a [Lanes],
    floor: f32,
}

impl pulp::NullaryFnOnce for CountKept<'_> {
    type Output = KeptEntries;

    #[inline(always)]
    fn call(self) -> KeptEntries {
        let Self { rows, floor } = self;
        let mut kept = KeptEntries { counts: [0; LANES], sums: [0.0; LANES], masses: [0.0; LANES] };
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

/// Packs the first `n_lanes` lanes into `out`; `lanes_first` is scratch memory.
pub(super) fn pack(
    arch: pulp::Arch,
    columns: ColumnBlock<'_>,
    n_lanes: usize,
    tolerance: f32,
    kept: &KeptEntries,
    lanes_first: &mut Vec<f32>,
    out: &mut PackedRows,
) {
    out.counts.clear();
    out.counts.extend_from_slice(&kept.counts[..n_lanes]);
    // A run is copied as a whole before the number of kept entries is known.
    let room = out.nnz() + RUN;
    if out.columns.len() < room {
        out.columns.resize(room, 0);
        out.values.resize(room, 0.0);
    }
    let stride = columns.active.len().next_multiple_of(RUN);
    if lanes_first.len() < stride * LANES {
        lanes_first.resize(stride * LANES, 0.0);
    }
    arch.dispatch(PackLanes {
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

struct PackLanes<'a> {
    active: &'a [u32],
    rows: &'a [Lanes],
    n_lanes: usize,
    stride: usize,
    floor: f32,
    kept: &'a KeptEntries,
    lanes_first: &'a mut [f32],
    out: &'a mut PackedRows,
}

impl pulp::NullaryFnOnce for PackLanes<'_> {
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

/// Transposes rows: `lanes_first[l·stride + k] = rows[k][l]`, padded with zeros up to the stride.
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

/// Appends the kept entries of a run at `at`, and returns the next position.
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
        // The store is unconditional and the count conditional, which avoids an unpredictable branch.
        let mut next = 0;
        for (&v, &name) in run.iter().zip(names) {
            columns[next % RUN] = name;
            values[next % RUN] = v * scale;
            next += usize::from(v >= floor);
        }
    }
    at + n_kept as usize
}
