//! The walk of one block through all levels: when the active set is built anew, and how far it reaches.

use super::local_columns::{LANES, Lanes, LocalColumns};
use super::pack::{Columns, Kept, kept};
use super::transpose::Transpose;
use super::{BasisError, BasisParams, deep};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};

/// Vertices where every lane is below this part of the tolerance are left out of the active set.
const FLOOR_OF_TOLERANCE: f32 = 0.03;

/// The most that may be missing from a lane's sum of 1 because of vertices left out; what is missing there could
/// matter by as much elsewhere. A tenth of the difference that is allowed between this method and squaring.
const MAX_LOST: f64 = 1e-6;

/// What rounding to single precision may do to a lane's sum in one step.
const ROUNDING_OF_A_STEP: f64 = 1e-7;

/// How the active set follows the walks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reach {
    /// Small values are left out, and the set grows as fast as a walk on a surface spreads. What gets lost is measured.
    Measured {
        /// Rings a step at step n, times √n; never more than one ring a step.
        pace: f64,
    },
    /// All that the walks can reach.
    Complete,
}

/// What is tried first, and what where that loses too much: the first does on even meshes, the second on uneven ones,
/// the last always. On the Stanford bunny most blocks lose too much at a pace of 1, and hardly one at 1.7.
const REACHES: [Reach; 3] = [Reach::Measured { pace: 1.7 }, Reach::Measured { pace: 3.0 }, Reach::Complete];

/// What every block needs.
#[derive(Clone, Debug)]
pub(super) struct Walk<'a> {
    pub(super) diffusion: &'a Diffusion,
    pub(super) transpose: &'a Transpose,
    pub(super) params: &'a BasisParams,
    /// The steps of the levels.
    pub(super) steps: Vec<u64>,
    pub(super) arch: pulp::Arch,
    pub(super) progress: Progress<'a>,
    /// How many of the levels are walked to step by step; the others are reached by a recurrence.
    n_shallow: usize,
    /// What an active vertex takes on all threads together.
    bytes_an_active: u64,
}

/// Whether a sweep is to go on after a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// With the next level.
    GoOn,
    /// Not at all.
    Stop,
}

/// A lane lost more than it may.
struct Lost;

impl<'a> Walk<'a> {
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

    /// Builds the active set anew.
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

    /// Walks from the vertices `first..end` (at most one a lane) and shows `record` the columns at each level: level
    /// from 0, columns, and what the tolerance keeps of them. A level may be shown twice; the later one counts.
    pub(super) fn sweep(
        &self,
        columns: &mut LocalColumns,
        first: usize,
        end: usize,
        mut record: impl FnMut(usize, Columns<'_>, &Kept) -> Next,
    ) -> Result<(), BasisError> {
        for reach in REACHES {
            if reach != Reach::Complete && self.params.drop_tolerance == 0.0 {
                continue;
            }
            if self.sweep_within(reach, columns, first, end, &mut record)?.is_ok() {
                break;
            }
        }
        Ok(())
    }

    fn sweep_within(
        &self,
        reach: Reach,
        columns: &mut LocalColumns,
        first: usize,
        end: usize,
        record: &mut impl FnMut(usize, Columns<'_>, &Kept) -> Next,
    ) -> Result<Result<(), Lost>, BasisError> {
        debug_assert!(end - first <= LANES);
        let tolerance = self.params.drop_tolerance as f32;
        let floor = if reach == Reach::Complete { 0.0 } else { FLOOR_OF_TOLERANCE * tolerance };
        let (shallow, deep) = self.steps.split_at(self.n_shallow);
        let mut show = |level: usize, n: u64, active: &[u32], rows: &[Lanes]| {
            let kept = kept(self.arch, rows, tolerance);
            let allowed = MAX_LOST + ROUNDING_OF_A_STEP * n as f64;
            for lane in 0..end - first {
                if reach != Reach::Complete && kept.masses[lane] < 1.0 - allowed {
                    return Ok(Err(Lost));
                }
                if kept.counts[lane] == 0 {
                    return Err(BasisError::EmptyRow {
                        row: first + lane,
                        steps: n,
                        tolerance: self.params.drop_tolerance,
                    });
                }
            }
            Ok(Ok(record(level, Columns { active, rows }, &kept)))
        };
        columns.start(first, end);
        let (mut done, mut fresh_for) = (0_u64, 0_u64);
        for (level, &n) in shallow.iter().enumerate() {
            while done < n {
                if fresh_for == 0 {
                    fresh_for = stretch(done);
                    let rings = match reach {
                        Reach::Measured { pace } => rings(done, fresh_for, pace),
                        Reach::Complete => fresh_for,
                    };
                    self.regrow(columns, floor, rings)?;
                }
                columns.advance(self.arch);
                done += 1;
                fresh_for -= 1;
            }
            match show(level, n, &columns.active, &columns.now)? {
                Ok(Next::GoOn) => {}
                Ok(Next::Stop) => return Ok(Ok(())),
                Err(lost) => return Ok(Err(lost)),
            }
        }
        if deep.is_empty() {
            return Ok(Ok(()));
        }
        deep::recur(self, columns, deep, done, floor)?;
        for (k, (&n, sum)) in deep.iter().zip(&columns.sums).enumerate() {
            match show(shallow.len() + k, n, &columns.active, sum)? {
                Ok(Next::GoOn) => {}
                Ok(Next::Stop) => break,
                Err(lost) => return Ok(Err(lost)),
            }
        }
        Ok(Ok(()))
    }
}

/// How many steps one active set serves, from step `done` on.
fn stretch(done: u64) -> u64 {
    (done / 2).clamp(2, 16)
}

/// How many rings to add for that many steps. The radius at which a walk of n steps on a surface falls below a given
/// value grows like √n, and so does the number of rings within it: by a part of 1/√n a step.
fn rings(done: u64, steps: u64, pace: f64) -> u64 {
    let a_step = (pace / (done.max(1) as f64).sqrt()).min(1.0);
    (steps as f64 * a_step).ceil() as u64
}
