//! Features of a shape with their descriptors, for matching.

use crate::Key;
use adwave::bands::{BandsError, Schedule, ScheduleError};
use adwave::features::{
    Descriptor, Feature, FeatureError, FeatureParams, Refinement, Response, describe, features,
};
use adwave::shape::Shape;
use adwave::signal::{OutwardError, outward_normals};
use adwave::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use thiserror::Error;

/// Width of the last level relative to the diagonal.
const MAX_RELATIVE_WIDTH: f64 = 0.08;
/// Smallest number of levels.
const MIN_LEVELS: usize = 6;
/// Relative accuracy of the bands, far below the differences between features.
const ACCURACY: f64 = 1e-6;

/// Failure to describe a shape for matching.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DescribeError {
    /// The shape is a graph or curve, which has no surface.
    #[error("matching needs a surface, and a graph has none")]
    NoPositions,
    /// All points are equal, so that there are no lengths.
    #[error("the shape has no extent: all its points are equal")]
    NoExtent,
    /// The levels are invalid.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The features cannot be computed.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// The normals do not fit the shape.
    #[error(transparent)]
    Outward(#[from] OutwardError),
    /// The call was cancelled.
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

/// Features of a shape with their keys and descriptors.
#[derive(Clone, Debug)]
pub struct ShapeFeatures {
    /// Features in the order of [`features`].
    pub features: Vec<Feature>,
    /// Keys for matching, in the same order.
    pub keys: Vec<Key>,
    /// Descriptors of the surroundings, in the same order.
    pub descriptors: Vec<Descriptor>,
    /// True if the shape has an outside, so that + is convex and − concave.
    pub is_signed: bool,
}

/// Common widths σ of two shapes, in model units: half an octave apart, from the larger mean edge length to 8 % of the
/// smaller diagonal.
///
/// # Errors
/// Returns a [`DescribeError`] for a graph and for a shape without extent.
pub fn common_lengths(first: &Decomposer, second: &Decomposer) -> Result<Vec<f64>, DescribeError> {
    for side in [first, second] {
        if matches!(side.geometry().shape(), Shape::Graph(_)) {
            return Err(DescribeError::NoPositions);
        }
        if !(side.extent() > 0.0 && side.mean_length() > 0.0) {
            return Err(DescribeError::NoExtent);
        }
    }
    let finest = first.mean_length().max(second.mean_length());
    let octaves = (MAX_RELATIVE_WIDTH * first.extent().min(second.extent()) / finest).log2();
    let n_levels = ((2.0 * octaves).ceil().max(0.0) as usize + 1).max(MIN_LEVELS);
    Ok((0..n_levels).map(|j| finest * (j as f64 / 2.0).exp2()).collect())
}

/// Finds and describes the features of the coordinates of a shape, at the widths `lengths`.
///
/// Features are extrema of `W_j·n / σ_j` along the outward normals n, or of `‖W_j‖ / σ_j` if the shape has no outside. Their
/// response is at least θ times the mean, and their positions are interpolated between vertices and levels. `normals` are
/// those stored in the file, if any. O(n × levels).
///
/// # Errors
/// Returns a [`DescribeError`] if bands, normals or features cannot be computed.
pub fn describe_shape(
    decomposer: &Decomposer,
    normals: Option<&[f64]>,
    lengths: &[f64],
    theta: f64,
    progress: Progress<'_>,
) -> Result<ShapeFeatures, DescribeError> {
    let geometry = decomposer.geometry();
    let points = geometry.shape().points().ok_or(DescribeError::NoPositions)?;
    let outward = outward_normals(geometry, normals, progress.quiet())?;
    let is_signed = outward.info.has_outside();
    let schedule = Schedule::lengths(lengths, decomposer.diffusion().step_length())?;
    let request =
        decomposer.request(points.as_flattened(), 3, &schedule).accuracy(ACCURACY).progress(progress);
    let wavelets = if is_signed { request.normal_components(&outward.normals)? } else { request.norms()? };
    let params = FeatureParams::default()
        .with_theta(theta)
        .with_response(Response::Sigma)
        .with_refinement(Refinement::Quadratic);
    let features = features(decomposer, &wavelets, &params, progress.quiet())?;
    let welded = geometry.vertex_map();
    let normal = |f: &Feature| if is_signed { outward.normals[welded.welded(f.vertex)] } else { [0.0; 3] };
    let keys = features.iter().filter_map(|f| Key::new(f, normal(f))).collect();
    let descriptors = describe(decomposer, &wavelets, &features);
    Ok(ShapeFeatures { features, keys, descriptors, is_signed })
}
