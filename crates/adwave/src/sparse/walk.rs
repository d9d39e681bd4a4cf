//! The walk prepared for many products.

use crate::operator::Diffusion;
use rayon::prelude::*;

/// Channels that go through a product together.
pub(crate) const MAX_CHANNELS: usize = 4;

#[derive(Debug)]
pub(crate) struct Walk<'a> {
    diffusion: &'a Diffusion,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(diffusion: &'a Diffusion) -> Self {
        Self { diffusion }
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.diffusion.n_vertices()
    }

    /// Bytes of memory that preparing `diffusion` will take at most.
    pub(crate) fn forecast_bytes(_diffusion: &Diffusion) -> u64 {
        0
    }

    /// Bytes of memory taken beyond the diffusion itself.
    pub(crate) fn bytes(&self) -> u64 {
        0
    }

    pub(crate) fn steps_per_pass(&self) -> usize {
        4
    }

    /// `u = (I − Φ₁)f` for the channels `at .. at + width` of f.
    pub(crate) fn difference(
        &self,
        signal: &[f64],
        n_channels: usize,
        at: usize,
        width: usize,
        out: &mut [f64],
    ) {
        out.par_chunks_exact_mut(width).with_min_len(1024).enumerate().for_each(|(x, out)| {
            let (columns, weights) = self.diffusion.row(x);
            for (c, out) in out.iter_mut().enumerate() {
                let here = signal[x * n_channels + at + c];
                *out = columns
                    .iter()
                    .zip(weights)
                    .map(|(&y, w)| w * (here - signal[y as usize * n_channels + at + c]))
                    .sum();
            }
        });
    }

    /// `before = scale·(2(2Φ₁ − I)·now − before)`.
    pub(crate) fn step(&self, now: &[f64], before: &mut [f64], width: usize, scale: f64) {
        before.par_chunks_exact_mut(width).with_min_len(1024).enumerate().for_each(|(x, out)| {
            let (columns, weights) = self.diffusion.row(x);
            for (c, out) in out.iter_mut().enumerate() {
                let sum: f64 =
                    columns.iter().zip(weights).map(|(&y, w)| 4.0 * w * now[y as usize * width + c]).sum();
                *out = scale * (sum - *out);
            }
        });
    }
}
