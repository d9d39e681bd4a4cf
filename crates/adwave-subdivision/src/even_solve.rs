//! Solver for the coarse values from which Loop subdivision makes given values at the coarse vertices.
//!
//! Loop subdivision moves the coarse vertices too: `f = E·c` with `E c(v) = c(v) + Σ β(v)·(c(w) − c(v))`. Vertices on a
//! border occur in the rows of others, but their own rows have only neighbors on the border. Both blocks, divided by
//! their β, are symmetric and positive definite. Inside, the spectrum of the rows divided by their diagonals lies
//! between 1 − max (nβ/2)/(1 − nβ) and 1 + max nβ/(1 − nβ), since Σ (x_a + x_b + x_c)² ≥ 0 over the faces; on a border
//! it lies between 2/3 and 4/3. Chebyshev's iteration with these bounds needs a fixed number of steps, and no sums over
//! all vertices.

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
    /// Number of steps; the bounds of the spectrum are `least` and `greatest`.
    n_steps: usize,
    least: f64,
    greatest: f64,
}

impl EvenRule {
    /// Prepares the rule with the given weights of neighbors.
    pub(crate) fn new(neighbors: CompressedRows<f64>) -> Self {
        let diagonal: Vec<f64> =
            (0..neighbors.n_rows()).map(|v| 1.0 - neighbors.row(v).1.iter().sum::<f64>()).collect();
        let (mut least, mut greatest) = (2.0_f64 / 3.0, 4.0_f64 / 3.0);
        for own in &diagonal {
            let ratio = (1.0 - own) / own;
            least = least.min(1.0 - 0.5 * ratio);
            greatest = greatest.max(1.0 + ratio);
        }
        let root = (greatest / least).sqrt();
        let factor = (root - 1.0) / (root + 1.0);
        let n_steps = ((ACCURACY / 2.0).ln() / factor.ln()).ceil() as usize + 2;
        Self { neighbors, diagonal, n_steps, least, greatest }
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
        // Chebyshev's iteration (`saad2003`, algorithm 12.1) for the rows divided by their diagonals.
        let (middle, half) = (f64::midpoint(self.greatest, self.least), 0.5 * (self.greatest - self.least));
        let sigma = middle / half;
        let mut rho = 1.0 / sigma;
        let mut c: Vec<f64> = f.to_vec();
        let mut residual = vec![0.0; f.len()];
        self.set_residual(f, &c, &mut residual, d, progress)?;
        let mut direction: Vec<f64> = residual.iter().map(|r| r / middle).collect();
        for _ in 0..self.n_steps {
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
}
