//! The same task by adwave and by another method, with differences and times side by side.

mod feature_map;
mod harmonics;
mod lee;
mod multiscale;
mod normal_filter;
mod parts;
mod sgwt;
mod taubin;

use crate::feature_map::FeatureMapError;
use crate::harmonics::HarmonicsError;
use crate::lee::LeeError;
use crate::linalg::LinalgError;
use crate::multiscale::MultiscaleError;
use crate::normal_filter::NormalFilterError;
use crate::sgwt::SgwtError;
use crate::taubin::TaubinError;
use adwave::bands::{BandsError, BandsParams, Schedule};
use adwave::features::FeatureError;
use adwave::saliency::SaliencyError;
use adwave::shape::Shape;
use adwave::{Decomposer, Progress, named_values};
use std::time::Instant;
use thiserror::Error;

/// What adwave is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Smoothing: manifold harmonics with a gain `e^(−λt)` of heat that is ½ at the same frequency.
    Harmonics,
    /// A saliency map: `lee2005`.
    Lee,
    /// Features of a signal of one channel: critical points at the same heats.
    FeatureMap,
    /// Bands and back: spectral graph wavelets of the same diffusion operator, as many kernels as levels.
    Sgwt,
    /// Bands and back: diffusion wavelets of the same diffusion operator.
    DiffusionWavelets,
    /// Bands and back: biorthogonal diffusion wavelets of the same diffusion operator.
    Biorthogonal,
    /// Smoothing: the windowed sinc and λ|μ on the same diffusion operator, the gain ½ at the same frequency.
    Taubin,
    /// Denoising of a mesh's coordinates: bilateral normal filtering.
    Bilateral,
    /// Denoising of a mesh's coordinates: guided normal filtering.
    Guided,
}

named_values!(Method, "method", {
    Harmonics => "mht", "Manifold harmonics";
    Lee => "lee", "Mesh saliency";
    FeatureMap => "feature-map", "Critical points";
    Sgwt => "sgwt", "Spectral graph wavelets";
    DiffusionWavelets => "dw", "Diffusion wavelets";
    Biorthogonal => "bdw", "Biorthogonal diffusion wavelets";
    Taubin => "taubin", "Windowed sinc";
    Bilateral => "bilateral", "Bilateral normal filtering";
    Guided => "guided", "Guided normal filtering";
});

/// Why a comparison cannot be made.
#[derive(Debug, Error)]
#[allow(missing_docs)] // each is the error of the module it names
pub enum CompareError {
    #[error(transparent)]
    Bands(#[from] BandsError),
    #[error(transparent)]
    Harmonics(#[from] HarmonicsError),
    #[error(transparent)]
    Lee(#[from] LeeError),
    #[error(transparent)]
    FeatureMap(#[from] FeatureMapError),
    #[error(transparent)]
    Sgwt(#[from] SgwtError),
    #[error(transparent)]
    Multiscale(#[from] MultiscaleError),
    #[error(transparent)]
    Taubin(#[from] TaubinError),
    #[error(transparent)]
    NormalFilter(#[from] NormalFilterError),
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    #[error(transparent)]
    Saliency(#[from] SaliencyError),
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// The task takes a signal of one channel.
    #[error("critical points need a signal of one channel; this one has {0}")]
    Channels(usize),
    /// The task takes the shape itself.
    #[error("normals of faces are filtered to denoise the shape itself; leave the signal at its coordinates")]
    NotCoordinates,
}

/// One measured quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What is measured, with its unit.
    pub quantity: String,
    /// By adwave, where it has a meaning.
    pub adwave: Option<f64>,
    /// By the other method.
    pub other: Option<f64>,
}

/// A result on the vertices of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// What it is.
    pub name: String,
    /// Values per vertex.
    pub n_channels: usize,
    /// n_vertices × n_channels.
    pub values: Vec<f64>,
}

/// Both results and what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What both did.
    pub task: String,
    /// The measurements.
    pub rows: Vec<Row>,
    /// Results of adwave.
    pub adwave: Vec<Outcome>,
    /// Results of the other method, in the same order.
    pub other: Vec<Outcome>,
}

/// What is compared on.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Its prepared geometry and diffusion operator.
    pub walk: &'a Decomposer,
    /// How long these took to make, seconds; `None` where that was not measured.
    pub prepare_seconds: Option<f64>,
    /// The levels of adwave.
    pub schedule: &'a Schedule,
    /// How its bands are computed.
    pub params: &'a BandsParams,
    /// n_vertices × n_channels.
    pub signal: &'a [f64],
    /// Channels of the signal.
    pub n_channels: usize,
    /// Harmonics of the first comparison.
    pub n_harmonics: usize,
}

/// Does the task of `method` both ways.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    subject: &Subject<'_>,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let bands = subject
        .walk
        .request(subject.signal, subject.n_channels, subject.schedule)
        .params(subject.params)
        .progress(progress)
        .bands()?;
    let seconds = start.elapsed().as_secs_f64();
    match method {
        Method::Harmonics => harmonics::compare(subject, &bands, seconds, progress),
        Method::Taubin => taubin::compare(subject, &bands, seconds),
        Method::Lee => lee::compare(subject, &bands, seconds, progress),
        Method::FeatureMap => feature_map::compare(subject, &bands, seconds, progress),
        Method::Sgwt => sgwt::compare(subject, &bands, seconds, progress),
        Method::DiffusionWavelets | Method::Biorthogonal => {
            multiscale::compare(subject, &bands, seconds, method, progress)
        }
        Method::Bilateral | Method::Guided => {
            normal_filter::compare(subject, &bands, seconds, method, progress)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::sample::Sample;
    use adwave::shape::Mesh;

    #[test]
    fn every_method_does_its_task_and_smoothing_agrees() {
        let sample = Sample::by_name("torus", Some(700)).unwrap();
        let points = sample.points.clone();
        let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
        let walk = Decomposer::new(&shape);
        let schedule = Schedule::dyadic(6).unwrap();
        let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let with = |method, signal: &[f64], n_channels| {
            let params = BandsParams::default();
            let subject = Subject {
                shape: &shape,
                walk: &walk,
                prepare_seconds: Some(0.5),
                schedule: &schedule,
                params: &params,
                signal,
                n_channels,
                n_harmonics: 300,
            };
            compare(&subject, method, Progress::none()).unwrap()
        };
        let value = |c: &Comparison, q: &str| {
            c.rows.iter().find(|r| r.quantity.starts_with(q)).unwrap().other.unwrap()
        };
        let coords = points.as_flattened();
        let mht = with(Method::Harmonics, coords, 3);
        let (moved, apart) = (value(&mht, "rms change"), value(&mht, "rms difference"));
        assert!(apart < 0.2 * moved, "the same heat by both: {moved} {apart}");
        for method in [Method::Sgwt, Method::DiffusionWavelets, Method::Biorthogonal] {
            assert!(value(&with(method, coords, 3), "largest error") < 1e-6, "{method:?}");
        }
        let sinc = with(Method::Taubin, coords, 3);
        let half = sinc.rows.iter().find(|r| r.quantity == "gain at the frequency").unwrap();
        assert!((half.adwave.unwrap() - half.other.unwrap()).abs() < 1e-9, "{half:?}");
        assert!(value(&sinc, "λ|μ: rms difference") < value(&sinc, "λ|μ: rms change"));
        for c in [&mht, &sinc] {
            let prepared = c.rows.iter().find(|r| r.quantity == "prepare, s").unwrap();
            assert_eq!(prepared.adwave, Some(0.5));
            // The largest distance is one of those whose mean square rms is the root of.
            assert!(value(c, "largest change") >= value(c, "rms change"));
        }
        for method in [Method::Taubin, Method::Lee] {
            assert!(with(method, coords, 3).other[0].values.iter().all(|v| v.is_finite()), "{method:?}");
        }
        for method in [Method::Bilateral, Method::Guided] {
            let denoised = with(method, coords, 3);
            assert_eq!(value(&denoised, "faces turned"), 0.0, "{method:?}");
            assert!(value(&denoised, "rms change") < moved, "less than a low-pass of six levels: {method:?}");
        }
        let critical = with(Method::FeatureMap, &heights, 1);
        assert_eq!(value(&critical, "sum of indices"), 0.0, "a torus");
    }
}
