//! Features of the coordinates of a cloud, independent of how its points were drawn.
//!
//! A band of coordinates moves points along the surface where their density changes, and along the normal where the
//! surface is curved or noisy. The response of a cloud is the part along the normal, divided by the response of the
//! same points on a sphere of curvature 1 (its second moment): 0 on a plane and equal everywhere on a sphere, wherever
//! the points are. What remains of the drawing and of noise is measured: the bands are computed again from two random
//! halves of the points, and a feature must stand out from its surroundings by several times the difference.

use super::sample::SampleResponse;
use super::{
    CoordinateFeatureError, CoordinateFeatures, Feature, FeatureParams, Response, ShapeCoordinates, features,
    select_spread,
};
use crate::bands::{BandsError, Wavelets};
use crate::population::Population;
use crate::shape::{distance, squared_distance};
use crate::vector::{dot, subtract};
use crate::{Cancelled, Decomposer, Progress, parallel};

/// Smallest height of a feature over its surroundings, in standard deviations due to the drawing of the points and
/// noise. The deviations are estimated from few places on coarse levels: the largest height on 88 flat, round and
/// cylindrical clouds of 4000 points was 8.5, and that of bumps of a fifth of the radius of a ball is 10 to 25.
const SIGNIFICANT: f64 = 9.0;

/// Height over the surroundings, in σ of the level, below which there is nothing but rounding.
pub(super) const ROUNDING: f64 = 1e-6;

/// Outer radius of the surroundings of a feature, in σ; the inner one is half of it.
const SURROUNDINGS: f64 = 2.0;

/// Radius within which drawing and noise are measured, in σ.
const MEASURED: f64 = 3.0;

/// Number of features that a thread tests at a time.
const TESTS_AT_A_TIME: usize = 8;

/// Number of features that are tested before the candidates near those kept are left out.
const TESTS_IN_A_BATCH: usize = 256;

/// Factor of the responses beyond the last level.
const SMALLER: f64 = 0.999;

/// Largest factor by which a response is corrected for the spread of its points.
pub(super) const MOST_CORRECTION: f64 = 4.0;

/// Finds the features of the coordinates of a cloud; see [`coordinate_features`](super::coordinate_features).
pub(super) fn cloud_features(
    decomposer: &Decomposer,
    coordinates: &ShapeCoordinates<'_>,
    normals: &[[f64; 3]],
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<CoordinateFeatures, CoordinateFeatureError> {
    let mut wavelets = normal_response(decomposer, coordinates, normals, progress)?;
    let sample = SampleResponse::new(decomposer, coordinates, normals, &wavelets.levels, progress.quiet())?;
    center_levels(decomposer, &mut wavelets);
    let response = if params.response == Response::Normalized { Response::Sigma } else { params.response };
    let every = FeatureParams { best: None, response, ..*params };
    let candidates = features(decomposer, &with_level_beyond(&wavelets, response), &every, progress.quiet())?;
    let test = SignificanceTest { decomposer, wavelets: &wavelets, sample };
    let found = strongest_nearby(&candidates, &test, progress.quiet())?;
    let found = match params.best {
        Some(best) => select_spread(&found, best),
        None => found,
    };
    Ok(CoordinateFeatures { features: found, wavelets })
}

/// Bands along the `normals` at the welded points, corrected for the spread of the points.
pub(super) fn normal_response(
    decomposer: &Decomposer,
    coordinates: &ShapeCoordinates<'_>,
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
    fn is_significant(&self, feature: &Feature, marks: &mut Marks) -> bool {
        let x = self.decomposer.vertex_map().welded(feature.vertex);
        let level = &self.wavelets.levels[feature.level - 1];
        let Some(differences) = self.sample.differences(feature.level) else { return false };
        let sigma = self.wavelets.sigma[feature.level];
        let (mut sum, mut n) = (0.0, 0_usize);
        let (mut squares, mut n_squares) = (0.0, 0_usize);
        for (y, away) in self.points_within(x, MEASURED.max(SURROUNDINGS) * sigma, marks) {
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
    fn points_within(&self, x: usize, reach: f64, marks: &mut Marks) -> Vec<(usize, f64)> {
        let (points, neighbors) = (self.decomposer.positions(), self.decomposer.neighbors());
        marks.forget();
        marks.mark(x as u32);
        let mut found = vec![(x, 0.0)];
        let mut at = 0;
        while at < found.len() {
            for &y in neighbors.row(found[at].0) {
                if marks.mark(y) {
                    let away = distance(&points[x], &points[y as usize]);
                    if away < reach {
                        found.push((y as usize, away));
                    }
                }
            }
            at += 1;
        }
        found
    }
}

/// Marks of the points that a search has reached. Forgetting all takes O(1).
struct Marks {
    /// Number of the last search that reached each point.
    search_of: Vec<u32>,
    search: u32,
}

impl Marks {
    fn new(n_points: usize) -> Self {
        Self { search_of: vec![0; n_points], search: 0 }
    }

    fn forget(&mut self) {
        if self.search == u32::MAX {
            self.search_of.fill(0);
            self.search = 0;
        }
        self.search += 1;
    }

    /// Marks a point. Returns whether it had no mark.
    fn mark(&mut self, x: u32) -> bool {
        std::mem::replace(&mut self.search_of[x as usize], self.search) != self.search
    }
}

/// Significant features that have no stronger one within their radius or its own, in the given order.
///
/// The strongest are tested first, some at a time, so that a candidate near one that is kept needs no test. How many are
/// tested at a time does not change the result.
fn strongest_nearby(
    candidates: &[Feature],
    test: &SignificanceTest<'_>,
    progress: Progress<'_>,
) -> Result<Vec<Feature>, Cancelled> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&a, &b| candidates[b].strength.total_cmp(&candidates[a].strength).then(a.cmp(&b)));
    let mut kept: Vec<usize> = Vec::new();
    let is_near_kept = |k: usize, kept: &[usize]| {
        kept.iter().any(|&other| {
            let (a, b) = (&candidates[k], &candidates[other]);
            let reach = a.sigma.max(b.sigma);
            a.position.zip(b.position).is_some_and(|(p, q)| squared_distance(&p, &q) < reach * reach)
        })
    };
    let n_places = test.decomposer.n_places();
    let mut rest = order.into_iter().peekable();
    while rest.peek().is_some() {
        let far = rest.by_ref().filter(|&k| !is_near_kept(k, &kept));
        let batch: Vec<usize> = far.take(TESTS_IN_A_BATCH).collect();
        let is_significant = parallel::try_map_chunks(
            batch.len(),
            TESTS_AT_A_TIME,
            progress,
            || Marks::new(n_places),
            |marks, range| {
                range.map(|k| test.is_significant(&candidates[batch[k]], marks)).collect::<Vec<_>>()
            },
        )?
        .concat();
        for (k, is_significant) in batch.into_iter().zip(is_significant) {
            if is_significant && !is_near_kept(k, &kept) {
                kept.push(k);
            }
        }
    }
    kept.sort_unstable();
    Ok(kept.into_iter().map(|k| candidates[k].clone()).collect())
}
