//! Scaling and wavelet coefficients of a signal, and back (eq. 11 and 15).

use super::{BandsInfo, BandsParams, Schedule, Transform};
use crate::operator::Diffusion;
use crate::shape::VertexMap;
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
        "the signal at vertex {vertex}, channel {channel} (both counted from 0) is {value}, which is not finite; correct it, or leave the vertex out"
    )]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// An accuracy that cannot be promised.
    #[error(
        "the accuracy {accuracy} of the bands is not between {} and 0.1; double precision promises no less, and more is no result",
        super::FINEST_ACCURACY
    )]
    Accuracy {
        /// The accuracy asked for.
        accuracy: f64,
    },
    /// The call would take more memory than it may.
    #[error(
        "the bands need {needed} bytes of memory and {available} may be used; ask for fewer levels or channels"
    )]
    TooLarge {
        /// Bytes needed, the result included.
        needed: u64,
        /// Bytes that may be used.
        available: u64,
    },
    /// Only a reversible walk has powers between whole ones.
    #[error(
        "level {level} has {steps} steps, and this walk takes whole steps only, because it is not reversible or is to be taken power by power; ask for whole steps, or make the graph of a cloud symmetric"
    )]
    NotWhole {
        /// The level, from 1.
        level: usize,
        /// Its steps.
        steps: f64,
    },
    /// Steps that are not whole could not be taken as accurately as asked.
    #[error(
        "level {level} {} and {accuracy:.1e} was asked for: few steps that are not whole are slow on a walk that goes to and fro; ask for whole steps or for less accuracy",
        reach(*.reached)
    )]
    Missed {
        /// The level, from 1; of a sum of levels the first that is not whole.
        level: usize,
        /// The accuracy asked for.
        accuracy: f64,
        /// A bound of the error, relative to the band; infinite where the band all but vanishes beside W_f(1).
        reached: f64,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What is said of the accuracy of a band.
fn reach(reached: f64) -> String {
    if reached < 1.0 {
        format!("reaches a relative accuracy of {reached:.1e}")
    } else {
        "all but vanishes beside the first, of which no relative accuracy can be had,".to_owned()
    }
}

/// The bands of a signal: S_f(0..J) and W_f(1..J), each n_vertices × n_channels, row-major, in the order of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Number of vertices.
    pub n_vertices: usize,
    /// Number of channels of the signal.
    pub n_channels: usize,
    /// Steps of the walk on level j, n_0 = 0 … n_J, whole or not.
    pub steps: Vec<f64>,
    /// Widths σ_j = s·√n_j in model units (hops on a graph), σ_0 = 0.
    pub sigma: Vec<f64>,
    /// S_f(j), j = 0 … J; S_f(0) is the signal itself.
    pub scaling: Vec<Vec<f64>>,
    /// W_f(j), j = 1 … J, at index j − 1.
    pub wavelet: Vec<Vec<f64>>,
    /// How they were computed.
    pub info: BandsInfo,
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
        let total = crate::parallel::sum(weights.len(), |x| weights[x]);
        let weight = |x: usize| if total > 0.0 { weights[x] / total } else { 1.0 / self.n_vertices as f64 };
        self.wavelet
            .iter()
            .map(|band| {
                crate::parallel::sum(self.n_vertices, |x| {
                    let row = &band[x * self.n_channels..][..self.n_channels];
                    // Vertices that are left out of the walk have no area, and NaN in the bands.
                    let square = || row.iter().map(|w| w * w).sum::<f64>();
                    if weight(x) == 0.0 { 0.0 } else { weight(x) * square() }
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

/// Bytes of memory that [`decompose`] will take, the bands included and the signal and the diffusion not.
pub fn forecast_bytes(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    n_channels: usize,
    schedule: &Schedule,
) -> u64 {
    let result = (2 * schedule.n_levels() as u64 + 1) * (vertex_map.n_vertices() * n_channels * 8) as u64;
    let welded = (vertex_map.n_welded() * n_channels * 8) as u64;
    // Steps that are not whole have one more vector, by which their error is measured.
    let guard = if schedule.first_real().is_some() { welded } else { 0 };
    result + welded + guard + Transform::forecast_bytes(diffusion, n_channels)
}

/// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into the bands of `schedule`.
///
/// `S_f(0) = f`, `S_f(j) = Φ₁^{n_j} f`, `W_f(j) = S_f(j−1) − S_f(j)` (eq. 11). A signal that differs at welded vertices is
/// averaged for S_f(1..J) only: what differs is in W_f(1), so that the bands still sum to the signal. Each W_f(j) has a
/// relative error of at most [`BandsParams::accuracy`]; S_f(j) is `f − W_f(1) − … − W_f(j)`.
///
/// About `√(n_J·ln(1/accuracy))` products with Φ₁, or n_J where the walk is not reversible. Steps that are not whole take at
/// least 64, or up to ten thousand where Φ₁ has eigenvalues near 0 that the signal takes part in.
///
/// # Errors
/// [`BandsError`] when the signal has the wrong length or a value that is not finite, the accuracy cannot be promised or met,
/// steps that are not whole are asked of a walk that is not reversible, the memory does not suffice, or when cancelled.
pub fn decompose(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    signal: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    params: &BandsParams,
    progress: Progress<'_>,
) -> Result<Bands, BandsError> {
    params.check()?;
    check_signal(signal, vertex_map.n_vertices(), n_channels)?;
    check_memory(forecast_bytes(diffusion, vertex_map, n_channels, schedule), params)?;
    Transform::new(diffusion, params)?.decompose(vertex_map, signal, n_channels, schedule, progress)
}

/// `Σ_j factors[j−1]·W_f(j)` (n_vertices × n_channels, in the order of the shape) by a single polynomial of Φ₁: much
/// cheaper than the bands one by one. `f + Σ_j (gain_j − 1)·W_f(j)` is the filter of eq. 18 with one gain a band.
///
/// The relative error of the result is at most [`BandsParams::accuracy`].
///
/// # Errors
/// As for [`decompose`].
///
/// # Panics
/// Unless there is one finite factor a level.
#[expect(clippy::too_many_arguments, reason = "the arguments of `decompose` and the factors")]
pub fn weighted_bands(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    signal: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    factors: &[f64],
    params: &BandsParams,
    progress: Progress<'_>,
) -> Result<(Vec<f64>, BandsInfo), BandsError> {
    params.check()?;
    check_signal(signal, vertex_map.n_vertices(), n_channels)?;
    let n_vectors = if schedule.first_real().is_some() { 4 } else { 3 };
    let needed = (vertex_map.n_vertices() * n_channels * n_vectors * 8) as u64
        + Transform::forecast_bytes(diffusion, n_channels);
    check_memory(needed, params)?;
    let transform = Transform::new(diffusion, params)?;
    let mean = vertex_map.mean(signal, n_channels);
    let mut out = vec![0.0; mean.len()];
    let info = transform.weighted_into(&mean, n_channels, schedule, factors, &mut out, progress)?;
    let mut sum = vertex_map.scatter(&out, n_channels);
    if vertex_map.n_welded() < vertex_map.n_vertices() {
        // What differs from the mean at welded vertices is part of W_f(1).
        let first = factors[0];
        sum.par_chunks_exact_mut(n_channels).zip(signal.par_chunks_exact(n_channels)).enumerate().for_each(
            |(x, (sum, signal))| {
                let mean = &mean[vertex_map.welded(x) * n_channels..][..n_channels];
                for ((sum, f), m) in sum.iter_mut().zip(signal).zip(mean) {
                    *sum += first * (f - m);
                }
            },
        );
    }
    Ok((sum, info))
}

fn check_memory(needed: u64, params: &BandsParams) -> Result<(), BandsError> {
    match params.max_bytes {
        Some(available) if needed > available => Err(BandsError::TooLarge { needed, available }),
        _ => Ok(()),
    }
}
