//! Scaling and wavelet coefficients of a signal, and back (eq. 11 and 15).

use super::{Schedule, smooth};
use crate::operator::Diffusion;
use crate::shape::Weld;
use crate::{Cancelled, Progress};
use rayon::prelude::*;
use thiserror::Error;

/// Why a signal cannot be split into bands.
#[derive(Debug, Error, PartialEq)]
pub enum BandsError {
    /// The signal does not belong to this shape.
    #[error("the signal has {n_values} values, which is not {n_vertices} vertices × {n_channels} channels")]
    WrongLength {
        /// Values given.
        n_values: usize,
        /// Vertices of the shape.
        n_vertices: usize,
        /// Channels of the signal.
        n_channels: usize,
    },
    /// A value is NaN or infinite.
    #[error(
        "the signal at vertex {vertex}, channel {channel} (both counted from 0) is {value}, which is not finite"
    )]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The bands of a signal: S_f(0..J) and W_f(1..J), each n_vertices × n_channels, row-major, in the order of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Number of vertices.
    pub n_vertices: usize,
    /// Number of channels of the signal.
    pub n_channels: usize,
    /// Steps of the walk on level j, n_0 = 0 … n_J.
    pub steps: Vec<u64>,
    /// Widths σ_j = s·√n_j in model units (hops on a graph), σ_0 = 0.
    pub sigma: Vec<f64>,
    /// S_f(j), j = 0 … J; S_f(0) is the signal itself.
    pub scaling: Vec<Vec<f64>>,
    /// W_f(j), j = 1 … J, at index j − 1.
    pub wavelet: Vec<Vec<f64>>,
}

impl Bands {
    /// J, the number of levels.
    pub fn n_levels(&self) -> usize {
        self.wavelet.len()
    }

    /// `f = S_f(J) + Σ_j W_f(j)` (eq. 15). Exact but for rounding, by whatever method the bands were computed: the sum
    /// telescopes.
    pub fn reconstruct(&self) -> Vec<f64> {
        let mut signal = self.scaling[self.n_levels()].clone();
        // From coarse to fine: the small bands are added last, so that the sum retraces S_f(j) step by step.
        for band in self.wavelet.iter().rev() {
            signal.par_iter_mut().zip(band).with_min_len(1 << 14).for_each(|(s, w)| *s += w);
        }
        signal
    }

    /// Mean square `Σ_x μ(x)‖W_f(j,x)‖² / Σ_x μ(x)` of each band j = 1 … J under a weight μ ≥ 0 of the vertices (their
    /// areas, say), in squared units of the signal.
    ///
    /// # Panics
    /// When there is not one weight a vertex.
    pub fn energy(&self, weights: &[f64]) -> Vec<f64> {
        assert_eq!(weights.len(), self.n_vertices, "one weight a vertex");
        let total = crate::reduce::sum(weights.len(), |x| weights[x]);
        let weight = |x: usize| if total > 0.0 { weights[x] / total } else { 1.0 / self.n_vertices as f64 };
        self.wavelet
            .iter()
            .map(|band| {
                crate::reduce::sum(self.n_vertices, |x| {
                    let row = &band[x * self.n_channels..][..self.n_channels];
                    weight(x) * row.iter().map(|w| w * w).sum::<f64>()
                })
            })
            .collect()
    }
}

/// Checks that a signal has a finite value for every channel of every vertex.
pub(crate) fn check_signal(signal: &[f64], n_vertices: usize, n_channels: usize) -> Result<(), BandsError> {
    if n_channels == 0 || n_vertices.checked_mul(n_channels) != Some(signal.len()) {
        return Err(BandsError::WrongLength { n_values: signal.len(), n_vertices, n_channels });
    }
    if let Some(at) = signal.iter().position(|v| !v.is_finite()) {
        let (vertex, channel) = (at / n_channels, at % n_channels);
        return Err(BandsError::NotFinite { vertex, channel, value: signal[at] });
    }
    Ok(())
}

/// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into the bands of `schedule`.
///
/// `S_f(0) = f`, `S_f(j) = Φ₁^{n_j} f`, `W_f(j) = S_f(j−1) − S_f(j)` (eq. 11). A signal that differs at welded vertices is
/// averaged for S_f(1..J) only: what differs is in W_f(1), so that the bands still sum to the signal.
///
/// # Errors
/// [`BandsError`] when the signal has the wrong length or a value that is not finite, or when cancelled.
pub fn decompose(
    diffusion: &Diffusion,
    weld: &Weld,
    signal: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Bands, BandsError> {
    let n_vertices = weld.n_vertices();
    check_signal(signal, n_vertices, n_channels)?;
    let smoothed = smooth(diffusion, &weld.mean(signal, n_channels), n_channels, schedule.steps(), progress)?;
    let mut scaling = vec![signal.to_vec()];
    scaling.extend(smoothed.into_iter().map(|level| weld.scatter(&level, n_channels)));
    let wavelet = scaling
        .windows(2)
        .map(|pair| {
            pair[0]
                .par_iter()
                .zip(&pair[1])
                .with_min_len(1 << 14)
                .map(|(fine, coarse)| fine - coarse)
                .collect()
        })
        .collect();
    Ok(Bands {
        n_vertices,
        n_channels,
        steps: schedule.steps_from_zero(),
        sigma: schedule.sigma(diffusion.step_length()),
        scaling,
        wavelet,
    })
}
