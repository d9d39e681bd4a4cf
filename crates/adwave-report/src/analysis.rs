//! Saliency and features of bands that are there in the order of the shape.

use adwave::bands::{Bands, Wavelets};
use adwave::features::{self, Feature, FeatureError, FeatureParams, Response};
use adwave::saliency::{self, Saliency, SaliencyError, SaliencyLevel, SaliencyParams};
use adwave::signal::{OutwardInfo, outward_normals};
use adwave::{Decomposer, Progress};

fn wavelets(decomposer: &Decomposer, bands: &Bands) -> Wavelets {
    bands.to_wavelets(decomposer.geometry().vertex_map())
}

/// [`saliency::saliency`] of all channels together.
pub(crate) fn saliency(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &SaliencyParams,
) -> Result<Saliency, SaliencyError> {
    saliency::saliency(decomposer, &wavelets(decomposer, bands).into_norms(), params, Progress::none())
}

/// A signed map, and how the outside of the shape was found where the signal is the shape.
pub(crate) struct SignedMap {
    pub(crate) map: Vec<f64>,
    /// Whether + and − are different sides.
    pub(crate) is_signed: bool,
    pub(crate) outward: Option<OutwardInfo>,
}

/// The map by [`SaliencyParams::default`]: of coordinates (`normals`: of the file, where it has some) with + where the shape is
/// convex, of a scalar signal with its own sign, of other vectors without.
pub(crate) fn signed_saliency(
    decomposer: &Decomposer,
    bands: &Bands,
    is_geometry: bool,
    normals: Option<&[f64]>,
) -> Result<SignedMap, SaliencyError> {
    let outward = is_geometry.then(|| outward_normals(decomposer.geometry(), normals, Progress::none()));
    let outward = outward.and_then(Result::ok);
    let wavelets = wavelets(decomposer, bands);
    let (wavelets, is_signed) = match &outward {
        Some(outward) if outward.info.has_outside() => (wavelets.into_along(&outward.normals), true),
        _ => (wavelets.into_norms(), bands.n_channels == 1),
    };
    let map = saliency::saliency(decomposer, &wavelets, &SaliencyParams::default(), Progress::none())?.map;
    Ok(SignedMap { map, is_signed, outward: outward.map(|o| o.info) })
}

/// [`saliency::saliency_per_level`] of all channels together.
pub(crate) fn saliency_per_level(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &SaliencyParams,
) -> Result<Vec<(SaliencyLevel, Vec<f64>)>, SaliencyError> {
    let norms = wavelets(decomposer, bands).into_norms();
    saliency::saliency_per_level(decomposer, &norms, params, Progress::none())
}

/// [`features::features`] of all channels together, or of each by itself where the response says so.
pub(crate) fn features(
    decomposer: &Decomposer,
    bands: &Bands,
    params: &FeatureParams,
) -> Result<Vec<Feature>, FeatureError> {
    let wavelets = wavelets(decomposer, bands);
    let wavelets = if params.response == Response::Channels { wavelets } else { wavelets.into_norms() };
    features::features(decomposer, &wavelets, params, Progress::none())
}
