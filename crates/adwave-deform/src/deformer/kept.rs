//! Positions that keep lengths, from the bend of the nodes.

use super::Deformer;
use crate::front::NO_SOURCE;
use crate::lengths::{BentDetail, KeptLengths, LengthSolver};
use crate::rotation::NO_TURN;
use crate::{DeformError, HandleMotion};
use adwave::Progress;
use adwave::vector::{Vector, subtract};

/// Parts of the way that the handles take one after the other where the surface would cross itself at once.
const PARTS_OF_THE_WAY: usize = 12;

impl Deformer {
    /// Positions of welded vertices that keep lengths.
    pub(super) fn solve_lengths(&mut self, progress: Progress<'_>) -> Result<KeptLengths, DeformError> {
        let solver = if let Some(solver) = self.length_solver.take() {
            solver
        } else {
            let n = self.base.points.len();
            let is_free = (0..n).map(|x| self.moves_freely(x)).collect();
            LengthSolver::new(&self.decomposer, is_free, self.keep_lengths, progress)?
        };
        let found = self.solve_lengths_with(&solver, progress);
        self.length_solver = Some(solver);
        found
    }

    /// Solves at once, and along the way of the handles if the surface crosses itself then.
    fn solve_lengths_with(
        &mut self,
        solver: &LengthSolver,
        progress: Progress<'_>,
    ) -> Result<KeptLengths, DeformError> {
        let detail = self.bent_detail();
        let mut best = solver.solve(&self.decomposer, &detail, progress)?;
        if best.n_crossing > 0 {
            let before = (self.motions.clone(), self.state.clone(), self.earlier.clone());
            let along = self.follow_the_way(solver, &detail, progress);
            (self.motions, self.state, self.earlier) = before;
            let along = along?;
            if along.n_crossing < best.n_crossing {
                best = along;
            }
        }
        Ok(best)
    }

    /// Solves for parts of the motions of the handles, each from the one before.
    fn follow_the_way(
        &mut self,
        solver: &LengthSolver,
        last: &BentDetail,
        progress: Progress<'_>,
    ) -> Result<KeptLengths, DeformError> {
        let whole = self.motions.clone();
        let rest = self.decomposer.positions().to_vec();
        let mut before = BentDetail { turns: vec![NO_TURN; rest.len()], points: rest };
        let mut kept = KeptLengths::rest_state(&before);
        for part in 1..=PARTS_OF_THE_WAY {
            let detail = if part == PARTS_OF_THE_WAY {
                last.clone()
            } else {
                let share = part as f64 / PARTS_OF_THE_WAY as f64;
                for ((motion, whole), region) in self.motions.iter_mut().zip(&whole).zip(&self.bound.regions)
                {
                    *motion = HandleMotion::blend(&[*whole], &[share], region.center)?;
                }
                self.solve_nodes(progress)?;
                self.bent_detail()
            };
            let moved = |(p, (now, was)): (&Vector, (&Vector, &Vector))| {
                let d = subtract(now, was);
                [0, 1, 2].map(|c| p[c] + d[c])
            };
            let pairs = detail.points.iter().zip(&before.points);
            let mut start =
                BentDetail { points: kept.points.iter().zip(pairs).map(moved).collect(), turns: kept.turns };
            // What does not move freely is where its motion takes it.
            for (x, p) in start.points.iter_mut().enumerate() {
                if !solver.is_free(x) {
                    *p = detail.points[x];
                }
            }
            kept = solver.follow(&self.decomposer, &start, &detail, progress)?;
            before = detail;
        }
        Ok(kept)
    }

    /// Positions and frames of the welded vertices by the nodes.
    fn bent_detail(&self) -> BentDetail {
        let map = self.decomposer.vertex_map();
        let points = map.positions(&self.points());
        let mut turns = vec![NO_TURN; points.len()];
        for (turn, &x) in self.rotations().iter().zip(map.as_slice()) {
            turns[x as usize] = *turn;
        }
        BentDetail { points, turns }
    }

    /// True if welded vertex `x` belongs to no region and to a part that has one.
    pub(super) fn moves_freely(&self, x: usize) -> bool {
        let n_moved = self.energy.n_columns() as u32;
        let follows = || self.bound.rows.row(x).columns.iter().any(|&k| k >= n_moved);
        self.base.takes_part[x] && self.bound.region_of[x] == NO_SOURCE && !follows()
    }
}
