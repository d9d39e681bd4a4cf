//! Positions that keep the lengths of edges, from those that keep the detail.
//!
//! The energy of `energy` falls by L-BFGS (`nocedal2006`) with the factorized Laplacian of the edges as first inverse,
//! as `liu2017` do; pairs of vertices that come near push each other apart. Where triangles still cross, they push
//! harder.

mod contacts;
mod energy;

use crate::DeformError;
use crate::crossings::crossing_pairs;
use adwave::vector::{Vector, dot, norm, subtract};
use adwave::{BackgroundWork, Cancelled, Decomposer, Progress};
use adwave_baselines::linalg::{Ldlt, LinalgError, SymmetricMatrix};
use contacts::{Contacts, MARGIN, kept_distances};
use energy::{LengthEnergy, LengthState};
use std::collections::VecDeque;

/// Pairs of steps that the search direction remembers.
const N_REMEMBERED: usize = 8;

/// Steps at most.
const MAX_STEPS: usize = 100;

/// Number of steps over which the decrease of the energy is watched.
const WATCHED: usize = 4;

/// Relative decrease over the watched steps below which the energy has come to rest.
const AT_REST: f64 = 0.04;

/// First attempt.
const QUICK: Attempt = Attempt { contact: 1.0, longest_step: 2.0 };

/// Next attempts, if triangles cross after the first one.
const CAREFUL: Attempt = Attempt { contact: 8.0, longest_step: 0.5 };

/// Strength with which vertices push each other apart, and the distance that they move.
#[derive(Clone, Copy)]
struct Attempt {
    /// Weight of a contact in that of a mean edge.
    contact: f64,
    /// Longest motion of a vertex in a step, in mean edges, so that surfaces do not jump through each other.
    longest_step: f64,
}

/// Halvings of a step at most.
const MAX_HALVINGS: usize = 20;

/// Share of the decrease promised by the slope that a step must reach.
const SUFFICIENT: f64 = 1e-4;

/// Addition to the diagonal of the Laplacian, relative to it.
const RIDGE: f64 = 1e-9;

/// Number of free vertices at most.
const MAX_FREE: usize = 2_000_000;

/// Solver for one shape and its regions.
#[derive(Debug)]
pub(crate) struct LengthSolver {
    energy: LengthEnergy,
    rest: Vec<Vector>,
    kept: Vec<f64>,
    /// Number of each free vertex; `u32::MAX` of others.
    number: Vec<u32>,
    factor: Option<Ldlt>,
}

/// Positions that keep lengths, for welded vertices, with the rotations of their neighborhoods.
#[derive(Clone, Debug)]
pub(crate) struct KeptLengths {
    pub(crate) points: Vec<Vector>,
    pub(crate) turns: Vec<[f64; 4]>,
    pub(crate) n_steps: usize,
    pub(crate) is_converged: bool,
    /// Number of pairs of triangles that cross and did not at rest.
    pub(crate) n_crossing: usize,
}

/// Positions and frames of welded vertices by the nodes, which keep the detail.
#[derive(Clone, Debug)]
pub(crate) struct BentDetail {
    pub(crate) points: Vec<Vector>,
    pub(crate) turns: Vec<[f64; 4]>,
}

impl KeptLengths {
    pub(crate) fn rest_state(rest: &BentDetail) -> Self {
        let BentDetail { points, turns } = rest.clone();
        Self { points, turns, n_steps: 0, is_converged: true, n_crossing: 0 }
    }
}

/// Factorizes a matrix. The library cannot be stopped, so that it works on a thread of its own.
fn factorize(matrix: SymmetricMatrix, progress: Progress<'_>) -> Result<Ldlt, DeformError> {
    let failed = || DeformError::Singular("the thread that factorizes ended early".to_owned());
    let work = BackgroundWork::start(move || Ldlt::new(&matrix, 0.0)).ok_or_else(failed)?;
    work.finish(progress)?.ok_or_else(failed)?.map_err(|e| singular(&e))
}

fn singular(error: &LinalgError) -> DeformError {
    DeformError::Singular(error.to_string())
}

impl LengthSolver {
    /// Factorizes the Laplacian of the free vertices. `share` is in (0, 1].
    pub(crate) fn new(
        decomposer: &Decomposer,
        is_free: Vec<bool>,
        share: f64,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let rest = decomposer.positions().to_vec();
        let mut number = vec![u32::MAX; rest.len()];
        let mut n_free = 0;
        for (own, _) in number.iter_mut().zip(&is_free).filter(|(_, free)| **free) {
            *own = n_free;
            n_free += 1;
        }
        if n_free as usize > MAX_FREE {
            return Err(DeformError::TooLargeForLengths { n_free: n_free as usize, most: MAX_FREE });
        }
        let kept = kept_distances(decomposer.neighbors(), &rest);
        let energy = LengthEnergy::new(decomposer.neighbors(), &rest, is_free, share);
        let mut entries = Vec::new();
        for (x, &row) in number.iter().enumerate().filter(|(_, row)| **row != u32::MAX) {
            let diagonal = energy.sums[x] * energy.curvature() * (1.0 + RIDGE);
            entries.push((row, row, if diagonal > 0.0 { diagonal } else { 1.0 }));
            for (y, w) in energy.edges(x).filter(|(y, _)| *y > x && number[*y] != u32::MAX) {
                entries.push((row, number[y], -w * energy.curvature()));
            }
        }
        let matrix = SymmetricMatrix::from_halves(n_free as usize, &entries).map_err(|e| singular(&e))?;
        let factor = (n_free > 0).then(|| factorize(matrix, progress)).transpose()?;
        Ok(Self { energy, rest, kept, number, factor })
    }

    /// True if a welded vertex moves.
    pub(crate) fn is_free(&self, x: usize) -> bool {
        self.energy.is_free[x]
    }

    /// Positions of least energy from those of the detail mode; a second attempt is made if triangles cross.
    pub(crate) fn solve(
        &self,
        decomposer: &Decomposer,
        detail: &BentDetail,
        progress: Progress<'_>,
    ) -> Result<KeptLengths, DeformError> {
        let mut quick = self.descend(detail, &detail.points, QUICK, progress)?;
        quick.n_crossing = crossing_pairs(decomposer, &quick.points, progress)?.len();
        if quick.n_crossing == 0 {
            return Ok(quick);
        }
        let careful = self.follow(decomposer, detail, detail, progress)?;
        Ok(if careful.n_crossing < quick.n_crossing { careful } else { quick })
    }

    /// Positions of least energy from a start, by short steps.
    pub(crate) fn follow(
        &self,
        decomposer: &Decomposer,
        start: &BentDetail,
        detail: &BentDetail,
        progress: Progress<'_>,
    ) -> Result<KeptLengths, DeformError> {
        let mut found = self.descend(start, &detail.points, CAREFUL, progress)?;
        found.n_crossing = crossing_pairs(decomposer, &found.points, progress)?.len();
        Ok(found)
    }

    fn contacts(
        &self,
        points: &[Vector],
        weight: f64,
        progress: Progress<'_>,
    ) -> Result<Contacts, Cancelled> {
        let unit = self.energy.unit;
        let (margin, scaled) = (MARGIN * unit, weight / (unit * unit));
        Contacts::new(points, &self.rest, &self.kept, &self.energy.is_free, margin, scaled, progress)
    }

    /// Steps of L-BFGS until the energy rests.
    fn descend(
        &self,
        start: &BentDetail,
        detail: &[Vector],
        attempt: Attempt,
        progress: Progress<'_>,
    ) -> Result<KeptLengths, DeformError> {
        let n = self.rest.len();
        let unit = self.energy.unit;
        let mut contacts = self.contacts(&start.points, attempt.contact, progress)?;
        let mut state = LengthState {
            points: start.points.clone(),
            turns: start.turns.clone(),
            gradient: vec![[0.0; 3]; n],
            value: 0.0,
        };
        self.energy.evaluate(&mut state, detail, &contacts, progress)?;
        let mut memory = Memory::default();
        let mut listed_at = state.points.clone();
        let mut values = vec![state.value];
        let (mut n_steps, mut is_converged) = (0, false);
        while n_steps < MAX_STEPS {
            progress.step(n_steps as u64, MAX_STEPS as u64)?;
            let mut direction = memory.direction(&state.gradient, |v| self.precondition(v));
            progress.check()?;
            let longest = direction.iter().map(norm).fold(0.0, f64::max);
            let cap = attempt.longest_step * unit;
            let slope = total(&state.gradient, &direction);
            if !(slope < 0.0 && longest > 0.0 && longest.is_finite()) {
                is_converged = slope == 0.0 || longest == 0.0;
                break;
            }
            let mut length = (cap / longest).min(1.0);
            let mut next = None;
            for _ in 0..MAX_HALVINGS {
                progress.check()?;
                let mut trial = state.clone();
                advance(&mut trial.points, length, &direction);
                self.energy.evaluate(&mut trial, detail, &contacts, progress)?;
                if trial.value <= state.value + SUFFICIENT * length * slope {
                    next = Some(trial);
                    break;
                }
                length *= 0.5;
            }
            let Some(next) = next else {
                is_converged = true;
                break;
            };
            for v in &mut direction {
                *v = v.map(|c| length * c);
            }
            memory.remember(direction, &state.gradient, &next.gradient);
            state = next;
            n_steps += 1;
            let moved = state.points.iter().zip(&listed_at).map(|(a, b)| norm(&subtract(a, b)));
            // Both vertices of a pair may move.
            if moved.fold(0.0, f64::max) > 0.5 * MARGIN * unit {
                contacts = self.contacts(&state.points, attempt.contact, progress)?;
                listed_at.clone_from(&state.points);
                self.energy.evaluate(&mut state, detail, &contacts, progress)?;
            }
            values.push(state.value);
            if n_steps >= WATCHED && values[n_steps - WATCHED] - state.value <= AT_REST * state.value {
                is_converged = true;
                break;
            }
        }
        Ok(KeptLengths { points: state.points, turns: state.turns, n_steps, is_converged, n_crossing: 0 })
    }

    /// Solution of the Laplacian for the free vertices; 0 at the others.
    fn precondition(&self, v: &[Vector]) -> Vec<Vector> {
        let mut result = vec![[0.0; 3]; v.len()];
        let Some(factor) = &self.factor else { return result };
        let n = factor.n();
        let mut columns = vec![0.0; 3 * n];
        for (row, value) in self.number.iter().zip(v).filter(|(row, _)| **row != u32::MAX) {
            for c in 0..3 {
                columns[c * n + *row as usize] = value[c];
            }
        }
        factor.solve_columns(&mut columns);
        for (row, value) in self.number.iter().zip(&mut result).filter(|(row, _)| **row != u32::MAX) {
            *value = [0, 1, 2].map(|c| columns[c * n + *row as usize]);
        }
        result
    }
}

/// Steps and changes of the gradient that an L-BFGS direction is made of.
#[derive(Default)]
struct Memory {
    pairs: VecDeque<(Vec<Vector>, Vec<Vector>, f64)>,
}

impl Memory {
    /// Direction of descent: minus the approximate inverse of the second derivative times the gradient.
    fn direction(&self, gradient: &[Vector], inverse: impl Fn(&[Vector]) -> Vec<Vector>) -> Vec<Vector> {
        let mut q = gradient.to_vec();
        let mut shares = Vec::with_capacity(self.pairs.len());
        for (step, change, product) in self.pairs.iter().rev() {
            let share = total(step, &q) / product;
            advance(&mut q, -share, change);
            shares.push(share);
        }
        let mut z = inverse(&q);
        for ((step, change, product), share) in self.pairs.iter().zip(shares.iter().rev()) {
            let excess = share - total(change, &z) / product;
            advance(&mut z, excess, step);
        }
        z.iter().map(|v| v.map(|c| -c)).collect()
    }

    /// Adds a step; one along which the gradient does not grow is left out.
    fn remember(&mut self, step: Vec<Vector>, before: &[Vector], after: &[Vector]) {
        let change: Vec<Vector> = after.iter().zip(before).map(|(a, b)| subtract(a, b)).collect();
        let product = total(&step, &change);
        if product > 1e-12 * total(&step, &step).sqrt() * total(&change, &change).sqrt() {
            self.pairs.push_back((step, change, product));
            if self.pairs.len() > N_REMEMBERED {
                self.pairs.pop_front();
            }
        }
    }
}

fn total(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(u, v)| dot(u, v)).sum()
}

/// `a ← a + s·b`.
fn advance(a: &mut [Vector], s: f64, b: &[Vector]) {
    for (u, v) in a.iter_mut().zip(b) {
        for c in 0..3 {
            u[c] += s * v[c];
        }
    }
}

#[cfg(test)]
mod tests;
