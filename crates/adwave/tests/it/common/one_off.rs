//! Single calls on a diffusion operator without a shape.

use adwave::Progress;
use adwave::bands::{Bands, BandsError, BandsInfo, BandsParams, Schedule, Transform};
use adwave::operator::Diffusion;
use adwave::shape::VertexMap;

/// The bands of one signal.
pub(crate) fn decompose(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    signal: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    params: &BandsParams,
    progress: Progress<'_>,
) -> Result<Bands, BandsError> {
    Transform::new(diffusion.clone(), params)?.bands(vertex_map, signal, n_channels, schedule, progress)
}

/// A weighted sum of the bands of one signal.
#[expect(clippy::too_many_arguments, reason = "the arguments of `decompose` and the factors")]
pub(crate) fn weighted_bands(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    signal: &[f64],
    n_channels: usize,
    schedule: &Schedule,
    factors: &[f64],
    params: &BandsParams,
    progress: Progress<'_>,
) -> Result<(Vec<f64>, BandsInfo), BandsError> {
    let transform = Transform::new(diffusion.clone(), params)?;
    transform.weighted(vertex_map, signal, n_channels, schedule, factors, progress)
}

/// Bytes that [`decompose`] will need.
pub(crate) fn forecast_bytes(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    n_channels: usize,
    schedule: &Schedule,
) -> u64 {
    let transform = Transform::new(diffusion.clone(), &BandsParams::default()).expect("a valid accuracy");
    transform.forecast_bands(vertex_map, n_channels, schedule)
}

/// W_f(1) … W_f(J).
pub(crate) fn levels(bands: &Bands) -> Vec<Vec<f64>> {
    bands.wavelets().map(<[f64]>::to_vec).collect()
}
