//! Positions of a chain over a parameter, and the polynomials that are fitted to them in windows.

use super::chains::Chain;
use super::polynomial::fit_weights;
use crate::vector::{add_scaled, dot, subtract, unit};
use std::collections::BTreeMap;

/// Numbers of vertices that windows reach to a side.
const REACHES: [usize; 12] = [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64];

/// Degrees of the polynomials.
const DEGREES: [usize; 3] = [1, 3, 5];

/// Sides of a vertex to which windows reach: before, after and both.
const SIDES: [(usize, usize); 3] = [(1, 0), (0, 1), (1, 1)];

/// Normal deviate up to which the squared distance of two estimates agrees with the χ² distribution that it has by the
/// variance of the one from the smaller window; 99.3 % of them do.
const AGREEMENT: f64 = 2.44;

/// Order of the vertices of a chain as numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Parameter {
    /// 0, 1, 2 …: for even spacing.
    Order,
    /// Length along the places.
    Length,
}

/// Positions of all vertices, and places from which lengths and directions are taken.
#[derive(Clone, Copy)]
pub(super) struct Positions<'a> {
    pub(super) points: &'a [[f64; 3]],
    /// The points, or, where noise stretches the edges, places without it.
    pub(super) places: &'a [[f64; 3]],
}

/// Axes whose noise is alike, which share their windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisGroup {
    /// One divided by the standard deviation of the noise along each axis; 0 for axes outside the group.
    pub(super) precisions: [f64; 3],
    /// Number of axes with noise.
    pub(super) n_axes: f64,
}

/// Difference of a vertex from its prediction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    /// In standard deviations of such a difference for noise of 1; across the curve if the parameter is its length.
    pub(super) apart: [f64; 3],
    /// Unit vector along the curve; 0 if its vertices coincide.
    pub(super) along: [f64; 3],
}

/// Points of a chain over a parameter.
pub(super) struct Track {
    points: Vec<[f64; 3]>,
    places: Vec<[f64; 3]>,
    at: Vec<f64>,
    /// Length of the parameter around a closed chain.
    period: f64,
    pub(super) is_closed: bool,
    /// True if the parameter is the order.
    is_even: bool,
    /// Weights of windows and degrees that are the same at all vertices, because the parameter is the order.
    known: BTreeMap<(Window, usize), Vec<f64>>,
}

/// Numbers of vertices before and after one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Window {
    before: usize,
    after: usize,
}

/// An estimate of a position.
#[derive(Clone, Copy, Default)]
pub(super) struct Estimate {
    pub(super) point: [f64; 3],
    /// Variance relative to that of the noise.
    pub(super) variance: f64,
    /// Weight of the vertex itself.
    pub(super) own: f64,
}

impl Track {
    pub(super) fn new(chain: &Chain, positions: Positions<'_>, parameter: Parameter) -> Self {
        let of_chain =
            |all: &[[f64; 3]]| -> Vec<[f64; 3]> { chain.vertices.iter().map(|&x| all[x as usize]).collect() };
        let (points, places) = (of_chain(positions.points), of_chain(positions.places));
        let n = points.len();
        let step = |k: usize| match parameter {
            Parameter::Order => 1.0,
            Parameter::Length => {
                let next = (k + 1) % n;
                match unit(&subtract(&places[next], &places[k])) {
                    Some(along) => dot(&subtract(&points[next], &points[k]), &along),
                    None => 0.0,
                }
            }
        };
        let mut at = Vec::with_capacity(n);
        let mut sum = 0.0;
        for k in 0..n {
            at.push(sum);
            sum += step(k);
        }
        Self {
            at,
            period: sum,
            is_closed: chain.is_closed,
            is_even: parameter == Parameter::Order,
            known: if parameter == Parameter::Order { even_weights() } else { BTreeMap::new() },
            points,
            places,
        }
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
        if let Some(weights) = self.known.get(&(window, degree)).filter(|_| !is_prediction) {
            return Some(self.weighted(i, &near, weights, weights[window.before]));
        }
        let nodes: Vec<f64> = near.iter().map(|(_, u)| *u).collect();
        let weights = fit_weights(&nodes, degree)?;
        let own = if is_prediction { 0.0 } else { weights[window.before] };
        Some(self.weighted(i, &near, &weights, own))
    }

    /// Sum of the positions of `near` with weights, of which vertex `i` itself has `own`.
    fn weighted(&self, i: usize, near: &[(usize, f64)], weights: &[f64], own: f64) -> Estimate {
        let add = |sum: [f64; 3], (w, (k, _)): (&f64, &(usize, f64))| {
            add_scaled(&sum, *w, &subtract(&self.points[*k], &self.points[i]))
        };
        let moved = weights.iter().zip(near).fold([0.0; 3], add);
        let variance = weights.iter().map(|w| w * w).sum();
        Estimate { point: add_scaled(&self.points[i], 1.0, &moved), variance, own }
    }

    /// Noisy position of vertex `i`.
    pub(super) fn point(&self, i: usize) -> [f64; 3] {
        self.points[i]
    }

    /// Number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.points.len()
    }

    /// Vertex that comes `offset` after vertex `i`, or before it; `None` beyond an end.
    pub(super) fn neighbor(&self, i: usize, offset: isize) -> Option<usize> {
        let n = self.points.len() as isize;
        let k = i as isize + offset;
        if self.is_closed {
            Some(k.rem_euclid(n) as usize)
        } else {
            (0..n).contains(&k).then_some(k as usize)
        }
    }

    /// Estimates at `vertices` from windows that reach so many vertices to either side, as far as there are any; `None`
    /// if a window reaches beyond both ends, or around the whole chain.
    pub(super) fn centered(&self, vertices: &[usize], reach: usize, degree: usize) -> Vec<Option<Estimate>> {
        let last = self.points.len() - 1;
        let mut known: Option<(Window, Vec<f64>)> = None;
        let estimate = |&i: &usize| {
            let window = if self.is_closed {
                Window { before: reach, after: reach }
            } else {
                Window { before: reach.min(i), after: reach.min(last - i) }
            };
            if window.before < reach && window.after < reach {
                return None;
            }
            let near = self.window(i, window)?;
            // Equal windows have equal weights where the parameter is the order.
            let is_known = self.is_even && known.as_ref().is_some_and(|(of, _)| *of == window);
            if !is_known {
                let nodes: Vec<f64> = near.iter().map(|(_, u)| *u).collect();
                known = Some((window, fit_weights(&nodes, degree)?));
            }
            let (_, weights) = known.as_ref()?;
            Some(self.weighted(i, &near, weights, weights[window.before]))
        };
        vertices.iter().map(estimate).collect()
    }

    /// Estimate of the position of vertex `i` from all sides and degrees.
    pub(super) fn estimate(&self, i: usize, group: &AxisGroup) -> Estimate {
        let data = Estimate { point: self.points[i], variance: 1.0, own: 1.0 };
        let limit = chi_square(group.n_axes, AGREEMENT);
        let (mut sum, mut own, mut total) = ([0.0; 3], 0.0, 0.0);
        for degree in DEGREES {
            for (before, after) in SIDES {
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
                        let apart: [f64; 3] = std::array::from_fn(|a| apart[a] * group.precisions[a]);
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
                own += share * best.own;
                total += share;
            }
        }
        let n_estimates = 3.0 * DEGREES.len() as f64;
        let variance = (n_estimates / total).sqrt();
        Estimate { point: add_scaled(&data.point, 1.0 / total, &sum), variance, own: own / total }
    }

    /// Differences between the vertices and their predictions by polynomials through their neighbors.
    pub(super) fn residuals(&self, degree: usize, parameter: Parameter) -> Vec<Residual> {
        let reach = degree.div_ceil(2);
        let window = Window { before: reach, after: reach };
        let n = self.points.len();
        let residual = |i: usize| {
            let found = self.fit(i, window, degree, true)?;
            let apart = subtract(&self.points[i], &found.point);
            let apart = apart.map(|c| c / (1.0 + found.variance).sqrt());
            let along = unit(&subtract(&self.places[(i + 1) % n], &self.places[(i + n - 1) % n]));
            let along = along.unwrap_or_default();
            if parameter == Parameter::Order {
                return Some(Residual { apart, along });
            }
            Some(Residual { apart: add_scaled(&apart, -dot(&apart, &along), &along), along })
        };
        (0..n).filter_map(residual).collect()
    }
}

/// Weights of the windows of [`Track::estimate`] for even spacing.
fn even_weights() -> BTreeMap<(Window, usize), Vec<f64>> {
    let mut known = BTreeMap::new();
    for degree in DEGREES {
        for (before, after) in SIDES {
            for reach in REACHES {
                let window = Window { before: before * reach, after: after * reach };
                let nodes: Vec<f64> =
                    (0..=window.before + window.after).map(|k| k as f64 - window.before as f64).collect();
                if let Some(weights) = fit_weights(&nodes, degree) {
                    known.insert((window, degree), weights);
                }
            }
        }
    }
    known
}

/// Quantile of the χ² distribution with `n_axes` degrees of freedom that belongs to a normal deviate (Wilson and
/// Hilferty).
pub(super) fn chi_square(n_axes: f64, normal: f64) -> f64 {
    let ninth = 2.0 / (9.0 * n_axes);
    n_axes * (1.0 - ninth + normal * ninth.sqrt()).powi(3)
}
