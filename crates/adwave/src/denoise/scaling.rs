//! Scaling functions that enter a mixture.

use super::DenoiseError;
use crate::Progress;
use crate::bands::{BandsParams, Precision, Schedule, Transform};
use crate::operator::{Diffusion, Operator};
use std::sync::Arc;

/// Transform of a walk whose bands have a relative error of at most `accuracy`.
pub(super) fn transform(
    diffusion: impl Into<Arc<Diffusion>>,
    accuracy: f64,
) -> Result<Transform, DenoiseError> {
    Ok(Transform::new(diffusion, &params(accuracy))?)
}

/// Transform of an operator without rows whose bands have a relative error of at most `accuracy`.
pub(super) fn shared_transform(
    operator: Arc<dyn Operator>,
    accuracy: f64,
) -> Result<Transform, DenoiseError> {
    Ok(Transform::from_shared_operator(operator, &params(accuracy))?)
}

/// A transform whose bands have a relative error of at most `accuracy`.
pub(super) fn with_accuracy(transform: &Transform, accuracy: f64) -> Result<Transform, DenoiseError> {
    Ok(transform.with_params(&params(accuracy))?)
}

fn params(accuracy: f64) -> BandsParams {
    // One call for each walk would not repay the preparation of single precision.
    BandsParams::default().with_accuracy(accuracy).with_precision(Precision::Double)
}

/// Scaling coefficients S on every level of `data` (n_channels per vertex, row-major), fine to coarse.
pub(super) fn scaling_functions(
    walk: &Transform,
    data: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, DenoiseError> {
    let mut bands = vec![vec![0.0; data.len()]; schedule.n_levels()];
    let mut slices: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
    walk.wavelets_into(data, n_channels, schedule, &mut slices, progress.quiet())?;
    // S(j) = f − W(1) − … − W(j) (eq. 15).
    let mut above = data;
    for band in &mut bands {
        for (w, s) in band.iter_mut().zip(above) {
            *w = s - *w;
        }
        above = band;
    }
    Ok(bands)
}
