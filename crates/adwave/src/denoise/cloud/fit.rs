//! Frames of neighborhoods, and planes and quadrics fitted to the heights of points over them.

// Code compiled for several instruction sets must be inlined into the function that selects one.
#![allow(clippy::inline_always)]

use super::NEIGHBORS;
use super::lanes::{FitSums, FourValues, LANES, exps, load, sum};
use crate::vector::{Vector, add_scaled, dot, subtract};
use pulp::{Arch, NullaryFnOnce};

/// Largest number of rounds of the eigenvalue iteration, and the size of what is left beside the diagonal, relative to
/// it, at which it ends; it converges quadratically.
const SWEEPS: usize = 8;
const CONVERGED: f64 = 1e-17;

/// Smallest pivot of a fit, relative to the trace of its matrix.
const LEAST_PIVOT: f64 = 1e-10;

/// Weight below which a point has no part in a fit.
const LEAST_WEIGHT: f64 = 1e-6;

/// Axes of a neighborhood, ordered by ascending spread, and the variance along each.
#[derive(Clone, Copy, Debug)]
pub(super) struct FitFrame {
    /// Normal and two tangents.
    pub(super) axes: [Vector; 3],
    /// Variance along each axis.
    pub(super) variances: [f64; 3],
}

impl FitFrame {
    /// Principal axes of the neighbors `row` of point `x` and itself, with Gaussian weights of width `width`.
    pub(super) fn new(points: &[Vector], x: usize, row: &[u32], width: f64) -> Self {
        let scale = -0.5 / (width * width);
        let [total, a, b, c, aa, ab, ac, bb, bc, cc] =
            Arch::new().dispatch(SpreadSums { points, x, row, scale });
        let (total, sum) = (total + 1.0, [a, b, c]);
        let squares = [[aa, ab, ac], [ab, bb, bc], [ac, bc, cc]];
        principal_axes(std::array::from_fn(|a| {
            std::array::from_fn(|b| squares[a][b] / total - sum[a] * sum[b] / (total * total))
        }))
    }
}

/// Weighted sums over neighbors: 1, their three coordinates relative to the point, and six products of these.
struct SpreadSums<'a> {
    points: &'a [Vector],
    x: usize,
    row: &'a [u32],
    /// Factor of the squared distance in the exponent of the weight.
    scale: f64,
}

impl NullaryFnOnce for SpreadSums<'_> {
    type Output = [f64; 10];

    #[inline(always)]
    fn call(self) -> [f64; 10] {
        let mut sums = [[0.0; LANES]; 10];
        for part in self.row.chunks(LANES) {
            let (mut offsets, mut is_there) = ([[0.0; LANES]; 3], [0.0; LANES]);
            for (lane, &y) in part.iter().enumerate() {
                let d = subtract(&self.points[y as usize], &self.points[self.x]);
                for axis in 0..3 {
                    offsets[axis][lane] = d[axis];
                }
                is_there[lane] = 1.0;
            }
            let [a, b, c] = offsets.map(FourValues);
            let weights = FourValues(is_there) * exps((a * a + b * b + c * c) * self.scale);
            let (wa, wb, wc) = (weights * a, weights * b, weights * c);
            let all = [weights, wa, wb, wc, wa * a, wa * b, wa * c, wb * b, wb * c, wc * c];
            for (sum, part) in sums.iter_mut().zip(all) {
                *sum = (FourValues(*sum) + part).0;
            }
        }
        sums.map(|lanes| sum(FourValues(lanes)))
    }
}

/// Eigenvectors of a symmetric matrix by Jacobi's rotations.
pub(super) fn principal_axes(mut a: [[f64; 3]; 3]) -> FitFrame {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let beside = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        if beside <= CONVERGED * (a[0][0].abs() + a[1][1].abs() + a[2][2].abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            if !t.is_finite() {
                continue;
            }
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (at_p, at_q) = (a[p], a[q]);
            a[p] = std::array::from_fn(|k| c * at_p[k] - s * at_q[k]);
            a[q] = std::array::from_fn(|k| s * at_p[k] + c * at_q[k]);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    FitFrame { axes: order.map(|j| [v[0][j], v[1][j], v[2][j]]), variances: order.map(|j| a[j][j].max(0.0)) }
}

/// Heights of neighbors over the plane of a frame through a point, in the order of the neighbors.
pub(super) struct Heights {
    /// Number of neighbors.
    pub(super) n: usize,
    /// Tangential coordinates in units of `radius`, by axis.
    tangential: [[f64; NEIGHBORS]; 2],
    /// Heights in the unit of the points.
    over_plane: [f64; NEIGHBORS],
    /// Squared distances in units of `radius`.
    squares: [f64; NEIGHBORS],
    radius: f64,
}

/// Surface fitted to heights, at the point itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeightFit {
    /// Height of the surface.
    pub(super) height: f64,
    /// Variance of that height for noise of variance 1.
    pub(super) variance: f64,
    /// Slopes along both tangents.
    pub(super) slopes: [f64; 2],
}

/// Plane (3) or quadric (6 coefficients).
pub(super) fn basis<const N: usize>([u, v]: [f64; 2]) -> [f64; N] {
    let all = [1.0, u, v, u * u, u * v, v * v];
    std::array::from_fn(|k| all[k])
}

/// [`basis`] of several neighbors.
#[inline(always)]
fn lane_basis<const N: usize>([u, v]: [FourValues; 2]) -> [FourValues; N] {
    let all = [FourValues([1.0; LANES]), u, v, u * u, u * v, v * v];
    std::array::from_fn(|k| all[k])
}

impl Heights {
    pub(super) fn new(points: &[Vector], x: usize, row: &[u32], frame: &FitFrame, radius: f64) -> Self {
        let mut out = Self {
            n: row.len(),
            tangential: [[0.0; NEIGHBORS]; 2],
            over_plane: [0.0; NEIGHBORS],
            squares: [0.0; NEIGHBORS],
            radius,
        };
        let [normal, first, second] = &frame.axes;
        for (k, &y) in row.iter().enumerate() {
            let d = subtract(&points[y as usize], &points[x]);
            out.tangential[0][k] = dot(&d, first) / radius;
            out.tangential[1][k] = dot(&d, second) / radius;
            out.over_plane[k] = dot(&d, normal);
            out.squares[k] = dot(&d, &d) / (radius * radius);
        }
        out
    }

    /// Fit to the `n` nearest neighbors with equal weights, without the point itself.
    pub(super) fn fit_without_center<const N: usize>(&self, n: usize) -> Option<HeightFit> {
        Arch::new().dispatch(EqualFit::<N> { heights: self, n })
    }

    /// Plane and quadric fitted to all neighbors and the point itself with Gaussian weights of `width` radii, and
    /// robust weights: first those of points near the height of the point itself, then those of points near the surface
    /// so found.
    pub(super) fn robust_fits(&self, width: f64, reach: RobustReach) -> [Option<HeightFit>; 2] {
        Arch::new().dispatch(RobustFits { heights: self, width, reach })
    }

    /// Tangential coordinates and heights of the neighbors from `k` on.
    #[inline(always)]
    fn lanes(&self, k: usize) -> ([FourValues; 2], FourValues) {
        let [u, v] = &self.tangential;
        ([load(u, k), load(v, k)], load(&self.over_plane, k))
    }

    /// Fit with the weights `start`, and again with those of points within `reach` of its surface.
    #[inline(always)]
    fn refit<const N: usize>(
        &self,
        start: &[f64; NEIGHBORS],
        by_distance: &[f64; NEIGHBORS],
        reach: f64,
    ) -> Option<HeightFit> {
        let (_, coefficients) = self.solve::<N>(start, 1.0)?;
        let scale = -0.5 / (reach * reach);
        let mut weights = [0.0; NEIGHBORS];
        for k in (0..self.n).step_by(LANES) {
            let (place, heights) = self.lanes(k);
            let mut residuals = heights;
            for (c, f) in coefficients.iter().zip(lane_basis::<N>(place)) {
                residuals = residuals - f * *c;
            }
            let own = load(by_distance, k) * exps(residuals * residuals * scale);
            weights[k..k + LANES].copy_from_slice(&own.0);
        }
        let center = exps(FourValues([scale * coefficients[0] * coefficients[0]; LANES])).0[0];
        let (fit, _) = self.solve::<N>(&weights, center)?;
        Some(HeightFit { variance: fit.variance * center, ..fit })
    }

    /// Weighted least squares, with weights of 0 beyond the neighbors; the point itself, at the origin, has the weight
    /// `center`.
    #[inline(always)]
    fn solve<const N: usize>(
        &self,
        weights: &[f64; NEIGHBORS],
        center: f64,
    ) -> Option<(HeightFit, [f64; N])> {
        let mut sums = FitSums::<N>::default();
        for k in (0..self.n).step_by(LANES) {
            let (place, heights) = self.lanes(k);
            let weights = load(weights, k).0.map(|w| if w < LEAST_WEIGHT { 0.0 } else { w });
            sums.add(FourValues(weights), place, heights);
        }
        let (mut matrix, right) = sums.equations();
        matrix[0][0] += center;
        if !factorize(&mut matrix) {
            return None;
        }
        let coefficients = substitute(&matrix, right);
        let mut first = [0.0; N];
        first[0] = 1.0;
        let variance = substitute(&matrix, first)[0];
        let slopes = [coefficients[1] / self.radius, coefficients[2] / self.radius];
        Some((HeightFit { height: coefficients[0], variance, slopes }, coefficients))
    }
}

/// [`Heights::fit_without_center`], compiled for several processors.
struct EqualFit<'a, const N: usize> {
    heights: &'a Heights,
    n: usize,
}

impl<const N: usize> NullaryFnOnce for EqualFit<'_, N> {
    type Output = Option<HeightFit>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut weights = [0.0; NEIGHBORS];
        weights[..self.n].fill(1.0);
        self.heights.solve::<N>(&weights, 0.0).map(|(fit, _)| fit)
    }
}

/// [`Heights::robust_fits`], compiled for several processors.
struct RobustFits<'a> {
    heights: &'a Heights,
    width: f64,
    reach: RobustReach,
}

impl NullaryFnOnce for RobustFits<'_> {
    type Output = [Option<HeightFit>; 2];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { heights, width, reach } = self;
        let (scale, start_scale) = (-0.5 / (width * width), -0.5 / (reach.start * reach.start));
        let (mut by_distance, mut start) = ([0.0; NEIGHBORS], [0.0; NEIGHBORS]);
        for k in (0..heights.n).step_by(LANES) {
            let over_plane = load(&heights.over_plane, k);
            let near = exps(load(&heights.squares, k) * scale);
            by_distance[k..k + LANES].copy_from_slice(&near.0);
            let near_in_height = near * exps(over_plane * over_plane * start_scale);
            start[k..k + LANES].copy_from_slice(&near_in_height.0);
        }
        by_distance[heights.n..].fill(0.0);
        start[heights.n..].fill(0.0);
        [
            heights.refit::<3>(&start, &by_distance, reach.fit),
            heights.refit::<6>(&start, &by_distance, reach.fit),
        ]
    }
}

/// Distances in height at which robust weights fall.
#[derive(Clone, Copy)]
pub(super) struct RobustReach {
    /// Distance from the point itself, in the first round.
    pub(super) start: f64,
    /// Distance from the fitted surface, in the second round.
    pub(super) fit: f64,
}

impl HeightFit {
    /// Motion of the point onto the surface, along its normal.
    pub(super) fn motion(&self, frame: &FitFrame) -> Vector {
        let [normal, first, second] = &frame.axes;
        let [a, b] = self.slopes;
        let upright = add_scaled(&add_scaled(normal, -a, first), -b, second);
        upright.map(|c| c * self.height / (1.0 + a * a + b * b))
    }
}

/// Cholesky's factor in the lower triangle; false if the matrix is not safely positive definite.
pub(super) fn factorize<const N: usize>(a: &mut [[f64; N]; N]) -> bool {
    let least = LEAST_PIVOT * (0..N).map(|i| a[i][i]).sum::<f64>();
    for i in 0..N {
        for j in 0..=i {
            let s = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            if i != j {
                a[i][j] = s / a[j][j];
            } else if s > least {
                a[i][i] = s.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

pub(super) fn substitute<const N: usize>(l: &[[f64; N]; N], mut x: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let s = x[i] - (0..i).map(|k| l[i][k] * x[k]).sum::<f64>();
        x[i] = s / l[i][i];
    }
    for i in (0..N).rev() {
        let s = x[i] - (i + 1..N).map(|k| l[k][i] * x[k]).sum::<f64>();
        x[i] = s / l[i][i];
    }
    x
}
