//! Least-squares quadrics over a tangent plane.

use super::{Curvature, try_cloud_normals};
use crate::parallel::{self, expect_not_cancelled};
use crate::shape::Neighborhoods;
use crate::{Cancelled, Progress};
use nalgebra::{Matrix6, Vector3, Vector6};

/// A right-handed frame at a point: two directions of the tangent plane and the normal.
pub(crate) struct TangentFrame {
    pub(crate) origin: Vector3<f64>,
    pub(crate) u: Vector3<f64>,
    pub(crate) v: Vector3<f64>,
    pub(crate) normal: Vector3<f64>,
}

impl TangentFrame {
    /// The frame with that unit normal.
    pub(crate) fn new(origin: [f64; 3], normal: Vector3<f64>) -> Self {
        let helper = if normal.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let u = normal.cross(&helper).normalize();
        Self { origin: origin.into(), u, v: normal.cross(&u), normal }
    }

    /// Coordinates of a point in the frame.
    pub(crate) fn local(&self, p: &[f64; 3]) -> Vector3<f64> {
        let d = Vector3::from(*p) - self.origin;
        Vector3::new(d.dot(&self.u), d.dot(&self.v), d.dot(&self.normal))
    }

    /// The point with these coordinates.
    pub(crate) fn global(&self, local: Vector3<f64>) -> [f64; 3] {
        (self.origin + local.x * self.u + local.y * self.v + local.z * self.normal).into()
    }
}

/// Coefficients of `a + b·u + c·v + ½(d·u² + 2e·uv + f·v²)` that fit samples `(u, v, value)` best; `None` if the
/// samples do not determine them. The values of u and v should be of the order of 1.
pub(crate) fn fit_quadric(samples: impl Iterator<Item = [f64; 3]>) -> Option<[f64; 6]> {
    /// Squared relative size of the smallest pivot below which the samples lie on a conic.
    const SINGULAR: f64 = 1e-10;
    let (mut matrix, mut right, mut count) = (Matrix6::<f64>::zeros(), Vector6::zeros(), 0);
    for [u, v, value] in samples {
        let row = Vector6::new(1.0, u, v, 0.5 * u * u, u * v, 0.5 * v * v);
        matrix += row * row.transpose();
        right += value * row;
        count += 1;
    }
    if count < 6 {
        return None;
    }
    let largest = matrix.diagonal().max();
    let factor = matrix.cholesky()?;
    let smallest = factor.l_dirty().diagonal().min();
    (smallest * smallest > SINGULAR * largest).then(|| factor.solve(&right).into())
}

/// Curvatures of a cloud, in 1/unit and 1/unit² of `points`, of the quadric over the tangent plane that fits a
/// point and its neighbors best; 0 if fewer than 6 points, or points on a conic, do not determine it. O(n k log n).
///
/// Signs as for [`mesh_curvature`](super::mesh_curvature), with the normals of [`cloud_normals`](super::cloud_normals).
///
/// # Panics
/// Unless `near` has one neighborhood per point.
pub fn cloud_curvature(points: &[[f64; 3]], near: &Neighborhoods) -> Curvature {
    expect_not_cancelled(try_cloud_curvature(points, near, Progress::none()))
}

/// [`cloud_curvature`]; stops if the call is cancelled.
pub(crate) fn try_cloud_curvature(
    points: &[[f64; 3]],
    near: &Neighborhoods,
    progress: Progress<'_>,
) -> Result<Curvature, Cancelled> {
    let normals = try_cloud_normals(points, near, progress)?;
    let at = |x: usize| {
        let (normal, radius) = (Vector3::from(normals[x]), near.radius[x]);
        if normal == Vector3::zeros() || radius == 0.0 {
            return (0.0, 0.0);
        }
        let frame = TangentFrame::new(points[x], normal);
        let around = std::iter::once(x).chain(near.adjacency.row(x).iter().map(|&y| y as usize));
        let samples = around.map(|y| (frame.local(&points[y]) / radius).into());
        let Some([_, b, c, d, e, f]) = fit_quadric(samples) else { return (0.0, 0.0) };
        // First and second fundamental form of the graph of the quadric at the projected point.
        let (ee, ff, gg) = (1.0 + b * b, b * c, 1.0 + c * c);
        let det = ee * gg - ff * ff;
        let root = det.sqrt();
        let mean = -(ee * f - 2.0 * ff * e + gg * d) / (2.0 * det * root);
        (mean / radius, (d * f - e * e) / (det * det) / (radius * radius))
    };
    let chunks = parallel::try_map_chunks(
        points.len(),
        1 << 10,
        progress,
        || (),
        |(), range| range.map(at).unzip::<f64, f64, Vec<f64>, Vec<f64>>(),
    )?;
    let (mean, gaussian): (Vec<_>, Vec<_>) = chunks.into_iter().unzip();
    Ok(Curvature { mean: mean.concat(), gaussian: gaussian.concat() })
}
