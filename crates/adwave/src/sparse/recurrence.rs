//! Chebyshev polynomials of the walk applied to a block of channels, and sums of them.

use super::walk::{MAX_CHANNELS, Walk};
use rayon::prelude::*;

/// A sum `Σ_k a_k T_k(Y)u` that is being added up.
pub(crate) struct Sum<'a> {
    /// a_0 … a_d.
    pub(crate) coefficients: &'a [f64],
    /// n_vertices × n_channels of the whole signal, of which the block's channels are written.
    pub(crate) out: &'a mut [f64],
}

/// `T_k(Y)u` for rising k, `Y = 2Φ₁ − I`, for up to four channels.
pub(crate) struct Recurrence<'a> {
    walk: &'a Walk<'a>,
    now: Vec<f64>,
    before: Vec<f64>,
    k: usize,
    width: usize,
    at: usize,
    stride: usize,
}

impl<'a> Recurrence<'a> {
    /// Starts at `T_0 u = u = (I − Φ₁)f` for the channels `at .. at + width` of `signal`.
    pub(crate) fn new(
        walk: &'a Walk<'a>,
        signal: &[f64],
        n_channels: usize,
        at: usize,
        width: usize,
    ) -> Self {
        assert!((1..=MAX_CHANNELS).contains(&width) && at + width <= n_channels, "a block of the channels");
        let n = walk.n_vertices();
        let mut now = vec![0.0; n * width];
        walk.difference(signal, n_channels, at, width, &mut now);
        Self { walk, before: vec![0.0; now.len()], now, k: 0, width, at, stride: n_channels }
    }

    pub(crate) fn k(&self) -> usize {
        self.k
    }

    pub(crate) fn now(&self) -> &[f64] {
        &self.now
    }

    /// Adds the next `n_steps` terms to the sums, and the term 0 if none has been added yet.
    pub(crate) fn advance(&mut self, n_steps: usize, sums: &mut [Sum<'_>]) {
        if self.k == 0 {
            for sum in &mut *sums {
                self.add(sum.coefficients[0], sum.out, true);
            }
        }
        for _ in 0..n_steps {
            let scale = if self.k == 0 { 0.5 } else { 1.0 };
            self.walk.step(&self.now, &mut self.before, self.width, scale);
            std::mem::swap(&mut self.now, &mut self.before);
            self.k += 1;
            for sum in &mut *sums {
                if let Some(&a) = sum.coefficients.get(self.k) {
                    self.add(a, sum.out, false);
                }
            }
        }
    }

    fn add(&self, a: f64, out: &mut [f64], first: bool) {
        let (width, at) = (self.width, self.at);
        out.par_chunks_exact_mut(self.stride)
            .zip(self.now.par_chunks_exact(width))
            .with_min_len(4096)
            .for_each(|(out, now)| {
                for (out, now) in out[at..at + width].iter_mut().zip(now) {
                    *out = if first { a * now } else { *out + a * now };
                }
            });
    }
}
