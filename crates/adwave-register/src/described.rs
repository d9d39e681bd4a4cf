//! The features of a shape as matching needs them.

use crate::Key;
use adwave::bands::{BandsError, Schedule, ScheduleError};
use adwave::features::{
    Descriptor, Feature, FeatureError, FeatureParams, Refinement, Response, describe, features,
};
use adwave::signal::{OutwardError, outward_normals};
use adwave::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use thiserror::Error;

/// How wide the last level is, as a share of the diagonal.
const WIDEST: f64 = 0.08;
/// Levels at least.
const LEAST_LEVELS: usize = 6;
/// Accuracy of the bands: far below what tells features apart.
const ACCURACY: f64 = 1e-6;

/// Why a shape cannot be matched.
#[derive(Debug, Error)]
pub enum DescribeError {
    /// A graph has no positions.
    #[error("a graph has no positions, so no motion brings it to another")]
    NoPositions,
    /// A shape without extent has no lengths.
    #[error("the shape has no extent: all its points are at one place")]
    NoExtent,
    /// Levels that there cannot be.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// No bands.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// No features.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// Normals that are not those of the shape.
    #[error(transparent)]
    Outward(#[from] OutwardError),
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for DescribeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoPositions | Self::NoExtent | Self::Schedule(_) => ErrorKind::Input,
            Self::Bands(e) => e.kind(),
            Self::Features(e) => e.kind(),
            Self::Outward(e) => e.kind(),
            Self::Cancelled(e) => e.kind(),
        }
    }
}

/// The features of a shape, and what they look like.
#[derive(Clone, Debug)]
pub struct Described {
    /// The features, as [`features`] gives them.
    pub features: Vec<Feature>,
    /// The same for matching, in the same order.
    pub keys: Vec<Key>,
    /// What their surroundings look like, in the same order.
    pub descriptors: Vec<Descriptor>,
    /// Whether + is convex and − concave: the shape has an outside.
    pub is_signed: bool,
}

/// Widths σ that two shapes can be compared at: half an octave apart, from the longer of their mean edges to 8 % of the shorter
/// diagonal.
///
/// # Errors
/// [`DescribeError`] of a graph and of a shape without extent.
pub fn common_lengths(first: &Decomposer, second: &Decomposer) -> Result<Vec<f64>, DescribeError> {
    for side in [first, second] {
        if side.geometry().points().is_empty() {
            return Err(DescribeError::NoPositions);
        }
        if !(side.diagonal() > 0.0 && side.mean_length() > 0.0) {
            return Err(DescribeError::NoExtent);
        }
    }
    let finest = first.mean_length().max(second.mean_length());
    let octaves = (WIDEST * first.diagonal().min(second.diagonal()) / finest).log2();
    let n_levels = ((2.0 * octaves).ceil().max(0.0) as usize + 1).max(LEAST_LEVELS);
    Ok((0..n_levels).map(|j| finest * (j as f64 / 2.0).exp2()).collect())
}

/// The features of a shape's coordinates along its outward normals (along nothing, by their length, where it has no outside): of
/// `W_j·n / σ_j` at the widths `lengths`, θ times the mean or more, placed between vertices and levels. `file` are the normals that its file
/// has. O(n × levels).
///
/// # Errors
/// [`DescribeError`].
pub fn described(
    decomposer: &Decomposer,
    file: Option<&[f64]>,
    lengths: &[f64],
    theta: f64,
    progress: Progress<'_>,
) -> Result<Described, DescribeError> {
    let geometry = decomposer.geometry();
    let points = geometry.shape().points().ok_or(DescribeError::NoPositions)?;
    let outward = outward_normals(geometry, file, progress.quiet())?;
    let is_signed = outward.info.has_outside();
    let schedule = Schedule::lengths(lengths, decomposer.diffusion().step_length())?;
    let request =
        decomposer.request(points.as_flattened(), 3, &schedule).accuracy(ACCURACY).progress(progress);
    let wavelets = if is_signed { request.along_normals(&outward.normals)? } else { request.norms()? };
    let params = FeatureParams::default()
        .with_theta(theta)
        .with_response(Response::Sigma)
        .with_refinement(Refinement::Quadratic);
    let features = features(decomposer, &wavelets, &params, progress.quiet())?;
    let welded = geometry.vertex_map();
    let normal = |f: &Feature| if is_signed { outward.normals[welded.welded(f.vertex)] } else { [0.0; 3] };
    let keys = features.iter().filter_map(|f| Key::new(f, normal(f))).collect();
    let descriptors = describe(decomposer, &wavelets, &features);
    Ok(Described { features, keys, descriptors, is_signed })
}
