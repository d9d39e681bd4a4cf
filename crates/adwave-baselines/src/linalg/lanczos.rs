//! Block Lanczos method with full reorthogonalization and thick restarts, for `(A − σI)⁻¹`.
//!
//! The solver keeps a basis V of the block Krylov space and all of `T = Vᵀ(A − σI)⁻¹V`, so that a restart with the best
//! Ritz vectors (`wu2000`) needs no special case. With blocks, the reorthogonalization is a product of matrices and the
//! solves share one pass through the factor; blocks also find multiple eigenvalues. The partial eigensolver of faer
//! does not return on some inputs.

use super::ldlt::Ldlt;
use super::panel::{Panel, add_product, gram, norm};
use super::{LinalgError, symmetric_eigen};
use adwave::Progress;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Number of vectors per block: two groups of the factor's lanes, for two threads.
const BLOCK: usize = 16;
/// Fraction of its norm to which orthogonalization must reduce a vector so that it counts as dependent on the others.
const DEPENDENT: f64 = 1e-11;

/// Numbers of requested eigenpairs, and limits of the iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct EigenRequest {
    /// Exact number of eigenvalues below σ that are not locked yet.
    pub(super) below: usize,
    /// Smallest number of eigenpairs next above σ, as far as they exist.
    pub(super) above: usize,
    /// Largest relative residual `‖(A−σI)⁻¹x − θx‖ / |θ|`.
    pub(super) tolerance: f64,
    /// Largest number of solves.
    pub(super) max_solves: usize,
}

/// Converged eigenpairs, in ascending order of the eigenvalue.
#[derive(Debug)]
pub(super) struct ConvergedPairs {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Panel,
    pub(super) solves: usize,
    pub(super) restarts: usize,
}

/// Computes the eigenpairs of A nearest to the shift of `factor`, orthogonal to the orthonormal columns of `locked`.
pub(super) fn nearest_eigenpairs(
    factor: &Ldlt,
    locked: &Panel,
    wanted: EigenRequest,
    progress: Progress<'_>,
) -> Result<ConvergedPairs, LinalgError> {
    let n = factor.n();
    let room = n - locked.n_columns().min(n);
    let count = (wanted.below + wanted.above).min(room);
    let mut state = LanczosState {
        factor,
        locked,
        basis: Panel::new(n),
        t: Vec::new(),
        block_start: 0,
        random: Pcg64::new(0x5eed, 0xada),
        solves: 0,
    };
    if count == 0 {
        return Ok(ConvergedPairs { values: Vec::new(), vectors: Panel::new(n), solves: 0, restarts: 0 });
    }
    let most = (2 * count + 12 * BLOCK).min(room);
    let mut first = vec![0.0; n * BLOCK.min(room)];
    state.fill_random(&mut first);
    let _ = state.project(&mut first);
    let kept = state.orthonormalize(&mut first).len() / BLOCK.min(room);
    first.truncate(kept * n);
    state.basis.values.extend(first);
    let mut check_at = count + 4 * BLOCK;
    let mut restarts = 0;
    loop {
        progress.step(state.solves as u64, wanted.max_solves as u64)?;
        let (next, coupling) = state.expand();
        let size = state.basis.n_columns();
        let exhausted = next.is_empty();
        let out_of_solves = state.solves >= wanted.max_solves;
        if exhausted || out_of_solves || size >= check_at.min(most) {
            let ritz = state.ritz(&coupling)?;
            let chosen = choose(&ritz, factor.shift(), wanted, room, exhausted);
            let (below, above) = (chosen.below.len(), chosen.above.len());
            if exhausted || (below >= wanted.below && above >= wanted.above) {
                return Ok(state.converged_pairs(&ritz, &chosen, restarts));
            }
            if out_of_solves {
                return Err(LinalgError::NotConverged {
                    found: below + above,
                    wanted: count,
                    solves: state.solves,
                });
            }
            if size + next.len() / n > most {
                // Half of the remaining Ritz vectors are kept besides the needed ones, which preserves the speed of
                // convergence.
                let keep = (count + (size - count.min(size)) / 3).min(size.saturating_sub(2 * BLOCK)).max(1);
                state.restart(&ritz, keep);
                restarts += 1;
            }
            check_at = state.basis.n_columns() + (size / 10).max(2 * BLOCK);
        }
        state.block_start = state.basis.n_columns();
        state.basis.values.extend(next);
    }
}

struct LanczosState<'a> {
    factor: &'a Ldlt,
    locked: &'a Panel,
    basis: Panel,
    /// Matrix T, one vector per column.
    t: Vec<Vec<f64>>,
    /// Index of the first vector in the newest block of the basis.
    block_start: usize,
    random: Pcg64,
    solves: usize,
}

/// Eigenpairs of T.
struct RitzPairs {
    theta: Vec<f64>,
    y: Vec<f64>,
    size: usize,
    residual: Vec<f64>,
}

struct ChosenPairs {
    below: Vec<usize>,
    above: Vec<usize>,
}

impl LanczosState<'_> {
    fn fill_random(&mut self, columns: &mut [f64]) {
        for v in columns {
            *v = StandardNormal.sample(&mut self.random);
        }
    }

    /// Subtracts from `w` its components along the locked vectors and the basis, twice; returns the components along
    /// the basis.
    fn project(&self, w: &mut [f64]) -> Vec<f64> {
        let n = self.basis.n;
        let mut h = vec![0.0; self.basis.n_columns() * (w.len() / n)];
        for _ in 0..2 {
            let inside = gram(n, &self.locked.values, w);
            add_product(n, w, -1.0, &self.locked.values, &inside);
            let inside = gram(n, &self.basis.values, w);
            add_product(n, w, -1.0, &self.basis.values, &inside);
            for (h, v) in h.iter_mut().zip(inside) {
                *h += v;
            }
        }
        h
    }

    /// Multiplies the newest block by the inverse and fills in T; returns the next block and its coupling to the newest
    /// one.
    fn expand(&mut self) -> (Vec<f64>, Vec<f64>) {
        let n = self.basis.n;
        let size = self.basis.n_columns();
        let width = size - self.block_start;
        let mut w = self.basis.columns(self.block_start..size).to_vec();
        self.factor.solve_columns(&mut w);
        self.solves += width;
        let h = self.project(&mut w);
        for column in &mut self.t {
            column.resize(size, 0.0);
        }
        for c in 0..width {
            let column = h[c * size..][..size].to_vec();
            let j = self.block_start + c;
            for (i, &value) in column.iter().enumerate().take(self.block_start) {
                self.t[i][j] = value;
            }
            self.t.push(column);
        }
        let coupling = self.orthonormalize(&mut w);
        let kept = coupling.len() / width.max(1);
        w.truncate(kept * n);
        (w, coupling)
    }

    /// Orthonormalizes the columns of `w`, which are already orthogonal to the basis, and returns R with
    /// `w_before = w R`, rows × columns, row-major. Dependent columns are replaced by random ones. If the space is
    /// exhausted, R has fewer rows, and the surplus columns of `w` must be ignored.
    fn orthonormalize(&mut self, w: &mut [f64]) -> Vec<f64> {
        let n = self.basis.n;
        let width = w.len() / n;
        let mut r: Vec<Vec<f64>> = Vec::new();
        let largest = w.chunks_exact(n).map(norm).fold(0.0, f64::max);
        let mut kept = 0;
        for j in 0..width {
            w.copy_within(j * n..(j + 1) * n, kept * n);
            let (before, rest) = w.split_at_mut(kept * n);
            let column = &mut rest[..n];
            let (inside, length) = gram_schmidt(n, before, column);
            for (row, value) in r.iter_mut().zip(&inside) {
                row[j] = *value;
            }
            if length > DEPENDENT * largest && length > 0.0 {
                let mut row = vec![0.0; width];
                row[j] = length;
                for v in column.iter_mut() {
                    *v /= length;
                }
                // A small remainder has lost its orthogonality to the basis.
                if length < 1e-4 * largest && !self.reorthogonalize(w, kept) {
                    continue;
                }
                r.push(row);
                kept += 1;
            } else {
                self.fill_random(&mut w[kept * n..(kept + 1) * n]);
                if self.reorthogonalize(w, kept) {
                    r.push(vec![0.0; width]);
                    kept += 1;
                }
            }
        }
        r.concat()
    }

    /// Orthogonalizes column `at` of `w` against all other vectors again; `false` if nothing of it remains.
    fn reorthogonalize(&self, w: &mut [f64], at: usize) -> bool {
        let n = self.basis.n;
        let (before, rest) = w.split_at_mut(at * n);
        let column = &mut rest[..n];
        for _ in 0..2 {
            let start = norm(column);
            if start == 0.0 {
                return false;
            }
            for v in column.iter_mut() {
                *v /= start;
            }
            let _ = self.project(column);
            let (_, length) = gram_schmidt(n, before, column);
            if length <= DEPENDENT {
                return false;
            }
            for v in column.iter_mut() {
                *v /= length;
            }
        }
        true
    }

    fn ritz(&self, coupling: &[f64]) -> Result<RitzPairs, LinalgError> {
        let size = self.t.len();
        let mut t = vec![0.0; size * size];
        for (j, column) in self.t.iter().enumerate() {
            for (i, &value) in column.iter().enumerate() {
                t[j * size + i] = 0.5 * (value + self.t[i][j]);
            }
        }
        let (theta, y) = symmetric_eigen(&t, size)?;
        let width = size - self.block_start;
        let residual = (0..size)
            .map(|i| {
                let last = &y[i * size + self.block_start..(i + 1) * size];
                let squares = coupling
                    .chunks_exact(width)
                    .map(|row| row.iter().zip(last).map(|(a, b)| a * b).sum::<f64>().powi(2));
                squares.sum::<f64>().sqrt()
            })
            .collect();
        Ok(RitzPairs { theta, y, size, residual })
    }

    fn restart(&mut self, ritz: &RitzPairs, keep: usize) {
        let mut order: Vec<usize> = (0..ritz.size).collect();
        order.sort_by(|&a, &b| ritz.theta[b].abs().total_cmp(&ritz.theta[a].abs()));
        order.truncate(keep);
        self.basis = self.combine(ritz, &order);
        self.t = (0..keep)
            .map(|j| (0..keep).map(|i| if i == j { ritz.theta[order[j]] } else { 0.0 }).collect())
            .collect();
    }

    /// Computes the Ritz vectors of the pairs `which`.
    fn combine(&self, ritz: &RitzPairs, which: &[usize]) -> Panel {
        let n = self.basis.n;
        let y: Vec<f64> =
            which.iter().flat_map(|&i| ritz.y[i * ritz.size..(i + 1) * ritz.size].iter().copied()).collect();
        let mut values = vec![0.0; n * which.len()];
        add_product(n, &mut values, 1.0, self.basis.columns(0..ritz.size), &y);
        Panel { n, values }
    }

    fn converged_pairs(&self, ritz: &RitzPairs, chosen: &ChosenPairs, restarts: usize) -> ConvergedPairs {
        let which: Vec<usize> = chosen.below.iter().rev().chain(&chosen.above).copied().collect();
        ConvergedPairs {
            values: which.iter().map(|&i| self.factor.shift() + 1.0 / ritz.theta[i]).collect(),
            vectors: self.combine(ritz, &which),
            solves: self.solves,
            restarts,
        }
    }
}

/// Selects the Ritz pairs that are eigenpairs: outward from σ, as far as all have converged.
fn choose(ritz: &RitzPairs, shift: f64, wanted: EigenRequest, room: usize, exhausted: bool) -> ChosenPairs {
    let is_good = |i: &usize| exhausted || ritz.residual[*i] <= wanted.tolerance * ritz.theta[*i].abs();
    let mut above: Vec<usize> = (0..ritz.size).filter(|&i| ritz.theta[i] > 0.0).collect();
    let mut below: Vec<usize> = (0..ritz.size).filter(|&i| ritz.theta[i] < 0.0).collect();
    above.sort_by(|&a, &b| ritz.theta[b].total_cmp(&ritz.theta[a]));
    below.sort_by(|&a, &b| ritz.theta[a].total_cmp(&ritz.theta[b]));
    let mut above: Vec<usize> = above.into_iter().take_while(is_good).collect();
    // Below σ the count is known; a Ritz value beyond that count is not an eigenvalue yet.
    let mut below: Vec<usize> = below.into_iter().take_while(is_good).collect();
    below.truncate(wanted.below);
    above.truncate(room - below.len());
    debug_assert!(shift.is_finite());
    ChosenPairs { below, above }
}

/// Subtracts from `column` its components along the orthonormal `before`, twice; returns these components and the norm
/// of the remainder.
fn gram_schmidt(n: usize, before: &[f64], column: &mut [f64]) -> (Vec<f64>, f64) {
    let mut inside = vec![0.0; before.len() / n];
    for _ in 0..2 {
        let part = gram(n, before, column);
        add_product(n, column, -1.0, before, &part);
        for (sum, p) in inside.iter_mut().zip(part) {
            *sum += p;
        }
    }
    (inside, norm(column))
}
