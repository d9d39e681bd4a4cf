//! Responses of random halves of a cloud, from which the influence of the drawing and of noise follows.

use super::ShapeCoordinates;
use super::cloud::normal_response;
use crate::bands::{BandsError, Schedule, Wavelets};
use crate::shape::{PointCloud, Shape};
use crate::signal::{FIT_NEIGHBORS, aligned_normals};
use crate::{Decomposer, Progress, parallel};

/// Fewest points of a half.
const FEWEST: usize = 32;

/// Fewest steps of the half before the beginning of a level: a band that starts earlier contains the noise of a point
/// itself, which is the same in the half.
const LEAST_STEPS: f64 = 2.0;

/// Differences between the responses of all points and of two random halves of them. If the response of all is the mean
/// of those of the halves, whose errors are independent, its standard deviation is the root mean square difference from
/// the halves.
pub(super) struct SampleResponse {
    levels: Vec<Option<SampleLevel>>,
}

/// Differences on one level.
struct SampleLevel {
    /// Difference at each welded point from the response of the half that it is in; NaN at points in neither.
    differences: Vec<f64>,
    mean_square: f64,
}

/// A half of the points and their responses.
struct Half {
    /// Welded points of the whole cloud, in the order of the half.
    vertices: Vec<u32>,
    steps: HalfSteps,
    wavelets: Wavelets,
}

impl SampleResponse {
    /// Computes the responses of both halves of the points of `decomposer`, whose `responses` of all points are known.
    pub(super) fn new(
        decomposer: &Decomposer,
        coordinates: &ShapeCoordinates<'_>,
        normals: &[[f64; 3]],
        responses: &[Vec<f64>],
        progress: Progress<'_>,
    ) -> Result<Self, BandsError> {
        let mut halves = Vec::new();
        for is_drawn in [true, false] {
            halves.extend(Half::new(decomposer, coordinates, normals, is_drawn, progress)?);
        }
        let level = |j: usize| {
            if halves.len() < 2 {
                return None;
            }
            SampleLevel::new(j, &halves, &responses[j - 1])
        };
        Ok(Self { levels: (1..=coordinates.schedule.n_levels()).map(level).collect() })
    }

    /// Difference at each welded point on level `j`, NaN where it is not known; `None` if the halves do not resolve the
    /// level.
    pub(super) fn differences(&self, j: usize) -> Option<&[f64]> {
        self.levels[j - 1].as_ref().map(|level| level.differences.as_slice())
    }

    /// Mean square difference on level `j`; 0 if the halves do not resolve the level.
    pub(super) fn mean_square(&self, j: usize) -> f64 {
        self.levels[j - 1].as_ref().map_or(0.0, |level| level.mean_square)
    }
}

impl Half {
    /// The half that is drawn, or the other one; `None` if there are too few points.
    fn new(
        decomposer: &Decomposer,
        coordinates: &ShapeCoordinates<'_>,
        normals: &[[f64; 3]],
        is_drawn: bool,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, BandsError> {
        let Some(geometry) = decomposer.geometry() else { return Ok(None) };
        let is_in =
            |x: &u32| in_first_half(*x) == is_drawn && geometry.participation().is_member(*x as usize);
        let half: Vec<u32> = (0..geometry.n_vertices() as u32).filter(is_in).collect();
        let pick = |values: &[[f64; 3]]| half.iter().map(|&x| values[x as usize]).collect::<Vec<_>>();
        let Ok(cloud) = PointCloud::new(pick(geometry.points())) else { return Ok(None) };
        if half.len() < FEWEST {
            return Ok(None);
        }
        let cloud = if geometry.has_separate_sheets() { cloud.with_normals(pick(normals)) } else { cloud };
        let own = Decomposer::with_params(&Shape::Cloud(cloud), decomposer.operator_params(), progress)?;
        let ratio = (own.operator().step_length() / decomposer.operator().step_length()).powi(2);
        let Some(steps) = HalfSteps::new(coordinates.schedule, ratio) else { return Ok(None) };
        let map = own.vertex_map();
        let mut vertices = vec![0_u32; own.n_places()];
        for (k, &x) in half.iter().enumerate() {
            vertices[map.welded(k)] = x;
        }
        let old: Vec<[f64; 3]> = vertices.iter().map(|&x| normals[x as usize]).collect();
        let Some(own_geometry) = own.geometry() else { return Ok(None) };
        let (unit, _) = own_geometry.unit_points(progress)?;
        let near = own_geometry.nearest(&unit, FIT_NEIGHBORS, progress)?;
        let own_normals = aligned_normals(&unit, &near.adjacency, &old, progress)?;
        let welded = geometry.vertex_map().mean(coordinates.points.as_flattened(), 3);
        let points = pick(welded.as_chunks().0);
        let schedule = &steps.schedule;
        let sampled = ShapeCoordinates { points: &points, normals: None, schedule, bands: coordinates.bands };
        let wavelets = normal_response(&own, &sampled, &own_normals, progress)?;
        Ok(Some(Self { vertices, steps, wavelets }))
    }

    /// Responses on level `j` of all points; `None` if the half does not resolve it.
    fn responses(&self, j: usize) -> Option<Vec<f64>> {
        let levels = &self.wavelets.levels[self.steps.levels(j)?];
        let value = |k: usize| levels.iter().map(|level| level[k]).sum::<f64>();
        Some(parallel::collect(self.vertices.len(), value))
    }
}

impl SampleLevel {
    /// Differences of the responses of the halves on level `j` from the `responses` of all points, which are scaled to
    /// fit best, as widths of levels differ by rounded steps; `None` if a half does not resolve the level.
    fn new(j: usize, halves: &[Half], responses: &[f64]) -> Option<Self> {
        let mut differences = vec![f64::NAN; responses.len()];
        let (mut sum, mut n) = (0.0, 0_usize);
        for half in halves {
            let values = half.responses(j)?;
            let pairs = || values.iter().zip(&half.vertices).map(|(v, &x)| (*v, responses[x as usize]));
            let (product, square) = pairs().fold((0.0, 0.0), |(p, s), (v, r)| (p + v * r, s + r * r));
            let factor = if square > 0.0 { product / square } else { 1.0 };
            // A factor far from 1 means that nothing but noise is left.
            let factor = if (0.5..=2.0).contains(&factor) { factor } else { 1.0 };
            for ((value, response), &x) in pairs().zip(&half.vertices) {
                let difference = value / factor - response;
                differences[x as usize] = difference;
                sum += difference * difference;
            }
            n += half.vertices.len();
        }
        Some(Self { differences, mean_square: sum / n.max(1) as f64 })
    }
}

/// Steps of the half whose widths are those of the levels of all points.
struct HalfSteps {
    schedule: Schedule,
    /// Index of the level that ends with each level of all points, counted from 1; `None` below the first step.
    ends: Vec<Option<usize>>,
}

impl HalfSteps {
    /// Steps divided by `ratio`, the squared ratio of the lengths of a step.
    fn new(schedule: &Schedule, ratio: f64) -> Option<Self> {
        if !(ratio.is_finite() && ratio > 0.0) {
            return None;
        }
        let is_whole = schedule.whole_steps().is_some();
        let scale = |n: &f64| if is_whole { (n / ratio).round() } else { n / ratio };
        let scaled: Vec<f64> = schedule.steps().iter().map(scale).collect();
        let mut steps: Vec<f64> = scaled.iter().copied().filter(|&n| n >= 1.0).collect();
        steps.dedup();
        let ends = scaled.iter().map(|n| steps.iter().position(|step| step == n).map(|k| k + 1)).collect();
        Some(Self { schedule: Schedule::real(steps).ok()?, ends })
    }

    /// Levels of the half, as indices from 0, that level `j` consists of; `None` if the half does not resolve it.
    fn levels(&self, j: usize) -> Option<std::ops::Range<usize>> {
        let before = self.ends[j.checked_sub(2)?]?;
        if self.schedule.steps()[before - 1] < LEAST_STEPS {
            return None;
        }
        let range = before..self.ends[j - 1]?;
        (!range.is_empty()).then_some(range)
    }
}

/// True for half of the points, drawn by their number in the analysis order, which the positions alone decide.
fn in_first_half(x: u32) -> bool {
    // The finalizer of the generator SplitMix64.
    let mut z = u64::from(x).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) & 1 == 0
}
