//! Comparisons: one task is solved by adwave and by another method, with the differences and times of both.

mod feature_map;
mod grid;
mod harmonics;
mod lee;
mod multiscale;
mod normal_filter;
mod sgwt;
mod shared;
mod subdivision;
mod taubin;

use crate::feature_map::FeatureMapError;
use crate::grid_smoothing::GridPlaces;
use crate::harmonics::HarmonicsError;
use crate::lee::LeeError;
use crate::linalg::LinalgError;
use crate::multiscale::MultiscaleError;
use crate::normal_filter::NormalFilterError;
use crate::sgwt::SgwtError;
use crate::taubin::TaubinError;
use adwave::bands::{BandsError, BandsParams, Schedule};
use adwave::features::FeatureError;
use adwave::operator::NoRows;
use adwave::region::RegionError;
use adwave::saliency::SaliencyError;
use adwave::shape::NoShape;
use adwave::shape::Shape;
use adwave::{Decomposer, Progress, named_values};
use adwave_subdivision::SubdivisionError;
use std::time::Instant;
use thiserror::Error;

/// Method with which adwave is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Smoothing by manifold harmonics with the gain `e^(−λt)` of heat; both gains are ½ at the same frequency.
    Harmonics,
    /// Saliency map of `lee2005`.
    Lee,
    /// Features of a one-channel signal: critical points after smoothing by heat of the same widths.
    FeatureMap,
    /// Decomposition and reconstruction by spectral graph wavelets of the same diffusion operator, with as many
    /// kernels as levels.
    Sgwt,
    /// Decomposition and reconstruction by diffusion wavelets of the same diffusion operator.
    DiffusionWavelets,
    /// Decomposition and reconstruction by biorthogonal diffusion wavelets of the same diffusion operator.
    Biorthogonal,
    /// Smoothing by the windowed sinc and by λ|μ on the same diffusion operator; both gains are ½ at the same
    /// frequency.
    Taubin,
    /// Denoising of a mesh's coordinates by bilateral normal filtering.
    Bilateral,
    /// Denoising of a mesh's coordinates by guided normal filtering.
    Guided,
    /// Wavelets by lifting on the levels of subdivision of a mesh, or on levels of any mesh.
    Subdivision,
    /// Bands of an image or a volume by sampled Gaussians of the same widths.
    Gaussian,
    /// Bands of an image or a volume by the isotropic undecimated wavelet of the B3 spline, `starck2007`.
    Starlet,
}

impl Method {
    /// True if the method takes images and volumes; the others take shapes.
    pub fn takes_grids(self) -> bool {
        matches!(self, Self::Gaussian | Self::Starlet)
    }
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
    Subdivision => "subdivision", "Wavelets by lifting";
    Gaussian => "gaussian", "Sampled Gaussians";
    Starlet => "starlet", "Starlet";
});

/// Reason for which a comparison cannot be made.
#[derive(Debug, Error)]
#[allow(missing_docs)] // each variant wraps the error of the module it names
#[non_exhaustive]
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
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    #[error(transparent)]
    Region(#[from] RegionError),
    #[error(transparent)]
    NoRows(#[from] NoRows),
    #[error(transparent)]
    NoShape(#[from] NoShape),
    /// The task needs a mesh.
    #[error("wavelets by lifting need a mesh of triangles; give one, or read the shape with --as mesh")]
    NotMesh,
    /// The method and the domain do not go together.
    #[error(
        "gaussian and starlet take images and volumes, the other methods take shapes; choose another method"
    )]
    OtherDomain,
    /// A sampled kernel has too many weights.
    #[error(
        "a sampled Gaussian must have at most a million weights on either side, and σ = {sigma} takes more; choose narrower levels"
    )]
    WideKernel {
        /// Width of the level.
        sigma: f64,
    },
    /// The task needs a signal with one channel.
    #[error("critical points need a signal with one channel, got {0} channels")]
    Channels(usize),
    /// The task needs the coordinates of the shape as its signal.
    #[error("normal filtering denoises the shape itself; select the coordinates as the signal")]
    NotCoordinates,
}

/// Measured quantity with its values for both methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the quantity, with its unit.
    pub quantity: String,
    /// The level that was measured; `None` for all together.
    pub level: Option<usize>,
    /// Value for adwave; `None` if the quantity has no meaning for adwave.
    pub adwave: Option<f64>,
    /// Value for the other method; `None` if the quantity has no meaning for that method.
    pub other: Option<f64>,
}

/// Result with values at the vertices of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Name of the result.
    pub name: String,
    /// Number of values per vertex.
    pub n_channels: usize,
    /// Values, row-major, n_vertices × n_channels.
    pub values: Vec<f64>,
}

/// Results of both methods, and the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Task that both methods solved.
    pub task: String,
    /// Measured quantities.
    pub rows: Vec<Row>,
    /// Results of adwave.
    pub adwave: Vec<Outcome>,
    /// Results of the other method, in the same order.
    pub other: Vec<Outcome>,
}

/// Shape, signal and settings that are given to both methods.
#[derive(Clone, Copy, Debug)]
pub struct ComparisonInput<'a> {
    /// Shape of the comparison.
    pub shape: &'a Shape,
    /// Places of an image or a volume; `None` for a shape.
    pub grid: Option<GridPlaces<'a>>,
    /// Prepared geometry and diffusion operator of the shape.
    pub decomposer: &'a Decomposer,
    /// Seconds spent on preparing the geometry and the operator; `None` if not measured.
    pub prepare_seconds: Option<f64>,
    /// Levels of adwave.
    pub schedule: &'a Schedule,
    /// Accuracy and method with which adwave computes its bands.
    pub params: &'a BandsParams,
    /// Signal, row-major, n_vertices × n_channels.
    pub signal: &'a [f64],
    /// Number of channels of the signal.
    pub n_channels: usize,
    /// Number of harmonics in the comparison with [`Method::Harmonics`].
    pub n_harmonics: usize,
}

/// Solves the task of `method` with adwave and with the other method.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    input: &ComparisonInput<'_>,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    if input.grid.is_some() != method.takes_grids() {
        return Err(CompareError::OtherDomain);
    }
    let start = Instant::now();
    let bands = input
        .decomposer
        .request(input.signal, input.n_channels, input.schedule)
        .params(input.params)
        .progress(progress)
        .bands()?;
    let seconds = start.elapsed().as_secs_f64();
    match method {
        Method::Harmonics => harmonics::compare(input, &bands, seconds, progress),
        Method::Taubin => taubin::compare(input, &bands, seconds),
        Method::Lee => lee::compare(input, &bands, seconds, progress),
        Method::FeatureMap => feature_map::compare(input, &bands, seconds, progress),
        Method::Sgwt => sgwt::compare(input, &bands, seconds, progress),
        Method::DiffusionWavelets | Method::Biorthogonal => {
            multiscale::compare(input, &bands, seconds, method, progress)
        }
        Method::Bilateral | Method::Guided => {
            normal_filter::compare(input, &bands, seconds, method, progress)
        }
        Method::Subdivision => subdivision::compare(input, &bands, seconds, progress),
        Method::Gaussian | Method::Starlet => {
            let places = input.grid.ok_or(CompareError::OtherDomain)?;
            grid::compare(input, &places, &bands, seconds, method)
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
        let sample = Sample::from_name("torus", Some(700)).unwrap();
        let points = sample.points.clone();
        let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
        let decomposer = Decomposer::new(&shape);
        let schedule = Schedule::dyadic(6).unwrap();
        let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let with = |method, signal: &[f64], n_channels| {
            let params = BandsParams::default();
            let input = ComparisonInput {
                shape: &shape,
                grid: None,
                decomposer: &decomposer,
                prepare_seconds: Some(0.5),
                schedule: &schedule,
                params: &params,
                signal,
                n_channels,
                n_harmonics: 300,
            };
            compare(&input, method, Progress::none()).unwrap()
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
            // The distances at the vertices whose mean square gives rms; the largest of them is reported.
            assert!(value(c, "largest change") >= value(c, "rms change"));
        }
        for method in [Method::Taubin, Method::Lee] {
            assert!(with(method, coords, 3).other[0].values.iter().all(|v| v.is_finite()), "{method:?}");
        }
        for method in [Method::Bilateral, Method::Guided] {
            let denoised = with(method, coords, 3);
            assert_eq!(value(&denoised, "faces rotated"), 0.0, "{method:?}");
            assert!(value(&denoised, "rms change") < moved, "less than a low-pass of six levels: {method:?}");
        }
        let lifted = with(Method::Subdivision, coords, 3);
        assert!(value(&lifted, "largest error") < 1e-12);
        let kept = lifted.rows.iter().find(|r| r.quantity.starts_with("error with a tenth")).unwrap();
        assert!(
            kept.other.unwrap() < 0.5 * kept.adwave.unwrap(),
            "a basis keeps more than a frame: {kept:?}"
        );
        let moved = lifted.rows.iter().find(|r| r.quantity.starts_with("share of a bump's energy")).unwrap();
        assert!(moved.adwave.unwrap() < moved.other.unwrap(), "bands depend less on the place: {moved:?}");
        let critical = with(Method::FeatureMap, &heights, 1);
        assert_eq!(value(&critical, "sum of indices"), 0.0, "a torus");
    }
}
