//! Wavelet coefficients in the analysis order, for all code that measures or edits them.

use super::error::check_signal;
use super::{Bands, BandsError, BandsInfo, Schedule, Transform};
use crate::pages::zeros;
use crate::shape::VertexMap;
use crate::{Progress, parallel};
use std::borrow::Cow;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// The wavelet coefficients W_f(1), …, W_f(J) at the welded vertices, in the analysis order, as saliency, features
/// and edits use them.
///
/// They belong to the mean of the signal at welded vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Wavelets {
    /// Number of channels; 1 for norms.
    pub n_channels: usize,
    /// Number of diffusion steps n_j on each level, n_0 = 0 … n_J; may be fractional.
    pub steps: Vec<f64>,
    /// Widths σ_j = s·√n_j in model units (hops on a graph), σ_0 = 0.
    pub sigma: Vec<f64>,
    /// The coefficients W_f(j) at index j − 1, n_welded × n_channels, row-major.
    pub levels: Vec<Vec<f64>>,
    /// Method, cost and error bound of the computation.
    pub info: BandsInfo,
}

impl Wavelets {
    /// Number of levels J.
    pub fn n_levels(&self) -> usize {
        self.levels.len()
    }

    /// Number of welded vertices.
    pub fn n_welded(&self) -> usize {
        self.levels.first().map_or(0, Vec::len) / self.n_channels.max(1)
    }

    /// The coefficients W_f(j), j = 1 … J, in the analysis order.
    ///
    /// # Panics
    /// If level `j` does not exist.
    pub fn wavelet(&self, j: usize) -> &[f64] {
        assert!((1..=self.n_levels()).contains(&j), "levels are 1 to {}, not {j}", self.n_levels());
        &self.levels[j - 1]
    }

    /// Euclidean norms of level `j` over the channels; a single channel is returned with its sign.
    pub(crate) fn level_norms(&self, j: usize) -> Cow<'_, [f64]> {
        match self.n_channels {
            1 => Cow::Borrowed(&self.levels[j - 1]),
            d => Cow::Owned(norms(&self.levels[j - 1], d)),
        }
    }

    /// Channel `c` of level `j`.
    pub(crate) fn channel(&self, j: usize, c: usize) -> Cow<'_, [f64]> {
        let (level, d) = (&self.levels[j - 1], self.n_channels);
        match d {
            1 => Cow::Borrowed(level),
            _ => Cow::Owned(parallel::collect(level.len() / d, |x| level[x * d + c])),
        }
    }

    /// Euclidean norms `‖W_f(j,x)‖` over the channels, as wavelets of one channel; a signal of one channel keeps
    /// its sign. The memory of each level is freed as soon as it is reduced. O(n × levels × channels).
    #[must_use]
    pub fn into_norms(self) -> Self {
        self.into_measure(RowMeasure::Norm)
    }

    /// Normal components `W_f(j,x)·n(x)` for unit normals n at the welded vertices (analysis order), as wavelets of
    /// one channel. For coordinates and outward normals they are positive where the surface is convex at the size
    /// σ_j. The memory of each level is freed as soon as it is reduced. O(n × levels).
    ///
    /// # Panics
    /// Unless the signal has three channels and there is one normal per welded vertex.
    #[must_use]
    pub fn into_along(self, normals: &[[f64; 3]]) -> Self {
        assert_eq!(
            (self.n_channels, self.n_welded()),
            (3, normals.len()),
            "a vector and a normal at each vertex"
        );
        self.into_measure(RowMeasure::Along(normals))
    }

    /// A scalar of each row, as wavelets of one channel; those of one channel stay.
    pub(crate) fn into_measure(mut self, measure: RowMeasure<'_>) -> Self {
        let d = std::mem::replace(&mut self.n_channels, 1);
        if d != 1 {
            for level in &mut self.levels {
                *level = measure.measure_rows(level, d);
            }
        }
        self
    }
}

/// Scalar computed from a row of several channels.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RowMeasure<'a> {
    /// Euclidean norm of the row.
    Norm,
    /// Component along the normal of the vertex.
    Along(&'a [[f64; 3]]),
}

impl RowMeasure<'_> {
    /// Scalar of each row of `d` values.
    pub(super) fn measure_rows(self, rows: &[f64], d: usize) -> Vec<f64> {
        let Self::Along(normals) = self else { return norms(rows, d) };
        let mut along = zeros(normals.len());
        parallel::visit_rows(&mut along, 1, VERTICES_AT_A_TIME, |first, along| {
            for ((w, row), n) in
                along.iter_mut().zip(rows[first * 3..].chunks_exact(3)).zip(&normals[first..])
            {
                *w = row[0] * n[0] + row[1] * n[1] + row[2] * n[2];
            }
        });
        along
    }
}

/// Euclidean norm of each row of `d` values.
fn norms(rows: &[f64], d: usize) -> Vec<f64> {
    let mut norms = zeros(rows.len() / d);
    parallel::visit_rows(&mut norms, 1, VERTICES_AT_A_TIME, |first, norms| {
        for (norm, row) in norms.iter_mut().zip(rows[first * d..].chunks_exact(d)) {
            *norm = row.iter().map(|w| w * w).sum::<f64>().sqrt();
        }
    });
    norms
}

impl Wavelets {
    /// Bands of `signal`, whose mean at the welded vertices has these wavelets, in the order of the shape. The
    /// difference from the mean is part of W_f(1). O(n × levels × channels).
    pub(crate) fn to_bands(&self, vertex_map: &VertexMap, signal: &[f64]) -> Bands {
        let mut coefficients = zeros((self.n_levels() + 1) * signal.len());
        let info = self.write_bands(vertex_map, signal, &mut coefficients);
        let (steps, sigma) = (self.steps.clone(), self.sigma.clone());
        Bands::new(vertex_map.n_vertices(), self.n_channels, steps, sigma, coefficients, info)
    }

    /// Writes [`to_bands`](Self::to_bands) into a buffer of (J + 1)·n_vertices·n_channels values.
    pub(crate) fn write_bands(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        buffer: &mut [f64],
    ) -> BandsInfo {
        let d = self.n_channels;
        let mut mean = vertex_map.mean(signal, d);
        let differences: Vec<f64> = parallel::collect(signal.len(), |i| {
            signal[i] - mean[vertex_map.welded(i / d) * d + i % d] // 0 where nothing is welded
        });
        let mut places = buffer.chunks_exact_mut(signal.len());
        for (level, place) in self.levels.iter().zip(&mut places) {
            place.copy_from_slice(&vertex_map.scatter(level, d));
            parallel::visit_rows(&mut mean, 1, VERTICES_AT_A_TIME, |first, mean| {
                for (s, w) in mean.iter_mut().zip(&level[first..]) {
                    *s -= w; // S_f(j) = S_f(j−1) − W_f(j) (eq. 11)
                }
            });
        }
        if let Some(place) = places.next() {
            place.copy_from_slice(&vertex_map.scatter(&mean, d));
        }
        if vertex_map.n_welded() < vertex_map.n_vertices() {
            let finest = &mut buffer[..signal.len()];
            finest.iter_mut().zip(&differences).for_each(|(w, difference)| *w += difference);
        }
        self.info.clone()
    }
}

impl Bands {
    /// Wavelet coefficients in the analysis order; at a welded vertex, the mean over its members that have a value.
    /// O(n × levels × channels).
    pub fn to_wavelets(&self, vertex_map: &VertexMap) -> Wavelets {
        let d = self.n_channels;
        let mut count = vec![0_u32; vertex_map.n_welded() * d];
        let level = |band: &[f64]| {
            let mut sum = zeros(vertex_map.n_welded() * d);
            count.fill(0);
            for (row, &x) in band.chunks_exact(d).zip(vertex_map.as_slice()) {
                for (c, w) in row.iter().enumerate().filter(|(_, w)| !w.is_nan()) {
                    sum[x as usize * d + c] += w;
                    count[x as usize * d + c] += 1;
                }
            }
            for (value, &n) in sum.iter_mut().zip(&count).filter(|(_, n)| **n != 1) {
                *value /= f64::from(n);
            }
            sum
        };
        let levels = self.wavelets().map(level).collect();
        let (steps, sigma, info) = (self.steps.clone(), self.sigma.clone(), self.info.clone());
        Wavelets { n_channels: d, steps, sigma, levels, info }
    }
}

impl Transform {
    /// Wavelet coefficients of `signal` (n_vertices × n_channels, row-major, in the order of the shape) in the
    /// analysis order, without scaling coefficients: half the memory of [`bands`](Self::bands), and no pass over
    /// the result.
    ///
    /// # Errors
    /// As for [`bands`](Self::bands).
    pub fn wavelets(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Wavelets, BandsError> {
        check_signal(signal, vertex_map.n_vertices(), n_channels)?;
        self.decompose_mean(&vertex_map.mean(signal, n_channels), n_channels, schedule, progress)
    }

    /// [`wavelets`](Self::wavelets) for a signal at the welded vertices.
    pub(crate) fn decompose_mean(
        &self,
        mean: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Wavelets, BandsError> {
        self.check_memory_of_wavelets(n_channels, schedule)?;
        let mut levels: Vec<Vec<f64>> = (0..schedule.n_levels()).map(|_| zeros(mean.len())).collect();
        let mut outs: Vec<&mut [f64]> = levels.iter_mut().map(Vec::as_mut_slice).collect();
        let info = self.wavelets_into(mean, n_channels, schedule, &mut outs, progress)?;
        let sigma = schedule.sigma(self.operator().step_length());
        Ok(Wavelets { n_channels, steps: schedule.steps_from_zero(), sigma, levels, info })
    }

    pub(super) fn check_memory_of_wavelets(
        &self,
        n_channels: usize,
        schedule: &Schedule,
    ) -> Result<(), BandsError> {
        let result = (schedule.n_levels() * self.operator().n_rows() * n_channels * 8) as u64;
        self.check_memory(result + self.forecast_wavelets(n_channels, schedule, 1))
    }
}
