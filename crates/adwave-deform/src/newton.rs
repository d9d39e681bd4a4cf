//! Truncated Newton steps on the energy of the nodes (`nocedal2006`). For given rotations the best maps follow from a
//! factorization of Q, which a bound deformation keeps; the steps are those of the energy with the best maps, by
//! conjugate gradients over the rotations.

use crate::DeformError;
use crate::node_energy::{ColumnMap, NodeEnergy};
use crate::rotation::{
    IDENTITY, Matrix, NO_TURN, add_outer, compose, exponential, image, nearest_rotation, normalized,
    symmetric_eigen, to_matrix, transpose,
};
use crate::skyline::{Skyline, near_order};
use adwave::vector::{Vector, dot};
use adwave::{Cancelled, Progress};

/// Addition to the diagonal of Q, relative to its largest entry, that keeps columns without samples solvable.
const RIDGE: f64 = 1e-10;

/// Squared residual, relative to the first, at which the direction of a step is good enough.
const ENOUGH: f64 = 1e-7;

/// Largest rotation vector of a step along a direction in which the energy is not convex.
const LARGEST_TURN: f64 = 0.2;

/// Earlier directions that a step combines.
const N_EARLIER: usize = 3;

/// Halvings of a step at most.
const MAX_HALVINGS: usize = 30;

/// Share of the decrease promised by the slope that a step must reach.
const SUFFICIENT: f64 = 1e-4;

/// Least curvature of a rotation in the preconditioner, relative to the mass of its node.
const LEAST_CURVATURE: f64 = 0.1;

/// Sweeps of the harmonic start of the rotations at most.
const MAX_HARMONIC: usize = 400;

/// State of the columns.
#[derive(Clone)]
pub(crate) struct NodeState {
    pub(crate) maps: Vec<ColumnMap>,
    pub(crate) turns: Vec<[f64; 4]>,
}

/// Factorization of Q over the free numbers of the columns.
pub(crate) struct NodeSolver {
    factor: Option<Skyline>,
    /// Row of each column's four numbers among the free ones.
    rows: Vec<[Option<usize>; 4]>,
    pub(crate) has_free_turn: Vec<bool>,
    n_free: usize,
}

/// Outcome of one step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NewtonStep {
    pub(crate) before: f64,
    pub(crate) after: f64,
    pub(crate) n_products: usize,
}

/// `[ω]·m` for the cross product with ω.
fn cross_rows(omega: &Vector, m: &Matrix) -> Matrix {
    let [x, y, z] = *omega;
    let row = |a: f64, u: usize, b: f64, v: usize| [0, 1, 2].map(|c| a * m[u][c] + b * m[v][c]);
    [row(-z, 1, y, 2), row(z, 0, -x, 2), row(-y, 0, x, 1)]
}

/// The vector v with `⟨[ω] r, m⟩ = ω·v`.
fn axial(m: &Matrix, r: &Matrix) -> Vector {
    let n = |i: usize, j: usize| dot(&m[i], &r[j]);
    [n(2, 1) - n(1, 2), n(0, 2) - n(2, 0), n(1, 0) - n(0, 1)]
}

/// Values at the present state that products with the Hessian share.
struct Linearized {
    rotations: Vec<Matrix>,
    /// `2 (tr(N) I − sym(N))` with `N = M Rᵀ`.
    curvature: Vec<Matrix>,
    /// Inverse of the curvature, made positive.
    inverse: Vec<Matrix>,
}

/// Directions of earlier steps, among which a step is exact: a limb that hangs on by a thin neck costs so little energy
/// that single steps would leave it behind.
#[derive(Clone, Default)]
pub(crate) struct EarlierSteps(Vec<Vec<Vector>>);

/// Earlier directions with their products, and the triangular factor of their Gram matrix.
struct Deflation {
    directions: Vec<Vec<Vector>>,
    products: Vec<Vec<Vector>>,
}

impl Deflation {
    /// Directions made conjugate to each other; those that add nothing are left out.
    fn new(earlier: &EarlierSteps, product: &dyn Fn(&[Vector]) -> Vec<Vector>) -> Self {
        let mut own = Self { directions: Vec::new(), products: Vec::new() };
        for direction in &earlier.0 {
            let mut d = direction.clone();
            own.remove(&mut d, None);
            let size = total_dot(direction, direction);
            let left = total_dot(&d, &d);
            if left.is_nan() || left <= 1e-6 * size {
                continue;
            }
            let h = product(&d);
            let curvature = total_dot(&d, &h);
            if curvature > 0.0 && curvature.is_finite() {
                let factor = 1.0 / curvature.sqrt();
                own.directions.push(scale(&d, factor));
                own.products.push(scale(&h, factor));
            }
        }
        own
    }

    /// Makes `d` conjugate to the directions, and its product accordingly.
    fn remove(&self, d: &mut [Vector], mut product: Option<&mut [Vector]>) {
        for (w, h) in self.directions.iter().zip(&self.products) {
            let share = total_dot(d, h);
            combine(d, 1.0, -share, w);
            if let Some(product) = product.as_deref_mut() {
                combine(product, 1.0, -share, h);
            }
        }
    }

    /// Best combination of the directions for a residual, and the residual that it leaves.
    fn best(&self, residual: &mut [Vector]) -> Vec<Vector> {
        let mut x = vec![[0.0; 3]; residual.len()];
        for (w, h) in self.directions.iter().zip(&self.products) {
            let share = total_dot(w, residual);
            combine(&mut x, 1.0, share, w);
            combine(residual, 1.0, -share, h);
        }
        x
    }
}

fn total_dot(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(u, v)| dot(u, v)).sum()
}

fn scale(a: &[Vector], s: f64) -> Vec<Vector> {
    a.iter().map(|v| v.map(|c| s * c)).collect()
}

/// `a ← s·a + t·b`.
fn combine(a: &mut [Vector], s: f64, t: f64, b: &[Vector]) {
    for (u, v) in a.iter_mut().zip(b) {
        for c in 0..3 {
            u[c] = s * u[c] + t * v[c];
        }
    }
}

impl NodeSolver {
    /// Factorizes Q over the free numbers: all four of nodes, and the linear part of a single point.
    pub(crate) fn new(energy: &NodeEnergy, n_nodes: usize, is_point: &[bool]) -> Result<Self, DeformError> {
        let (mut rows, mut n_free) = (vec![[None; 4]; energy.n_columns()], 0);
        let mut has_free_turn = vec![true; n_nodes];
        has_free_turn.extend_from_slice(is_point);
        for k in near_order(&energy.offsets, &energy.columns) {
            let row = &mut rows[k];
            let n = if k < n_nodes { 4 } else { 3 * usize::from(is_point[k - n_nodes]) };
            for slot in &mut row[..n] {
                *slot = Some(n_free);
                n_free += 1;
            }
        }
        let mut entries = Vec::new();
        let mut largest = 0.0_f64;
        for (k, l, block) in energy.blocks() {
            for (a, values) in block.iter().enumerate() {
                for (b, &value) in values.iter().enumerate() {
                    let (Some(row), Some(col)) = (rows[k][a], rows[l][b]) else { continue };
                    if row >= col {
                        entries.push((row, col, value));
                        largest = largest.max(value.abs());
                    }
                }
            }
        }
        let ridge = if largest > 0.0 { RIDGE * largest } else { 1.0 };
        entries.extend((0..n_free).map(|row| (row, row, ridge)));
        if !largest.is_finite() {
            return Err(DeformError::Singular("an entry is not finite".to_owned()));
        }
        let factor = match n_free {
            0 => None,
            _ => Some(
                Skyline::new(n_free, &entries)
                    .ok_or_else(|| DeformError::Singular("a pivot is not positive".to_owned()))?,
            ),
        };
        Ok(Self { factor, rows, has_free_turn, n_free })
    }

    /// `Q⁻¹` on the free numbers; 0 on the others.
    fn solve(&self, maps: &[ColumnMap]) -> Vec<ColumnMap> {
        let mut result = vec![[[0.0; 3]; 4]; maps.len()];
        let Some(factor) = &self.factor else { return result };
        let mut right = [0, 1, 2].map(|_| vec![0.0; self.n_free]);
        for (map, rows) in maps.iter().zip(&self.rows) {
            for (v, row) in map.iter().zip(rows) {
                if let Some(row) = row {
                    for (side, c) in right.iter_mut().zip(v) {
                        side[*row] = *c;
                    }
                }
            }
        }
        factor.solve(&mut right);
        for (map, rows) in result.iter_mut().zip(&self.rows) {
            for (v, row) in map.iter_mut().zip(rows) {
                if let Some(row) = row {
                    *v = [0, 1, 2].map(|c| right[c][*row]);
                }
            }
        }
        result
    }

    /// Rotations spread from the regions over the nodes, and the maps that are best with them.
    pub(crate) fn harmonic_start(&self, energy: &NodeEnergy, state: &mut NodeState) {
        let n = energy.n_columns();
        let reference = (0..n).find(|&k| !self.has_free_turn[k]).map_or(NO_TURN, |k| state.turns[k]);
        for (turn, is_free) in state.turns.iter_mut().zip(&self.has_free_turn) {
            let cosine: f64 = turn.iter().zip(&reference).map(|(a, b)| a * b).sum();
            if *is_free {
                *turn = reference;
            } else if cosine < 0.0 {
                *turn = turn.map(|c| -c);
            }
        }
        let mut order: Vec<usize> = (0..n).filter(|&k| self.has_free_turn[k]).collect();
        for sweep in 0..MAX_HARMONIC {
            let mut largest = 0.0_f64;
            for &k in &order {
                let (mut sum, mut total) = ([0.0; 4], 0.0);
                for (l, w) in energy.bends(k).filter(|(l, _)| *l != k) {
                    total += w;
                    for (s, c) in sum.iter_mut().zip(&state.turns[l]) {
                        *s += w * c;
                    }
                }
                if total > 0.0 {
                    let next = sum.map(|s| s / total);
                    for (c, old) in next.iter().zip(&state.turns[k]) {
                        largest = largest.max((c - old).abs());
                    }
                    state.turns[k] = next;
                }
            }
            order.reverse();
            if largest < 1e-4 && sweep > 2 {
                break;
            }
        }
        for turn in &mut state.turns {
            *turn = normalized(turn);
        }
        self.fit_maps(energy, state);
    }

    /// Best maps for the present rotations.
    pub(crate) fn fit_maps(&self, energy: &NodeEnergy, state: &mut NodeState) {
        let rotations: Vec<Matrix> = state.turns.iter().map(to_matrix).collect();
        let (products, pulled) = (energy.stretch(&state.maps), energy.pull_back(&rotations));
        let difference =
            |(p, q): (&ColumnMap, &ColumnMap)| [0, 1, 2, 3].map(|a| [0, 1, 2].map(|c| p[a][c] - q[a][c]));
        let residual: Vec<ColumnMap> = pulled.iter().zip(&products).map(difference).collect();
        let change = self.solve(&residual);
        for (map, d) in state.maps.as_flattened_mut().iter_mut().zip(change.as_flattened()) {
            for c in 0..3 {
                map[c] += d[c];
            }
        }
    }

    /// One sweep of best rotations for the present maps.
    fn fit_turns(&self, energy: &NodeEnergy, state: &mut NodeState) {
        let fitted = energy.fit_matrices(&state.maps);
        let mut rotations: Vec<Matrix> = state.turns.iter().map(to_matrix).collect();
        for k in (0..energy.n_columns()).filter(|&k| self.has_free_turn[k]) {
            let bend = energy.bend_row(k, &rotations);
            let target = [0, 1, 2].map(|i| [0, 1, 2].map(|c| fitted[k][i][c] + bend[i][c]));
            let best = nearest_rotation(&target);
            let matrix = to_matrix(&best);
            let gain = |r: &Matrix| (0..3).map(|i| dot(&r[i], &target[i])).sum::<f64>();
            if gain(&matrix) > gain(&rotations[k]) {
                let cosine: f64 = best.iter().zip(&state.turns[k]).map(|(a, b)| a * b).sum();
                state.turns[k] = if cosine < 0.0 { best.map(|c| -c) } else { best };
                rotations[k] = matrix;
            }
        }
    }

    /// Gradient of the energy with the best maps, by the rotations, and the values that products with its Hessian
    /// share.
    fn linearize(&self, energy: &NodeEnergy, state: &NodeState) -> (Linearized, Vec<Vector>) {
        let n = energy.n_columns();
        let rotations: Vec<Matrix> = state.turns.iter().map(to_matrix).collect();
        let fitted = energy.fit_matrices(&state.maps);
        let (mut gradient, mut curvature) = (vec![[0.0; 3]; n], Vec::with_capacity(n));
        let mut inverse = Vec::with_capacity(n);
        for k in 0..n {
            let bend = energy.bend_row(k, &rotations);
            let m = [0, 1, 2].map(|i| [0, 1, 2].map(|c| fitted[k][i][c] + bend[i][c]));
            if self.has_free_turn[k] {
                gradient[k] = axial(&m, &rotations[k]).map(|c| -2.0 * c);
            }
            let n = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&m[i], &rotations[k][j])));
            let trace = n[0][0] + n[1][1] + n[2][2];
            let d: Matrix = [0, 1, 2]
                .map(|i| [0, 1, 2].map(|j| 2.0 * (trace * IDENTITY[i][j] - 0.5 * (n[i][j] + n[j][i]))));
            curvature.push(d);
            inverse.push(positive_inverse(&d, LEAST_CURVATURE * energy.masses[k]));
        }
        (Linearized { rotations, curvature, inverse }, gradient)
    }

    /// Product of the Hessian of the energy with the best maps, by the rotations: `(H_ωω − H_ωT H_TT⁻¹ H_Tω) ω`.
    fn hessian(&self, energy: &NodeEnergy, at: &Linearized, omega: &[Vector]) -> Vec<Vector> {
        let turned: Vec<Matrix> = omega.iter().zip(&at.rotations).map(|(w, r)| cross_rows(w, r)).collect();
        let maps = self.solve(&energy.pull_back(&turned));
        let fitted = energy.fit_matrices(&maps);
        let product = |k: usize| {
            if !self.has_free_turn[k] {
                return [0.0; 3];
            }
            let bend = energy.bend_row(k, &turned);
            let m = [0, 1, 2].map(|i| [0, 1, 2].map(|c| fitted[k][i][c] + bend[i][c]));
            let (coupled, own) = (axial(&m, &at.rotations[k]), image(&at.curvature[k], &omega[k]));
            [0, 1, 2].map(|c| own[c] - 2.0 * coupled[c])
        };
        energy.each_column(product)
    }

    fn precondition(&self, at: &Linearized, r: &[Vector]) -> Vec<Vector> {
        let free = |k: usize| if self.has_free_turn[k] { image(&at.inverse[k], &r[k]) } else { [0.0; 3] };
        (0..r.len()).map(free).collect()
    }

    /// Direction of a step: conjugate gradients after the best combination of earlier directions.
    fn direction(
        &self,
        energy: &NodeEnergy,
        at: &Linearized,
        gradient: &[Vector],
        limits: StepLimits<'_>,
        earlier: &EarlierSteps,
    ) -> Result<(Vec<Vector>, usize), Cancelled> {
        let product = |omega: &[Vector]| self.hessian(energy, at, omega);
        let deflation = Deflation::new(earlier, &product);
        let mut n_products = deflation.directions.len();
        let mut r = scale(gradient, -1.0);
        let at_start = total_dot(&r, &self.precondition(at, &r));
        let mut x = deflation.best(&mut r);
        let mut p = self.precondition(at, &r);
        let mut rz = total_dot(&r, &p);
        deflation.remove(&mut p, None);
        while n_products < limits.max_products && rz > ENOUGH * at_start && rz > 0.0 {
            limits.progress.check()?;
            let hp = product(&p);
            n_products += 1;
            let curvature = total_dot(&p, &hp);
            if curvature.is_nan() || curvature <= 1e-14 * rz {
                // Downhill without an end. What was found is good; before that, as far as rotations stay moderate.
                let largest = p.iter().map(|v| dot(v, v).sqrt()).fold(0.0, f64::max);
                if n_products == deflation.directions.len() + 1 && largest > 0.0 && largest.is_finite() {
                    combine(&mut x, 1.0, LARGEST_TURN / largest, &p);
                }
                break;
            }
            let alpha = rz / curvature;
            combine(&mut x, 1.0, alpha, &p);
            combine(&mut r, 1.0, -alpha, &hp);
            let mut z = self.precondition(at, &r);
            let next = total_dot(&r, &z);
            deflation.remove(&mut z, None);
            combine(&mut p, next / rz, 1.0, &z);
            rz = next;
        }
        Ok((x, n_products))
    }

    /// One step of about `max_products` products with the Hessian. The energy does not grow.
    pub(crate) fn step(
        &self,
        energy: &NodeEnergy,
        state: &mut NodeState,
        earlier: &mut EarlierSteps,
        limits: StepLimits<'_>,
    ) -> Result<NewtonStep, Cancelled> {
        let value = |state: &NodeState| {
            energy.value(&state.maps, &state.turns.iter().map(to_matrix).collect::<Vec<_>>())
        };
        let before = value(state);
        self.fit_turns(energy, state);
        self.fit_maps(energy, state);
        let (at, gradient) = self.linearize(energy, state);
        let (x, n_products) = self.direction(energy, &at, &gradient, limits, earlier)?;
        let slope = total_dot(&gradient, &x);
        let current = value(state);
        let mut after = current;
        if slope < 0.0 {
            let mut length = 1.0;
            for _ in 0..MAX_HALVINGS {
                let mut trial = rotate_state(state, &x, length);
                self.fit_maps(energy, &mut trial);
                let found = value(&trial);
                if found <= current + SUFFICIENT * length * slope {
                    (*state, after) = (trial, found);
                    break;
                }
                length *= 0.5;
            }
            earlier.0.insert(0, x);
            earlier.0.truncate(N_EARLIER);
        }
        Ok(NewtonStep { before, after, n_products })
    }
}

/// Limits of a step.
#[derive(Clone, Copy)]
pub(crate) struct StepLimits<'a> {
    pub(crate) max_products: usize,
    pub(crate) progress: Progress<'a>,
}

/// State after rotations by vectors.
fn rotate_state(state: &NodeState, direction: &[Vector], length: f64) -> NodeState {
    let mut next = state.clone();
    for (turn, v) in next.turns.iter_mut().zip(direction) {
        if *v != [0.0; 3] {
            *turn = normalized(&compose(&exponential(&v.map(|c| length * c)), turn));
        }
    }
    next
}

/// Inverse of a symmetric matrix whose eigenvalues are raised to at least `least`; 0 without any.
fn positive_inverse(m: &Matrix, least: f64) -> Matrix {
    let (values, vectors) = symmetric_eigen(*m);
    let mut inverse = [[0.0; 3]; 3];
    for (k, value) in values.iter().enumerate() {
        let value = value.max(least);
        if value > 0.0 && value.is_finite() {
            let v = transpose(&vectors)[k];
            add_outer(&mut inverse, 1.0 / value, &v, &v);
        }
    }
    inverse
}

#[cfg(test)]
mod tests;
