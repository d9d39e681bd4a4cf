//! Features of a shape with their descriptors, for matching.

use crate::Key;
use adwave::bands::{BandsError, BandsParams, Schedule, ScheduleError, Wavelets};
use adwave::features::{
    CoordinateFeatureError, DESCRIPTOR_LENGTH, Descriptor, Feature, FeatureError, FeatureParams, Refinement,
    Response, ShapeCoordinates, coordinate_features, describe, features,
};
use adwave::shape::Shape;
use adwave::signal::{OutwardError, OutwardNormals, outward_normals};
use adwave::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use std::sync::Arc;
use thiserror::Error;

/// Width σ of the last level, relative to the diagonal.
const MAX_RELATIVE_WIDTH: f64 = 0.08;
/// Smallest number of levels.
const MIN_LEVELS: usize = 6;
/// Relative accuracy of the bands, far below the differences between features.
const ACCURACY: f64 = 1e-6;

/// Least response of a feature, relative to the mean of its level, where significance does not apply.
pub const DEFAULT_THETA: f64 = 1.0;

/// Largest number of landmarks of a shape; the strongest are kept.
const MAX_LANDMARKS: usize = 250;
/// Smallest σ of a landmark, in mean spacings: finer bands are mostly noise.
const LANDMARK_SPACINGS: f64 = 2.0;

/// Largest σ of a landmark, relative to the diagonal; few wider landmarks lie off the borders of an overlap.
const LANDMARK_EXTENT: f64 = 0.06;

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
    /// The features of the coordinates cannot be computed.
    #[error(transparent)]
    Coordinates(#[from] CoordinateFeatureError),
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
            Self::Coordinates(e) => e.kind(),
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
    /// Keys of the places at which a band is extremal on the surface and over the levels, significant or not. A small
    /// overlap may have no feature, but a motion that brings none of these places together is not believed.
    pub(crate) extremal_keys: Vec<Key>,
    /// Descriptors of the surroundings, in the same order.
    pub descriptors: Vec<Descriptor>,
    /// Places at which a band is extremal on the surface, regardless of other levels. They outnumber the features, and
    /// the search for a motion starts from them.
    pub(crate) landmarks: Landmarks,
    /// True if the shape has an outside, so that + is convex and − concave.
    pub is_signed: bool,
    /// True if the outside of a part was guessed, so that another scan of the part may have the other side outside.
    pub is_guessed: bool,
    /// Bands in which the features were found, one channel; `None` without features.
    pub bands: Option<Arc<Wavelets>>,
    /// Outward normals at the welded vertices; zero if the shape has no outside.
    pub normals: Arc<Vec<[f64; 3]>>,
}

/// Places at which a band is extremal on the surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct Landmarks {
    pub(crate) keys: Vec<Key>,
    pub(crate) descriptors: Vec<Descriptor>,
}

impl Landmarks {
    /// Finds the [`MAX_LANDMARKS`] strongest landmarks on levels an octave apart, from [`LANDMARK_SPACINGS`] upward.
    /// O(n × levels).
    fn new(decomposer: &Decomposer, bands: &Wavelets, normal: impl Fn(usize) -> [f64; 3]) -> Self {
        let (neighbors, map) = (decomposer.neighbors(), decomposer.vertex_map().as_slice());
        let mut first = vec![usize::MAX; decomposer.n_places()];
        for (vertex, &x) in map.iter().enumerate().rev() {
            first[x as usize] = vertex;
        }
        let mut found: Vec<Feature> = Vec::new();
        let finest = LANDMARK_SPACINGS * decomposer.mean_length();
        let Some(start) = (1..=bands.n_levels()).find(|&j| bands.sigma[j] >= finest) else {
            return Self::default();
        };
        let widest = LANDMARK_EXTENT * decomposer.extent();
        for level in (start..=bands.n_levels()).step_by(2).filter(|&j| j == start || bands.sigma[j] <= widest)
        {
            let band = bands.wavelet(level);
            let mean = band.iter().map(|r| r.abs()).sum::<f64>() / band.len().max(1) as f64;
            let is_extremal = |x: usize| {
                let (r, sign) = (band[x].abs(), band[x].signum());
                let is_less = |&y: &u32| y as usize == x || sign * band[y as usize] < r;
                let ring = neighbors.row(x);
                r > mean && ring.iter().all(|y| is_less(y) && neighbors.row(*y as usize).iter().all(is_less))
            };
            found.extend((0..band.len()).filter(|&x| first[x] != usize::MAX && is_extremal(x)).map(|x| {
                Feature {
                    vertex: first[x],
                    position: decomposer.positions().get(x).copied(),
                    level,
                    sigma: bands.sigma[level],
                    response: band[x],
                    strength: band[x].abs() / mean,
                    channel: None,
                }
            }));
        }
        found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        found.truncate(MAX_LANDMARKS);
        let keys = found.iter().filter_map(|f| Key::new(f, normal(f.vertex))).collect();
        Self { keys, descriptors: describe(decomposer, bands, &found) }
    }

    fn map(&self, key: impl Fn(&Key) -> Key, descriptor: impl Fn(&Descriptor) -> Descriptor) -> Self {
        Self {
            keys: self.keys.iter().map(key).collect(),
            descriptors: self.descriptors.iter().map(descriptor).collect(),
        }
    }

    /// Landmarks of the surface with its other side outside.
    pub(crate) fn flipped(&self) -> Self {
        self.map(Key::flipped, flip_descriptor)
    }

    /// Landmarks of the mirror image at x = 0. Descriptors stay unchanged.
    pub(crate) fn mirrored(&self) -> Self {
        self.map(Key::mirrored, Descriptor::clone)
    }
}

impl ShapeFeatures {
    /// Creates a result with normals alone, for comparisons of surfaces that need no features.
    pub fn without_features(outward: OutwardNormals) -> Self {
        Self {
            features: Vec::new(),
            keys: Vec::new(),
            extremal_keys: Vec::new(),
            descriptors: Vec::new(),
            landmarks: Landmarks::default(),
            is_signed: outward.info.has_outside(),
            is_guessed: outward.info.n_by_majority > 0,
            bands: None,
            normals: Arc::new(outward.normals),
        }
    }
}

/// Keys of the mirror image at x = 0 if `is_mirrored`, with the other side outside if `is_flipped`.
pub(crate) fn keys_of_view(keys: &[Key], is_mirrored: bool, is_flipped: bool) -> Vec<Key> {
    let view = |key: &Key| {
        let key = if is_mirrored { key.mirrored() } else { *key };
        if is_flipped { key.flipped() } else { key }
    };
    keys.iter().map(view).collect()
}

/// Common widths σ of two shapes, in model units: half an octave apart, from the larger mean edge length to at least 8
/// % of the smaller diagonal, at least six.
///
/// # Errors
/// Returns a [`DescribeError`] for a graph and for a shape without extent.
pub fn common_lengths(first: &Decomposer, second: &Decomposer) -> Result<Vec<f64>, DescribeError> {
    for side in [first, second] {
        if side.shape().is_none_or(Shape::is_graph) {
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

/// Finds and describes the features of the coordinates of a shape, at the widths `lengths` in model units.
///
/// Without `theta` they are the significant features of the coordinates ([`coordinate_features`]) of a mesh or cloud that
/// has an outside. With `theta`, or without an outside, they are extrema of `W_j·n / σ_j` along the outward normals n, or
/// of `‖W_j‖ / σ_j`, whose response is at least `theta` times the mean, by default [`DEFAULT_THETA`]. Positions are
/// interpolated between vertices and levels. `normals` are those stored in the file, three values per vertex, if any.
/// O(n × levels).
///
/// # Errors
/// Returns a [`DescribeError`] if bands, normals or features cannot be computed.
pub fn describe_shape(
    decomposer: &Decomposer,
    normals: Option<&[f64]>,
    lengths: &[f64],
    theta: Option<f64>,
    progress: Progress<'_>,
) -> Result<ShapeFeatures, DescribeError> {
    let geometry = decomposer.geometry().ok_or(DescribeError::NoPositions)?;
    let points = geometry.shape().points().ok_or(DescribeError::NoPositions)?;
    let outward = outward_normals(geometry, normals, progress.quiet())?;
    let is_signed = outward.info.has_outside();
    let is_guessed = outward.info.n_by_majority > 0;
    let schedule = Schedule::lengths(lengths, decomposer.operator().step_length())?;
    let bands = BandsParams::default().with_accuracy(ACCURACY);
    let request = decomposer.request(points.as_flattened(), 3, &schedule).params(&bands).progress(progress);
    let wavelets = if is_signed { request.normal_components(&outward.normals)? } else { request.norms()? };
    let significant = FeatureParams::default().with_refinement(Refinement::Quadratic);
    let extremal = significant.with_theta(theta.unwrap_or(DEFAULT_THETA)).with_response(Response::Sigma);
    let extremal = features(decomposer, &wavelets, &extremal, progress.quiet())?;
    let welded = geometry.vertex_map();
    let vertex_normal = |x: usize| if is_signed { outward.normals[welded.welded(x)] } else { [0.0; 3] };
    let keys_of = |features: &[Feature]| -> Vec<Key> {
        features.iter().filter_map(|f| Key::new(f, vertex_normal(f.vertex))).collect()
    };
    let extremal_keys = keys_of(&extremal);
    let features = if theta.is_none() && is_signed && significant.finds_significant(decomposer) {
        let coordinates = ShapeCoordinates { points, normals, schedule: &schedule, bands };
        coordinate_features(decomposer, &coordinates, &significant, progress)?.features
    } else {
        extremal
    };
    let (keys, descriptors) = (keys_of(&features), describe(decomposer, &wavelets, &features));
    let landmarks = Landmarks::new(decomposer, &wavelets, vertex_normal);
    let (bands, normals) = (Some(Arc::new(wavelets)), Arc::new(outward.normals));
    Ok(ShapeFeatures {
        features,
        keys,
        extremal_keys,
        descriptors,
        landmarks,
        is_signed,
        is_guessed,
        bands,
        normals,
    })
}

/// Number of values of each of the five levels of a descriptor: pairs of a positive and a negative part, and the
/// response itself.
const PER_LEVEL: usize = DESCRIPTOR_LENGTH / 5;

/// Computes the descriptor of the same feature of the negated signal.
fn flip_descriptor(descriptor: &Descriptor) -> Descriptor {
    let mut flipped = *descriptor;
    for level in flipped.chunks_exact_mut(PER_LEVEL) {
        level.chunks_exact_mut(2).for_each(|parts| parts.swap(0, 1));
        level[PER_LEVEL - 1] = -level[PER_LEVEL - 1];
    }
    flipped
}
