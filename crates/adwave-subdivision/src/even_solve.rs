//! Solver for the coarse values from which subdivision makes given values at the coarse vertices.
//!
//! Both rules move the coarse vertices too: `f = E·c` with `E c(v) = c(v) + Σ β(v)·(c(w) − c(v))`.
//!
//! Loop subdivision: vertices on a border occur in the rows of others, but their own rows have only neighbors on the
//! border. Both blocks, divided by their β, are symmetric and positive definite. Inside, the spectrum of the rows
//! divided by their diagonals lies between 1 − max (nβ/2)/(1 − nβ) and 1 + max nβ/(1 − nβ), since Σ (x_a + x_b + x_c)²
//! ≥ 0 over the faces; on a border it lies between 2/3 and 4/3. Chebyshev's iteration with these bounds needs a fixed
//! number of steps, and no sums over all vertices.
//!
//! Catmull–Clark subdivision has no such bounds at vertices of two or three faces, and sharp edges that end inside the
//! surface make its rows unsymmetric. BiCGSTAB (`vandervorst1992`) solves for each channel on its own; its sums are
//! taken in one order. With n(v) the number of faces at v, F the face points and R the midpoints of the coarse mesh,
//! `Σ n(v)² c(v)·(E c)(v) = Σ |face|·F² + 4·Σ R² + Σ n(v)(n(v) − 3)·c(v)²` inside the surface: all terms are at least 0
//! for n ≥ 3, and all vanish only for fields that alternate between vertices of three faces.

use crate::rows::visit_rows;
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};

/// Residual that the iteration reaches, relative to the values.
const ACCURACY: f64 = 1e-16;

/// Rule E of the coarse vertices, prepared for solving.
#[derive(Clone, Debug)]
pub(crate) struct EvenRule {
    /// Weights of the neighbors; the weight of the vertex itself is 1 minus their sum.
    neighbors: CompressedRows<f64>,
    /// Weight of each vertex in its own row.
    diagonal: Vec<f64>,
    solver: Solver,
}

/// Solver of a rule.
#[derive(Clone, Copy, Debug)]
enum Solver {
    /// Chebyshev's iteration with a number of steps for the bounds `least` and `greatest` of the spectrum.
    Chebyshev {
        n_steps: usize,
        least: f64,
        greatest: f64,
    },
    BiCgStab,
}

/// Largest number of steps of BiCGSTAB, and of times that it begins again with what is left.
const MAX_STEPS: usize = 2000;
const MAX_RESTARTS: usize = 20;

/// Number of steps without a smaller residual after which BiCGSTAB begins again.
const PATIENCE: usize = 40;

impl EvenRule {
    /// Prepares any rule with the given weights of other vertices.
    pub(crate) fn from_rows(neighbors: CompressedRows<f64>) -> Self {
        let diagonal = diagonal(&neighbors);
        Self { neighbors, diagonal, solver: Solver::BiCgStab }
    }

    /// Prepares the rule of Loop subdivision with the given weights of neighbors.
    pub(crate) fn new(neighbors: CompressedRows<f64>) -> Self {
        let diagonal = diagonal(&neighbors);
        let (mut least, mut greatest) = (2.0_f64 / 3.0, 4.0_f64 / 3.0);
        for own in &diagonal {
            let ratio = (1.0 - own) / own;
            least = least.min(1.0 - 0.5 * ratio);
            greatest = greatest.max(1.0 + ratio);
        }
        let root = (greatest / least).sqrt();
        let factor = (root - 1.0) / (root + 1.0);
        let n_steps = ((ACCURACY / 2.0).ln() / factor.ln()).ceil() as usize + 2;
        Self { neighbors, diagonal, solver: Solver::Chebyshev { n_steps, least, greatest } }
    }

    /// Entries of a row of E: the weight of the vertex itself, then those of its neighbors.
    pub(crate) fn row(&self, v: usize) -> (f64, (&[u32], &[f64])) {
        (self.diagonal[v], self.neighbors.row(v))
    }

    /// Computes the values E·c at the coarse vertices, for `d` channels.
    pub(crate) fn apply(&self, c: &[f64], d: usize, progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let mut out = c.to_vec();
        visit_rows(&mut out, d, progress, |first, rows| {
            for (v, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                let (columns, weights) = self.neighbors.row(v);
                for (channel, value) in row.iter_mut().enumerate() {
                    let terms = columns.iter().zip(weights);
                    let own = c[v * d + channel];
                    *value += terms.map(|(&w, beta)| beta * (c[w as usize * d + channel] - own)).sum::<f64>();
                }
            }
        })?;
        Ok(out)
    }

    /// Replaces the values f = E·c by c, for `d` channels.
    pub(crate) fn solve(&self, f: &mut [f64], d: usize, progress: Progress<'_>) -> Result<(), Cancelled> {
        let Solver::Chebyshev { n_steps, least, greatest } = self.solver else {
            return self.solve_by_channel(f, d, progress);
        };
        // Chebyshev's iteration (`saad2003`, algorithm 12.1) for the rows divided by their diagonals.
        let (middle, half) = (f64::midpoint(greatest, least), 0.5 * (greatest - least));
        let sigma = middle / half;
        let mut rho = 1.0 / sigma;
        let mut c: Vec<f64> = f.to_vec();
        let mut residual = vec![0.0; f.len()];
        self.set_residual(f, &c, &mut residual, d, progress)?;
        let mut direction: Vec<f64> = residual.iter().map(|r| r / middle).collect();
        for _ in 0..n_steps {
            visit_rows(&mut c, d, progress, |first, rows| {
                for (value, step) in rows.iter_mut().zip(&direction[first * d..]) {
                    *value += step;
                }
            })?;
            self.set_residual(f, &c, &mut residual, d, progress)?;
            let next = 1.0 / (2.0 * sigma - rho);
            let (keep, add) = (next * rho, 2.0 * next / half);
            visit_rows(&mut direction, d, progress, |first, rows| {
                for (step, r) in rows.iter_mut().zip(&residual[first * d..]) {
                    *step = keep * *step + add * r;
                }
            })?;
            rho = next;
        }
        f.copy_from_slice(&c);
        Ok(())
    }

    /// Computes the residual (f − E·c) divided by the diagonal.
    fn set_residual(
        &self,
        f: &[f64],
        c: &[f64],
        residual: &mut [f64],
        d: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        visit_rows(residual, d, progress, |first, rows| {
            for (v, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                let (columns, weights) = self.neighbors.row(v);
                for (channel, value) in row.iter_mut().enumerate() {
                    let own = c[v * d + channel];
                    let moved: f64 = columns
                        .iter()
                        .zip(weights)
                        .map(|(&w, beta)| beta * (c[w as usize * d + channel] - own))
                        .sum();
                    *value = (f[v * d + channel] - own - moved) / self.diagonal[v];
                }
            }
        })
    }

    fn solve_by_channel(&self, f: &mut [f64], d: usize, progress: Progress<'_>) -> Result<(), Cancelled> {
        for channel in 0..d {
            let right: Vec<f64> = f.iter().skip(channel).step_by(d).copied().collect();
            // Scaled, so that squares neither overflow nor vanish.
            let scale = right.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if scale == 0.0 {
                continue;
            }
            let right: Vec<f64> = right.iter().map(|x| x / scale).collect();
            let found = self.solve_channel(&right, progress)?;
            for (slot, x) in f.iter_mut().skip(channel).step_by(d).zip(found) {
                *slot = x * scale;
            }
        }
        Ok(())
    }

    /// Returns c with E·c = f, by rounds of BiCGSTAB for what is left of f.
    fn solve_channel(&self, f: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let mut c = f.to_vec();
        let mut rest = vec![0.0; f.len()];
        self.set_residual(f, &c, &mut rest, 1, progress)?;
        let mut norm = dot(&rest, &rest);
        for _ in 0..MAX_RESTARTS {
            if norm == 0.0 {
                break;
            }
            let change = self.bicgstab(&rest, progress)?;
            let next: Vec<f64> = c.iter().zip(&change).map(|(x, y)| x + y).collect();
            let mut left = vec![0.0; f.len()];
            self.set_residual(f, &next, &mut left, 1, progress)?;
            let next_norm = dot(&left, &left);
            // What is left after rounding does not become smaller.
            if next_norm.is_nan() || next_norm >= norm {
                break;
            }
            let is_last = next_norm <= ACCURACY * ACCURACY * dot(f, f);
            (c, rest, norm) = (next, left, next_norm);
            if is_last {
                break;
            }
        }
        Ok(c)
    }

    /// Returns an approximate solution of D⁻¹E·x = b, with D the diagonal of E: that of the step with the least
    /// residual.
    fn bicgstab(&self, b: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let n = b.len();
        let (mut x, mut r, shadow) = (vec![0.0; n], b.to_vec(), b);
        let (mut p, mut v) = (vec![0.0; n], vec![0.0; n]);
        let (mut rho, mut alpha, mut omega) = (1.0_f64, 1.0, 1.0);
        let start = dot(b, b);
        let (mut best, mut best_norm, mut n_worse) = (x.clone(), start, 0);
        for step in 0..MAX_STEPS {
            let next_rho = dot(shadow, &r);
            let beta = if step == 0 { 0.0 } else { next_rho / rho * (alpha / omega) };
            p.iter_mut().zip(&r).zip(&v).for_each(|((p, r), v)| *p = r + beta * (*p - omega * v));
            v = self.scaled_product(&p, progress)?;
            alpha = next_rho / dot(shadow, &v);
            let s: Vec<f64> = r.iter().zip(&v).map(|(r, v)| r - alpha * v).collect();
            let t = self.scaled_product(&s, progress)?;
            let square = dot(&t, &t);
            omega = if square > 0.0 { dot(&t, &s) / square } else { 0.0 };
            x.iter_mut().zip(&p).zip(&s).for_each(|((x, p), s)| *x += alpha * p + omega * s);
            r = s.iter().zip(&t).map(|(s, t)| s - omega * t).collect();
            rho = next_rho;
            let norm = dot(&r, &r);
            if norm.is_nan() {
                break;
            }
            n_worse += 1;
            if norm < best_norm {
                (best_norm, n_worse) = (norm, 0);
                best.copy_from_slice(&x);
            }
            if norm <= ACCURACY * ACCURACY * start || n_worse > PATIENCE || omega == 0.0 {
                break;
            }
        }
        Ok(best)
    }

    /// Computes D⁻¹E·x.
    fn scaled_product(&self, x: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let mut out = self.apply(x, 1, progress)?;
        out.iter_mut().zip(&self.diagonal).for_each(|(value, own)| *value /= own);
        Ok(out)
    }

    /// Largest relative error of E·c = f after solving, for a field without a pattern.
    pub(crate) fn measured_error(&self, progress: Progress<'_>) -> Result<f64, Cancelled> {
        let field: Vec<f64> = (0..self.diagonal.len()).map(|v| (0.7 + 2.399_963 * v as f64).sin()).collect();
        let mut c = field.clone();
        self.solve(&mut c, 1, progress)?;
        let again = self.apply(&c, 1, progress)?;
        Ok(again.iter().zip(&field).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
    }
}

/// Weight of each vertex in its own row.
fn diagonal(neighbors: &CompressedRows<f64>) -> Vec<f64> {
    (0..neighbors.n_rows()).map(|v| 1.0 - neighbors.row(v).1.iter().sum::<f64>()).collect()
}

/// Sum of products in the order of the entries.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
