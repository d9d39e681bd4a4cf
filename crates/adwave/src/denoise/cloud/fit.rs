//! Frames of neighborhoods, and planes and quadrics fitted to the heights of points over them.

use super::NEIGHBORS;
use crate::vector::{Vector, add_scaled, dot, subtract};

/// Rounds of the eigenvalue iteration; it converges quadratically.
const SWEEPS: usize = 8;

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
        let (mut total, mut sum, mut squares) = (1.0, [0.0; 3], [[0.0; 3]; 3]);
        for &y in row {
            let d = subtract(&points[y as usize], &points[x]);
            let weight = (scale * dot(&d, &d)).exp();
            total += weight;
            for a in 0..3 {
                sum[a] += weight * d[a];
                for b in 0..=a {
                    squares[a][b] += weight * d[a] * d[b];
                }
            }
        }
        let mut matrix = [[0.0; 3]; 3];
        for a in 0..3 {
            for b in 0..=a {
                matrix[a][b] = squares[a][b] / total - sum[a] * sum[b] / (total * total);
                matrix[b][a] = matrix[a][b];
            }
        }
        principal_axes(matrix)
    }
}

/// Eigenvectors of a symmetric matrix by Jacobi's rotations.
pub(super) fn principal_axes(mut a: [[f64; 3]; 3]) -> FitFrame {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            if !t.is_finite() {
                continue;
            }
            let c = 1.0 / t.hypot(1.0);
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
    /// Tangential coordinates in units of `radius`.
    tangential: [[f64; 2]; NEIGHBORS],
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

fn gauss(height: f64, width: f64) -> f64 {
    (-0.5 * height * height / (width * width)).exp()
}

/// Plane (3) or quadric (6 coefficients).
pub(super) fn basis<const N: usize>([u, v]: [f64; 2]) -> [f64; N] {
    let all = [1.0, u, v, u * u, u * v, v * v];
    std::array::from_fn(|k| all[k])
}

impl Heights {
    pub(super) fn new(points: &[Vector], x: usize, row: &[u32], frame: &FitFrame, radius: f64) -> Self {
        let mut out = Self {
            n: row.len(),
            tangential: [[0.0; 2]; NEIGHBORS],
            over_plane: [0.0; NEIGHBORS],
            squares: [0.0; NEIGHBORS],
            radius,
        };
        let [normal, first, second] = &frame.axes;
        for (k, &y) in row.iter().enumerate() {
            let d = subtract(&points[y as usize], &points[x]);
            out.tangential[k] = [dot(&d, first) / radius, dot(&d, second) / radius];
            out.over_plane[k] = dot(&d, normal);
            out.squares[k] = dot(&d, &d) / (radius * radius);
        }
        out
    }

    /// Fit to the `n` nearest neighbors with equal weights, without the point itself.
    pub(super) fn fit_without_center<const N: usize>(&self, n: usize) -> Option<HeightFit> {
        self.solve::<N>(&[1.0; NEIGHBORS][..n], 0.0).map(|(fit, _)| fit)
    }

    /// Plane and quadric fitted to all neighbors and the point itself with Gaussian weights of `width` radii, and
    /// robust weights: first those of points near the height of the point itself, then those of points near the surface
    /// so found.
    pub(super) fn robust_fits(&self, width: f64, reach: RobustReach) -> [Option<HeightFit>; 2] {
        let scale = -0.5 / (width * width);
        let (mut by_distance, mut start) = ([0.0; NEIGHBORS], [0.0; NEIGHBORS]);
        for k in 0..self.n {
            by_distance[k] = (scale * self.squares[k]).exp();
            start[k] = by_distance[k] * gauss(self.over_plane[k], reach.start);
        }
        [
            self.refit::<3>(&start[..self.n], &by_distance, reach.fit),
            self.refit::<6>(&start[..self.n], &by_distance, reach.fit),
        ]
    }

    /// Fit with the weights `start`, and again with those of points within `reach` of its surface.
    fn refit<const N: usize>(&self, start: &[f64], by_distance: &[f64], reach: f64) -> Option<HeightFit> {
        let (_, coefficients) = self.solve::<N>(start, 1.0)?;
        let residual = |tangential: [f64; 2], height: f64| {
            let f = basis::<N>(tangential);
            height - (0..N).map(|i| coefficients[i] * f[i]).sum::<f64>()
        };
        let mut weights = [0.0; NEIGHBORS];
        for k in 0..self.n {
            weights[k] = by_distance[k] * gauss(residual(self.tangential[k], self.over_plane[k]), reach);
        }
        let center = gauss(residual([0.0; 2], 0.0), reach);
        let (fit, _) = self.solve::<N>(&weights[..self.n], center)?;
        Some(HeightFit { variance: fit.variance * center, ..fit })
    }

    /// Weighted least squares; the point itself, at the origin, has the weight `center`.
    fn solve<const N: usize>(&self, weights: &[f64], center: f64) -> Option<(HeightFit, [f64; N])> {
        let (mut matrix, mut right) = ([[0.0; N]; N], [0.0; N]);
        matrix[0][0] = center;
        for (k, &weight) in weights.iter().enumerate() {
            if weight < LEAST_WEIGHT {
                continue;
            }
            let f = basis::<N>(self.tangential[k]);
            for i in 0..N {
                let weighted = weight * f[i];
                for j in 0..=i {
                    matrix[i][j] += weighted * f[j];
                }
                right[i] += weighted * self.over_plane[k];
            }
        }
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
