//! Noise of a curve from how badly its vertices are predicted by their neighbors, along each axis.

use super::chains::Chain;
use super::track::{AxisGroup, Parameter, Positions, Residual, Track, chi_square};
use crate::Progress;
use crate::denoise::DenoiseError;
use crate::vector::dot;
use nalgebra::{Matrix3, SymmetricEigen};

/// Degrees of the polynomials through the neighbors of a vertex that predict it, for the noise; smooth curves are
/// predicted by high degrees, curves of many corners by low ones.
const PREDICTIONS: [usize; 4] = [1, 3, 5, 7];

/// Smallest number of predictions from which a noise level is estimated.
const FEWEST: usize = 6;

/// Factor within which the estimate of a lower degree counts as equal to the least one.
const EQUAL: f64 = 1.2;

/// Largest noise along the order of the vertices, relative to what the noise across the curve explains, for which
/// vertices count as evenly spaced, so that noise along the curve can be distinguished from uneven spacing.
const EVEN: f64 = 1.7;

/// Noise along the curve, relative to that of all axes, up to which it need not be explained.
const HARMLESS: f64 = 0.3;

/// Largest noise along the curve relative to the noise that is expected, so that it stays finite.
const MOST_EXCESS: f64 = 1e6;

/// Share of the axes across a curve below which noise has fewer axes, such as height alone.
const FEW_AXES: f64 = 0.75;

/// Noise relative to the mean edge length up to which it counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Share of the largest eigenvalue above which noise has the direction of an eigenvector.
const LEAST_EIGENVALUE: f64 = 1e-6;

/// Ratio of the noise along two axes above which they differ, without and with its random part for n vertices, which is
/// divided by √n.
const DIFFERENT: [f64; 2] = [1.2, 4.0];

/// Ratio of the noise of two axes up to which they share their windows.
const ALIKE: f64 = 1.5;

/// Noise along an axis, relative to the largest, up to which the axis is exact.
const EXACT: f64 = 0.02;

/// Largest mean share of an axis in the squared direction of the curve for which noise along it is seen across the curve.
const SEEN: f64 = 0.75;

/// Noise, in the unit of the points, that changes no coordinate; squares of its inverse are finite.
const TINY: f64 = 1e-100;

/// Assumed noise of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveNoise {
    /// Standard deviation along each axis.
    pub(super) deviations: [f64; 3],
    /// Number of directions with noise.
    n_directions: f64,
    pub(super) parameter: Parameter,
}

impl CurveNoise {
    /// Root mean square of the noise along the axes that have some.
    pub(super) fn typical(&self) -> f64 {
        root_mean_square(&self.deviations.into_iter().filter(|s| *s > 0.0).collect::<Vec<_>>())
    }

    /// Raises the noise along each axis to `least`.
    pub(super) fn raise_to(&mut self, least: [f64; 3]) {
        self.deviations = std::array::from_fn(|a| self.deviations[a].max(least[a]));
        self.n_directions = self.n_directions.max(least.iter().filter(|s| **s > 0.0).count() as f64);
    }

    /// Axes with noise, by its size; those in a group share their windows.
    pub(super) fn groups(&self) -> Vec<AxisGroup> {
        let mut axes: Vec<usize> = (0..3).filter(|&a| self.deviations[a] > TINY).collect();
        axes.sort_by(|&a, &b| self.deviations[a].total_cmp(&self.deviations[b]));
        let alike = |a: &usize, b: &usize| self.deviations[*b] <= ALIKE * self.deviations[*a];
        let group = |axes: &[usize]| {
            let mut precisions = [0.0; 3];
            for &a in axes {
                precisions[a] = 1.0 / self.deviations[a];
            }
            AxisGroup { precisions, n_axes: self.n_directions.min(axes.len() as f64) }
        };
        axes.chunk_by(alike).map(group).collect()
    }
}

/// Noise of a curve from how badly vertices are predicted by their neighbors.
pub(super) fn noise_of(
    chains: &[Chain],
    positions: Positions<'_>,
    mean_length: f64,
    progress: Progress<'_>,
) -> Result<CurveNoise, DenoiseError> {
    let residuals = |parameter: Parameter| -> Result<Vec<Vec<Residual>>, DenoiseError> {
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
    let n_directions = by_order.first().map_or(3.0, |all| rank(&apart(all)));
    let across = noise_across(&by_length);
    let parameter =
        if excess_along(&by_order, &across) <= EVEN { Parameter::Order } else { Parameter::Length };
    let (pooled, by_axis, n) = match parameter {
        Parameter::Order => {
            let pooled =
                |all: &Vec<Residual>| deviation(&apart(all), typical_axes(&apart(all)).min(n_directions));
            let along = |axis: usize| {
                least(by_order.iter().map(|all| deviation_along(all.iter().map(|r| r.apart[axis]))))
            };
            let n = by_order.first().map_or(0, Vec::len);
            (least(by_order.iter().map(pooled)), std::array::from_fn(along), n)
        }
        Parameter::Length => {
            let pooled = |all: &Vec<Residual>| {
                let (most, typical) = ((n_directions - 1.0).max(1.0), typical_axes(&apart(all)));
                deviation(&apart(all), if typical < FEW_AXES * most { typical } else { most })
            };
            (least(by_length.iter().map(pooled)), across, by_length.first().map_or(0, |all| all.len() / 3))
        }
    };
    let deviations = if by_axis.iter().copied().fold(pooled, f64::max) > ROUNDING * mean_length {
        pool(by_axis, pooled, n)
    } else {
        [0.0; 3]
    };
    Ok(CurveNoise { deviations, n_directions, parameter })
}

/// Noise along each axis: 0 for exact axes, and equal for the others if their estimates from `n` vertices differ no more
/// than by chance. `pooled` is the noise of all axes together.
fn pool(by_axis: [f64; 3], pooled: f64, n: usize) -> [f64; 3] {
    let largest = by_axis.into_iter().fold(0.0, f64::max);
    let noisy: Vec<f64> = by_axis.into_iter().filter(|s| *s > EXACT * largest).collect();
    let least = noisy.iter().copied().fold(f64::INFINITY, f64::min);
    let by_chance = DIFFERENT[0] * (1.0 + DIFFERENT[1] / (n.max(1) as f64).sqrt());
    let common = if noisy.len() == 3 { pooled } else { root_mean_square(&noisy) };
    let of_axis = |s: f64| if largest > by_chance * least { s } else { common };
    by_axis.map(|s| if s > EXACT * largest { of_axis(s) } else { 0.0 })
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Differences of vertices from their predictions, as vectors.
fn apart(all: &[Residual]) -> Vec<[f64; 3]> {
    all.iter().map(|r| r.apart).collect()
}

/// Noise along each axis, from the third of the vertices where the curve is most across it; where the curve goes along
/// the axis everywhere, the root mean square of the other axes.
fn noise_across(by_length: &[Vec<Residual>]) -> [f64; 3] {
    let of_degree = |all: &Vec<Residual>, axis: usize| {
        let mut across: Vec<(f64, f64)> =
            all.iter().map(|r| (r.along[axis].powi(2), r.apart[axis])).collect();
        across.sort_by(|a, b| a.0.total_cmp(&b.0));
        across.truncate((all.len() / 3).max(FEWEST));
        let share = across.iter().map(|(share, _)| share).sum::<f64>() / across.len() as f64;
        (share <= SEEN).then(|| deviation_along(across.iter().map(|(share, r)| r / (1.0 - share).sqrt())))
    };
    let found: [Option<f64>; 3] = std::array::from_fn(|axis| {
        let found: Vec<f64> = by_length.iter().filter_map(|all| of_degree(all, axis)).collect();
        (!found.is_empty()).then(|| least(found.into_iter()))
    });
    let seen: Vec<f64> = found.into_iter().flatten().collect();
    found.map(|s| s.unwrap_or(root_mean_square(&seen)))
}

/// Noise along the curve, relative to what the noise along the axes explains: more than 1 if the spacing is uneven.
fn excess_along(by_order: &[Vec<Residual>], noise: &[f64; 3]) -> f64 {
    let least_expected = HARMLESS * root_mean_square(&noise[..]);
    let relative = |r: &Residual| {
        let expected = (0..3).map(|a| (r.along[a] * noise[a]).powi(2)).sum::<f64>().sqrt();
        let along = dot(&r.apart, &r.along).abs();
        if along == 0.0 { 0.0 } else { (along / expected.max(least_expected)).min(MOST_EXCESS) }
    };
    least(by_order.iter().map(|all| deviation_along(all.iter().map(relative))))
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

/// Standard deviation of normal values.
fn deviation_along(values: impl Iterator<Item = f64>) -> f64 {
    deviation(&values.map(|value| [value, 0.0, 0.0]).collect::<Vec<_>>(), 1.0)
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
        (square / chi_square(n_axes, normal)).sqrt()
    };
    let (median, low) = (quantile(0.5, 0.0), quantile(LOW, LOW_NORMAL));
    if low < MUCH_LESS * median { low } else { median }
}
