//! Saliency and features of bands in the order of the shape, for the crates of this workspace.

use adwave::bands::{Bands, Wavelets};
use adwave::features::{self, Feature, FeatureError, FeatureParams, Response};
use adwave::saliency::{self, Saliency, SaliencyError, SaliencyLevel, SaliencyParams};
use adwave::signal::{OutwardInfo, outward_normals};
use adwave::{Decomposer, Progress};

fn wavelets(decomposer: &Decomposer, bands: &Bands) -> Wavelets {
    bands.to_wavelets(decomposer.vertex_map())
}

/// Computes the map of [`saliency::saliency`] over all channels together.
///
/// # Errors
/// As for [`saliency::saliency`].
pub fn saliency(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &SaliencyParams,
) -> Result<Saliency, SaliencyError> {
    saliency::saliency(decomposer, &wavelets(decomposer, bands).into_norms(), params, Progress::none())
}

/// Saliency map that is signed if possible, one value per vertex.
pub(crate) struct SignedMap {
    pub(crate) map: Vec<f64>,
    /// True if the sign of the map has a meaning.
    pub(crate) is_signed: bool,
    /// Orientation of the normals, if the signal is the shape itself.
    pub(crate) outward: Option<OutwardInfo>,
}

/// Computes the saliency map with the default parameters. For coordinates it is positive where the shape is convex;
/// `normals` are those of the file, three numbers per vertex, if it has any. For a scalar signal it has the sign of the
/// signal, and for other vectors it is unsigned.
pub(crate) fn signed_saliency(
    decomposer: &Decomposer,
    bands: &Bands,
    is_geometry: bool,
    normals: Option<&[f64]>,
) -> Result<SignedMap, SaliencyError> {
    let geometry = decomposer.geometry().filter(|_| is_geometry);
    let outward = geometry.and_then(|geometry| outward_normals(geometry, normals, Progress::none()).ok());
    let wavelets = wavelets(decomposer, bands);
    let (wavelets, is_signed) = match &outward {
        Some(outward) if outward.info.has_outside() => (wavelets.into_along(&outward.normals), true),
        _ => (wavelets.into_norms(), bands.n_channels == 1),
    };
    let map = saliency::saliency(decomposer, &wavelets, &SaliencyParams::default(), Progress::none())?.map;
    Ok(SignedMap { map, is_signed, outward: outward.map(|o| o.info) })
}

/// Computes the maps of [`saliency::saliency_per_level`] over all channels together.
///
/// # Errors
/// As for [`saliency::saliency_per_level`].
pub fn saliency_per_level(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &SaliencyParams,
) -> Result<Vec<(SaliencyLevel, Vec<f64>)>, SaliencyError> {
    let norms = wavelets(decomposer, bands).into_norms();
    saliency::saliency_per_level(decomposer, &norms, params, Progress::none())
}

/// Finds the features of [`features::features`] over all channels together, or of each channel if the response is by
/// channel.
///
/// # Errors
/// As for [`features::features`].
pub fn features(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &FeatureParams,
) -> Result<Vec<Feature>, FeatureError> {
    let wavelets = wavelets(decomposer, bands);
    let wavelets = if params.response == Response::Channels { wavelets } else { wavelets.into_norms() };
    features::features(decomposer, &wavelets, params, Progress::none())
}
