//! Features of the coordinates of a cloud, independent of how its points were drawn.
//!
//! A band of coordinates moves points along the surface where their density changes, and along the normal where the
//! surface is curved or noisy. The response of a cloud is the part along the normal, divided by the response of the
//! same points on a sphere of curvature 1 (its second moment): 0 on a plane and equal everywhere on a sphere, wherever
//! the points are. What remains of the drawing and of noise is measured: the bands are computed again from two random
//! halves of the points, and a feature must stand out from its surroundings by several times the difference.

use super::sample::SampleResponse;
use super::{Feature, FeatureError, FeatureParams, Response, features, select_spread};
use crate::bands::{BandsError, BandsParams, Schedule, Wavelets};
use crate::population::Population;
use crate::shape::NoShape;
use crate::shape::{distance, squared_distance};
use crate::signal::{FIT_NEIGHBORS, OutwardError, outward_normals, try_cloud_normals};
use crate::vector::{dot, subtract};
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress, parallel};
use std::collections::HashSet;
use thiserror::Error;

/// Smallest height of a feature over its surroundings, in standard deviations due to the drawing of the points and
/// noise. The deviations are estimated from few places on coarse levels: the largest height on 88 flat, round and
/// cylindrical clouds of 4000 points was 8.5, and that of bumps of a fifth of the radius of a ball is 10 to 25.
const SIGNIFICANT: f64 = 9.0;

/// Height over the surroundings, in σ of the level, below which there is nothing but rounding.
const ROUNDING: f64 = 1e-6;

/// Outer radius of the surroundings of a feature, in σ; the inner one is half of it.
const SURROUNDINGS: f64 = 2.0;

/// Radius within which drawing and noise are measured, in σ.
const MEASURED: f64 = 3.0;

/// Factor of the responses beyond the last level.
const SMALLER: f64 = 0.999;

/// Largest factor by which a response is corrected for the spread of its points.
const MOST_CORRECTION: f64 = 4.0;

/// Error of finding the features of a cloud.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CloudFeatureError {
    /// The levels or parameters do not allow features.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The normals cannot be found.
    #[error(transparent)]
    Outward(#[from] OutwardError),
    /// The domain is no shape.
    #[error(transparent)]
    NoShape(#[from] NoShape),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for CloudFeatureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Features(e) => e.kind(),
            Self::Bands(e) => e.kind(),
            Self::Outward(e) => e.kind(),
            Self::NoShape(e) => e.kind(),
            Self::Cancelled(e) => e.kind(),
        }
    }
}

/// Coordinates of a cloud with the levels on which features are sought.
#[derive(Clone, Copy, Debug)]
pub struct CloudCoordinates<'a> {
    /// Coordinates of the points, in the order of the shape.
    pub points: &'a [[f64; 3]],
    /// Normals of the file, three numbers a point, in the order of the shape.
    pub normals: Option<&'a [f64]>,
    /// Levels.
    pub schedule: &'a Schedule,
    /// Accuracy and method of the bands.
    pub bands: BandsParams,
}

/// Features of a cloud and the responses in which they were found.
#[derive(Clone, Debug)]
pub struct CloudFeatures {
    /// The features, in the order of [`features`].
    pub features: Vec<Feature>,
    /// Responses W_j·n, corrected for the spread of the points, less their medians, as bands of one channel: positive
    /// where the surface is more convex than usual at the size of the level, if the cloud has an outside.
    pub wavelets: Wavelets,
}

/// Finds the features of the coordinates of a cloud: those of [`features`] for the bands along the normals that are
/// significant against the drawing of the points and against noise. O(n × levels), with the bands of two halves of the
/// points.
///
/// The response is `W_j·n·⟨M_j⟩/M_j`, where `M_j(x) = Σ_y ψ_j(x,y)·|y − x|²` and ⟨M_j⟩ is its mean: on a sphere `W_j·n`
/// is `−M_j/2R` at every point. Its median is subtracted, and [`Response::Normalized`] divides by σ_j as
/// [`Response::Sigma`] does, since on a smooth cloud no level is more uneven than another. A feature must differ from
/// the mean of the response between σ and 2σ around it by more than 9 standard deviations of the response. The standard
/// deviation is the root mean square difference from the responses of two random halves of the points, the larger of
/// the local and the global one. Levels finer than half of the points resolves have no features, and the features of
/// the last level include bumps that are wider. Of significant features within σ of each other the strongest is kept.
///
/// # Errors
/// [`CloudFeatureError`] if the bands, the normals or the features cannot be computed.
///
/// # Panics
/// Unless the shape is a cloud with as many points.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule};
/// use adwave::features::{CloudCoordinates, FeatureParams, cloud_features};
/// use adwave::sample::Sample;
/// use adwave::shape::{PointCloud, Shape};
/// use adwave::{Decomposer, Progress};
/// let points = Sample::from_name("sphere", Some(2000))?.points;
/// let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone())?));
/// let schedule = Schedule::dyadic(6)?;
/// let coordinates =
///     CloudCoordinates { points: &points, normals: None, schedule: &schedule, bands: BandsParams::default() };
/// let found = cloud_features(&decomposer, &coordinates, &FeatureParams::default(), Progress::none())?;
/// assert!(found.features.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cloud_features(
    decomposer: &Decomposer,
    coordinates: &CloudCoordinates<'_>,
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<CloudFeatures, CloudFeatureError> {
    params.check()?;
    let n_levels = coordinates.schedule.n_levels();
    if n_levels < 3 {
        return Err(FeatureError::TooFewLevels { n_levels }.into());
    }
    let normals = normals(decomposer, coordinates.normals, progress)?;
    let mut wavelets = normal_response(decomposer, coordinates, &normals, progress)?;
    let sample = SampleResponse::new(decomposer, coordinates, &normals, &wavelets.levels, progress.quiet())?;
    center_levels(decomposer, &mut wavelets);
    let response = if params.response == Response::Normalized { Response::Sigma } else { params.response };
    let every = FeatureParams { best: None, response, ..*params };
    let candidates = features(decomposer, &with_level_beyond(&wavelets, response), &every, progress.quiet())?;
    let test = SignificanceTest { decomposer, wavelets: &wavelets, sample };
    let is_significant: Vec<bool> = parallel::map_items(decomposer.n_vertices(), candidates.len(), |k| {
        test.is_significant(&candidates[k])
    });
    let significant = candidates.into_iter().zip(is_significant).filter(|(_, is)| *is).map(|(f, _)| f);
    let found = strongest_nearby(significant.collect());
    let found = match params.best {
        Some(best) => select_spread(&found, best),
        None => found,
    };
    Ok(CloudFeatures { features: found, wavelets })
}

/// Outward normals; on a surface without an outside, the normals of one of its sides.
fn normals(
    decomposer: &Decomposer,
    file: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, CloudFeatureError> {
    let geometry = decomposer.geometry_for("a search for features of a cloud")?;
    let mut normals = outward_normals(geometry, file, progress.quiet())?.normals;
    if normals.contains(&[0.0; 3]) {
        let (points, _) = geometry.unit_points(progress)?;
        let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
        let one_side = try_cloud_normals(&points, &near, progress)?;
        for (normal, other) in normals.iter_mut().zip(one_side) {
            if *normal == [0.0; 3] {
                *normal = other;
            }
        }
    }
    Ok(normals)
}

/// Bands along the `normals` at the welded points, corrected for the spread of the points.
pub(super) fn normal_response(
    decomposer: &Decomposer,
    coordinates: &CloudCoordinates<'_>,
    normals: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Wavelets, BandsError> {
    let points = coordinates.points;
    let map = decomposer.vertex_map();
    let n = points.len().max(1) as f64;
    let center: [f64; 3] = std::array::from_fn(|c| points.iter().map(|p| p[c] / n).sum());
    let with_square = |p: &[f64; 3]| {
        let [x, y, z] = subtract(p, &center);
        [x, y, z, x * x + y * y + z * z]
    };
    let signal: Vec<f64> = points.iter().flat_map(with_square).collect();
    let request = decomposer.request(&signal, 4, coordinates.schedule).params(&coordinates.bands);
    let mut wavelets = request.progress(progress).wavelets()?;
    let mean = map.mean(&signal, 4);
    wavelets.n_channels = 1;
    let population = Population::new(decomposer);
    for level in &mut wavelets.levels {
        let rows = level.as_chunks::<4>().0;
        // The second moment about the point itself, as the rows of a wavelet sum to 0.
        let moment = |x: usize| {
            let [a, b, c, square] = rows[x];
            square - 2.0 * (a * mean[4 * x] + b * mean[4 * x + 1] + c * mean[4 * x + 2])
        };
        let moments: Vec<f64> = parallel::collect(rows.len(), moment);
        let usual = population.mean(&moments);
        let response = |x: usize| {
            let [a, b, c, _] = rows[x];
            let along = dot(&[a, b, c], &normals[x]);
            let correction = usual / moments[x].abs();
            if correction.is_finite() && correction > 0.0 {
                along * correction.clamp(1.0 / MOST_CORRECTION, MOST_CORRECTION)
            } else {
                along
            }
        };
        *level = parallel::collect(rows.len(), response);
    }
    Ok(wavelets)
}

/// Subtracts from each level its median, which is the response of the shape as a whole: that of a sphere, for a ball
/// with bumps.
fn center_levels(decomposer: &Decomposer, wavelets: &mut Wavelets) {
    let outsiders = decomposer.domain().outsiders();
    let is_member = |x: usize| outsiders.as_ref().is_none_or(|outsiders| !outsiders[x]);
    for level in &mut wavelets.levels {
        let mut known: Vec<f64> = (0..level.len()).filter(|&x| is_member(x)).map(|x| level[x]).collect();
        if known.is_empty() {
            continue;
        }
        let middle = known.len() / 2;
        let median = *known.select_nth_unstable_by(middle, f64::total_cmp).1;
        for value in level.iter_mut() {
            *value -= median;
        }
    }
}

/// The bands with one more level, on which every response is a little smaller than on the last one: a bump that is as
/// large as the last level, or larger, is a feature of the last level.
fn with_level_beyond(wavelets: &Wavelets, response: Response) -> Wavelets {
    let mut extended = wavelets.clone();
    let growth = std::f64::consts::SQRT_2;
    let factor = if response == Response::Sigma { SMALLER * growth } else { SMALLER };
    if let (Some(last), Some(sigma), Some(steps)) =
        (wavelets.levels.last(), wavelets.sigma.last(), wavelets.steps.last())
    {
        extended.levels.push(last.iter().map(|value| factor * value).collect());
        extended.sigma.push(growth * sigma);
        extended.steps.push(2.0 * steps);
    }
    extended
}

/// Test of features against the drawing of the points and noise.
struct SignificanceTest<'a> {
    decomposer: &'a Decomposer,
    wavelets: &'a Wavelets,
    sample: SampleResponse,
}

impl SignificanceTest<'_> {
    /// True if the response at a feature differs from its surroundings by more than drawing and noise explain.
    fn is_significant(&self, feature: &Feature) -> bool {
        let x = self.decomposer.vertex_map().welded(feature.vertex);
        let level = &self.wavelets.levels[feature.level - 1];
        let Some(differences) = self.sample.differences(feature.level) else { return false };
        let sigma = self.wavelets.sigma[feature.level];
        let (mut sum, mut n) = (0.0, 0_usize);
        let (mut squares, mut n_squares) = (0.0, 0_usize);
        for (y, away) in self.points_within(x, MEASURED.max(SURROUNDINGS) * sigma) {
            if away >= 0.5 * SURROUNDINGS * sigma && away < SURROUNDINGS * sigma {
                sum += level[y];
                n += 1;
            }
            let difference = differences[y];
            if away < MEASURED * sigma && !difference.is_nan() {
                squares += difference * difference;
                n_squares += 1;
            }
        }
        if n == 0 {
            return false;
        }
        let height = (level[x] - sum / n as f64).abs();
        let local = if n_squares > 0 { squares / n_squares as f64 } else { 0.0 };
        let deviation = local.max(self.sample.mean_square(feature.level)).sqrt();
        height > SIGNIFICANT * deviation && height > ROUNDING * sigma
    }

    /// Welded points within a distance of `x` that neighbors connect, with their distances.
    fn points_within(&self, x: usize, reach: f64) -> Vec<(usize, f64)> {
        let (points, neighbors) = (self.decomposer.positions(), self.decomposer.neighbors());
        let mut seen = HashSet::from([x as u32]);
        let mut found = vec![(x, 0.0)];
        let mut at = 0;
        while at < found.len() {
            for &y in neighbors.row(found[at].0) {
                let away = distance(&points[x], &points[y as usize]);
                if away < reach && seen.insert(y) {
                    found.push((y as usize, away));
                }
            }
            at += 1;
        }
        found
    }
}

/// Features that have no stronger one within their radius or its own, in the given order.
fn strongest_nearby(found: Vec<Feature>) -> Vec<Feature> {
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|&a, &b| found[b].strength.total_cmp(&found[a].strength).then(a.cmp(&b)));
    let mut is_kept = vec![false; found.len()];
    let mut kept: Vec<usize> = Vec::new();
    for k in order {
        let is_near = |other: &&usize| {
            let (a, b) = (&found[k], &found[**other]);
            let reach = a.sigma.max(b.sigma);
            a.position.zip(b.position).is_some_and(|(p, q)| squared_distance(&p, &q) < reach * reach)
        };
        if !kept.iter().any(|other| is_near(&other)) {
            kept.push(k);
            is_kept[k] = true;
        }
    }
    found.into_iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(f, _)| f).collect()
}
