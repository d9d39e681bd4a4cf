//! Bands in the order of the shape: maps the signal to the analysis order, transforms it, and maps the result back
//! in one pass.

use super::error::{check_buffer, check_factors, check_signal};
use super::stages::EXTRA_VECTORS;
use super::{Bands, BandsError, BandsInfo, Schedule, Transform};
use crate::pages::zeros;
use crate::shape::VertexMap;
use crate::sparse::SignalView;
use crate::{Cancelled, Progress, parallel};

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

impl Transform {
    /// Bytes of memory that [`bands`](Self::bands) needs, including the bands and without the signal and the
    /// operator.
    pub fn forecast_bands(&self, vertex_map: &VertexMap, n_channels: usize, schedule: &Schedule) -> u64 {
        let result = (schedule.n_levels() as u64 + 1) * (vertex_map.n_vertices() * n_channels * 8) as u64;
        result + self.forecast_wavelets(n_channels, schedule, 1)
    }

    /// Bytes of memory that wavelets need beyond themselves and the signal, with `n_vectors` further vectors.
    pub(super) fn forecast_wavelets(&self, n_channels: usize, schedule: &Schedule, n_vectors: u64) -> u64 {
        let vector = (self.operator().n_rows() * n_channels * 8) as u64;
        // Fractional powers need one more vector, which measures their error.
        let mut n_vectors = n_vectors + u64::from(schedule.first_real().is_some());
        if self.is_staged(schedule) {
            n_vectors += EXTRA_VECTORS;
        }
        n_vectors * vector + self.forecast(n_channels)
    }

    pub(super) fn check_memory(&self, needed: u64) -> Result<(), BandsError> {
        match self.params().max_bytes {
            Some(available) if needed > available => Err(BandsError::TooLarge { needed, available }),
            _ => Ok(()),
        }
    }

    /// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into the bands of `schedule`.
    ///
    /// `S_f(0) = f`, `S_f(j) = Φ₁^{n_j} f`, `W_f(j) = S_f(j−1) − S_f(j)` (eq. 11). A signal that differs at welded
    /// vertices is averaged for S_f(1..J) only; the difference is part of W_f(1), so the bands still sum to the
    /// signal. Each W_f(j) has a relative error of at most [`BandsParams::accuracy`](super::BandsParams::accuracy).
    ///
    /// Cost: about `√(n_J·ln(1/accuracy))` products with Φ₁, or n_J products if it is not reversible. Fractional
    /// powers need at least 64 products, and up to ten thousand if the signal takes part in eigenvalues of Φ₁ near
    /// 0.
    ///
    /// # Errors
    /// [`BandsError`] if the signal has the wrong length or a value that is not finite, the accuracy cannot be
    /// reached, the operator is not reversible and a level is fractional, the memory limit is exceeded, or the call
    /// is cancelled.
    pub fn bands(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Bands, BandsError> {
        let n_vertices = vertex_map.n_vertices();
        check_signal(signal, n_vertices, n_channels)?;
        self.check_memory(self.forecast_bands(vertex_map, n_channels, schedule))?;
        let mut coefficients = zeros((schedule.n_levels() + 1) * signal.len());
        let info = self.bands_into(vertex_map, signal, n_channels, schedule, &mut coefficients, progress)?;
        let sigma = schedule.sigma(self.operator().step_length());
        Ok(Bands::new(n_vertices, n_channels, schedule.steps_from_zero(), sigma, coefficients, info))
    }

    /// Writes [`bands`](Self::bands) into a buffer of (J + 1)·n_vertices·n_channels values: W_f(1), …, W_f(J),
    /// S_f(J).
    ///
    /// Beyond the wavelets it costs one pass over the result.
    ///
    /// # Errors
    /// As for [`bands`](Self::bands), and if the buffer has the wrong length.
    pub fn bands_into(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        buffer: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<BandsInfo, BandsError> {
        check_signal(signal, vertex_map.n_vertices(), n_channels)?;
        let (len, n_levels) = (signal.len(), schedule.n_levels());
        check_buffer(buffer.len(), (n_levels + 1) * len)?;
        if vertex_map.is_identity() {
            let (wavelets, coarsest) = buffer.split_at_mut(n_levels * len);
            let mut outs: Vec<&mut [f64]> = wavelets.chunks_exact_mut(len).collect();
            let spare = Some(&mut *coarsest);
            let info = self.wavelets_into_with(signal, n_channels, schedule, &mut outs, spare, progress)?;
            parallel::try_visit_rows(coarsest, n_channels, VERTICES_AT_A_TIME, progress, |first, rows| {
                rows.copy_from_slice(&signal[first * n_channels..][..rows.len()]);
                subtract_bands(rows, wavelets, len, first * n_channels);
            })?;
            return Ok(info);
        }
        let mut mean = vertex_map.mean(signal, n_channels);
        // W_f(j) is first computed in the analysis order in the slot of its successor; then the levels move up one
        // by one.
        let mut outs: Vec<&mut [f64]> =
            buffer.chunks_exact_mut(len).skip(1).map(|place| &mut place[..mean.len()]).collect();
        let info = self.wavelets_into(&mean, n_channels, schedule, &mut outs, progress)?;
        let order = ShapeOrder { vertex_map, n_channels, progress };
        let (first, rest) = buffer.split_at_mut(len);
        order.gather(&rest[..mean.len()], first)?;
        if vertex_map.n_welded() < vertex_map.n_vertices() {
            // The difference from the mean at welded vertices is part of W_f(1).
            order.add_difference(1.0, signal, &mean, first)?;
        }
        parallel::try_visit_rows(&mut mean, n_channels, VERTICES_AT_A_TIME, progress, |first, mean| {
            subtract_bands(mean, rest, len, first * n_channels);
        })?;
        for level in 2..=n_levels {
            let (finer, coarser) = buffer.split_at_mut(level * len);
            order.gather(&coarser[..mean.len()], &mut finer[(level - 1) * len..])?;
        }
        order.gather(&mean, &mut buffer[n_levels * len..])?;
        Ok(info)
    }

    /// Calls `visit(level, band)` with each of [`bands`](Self::bands), W_f(1), …, W_f(J) and S_f(J), with levels counted from
    /// 0. `visit` may change the band. Those of an operator that takes many steps at once ([`Leap`](crate::operator::Leap))
    /// are computed one after another, so that all of it takes the memory of three signals; if the accuracy asks for finer
    /// steps, they come again from the first one. The values are those of `bands` bit for bit.
    ///
    /// # Errors
    /// As for [`bands`](Self::bands), and the first error of `visit`.
    pub fn visit_bands<E: From<BandsError>>(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
        mut visit: impl FnMut(usize, &mut [f64]) -> Result<(), E>,
    ) -> Result<BandsInfo, E> {
        self.check_signal(signal, n_channels)?;
        let leap = self.leap().filter(|_| vertex_map.is_identity() && schedule.n_levels() > 1);
        if let Some(leap) = leap {
            self.check_steps(schedule)?;
            self.check_precision(schedule, progress)?;
            let (view, mut failed) = (SignalView { values: signal, n_channels }, None);
            let mut coarsest = zeros(signal.len());
            let outcome = self.visit_bands_by_leaps(leap, view, schedule, progress, |level, band| {
                parallel::try_visit_rows(&mut coarsest, 1, VERTICES_AT_A_TIME, progress, |first, rows| {
                    if level == 0 {
                        rows.copy_from_slice(&signal[first..][..rows.len()]);
                    }
                    subtract_bands(rows, band, band.len(), first);
                })?;
                visit(level, band).map_err(|error| {
                    failed = Some(error);
                    Cancelled
                })
            });
            if let Some(error) = failed {
                return Err(error);
            }
            match outcome {
                Err(BandsError::Missed { .. }) if self.operator().is_reversible() => {}
                outcome => {
                    let info = self.info(&outcome?, n_channels);
                    visit(schedule.n_levels(), &mut coarsest)?;
                    return Ok(info);
                }
            }
        }
        let mut bands = self.bands(vertex_map, signal, n_channels, schedule, progress)?;
        bands.try_visit_levels(visit).map(|()| bands.info)
    }

    /// Weighted sum `Σ_j factors[j−1]·W_f(j)` (n_vertices × n_channels, in the order of the shape) by a single
    /// polynomial of Φ₁, which is much cheaper than the bands one by one. Its relative error is at most
    /// [`BandsParams::accuracy`](super::BandsParams::accuracy).
    ///
    /// # Errors
    /// As for [`bands`](Self::bands), and unless there is one finite factor per level.
    pub fn weighted(
        &self,
        vertex_map: &VertexMap,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        factors: &[f64],
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, BandsInfo), BandsError> {
        let is_identity = vertex_map.is_identity();
        if !is_identity {
            check_signal(signal, vertex_map.n_vertices(), n_channels)?;
        }
        check_factors(factors, schedule)?;
        let result = 8 * signal.len() as u64;
        self.check_memory(result + self.forecast_wavelets(n_channels, schedule, 2))?;
        let mut sum = zeros(signal.len());
        if is_identity {
            let info = self.weighted_into(signal, n_channels, schedule, factors, &mut sum, progress)?;
            return Ok((sum, info));
        }
        let mean = vertex_map.mean(signal, n_channels);
        let mut out = zeros(mean.len());
        let info = self.weighted_into(&mean, n_channels, schedule, factors, &mut out, progress)?;
        let order = ShapeOrder { vertex_map, n_channels, progress };
        order.gather(&out, &mut sum)?;
        if vertex_map.n_welded() < vertex_map.n_vertices() {
            order.add_difference(factors[0], signal, &mean, &mut sum)?;
        }
        Ok((sum, info))
    }
}

/// Subtracts from `values`, a part of S_f(0) from index `first` on, the bands of `len` values each: `S_f(j) = S_f(j−1) −
/// W_f(j)` (eq. 11).
fn subtract_bands(values: &mut [f64], bands: &[f64], len: usize, first: usize) {
    for band in bands.chunks_exact(len) {
        for (s, w) in values.iter_mut().zip(&band[first..]) {
            *s -= w;
        }
    }
}

/// Conversion from the analysis order to the order of the shape.
struct ShapeOrder<'a> {
    vertex_map: &'a VertexMap,
    n_channels: usize,
    progress: Progress<'a>,
}

impl ShapeOrder<'_> {
    /// Copies rows of channels: `to[x] = from[welded(x)]`.
    fn gather(&self, from: &[f64], to: &mut [f64]) -> Result<(), BandsError> {
        match self.n_channels {
            1 => self.gather_fixed::<1>(from, to),
            2 => self.gather_fixed::<2>(from, to),
            3 => self.gather_fixed::<3>(from, to),
            d => {
                let welded = self.vertex_map.as_slice();
                Ok(parallel::try_visit_rows(to, d, VERTICES_AT_A_TIME, self.progress, |first, rows| {
                    for (row, &x) in rows.chunks_exact_mut(d).zip(&welded[first..]) {
                        row.copy_from_slice(&from[x as usize * d..][..d]);
                    }
                })?)
            }
        }
    }

    fn gather_fixed<const D: usize>(&self, from: &[f64], to: &mut [f64]) -> Result<(), BandsError> {
        let (from, welded) = (from.as_chunks::<D>().0, self.vertex_map.as_slice());
        let to = to.as_chunks_mut::<D>().0;
        Ok(parallel::try_visit_rows(to, 1, VERTICES_AT_A_TIME, self.progress, |first, rows| {
            for (row, &x) in rows.iter_mut().zip(&welded[first..]) {
                *row = from[x as usize];
            }
        })?)
    }

    /// Adds `factor` times the difference between the signal and the mean at its welded vertex.
    fn add_difference(
        &self,
        factor: f64,
        signal: &[f64],
        mean: &[f64],
        to: &mut [f64],
    ) -> Result<(), BandsError> {
        let d = self.n_channels;
        Ok(parallel::try_visit_rows(to, d, VERTICES_AT_A_TIME, self.progress, |first, rows| {
            for (x, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                let mean = &mean[self.vertex_map.welded(x) * d..][..d];
                for ((value, f), m) in row.iter_mut().zip(&signal[x * d..]).zip(mean) {
                    *value += factor * (f - m);
                }
            }
        })?)
    }
}
