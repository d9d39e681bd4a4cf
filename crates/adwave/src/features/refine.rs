//! Refinement of features between vertices and levels, and rejection of edges.

use super::response::ResponseLevel;
use crate::Decomposer;
use crate::signal::{TangentFrame, fit_quadric};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// A neighborhood in its tangent plane.
pub(super) struct TangentNeighborhood {
    frame: Option<TangentFrame>,
    /// Vertices with their coordinates in the tangent frame in units of `size`; the center comes first.
    around: Vec<(usize, Vector3<f64>)>,
    size: f64,
}

impl TangentNeighborhood {
    /// The neighbors of `x` in their best-fitting plane; on a graph there is no frame.
    pub(super) fn new(decomposer: &Decomposer, neighbors: &[u32], x: usize) -> Self {
        let points = decomposer.positions();
        let flat = Self { frame: None, around: Vec::new(), size: 0.0 };
        let Some(origin) = points.get(x).map(|p| Vector3::from(*p)) else { return flat };
        let offsets = neighbors.iter().map(|&y| Vector3::from(points[y as usize]) - origin);
        let size = offsets.clone().map(|d| d.amax()).fold(0.0, f64::max);
        if size == 0.0 {
            return flat;
        }
        let mean = offsets.clone().map(|d| d / size).sum::<Vector3<f64>>() / (neighbors.len() + 1) as f64;
        let covariance = offsets.fold(mean * mean.transpose(), |m: Matrix3<f64>, d| {
            let d = d / size - mean;
            m + d * d.transpose()
        });
        let eigen = covariance.symmetric_eigen();
        let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).normalize();
        let frame = TangentFrame::new(points[x], normal);
        let around = std::iter::once(x)
            .chain(neighbors.iter().map(|&y| y as usize))
            .map(|y| (y, frame.local(&points[y]) / size))
            .collect();
        Self { frame: Some(frame), around, size }
    }

    fn fit(&self, value: impl Fn(usize, &Vector3<f64>) -> f64) -> Option<[f64; 6]> {
        fit_quadric(self.around.iter().map(|(y, p)| [p.x, p.y, value(*y, p)]))
    }
}

/// Ratio of the larger to the smaller principal curvature of R over the neighborhood, ≥ 1; `None` if R is a saddle
/// or flat in one direction, or the neighborhood does not determine it.
pub(super) fn edge_ratio(local: &TangentNeighborhood, response: &ResponseLevel<'_>) -> Option<f64> {
    let [_, _, _, d, e, f] = local.fit(|y, _| response.value(y))?;
    let (half_trace, det) = (0.5 * (d + f), d * f - e * e);
    if det <= 0.0 {
        return None;
    }
    let spread = (half_trace * half_trace - det).max(0.0).sqrt();
    let (large, small) = (half_trace.abs() + spread, half_trace.abs() - spread);
    (small > 0.0).then(|| large / small)
}

/// Position of the extremum of the quadric through R, on the quadric through the neighborhood's points; `None` if
/// it is not an extremum or is further away than the nearest neighbor, where the vertex itself is the better
/// answer.
pub(super) fn refined_position(
    local: &TangentNeighborhood,
    response: &ResponseLevel<'_>,
) -> Option<[f64; 3]> {
    let frame = local.frame.as_ref()?;
    let [_, b, c, d, e, f] = local.fit(|y, _| response.value(y))?;
    let sign = response.value(local.around[0].0).signum();
    let hessian = Matrix2::new(d, e, e, f);
    // A maximum of a positive response bends down in both directions, a minimum of a negative one up.
    if hessian.determinant() <= 0.0 || sign * hessian.trace() >= 0.0 {
        return None;
    }
    let offset = -hessian.try_inverse()? * Vector2::new(b, c);
    let nearest = local.around[1..].iter().map(|(_, p)| p.norm()).fold(f64::INFINITY, f64::min);
    if offset.norm().is_nan() || offset.norm() > nearest {
        return None;
    }
    let (u, v) = (offset.x, offset.y);
    let [_, b, c, d, e, f] = local.fit(|_, p| p.z)?;
    // Without a constant term, because the surface passes through the vertex.
    let height = b * u + c * v + 0.5 * (d * u * u + 2.0 * e * u * v + f * v * v);
    Some(frame.global(Vector3::new(u, v, height) * local.size))
}

/// The σ at which the parabola through |R| on levels j − 1, j and j + 1 over log σ is largest, limited to half-way
/// to the adjacent levels.
pub(super) fn refined_sigma(sigma: &[f64], levels: &[ResponseLevel<'_>], j: usize, x: usize) -> f64 {
    let sign = levels[j - 1].value(x).signum();
    parabola_peak(
        [j - 1, j, j + 1].map(|j| sigma[j]),
        [j - 2, j - 1, j].map(|level| sign * levels[level].value(x)),
    )
}

/// The width at which the parabola through three values over log σ is largest, limited to half-way to the outer ones;
/// the middle one if the values have no maximum.
pub(super) fn parabola_peak(sigma: [f64; 3], values: [f64; 3]) -> f64 {
    let [before, here, after] = sigma.map(f64::ln);
    let [p, q, r] = values;
    let (left, right) = (here - before, after - here);
    let (up, down) = ((q - p) / left, (r - q) / right);
    // The divided differences decrease across a maximum.
    let bend = 2.0 * (down - up) / (left + right);
    if bend >= 0.0 {
        return sigma[1];
    }
    let slope = (up * right + down * left) / (left + right);
    let shift = (-slope / bend).clamp(-0.5 * left, 0.5 * right);
    (here + shift).exp()
}
