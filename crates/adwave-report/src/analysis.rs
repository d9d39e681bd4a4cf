//! Saliency and features of bands that are there in the order of the shape.

use adwave::bands::{Bands, Wavelets};
use adwave::features::{self, Feature, FeatureError, FeatureParams, Response};
use adwave::saliency::{self, Saliency, SaliencyError, SaliencyLevel, SaliencyParams};
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
