//! Statistics that several figures need, and the bands of a model.

use crate::{Context, FigureError, Model};
use adwave::bands::{Bands, Schedule};
use adwave::signal::{SurfaceSignal, surface_signal};
use adwave::vector::{norm, subtract};
use adwave::{Decomposer, Progress};

/// Prepares the geometry of a model, with the operator of the paper.
pub(crate) fn decomposer(model: &Model) -> Decomposer {
    Decomposer::new(&model.shape)
}

/// Decomposes a signal into bands on dyadic levels.
pub(crate) fn bands(
    context: &Context<'_>,
    decomposer: &Decomposer,
    signal: &[f64],
    n_channels: usize,
    n_levels: usize,
) -> Result<Bands, FigureError> {
    let schedule = Schedule::dyadic(n_levels)?;
    Ok(decomposer.request(signal, n_channels, &schedule).progress(context.progress).bands()?)
}

/// Mean curvature of a mesh or cloud, in 1/model unit.
pub(crate) fn mean_curvature(decomposer: &Decomposer) -> Result<Vec<f64>, FigureError> {
    let geometry = decomposer.geometry_for("a curvature")?;
    Ok(surface_signal(geometry, SurfaceSignal::MeanCurvature, Progress::none())?)
}

/// Euclidean norm of the channels of each vertex.
pub(crate) fn norms(values: &[f64], n_channels: usize) -> Vec<f64> {
    values.chunks_exact(n_channels).map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt()).collect()
}

/// Smallest and largest finite value.
pub(crate) fn extent(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Converts a signal of three channels to positions.
pub(crate) fn positions(values: &[f64]) -> Vec<[f64; 3]> {
    values.as_chunks().0.to_vec()
}

/// Distance between two points.
pub(crate) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    norm(&subtract(a, b))
}

/// Formats a share, such as `12 %`.
pub(crate) fn percent(share: f64) -> String {
    if share.is_nan() { "–".to_owned() } else { format!("{:.0} %", 100.0 * share) }
}
