//! Denoising of the positions of a curve.
//!
//! Along each piece of the curve, a polynomial is fitted to the positions in a window around a vertex, before it, or
//! after it. Windows grow as long as their estimates agree within the noise (the rule of Lepski, as intersection of
//! confidence intervals in `katkovnik1999`), so that they end at corners and bends; the estimates of all sides and
//! degrees are averaged by their variances. At a corner the windows of either side reach up to it, and it stays sharp.

mod chains;
mod polynomial;

use super::{DenoiseError, DenoiseInfo, DenoiseParams, Denoised, FAR};
use crate::rows::Pattern;
use crate::shape::{Graph, PreparedGeometry, Shape, WeldMode, distance, places_without_noise};
use crate::vector::{add_scaled, dot, norm, subtract, unit};
use crate::{Progress, parallel};
use chains::{Chain, chains};
use nalgebra::{Matrix3, SymmetricEigen};
use polynomial::fit_weights;

/// Numbers of vertices that windows reach to a side.
const REACHES: [usize; 12] = [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64];

/// Degrees of the polynomials.
const DEGREES: [usize; 3] = [1, 3, 5];

/// Distance of two estimates that still agree, in standard deviations of the one from the smaller window.
const AGREEMENT: f64 = 1.4;

/// Degrees of the polynomials through the neighbors of a vertex that predict it, for the noise; smooth curves are
/// predicted by high degrees, curves of many corners by low ones.
const PREDICTIONS: [usize; 4] = [1, 3, 5, 7];

/// Smallest number of predictions from which a noise level is estimated.
const FEWEST: usize = 6;

/// Factor within which the estimate of a lower degree counts as equal to the least one.
const EQUAL: f64 = 1.2;

/// Largest noise along the order of the vertices, relative to that across the curve, for which vertices count as evenly
/// spaced, so that noise along the curve can be distinguished from uneven spacing.
const EVEN: f64 = 1.5;

/// Share of the axes across a curve below which noise has fewer axes, such as height alone.
const FEW_AXES: f64 = 0.75;

/// Noise relative to the mean edge length up to which it counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Share of the largest eigenvalue above which noise has the direction of an eigenvector.
const LEAST_EIGENVALUE: f64 = 1e-6;

/// Order of the vertices of a chain as numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Parameter {
    /// 0, 1, 2 …: for even spacing.
    Order,
    /// Length along the edges.
    Length,
}

/// Positions of all vertices, and places from which lengths and directions are taken.
#[derive(Clone, Copy)]
struct Positions<'a> {
    points: &'a [[f64; 3]],
    /// The points, or, where noise makes up most of the length of the edges, places without it.
    places: &'a [[f64; 3]],
}

/// Points of a chain over a parameter.
struct Track {
    points: Vec<[f64; 3]>,
    places: Vec<[f64; 3]>,
    at: Vec<f64>,
    /// Length of the parameter around a closed chain.
    period: f64,
    is_closed: bool,
}

/// Vertices `first..=last` relative to one, by number.
#[derive(Clone, Copy)]
struct Window {
    before: usize,
    after: usize,
}

/// An estimate of a position, and its variance relative to the noise.
#[derive(Clone, Copy, Default)]
struct Estimate {
    point: [f64; 3],
    variance: f64,
}

/// Assumed noise of a curve.
#[derive(Clone, Copy, Debug)]
struct CurveNoise {
    /// Standard deviation along an axis.
    deviation: f64,
    /// Number of axes with noise.
    n_axes: f64,
    parameter: Parameter,
}

/// Removes noise from the positions of a curve, or of a graph with positions; end points stay. O(n).
pub(super) fn denoise_curve(
    geometry: &PreparedGeometry,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<Denoised, DenoiseError> {
    let Some(original) = geometry.shape().points() else { return Err(DenoiseError::NoPositions) };
    let Some(edges) = geometry.curve_edges() else {
        let Some(graph) = geometry.shape().as_graph() else { return Err(DenoiseError::NoPositions) };
        let pairs = pairs(graph.adjacency());
        let Ok(curve) = Graph::curve(original.to_vec(), &pairs) else {
            return Err(DenoiseError::NoPositions);
        };
        let geometry = PreparedGeometry::new(&Shape::Graph(curve), WeldMode::EqualPositions, progress)?;
        return denoise_curve(&geometry, params, progress);
    };
    let (points, unit) = geometry.unit_points(progress)?;
    let chains = chains(edges);
    let n_edges = edges.nnz() / 2;
    let total: f64 =
        pairs(edges).iter().map(|[x, y]| distance(&points[*x as usize], &points[*y as usize])).sum();
    let mean_length = total / n_edges.max(1) as f64;
    let places = places_without_noise(&points, edges);
    let positions = Positions { points: &points, places: places.as_deref().unwrap_or(&points[..]) };
    let mut noise = noise_of(&chains, positions, mean_length, progress)?;
    if let Some(given) = params.noise {
        noise.deviation = given / unit;
    }
    let mut info = DenoiseInfo {
        noise: noise.deviation * unit,
        noise_in_edges: if mean_length > 0.0 { noise.deviation / mean_length } else { 0.0 },
        kept: 1.0,
        ..DenoiseInfo::default()
    };
    noise.deviation *= params.strength;
    if noise.deviation == 0.0 || n_edges == 0 {
        return Ok(Denoised { points: original.to_vec(), outliers: Vec::new(), info });
    }
    info.kept = 0.0;
    info.n_sampled = points.len();
    let moves = moves(&chains, edges, positions, noise, progress)?;
    let moves = geometry.vertex_map().scatter(&moves, 1);
    let lengths: Vec<f64> = moves.iter().map(norm).collect();
    info.n_far = lengths.iter().filter(|d| **d > FAR * noise.deviation).count();
    info.furthest = lengths.iter().copied().fold(0.0, f64::max) * unit;
    let moved = |(p, d): (&[f64; 3], &[f64; 3])| if *d == [0.0; 3] { *p } else { add_scaled(p, unit, d) };
    Ok(Denoised { points: original.iter().zip(&moves).map(moved).collect(), outliers: Vec::new(), info })
}

/// Edges as pairs with the smaller vertex first.
fn pairs(edges: &Pattern) -> Vec<[u32; 2]> {
    let later = |x: u32| edges.row(x as usize).iter().filter(move |&&y| y > x).map(move |&y| [x, y]);
    (0..edges.n_rows() as u32).flat_map(later).collect()
}

/// Moves of the vertices from the estimates of their chains. Branches belong to several chains.
fn moves(
    chains: &[Chain],
    edges: &Pattern,
    positions: Positions<'_>,
    noise: CurveNoise,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    let points = positions.points;
    let mut sums = vec![([0.0; 3], 0.0); points.len()];
    for chain in chains {
        let track = Track::new(chain, positions, noise.parameter);
        let estimates = parallel::try_collect(track.points.len(), progress, |i| track.estimate(i, noise))?;
        for (&x, estimate) in chain.vertices.iter().zip(estimates) {
            let (sum, weight) = &mut sums[x as usize];
            let share = 1.0 / (estimate.variance * estimate.variance);
            *sum = add_scaled(sum, share, &subtract(&estimate.point, &points[x as usize]));
            *weight += share;
        }
    }
    let is_moved = |x: usize| edges.row(x).len() > 1;
    let mean = |(x, (sum, weight)): (usize, ([f64; 3], f64))| {
        if is_moved(x) && weight > 0.0 && weight.is_finite() { sum.map(|c| c / weight) } else { [0.0; 3] }
    };
    Ok(sums.into_iter().enumerate().map(mean).collect())
}

impl Track {
    fn new(chain: &Chain, positions: Positions<'_>, parameter: Parameter) -> Self {
        let of_chain =
            |all: &[[f64; 3]]| -> Vec<[f64; 3]> { chain.vertices.iter().map(|&x| all[x as usize]).collect() };
        let (points, places) = (of_chain(positions.points), of_chain(positions.places));
        let n = points.len();
        let step = |k: usize| match parameter {
            Parameter::Order => 1.0,
            Parameter::Length => distance(&places[k], &places[(k + 1) % n]),
        };
        let mut at = Vec::with_capacity(n);
        let mut sum = 0.0;
        for k in 0..n {
            at.push(sum);
            sum += step(k);
        }
        Self { at, period: sum, is_closed: chain.is_closed, points, places }
    }

    /// Vertices of a window around vertex `i` with their parameters relative to its own; `None` if the window reaches
    /// beyond an end or around the whole chain.
    fn window(&self, i: usize, window: Window) -> Option<Vec<(usize, f64)>> {
        let n = self.points.len();
        let Window { before, after } = window;
        if self.is_closed {
            if before + after + 1 > n {
                return None;
            }
        } else if before > i || i + after >= n {
            return None;
        }
        let relative = |k: usize| {
            // Numbers are shifted by n, so that they are not negative.
            let shifted = n + i + k - before;
            let turns = (shifted / n) as f64 - 1.0;
            (shifted % n, self.at[shifted % n] + turns * self.period - self.at[i])
        };
        Some((0..=before + after).map(relative).collect())
    }

    /// Value at vertex `i` of the polynomial fitted to a window, without the vertex itself if `is_prediction`.
    fn fit(&self, i: usize, window: Window, degree: usize, is_prediction: bool) -> Option<Estimate> {
        let mut near = self.window(i, window)?;
        if is_prediction {
            near.remove(window.before);
        }
        let nodes: Vec<f64> = near.iter().map(|(_, u)| *u).collect();
        let weights = fit_weights(&nodes, degree)?;
        let add = |sum: [f64; 3], (w, (k, _)): (&f64, &(usize, f64))| {
            add_scaled(&sum, *w, &subtract(&self.points[*k], &self.points[i]))
        };
        let moved = weights.iter().zip(&near).fold([0.0; 3], add);
        let variance = weights.iter().map(|w| w * w).sum();
        Some(Estimate { point: add_scaled(&self.points[i], 1.0, &moved), variance })
    }

    /// Estimate of the position of vertex `i` from all sides and degrees.
    fn estimate(&self, i: usize, noise: CurveNoise) -> Estimate {
        let data = Estimate { point: self.points[i], variance: 1.0 };
        let limit = AGREEMENT * AGREEMENT * noise.n_axes * noise.deviation * noise.deviation;
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for degree in DEGREES {
            for (before, after) in [(1, 0), (0, 1), (1, 1)] {
                let mut best = data;
                let mut known = vec![data];
                for reach in REACHES {
                    let window = Window { before: before * reach, after: after * reach };
                    if window.before + window.after < degree + 1 {
                        continue;
                    }
                    let Some(found) = self.fit(i, window, degree, false) else { break };
                    if found.variance >= 1.0 {
                        continue;
                    }
                    let agrees = |old: &Estimate| {
                        let apart = subtract(&found.point, &old.point);
                        dot(&apart, &apart) <= limit * old.variance
                    };
                    if !known.iter().all(agrees) {
                        break;
                    }
                    known.push(found);
                    if found.variance < best.variance {
                        best = found;
                    }
                }
                let share = 1.0 / (best.variance * best.variance);
                sum = add_scaled(&sum, share, &subtract(&best.point, &data.point));
                total += share;
            }
        }
        let n_estimates = 3.0 * DEGREES.len() as f64;
        let variance = (n_estimates / total).sqrt();
        Estimate { point: add_scaled(&data.point, 1.0 / total, &sum), variance }
    }

    /// Differences between the vertices and their predictions by polynomials through their neighbors, in standard
    /// deviations of such a difference; across the curve if the parameter is its length.
    fn residuals(&self, degree: usize, parameter: Parameter) -> Vec<[f64; 3]> {
        let reach = degree.div_ceil(2);
        let window = Window { before: reach, after: reach };
        let n = self.points.len();
        let residual = |i: usize| {
            let found = self.fit(i, window, degree, true)?;
            let apart = subtract(&self.points[i], &found.point);
            let apart = apart.map(|c| c / (1.0 + found.variance).sqrt());
            if parameter == Parameter::Order {
                return Some(apart);
            }
            let along = unit(&subtract(&self.places[(i + 1) % n], &self.places[(i + n - 1) % n]));
            Some(along.map_or(apart, |t| add_scaled(&apart, -dot(&apart, &t), &t)))
        };
        (0..n).filter_map(residual).collect()
    }
}

/// Noise of a curve from how badly vertices are predicted by their neighbors.
fn noise_of(
    chains: &[Chain],
    positions: Positions<'_>,
    mean_length: f64,
    progress: Progress<'_>,
) -> Result<CurveNoise, DenoiseError> {
    let residuals = |parameter: Parameter| -> Result<Vec<Vec<[f64; 3]>>, DenoiseError> {
        let mut by_degree = vec![Vec::new(); PREDICTIONS.len()];
        for chain in chains {
            progress.check()?;
            let track = Track::new(chain, positions, parameter);
            for (all, degree) in by_degree.iter_mut().zip(PREDICTIONS) {
                all.extend(track.residuals(degree, parameter));
            }
        }
        by_degree.retain(|all| all.len() >= FEWEST);
        Ok(by_degree)
    };
    let (by_order, by_length) = (residuals(Parameter::Order)?, residuals(Parameter::Length)?);
    let n_axes = by_order.first().map_or(3.0, |all| rank(all));
    let along = least(by_order.iter().map(|all| deviation(all, typical_axes(all).min(n_axes))));
    let across = least(by_length.iter().map(|all| {
        let (most, typical) = ((n_axes - 1.0).max(1.0), typical_axes(all));
        deviation(all, if typical < FEW_AXES * most { typical } else { most })
    }));
    let (deviation, parameter) =
        if along <= EVEN * across { (along, Parameter::Order) } else { (across, Parameter::Length) };
    let deviation = if deviation > ROUNDING * mean_length { deviation } else { 0.0 };
    Ok(CurveNoise { deviation, n_axes, parameter })
}

/// The first value that hardly exceeds the least; 0 without values.
fn least(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    values.into_iter().find(|v| *v <= EQUAL * least).unwrap_or(0.0)
}

/// Covariance of vectors around 0, times their number.
fn covariance(vectors: &[[f64; 3]]) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for v in vectors {
        for a in 0..3 {
            for b in 0..3 {
                sum[(a, b)] += v[a] * v[b];
            }
        }
    }
    sum
}

/// Number of axes along which the vectors differ from 0, at least 1.
fn rank(vectors: &[[f64; 3]]) -> f64 {
    let values = SymmetricEigen::new(covariance(vectors)).eigenvalues;
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|v| **v > LEAST_EIGENVALUE * largest).count().max(1) as f64
}

/// Number of axes that the shorter half of the vectors fills, `(tr C)²/tr C²`; 1 if they vanish.
fn typical_axes(vectors: &[[f64; 3]]) -> f64 {
    let mut by_length = vectors.to_vec();
    by_length.sort_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    by_length.truncate(vectors.len() / 2 + 1);
    let covariance = covariance(&by_length);
    let (trace, square) = (covariance.trace(), (covariance * covariance).trace());
    if square > 0.0 { (trace * trace / square).max(1.0) } else { 1.0 }
}

/// Standard deviation along an axis of normal vectors with `n_axes` axes, from the median of their squared lengths; a
/// lower quantile is used if it gives much less, as for a curve on which half of the vertices are corners.
fn deviation(vectors: &[[f64; 3]], n_axes: f64) -> f64 {
    const LOW: f64 = 0.3;
    const LOW_NORMAL: f64 = -0.524_400_512_708_041;
    const MUCH_LESS: f64 = 0.75;
    let mut squares: Vec<f64> = vectors.iter().map(|v| dot(v, v)).collect();
    squares.sort_by(f64::total_cmp);
    let quantile = |share: f64, normal: f64| {
        let place = share * (squares.len() - 1) as f64;
        let (low, part) = (place.floor() as usize, place.fract());
        let high = (low + 1).min(squares.len() - 1);
        let square = squares[low] + part * (squares[high] - squares[low]);
        // Quantile of χ² by Wilson and Hilferty.
        let cube_root = 1.0 - 2.0 / (9.0 * n_axes) + normal * (2.0 / (9.0 * n_axes)).sqrt();
        (square / (n_axes * cube_root.powi(3))).sqrt()
    };
    let (median, low) = (quantile(0.5, 0.0), quantile(LOW, LOW_NORMAL));
    if low < MUCH_LESS * median { low } else { median }
}
