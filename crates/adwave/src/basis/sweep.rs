//! Applies the powers of Φ₁ to one block of vertices through all levels, and controls how the active set is rebuilt
//! and grown.

use super::local_columns::{LANES, Lanes, LocalColumns};
use super::pack::{ColumnBlock, KeptEntries, count_kept};
use super::transpose::Transpose;
use super::{BasisError, BasisParams, deep};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};

/// Fraction of the tolerance below which all lanes of a vertex must be for it to leave the active set.
const FLOOR_OF_TOLERANCE: f32 = 0.03;

/// Largest part of a lane's sum of 1 that may be lost to inactive vertices; the same amount may be missing
/// elsewhere. It is a tenth of the allowed difference from squaring.
const MAX_LOST: f64 = 1e-6;

/// Rounding error of a lane's sum per step in single precision.
const ROUNDING_OF_A_STEP: f64 = 1e-7;

/// Growth rule of the active set.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ActiveSetGrowth {
    /// The set grows as fast as a walk spreads on a surface, without small values. The loss is measured.
    Measured {
        /// Rings per step at step n, times √n; at most one ring per step.
        rate: f64,
    },
    /// The set contains all vertices that the diffusion can reach.
    Complete,
}

/// Growth rules in the order in which they are tried when the previous one loses too much. The first suffices on
/// even meshes, the second on uneven ones, the last always. On the Stanford bunny most blocks lose too much at a
/// rate of 1, and hardly any at 1.7.
const GROWTHS: [ActiveSetGrowth; 3] = [
    ActiveSetGrowth::Measured { rate: 1.7 },
    ActiveSetGrowth::Measured { rate: 3.0 },
    ActiveSetGrowth::Complete,
];

/// Data shared by all blocks.
#[derive(Clone, Debug)]
pub(super) struct BlockSweep<'a> {
    pub(super) diffusion: &'a Diffusion,
    pub(super) transpose: &'a Transpose,
    pub(super) params: &'a BasisParams,
    /// Number of steps of each level.
    pub(super) steps: Vec<u64>,
    pub(super) arch: pulp::Arch,
    pub(super) progress: Progress<'a>,
    /// Number of levels computed step by step; the others are reached by a recurrence.
    n_shallow: usize,
    /// Bytes that an active vertex takes over all threads together.
    bytes_an_active: u64,
}

/// Decision after a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SweepControl {
    /// Continue with the next level.
    GoOn,
    /// Stop.
    Stop,
}

/// A lane lost more than is allowed.
struct LostMass;

impl<'a> BlockSweep<'a> {
    pub(super) fn new(
        diffusion: &'a Diffusion,
        transpose: &'a Transpose,
        params: &'a BasisParams,
        progress: Progress<'a>,
    ) -> Self {
        let steps = params.steps();
        let n_shallow = deep::n_shallow(diffusion, &steps);
        let n_columns = 4 + params.schedule.n_levels() - n_shallow;
        let bytes_an_active = (rayon::current_num_threads() * n_columns * size_of::<Lanes>()) as u64;
        let arch = pulp::Arch::new();
        Self { diffusion, transpose, params, steps, arch, progress, n_shallow, bytes_an_active }
    }

    /// Rebuilds the active set.
    pub(super) fn regrow(
        &self,
        columns: &mut LocalColumns,
        floor: f32,
        rings: u64,
    ) -> Result<(), BasisError> {
        if self.progress.is_cancelled() {
            return Err(Cancelled.into());
        }
        columns.regrow(self.diffusion, self.transpose, self.arch, floor, rings);
        let needed = columns.active.len() as u64 * self.bytes_an_active;
        let limit = self.params.memory_limit;
        if needed > limit {
            return Err(BasisError::TooLarge {
                n_levels: self.params.schedule.n_levels(),
                n_vertices: self.diffusion.n_vertices(),
                needed,
                limit,
            });
        }
        Ok(())
    }

    /// Diffuses from the vertices `first..end` (at most one per lane) and passes the columns at each level to
    /// `record`: the level from 0, the columns, and the entries that the tolerance keeps. A level may be passed
    /// twice; the later call replaces the earlier one.
    pub(super) fn sweep(
        &self,
        columns: &mut LocalColumns,
        first: usize,
        end: usize,
        mut record: impl FnMut(usize, ColumnBlock<'_>, &KeptEntries) -> SweepControl,
    ) -> Result<(), BasisError> {
        for growth in GROWTHS {
            if growth != ActiveSetGrowth::Complete && self.params.drop_tolerance == 0.0 {
                continue;
            }
            if self.sweep_within(growth, columns, first, end, &mut record)?.is_ok() {
                break;
            }
        }
        Ok(())
    }

    fn sweep_within(
        &self,
        growth: ActiveSetGrowth,
        columns: &mut LocalColumns,
        first: usize,
        end: usize,
        record: &mut impl FnMut(usize, ColumnBlock<'_>, &KeptEntries) -> SweepControl,
    ) -> Result<Result<(), LostMass>, BasisError> {
        debug_assert!(end - first <= LANES);
        let tolerance = self.params.drop_tolerance as f32;
        let floor = if growth == ActiveSetGrowth::Complete { 0.0 } else { FLOOR_OF_TOLERANCE * tolerance };
        let (shallow, deep) = self.steps.split_at(self.n_shallow);
        let mut show = |level: usize, n: u64, active: &[u32], rows: &[Lanes]| {
            let kept = count_kept(self.arch, rows, tolerance);
            let allowed = MAX_LOST + ROUNDING_OF_A_STEP * n as f64;
            for lane in 0..end - first {
                if growth != ActiveSetGrowth::Complete && kept.masses[lane] < 1.0 - allowed {
                    return Ok(Err(LostMass));
                }
                if kept.counts[lane] == 0 {
                    return Err(BasisError::EmptyRow {
                        row: first + lane,
                        steps: n,
                        tolerance: self.params.drop_tolerance,
                    });
                }
            }
            Ok(Ok(record(level, ColumnBlock { active, rows }, &kept)))
        };
        columns.start(first, end);
        let (mut done, mut fresh_for) = (0_u64, 0_u64);
        for (level, &n) in shallow.iter().enumerate() {
            while done < n {
                if fresh_for == 0 {
                    fresh_for = stretch(done);
                    let rings = match growth {
                        ActiveSetGrowth::Measured { rate } => rings(done, fresh_for, rate),
                        ActiveSetGrowth::Complete => fresh_for,
                    };
                    self.regrow(columns, floor, rings)?;
                }
                columns.advance(self.arch);
                done += 1;
                fresh_for -= 1;
            }
            match show(level, n, &columns.active, &columns.now)? {
                Ok(SweepControl::GoOn) => {}
                Ok(SweepControl::Stop) => return Ok(Ok(())),
                Err(lost) => return Ok(Err(lost)),
            }
        }
        if deep.is_empty() {
            return Ok(Ok(()));
        }
        deep::recur(self, columns, deep, done, floor)?;
        for (k, (&n, sum)) in deep.iter().zip(&columns.sums).enumerate() {
            match show(shallow.len() + k, n, &columns.active, sum)? {
                Ok(SweepControl::GoOn) => {}
                Ok(SweepControl::Stop) => break,
                Err(lost) => return Ok(Err(lost)),
            }
        }
        Ok(Ok(()))
    }
}

/// Number of steps, from step `done`, that one active set serves.
fn stretch(done: u64) -> u64 {
    (done / 2).clamp(2, 16)
}

/// Number of rings to add for that many steps. The radius at which a walk of n steps on a surface falls below a
/// given value grows like √n, and so does the number of rings within it: by 1/√n per step.
fn rings(done: u64, steps: u64, rate: f64) -> u64 {
    let a_step = (rate / (done.max(1) as f64).sqrt()).min(1.0);
    (steps as f64 * a_step).ceil() as u64
}
