//! Bands about a local linear fit.

use super::FitDomain;
use super::gradient::{GradientFit, edges};
use crate::bands::{BandsError, BandsInfo, Schedule, Transform};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress, parallel};

/// Share of a level's steps that smooth its gradient. The gradient is then fitted over half the width σ_j: wide
/// enough that its noise times the drift at a border, about 0.6·σ_j, stays below that of the band, for a third of the
/// products that the whole width takes.
const GRADIENT_STEPS: f64 = 0.25;

/// Relative error of smoothed gradients. It changes nothing for a linear field, because gradients and their weights
/// have the same error.
pub(super) const GRADIENT_ACCURACY: f64 = 1e-4;

/// Smoothed weight, relative to the mean weight, below which a vertex keeps its own gradient; above it, the error
/// of the smoothed weight is a hundredth.
pub(super) const LEAST_WEIGHT: f64 = 1e-2;

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

/// Transform of an operator prepared for fields over one domain.
#[derive(Clone, Debug)]
pub(crate) struct LinearTransform<'a> {
    transform: &'a Transform,
    /// Steps between the neighbors over which gradients are fitted.
    rows: &'a Diffusion,
    domain: FitDomain,
    fit: GradientFit,
}

impl<'a> LinearTransform<'a> {
    /// Prepares the fits of an operator whose vertices are at `points`, in a unit in which squares of lengths neither
    /// overflow nor underflow; `rows` are its own, or steps between the same neighbors. `is_surface` excludes that the
    /// points fill a volume. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(
        transform: &'a Transform,
        rows: &'a Diffusion,
        points: &[[f64; 3]],
        domain: FitDomain,
        is_surface: bool,
        progress: Progress<'_>,
    ) -> Result<Self, BandsError> {
        let fit = GradientFit::new(rows, points, domain, is_surface, progress)?;
        Ok(Self { transform, rows, domain, fit })
    }

    /// The fits of another operator on the same vertices. O(entries).
    pub(crate) fn with_transform<'t>(
        &self,
        transform: &'t Transform,
        rows: &'t Diffusion,
        progress: Progress<'_>,
    ) -> Result<LinearTransform<'t>, Cancelled> {
        let fit = self.fit.refit(rows, self.domain, progress)?;
        Ok(LinearTransform { transform, rows, domain: self.domain, fit })
    }

    /// Domain of the fits.
    pub(crate) fn domain(&self) -> FitDomain {
        self.domain
    }

    /// Wavelet coefficients W_f(1), …, W_f(J) of a field of one channel, in the order of the operator.
    ///
    /// # Errors
    /// As for [`Transform::wavelets_into`].
    pub(crate) fn wavelets(
        &self,
        field: &[f64],
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<(Vec<Vec<f64>>, BandsInfo), BandsError> {
        self.visit_wavelets(field, schedule, progress, |_, _| Ok(()))
    }

    /// [`wavelets`](Self::wavelets), with a call `visit(level, value)` for the coefficients of the operator itself on
    /// each level from 0, `value` being a function of the vertex.
    fn visit_wavelets(
        &self,
        field: &[f64],
        schedule: &Schedule,
        progress: Progress<'_>,
        mut visit: impl FnMut(usize, &(dyn Fn(usize) -> f64 + Sync)) -> Result<(), Cancelled>,
    ) -> Result<(Vec<Vec<f64>>, BandsInfo), BandsError> {
        let n = field.len();
        let (unit, scale) = self.units(field, progress)?;
        let axes = self.domain.axes();
        // The field and the positions are one block of channels, so that their series are truncated alike.
        let width = 1 + axes.len();
        let mut block = crate::pages::zeros(n * width);
        parallel::try_visit_rows(&mut block, width, ROWS_AT_A_TIME, progress, |first, rows| {
            for (x, row) in (first..).zip(rows.chunks_exact_mut(width)) {
                row[0] = field[x] / unit;
                axes.iter()
                    .zip(&mut row[1..])
                    .for_each(|(&axis, c)| *c = scale * self.fit.positions[x][axis]);
            }
        })?;
        let bands = self.transform.decompose_mean(&block, width, schedule, progress)?;
        let mut info = bands.info.clone();
        let field: Vec<f64> = parallel::try_collect(n, progress, |x| block[x * width])?;
        drop(block);
        let mut gradients = SmoothedGradients::new(self, &field, scale, schedule, &mut info, progress)?;
        let mut sums = DriftSums { width, rows: crate::pages::zeros(n * (width + 1)) };
        let mut levels = Vec::with_capacity(bands.levels.len());
        for (level, (band, &steps)) in bands.levels.into_iter().zip(schedule.steps()).enumerate() {
            gradients.advance_to(steps, progress)?;
            visit(level, &|x| band[x * width] * unit)?;
            levels.push(sums.add_level(self, &band, &gradients, unit, progress)?);
        }
        Ok((levels, info))
    }

    /// Scaling coefficients of a field of one channel on every level, and those of the operator itself on the levels
    /// from `first_plain` on, counted from 0.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    pub(crate) fn scaling(
        &self,
        field: &[f64],
        schedule: &Schedule,
        first_plain: usize,
        progress: Progress<'_>,
    ) -> Result<LinearScaling, BandsError> {
        let (mut plain, mut now) = (Vec::new(), field.to_vec());
        let (mut levels, _) = self.visit_wavelets(field, schedule, progress, |level, band| {
            parallel::try_visit_rows(&mut now, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (x, s) in (first..).zip(rows) {
                    *s -= band(x);
                }
            })?;
            if level >= first_plain {
                plain.push(now.clone());
            }
            Ok(())
        })?;
        let mut finer = field;
        for level in &mut levels {
            for (w, s) in level.iter_mut().zip(finer) {
                *w = s - *w; // S_f(j) = S_f(j−1) − W_f(j) (eq. 11)
            }
            finer = level;
        }
        Ok(LinearScaling { levels, plain })
    }

    /// Difference of a field of one channel from the linear fit to the neighbors of each vertex, all with the same
    /// weight; NaN without neighbors. O(entries).
    pub(crate) fn residuals(&self, field: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let diffusion = self.rows;
        let gradients = self.fit.gradients(diffusion, field, progress)?;
        parallel::try_collect(field.len(), progress, |x| {
            let mut n_neighbors = 0.0;
            let (mut rise, mut drift) = (0.0, [0.0; 3]);
            for (_, d, y) in edges(diffusion, &self.fit.positions, x) {
                n_neighbors += 1.0;
                rise += field[y] - field[x];
                drift = std::array::from_fn(|k| drift[k] + d[k]);
            }
            let (drift, a) = (self.fit.tangential(x, drift), &gradients[x]);
            (drift[0] * a[0] + drift[1] * a[1] + drift[2] * a[2] - rise) / n_neighbors
        })
    }

    /// Powers of two: the unit of the field, and the factor of the positions for which their change in one step is as
    /// large as that of the field in its unit. Series are truncated by the norm of both.
    fn units(&self, field: &[f64], progress: Progress<'_>) -> Result<(f64, f64), Cancelled> {
        let power_of_two = |v: f64| v.log2().round().clamp(-1000.0, 1000.0).exp2();
        let largest = parallel::max(field.len(), 0.0, |x| field[x].abs());
        if !(largest > 0.0 && largest.is_finite()) {
            return Ok((1.0, 1.0));
        }
        let unit = power_of_two(largest);
        let diffusion = self.rows;
        let square = parallel::try_sum(field.len(), progress, |x| {
            let (columns, weights) = diffusion.row(x);
            let rises =
                columns.iter().zip(weights).map(|(&y, w)| w * (field[y as usize] / unit - field[x] / unit));
            rises.sum::<f64>().powi(2)
        })? / field.len() as f64;
        let ratio = (square / self.fit.drift_square).sqrt();
        Ok((unit, if ratio > 0.0 && ratio.is_finite() { power_of_two(ratio) } else { 1.0 }))
    }
}

/// Scaling coefficients of a field, n_vertices values for each level.
pub(crate) struct LinearScaling {
    /// Coefficients about the fit.
    pub(crate) levels: Vec<Vec<f64>>,
    /// Coefficients of the operator itself, on the last levels.
    pub(crate) plain: Vec<Vec<f64>>,
}

/// Gradients of a field times their weights, and the weights, smoothed level by level.
struct SmoothedGradients {
    n_axes: usize,
    /// Gradients that were smoothed by no steps.
    first: Vec<f64>,
    /// Gradients and weights of the current level, n_vertices × (n_axes + 1).
    rows: Vec<f64>,
    /// Bands of `rows` that are still to be taken off, and the steps of their levels, coarse to fine.
    bands: Vec<(f64, Vec<f64>)>,
    /// Smallest weight by which a gradient is divided.
    least: f64,
}

impl SmoothedGradients {
    fn new(
        of: &LinearTransform<'_>,
        field: &[f64],
        scale: f64,
        schedule: &Schedule,
        info: &mut BandsInfo,
        progress: Progress<'_>,
    ) -> Result<Self, BandsError> {
        let (fit, axes) = (&of.fit, of.domain.axes());
        let (n, width) = (field.len(), axes.len() + 1);
        let gradients = fit.gradients(of.rows, field, progress)?;
        let mut rows = crate::pages::zeros(n * width);
        parallel::try_visit_rows(&mut rows, width, ROWS_AT_A_TIME, progress, |first, rows| {
            for (x, row) in (first..).zip(rows.chunks_exact_mut(width)) {
                let weight = fit.confidence[x];
                // Positions are multiplied by the scale, so gradients are divided by it.
                axes.iter().zip(&mut *row).for_each(|(&axis, a)| *a = weight * (gradients[x][axis] / scale));
                row[axes.len()] = weight;
            }
        })?;
        drop(gradients);
        let mut steps: Vec<f64> = schedule.steps().iter().map(|n| gradient_steps(*n)).collect();
        steps.retain(|n| *n > 0.0);
        steps.dedup();
        let mut bands = Vec::new();
        if !steps.is_empty() {
            let schedule = Schedule::real(steps).expect("increasing numbers of at least one step");
            let accuracy = of.transform.params().accuracy.max(GRADIENT_ACCURACY);
            let transform = of.transform.with_params(&of.transform.params().with_accuracy(accuracy))?;
            let found = transform.decompose_mean(&rows, width, &schedule, progress)?;
            info.products += found.info.products;
            info.terms += found.info.terms;
            bands = schedule.steps().iter().copied().zip(found.levels).rev().collect();
        }
        let mean = parallel::try_sum(n, progress, |x| fit.confidence[x])? / n.max(1) as f64;
        let first = rows.clone();
        Ok(Self { n_axes: axes.len(), first, rows, bands, least: LEAST_WEIGHT * mean })
    }

    /// Smooths the gradients to those of a level of `steps` steps.
    fn advance_to(&mut self, steps: f64, progress: Progress<'_>) -> Result<(), Cancelled> {
        while self.bands.last().is_some_and(|(of, _)| *of <= gradient_steps(steps)) {
            let Some((_, band)) = self.bands.pop() else { break };
            parallel::try_visit_rows(&mut self.rows, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (s, w) in rows.iter_mut().zip(&band[first..]) {
                    *s -= w;
                }
            })?;
        }
        Ok(())
    }

    /// Gradient of the current level at vertex `x`, by axis.
    fn component(&self, x: usize, axis: usize) -> f64 {
        let width = self.n_axes + 1;
        let row = &self.rows[x * width..][..width];
        let row = if row[self.n_axes] > self.least { row } else { &self.first[x * width..][..width] };
        if row[self.n_axes] > 0.0 { row[axis] / row[self.n_axes] } else { 0.0 }
    }
}

/// Number of steps that smooth the gradient of a level: whole, so that any operator can take them.
pub(super) fn gradient_steps(steps: f64) -> f64 {
    (GRADIENT_STEPS * steps).floor()
}

/// Sums over the levels up to the current one.
struct DriftSums {
    /// Number of channels of a band: the field and the axes.
    width: usize,
    /// For each vertex the product a_j·d_j, the drift d_j by axis, and the result of the level.
    rows: Vec<f64>,
}

impl DriftSums {
    /// Adds the band of a level, and returns the wavelet coefficients about the fit:
    /// `W_f(j) + a_{j−1}·d_{j−1} − a_j·d_j`.
    fn add_level(
        &mut self,
        of: &LinearTransform<'_>,
        band: &[f64],
        gradients: &SmoothedGradients,
        unit: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let (axes, width) = (of.domain.axes(), self.width);
        let stride = width + 1;
        parallel::try_visit_rows(&mut self.rows, stride, ROWS_AT_A_TIME, progress, |first, rows| {
            for (x, row) in (first..).zip(rows.chunks_exact_mut(stride)) {
                let band = &band[x * width..][..width];
                let mut drift = [0.0; 3];
                for (k, &axis) in axes.iter().enumerate() {
                    row[1 + k] += band[1 + k]; // d_j = p − S_p(j)
                    drift[axis] = row[1 + k];
                }
                let drift = of.fit.tangential(x, drift);
                let product: f64 =
                    axes.iter().enumerate().map(|(k, &axis)| gradients.component(x, k) * drift[axis]).sum();
                row[width] = (band[0] + row[0] - product) * unit;
                row[0] = product;
            }
        })?;
        parallel::try_collect(self.rows.len() / stride, progress, |x| self.rows[x * stride + width])
    }
}
