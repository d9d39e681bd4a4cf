//! Signed distances from one shape to another.

use crate::{ClosestPoint, ClosestPointSearch, Signs};
use adwave::vector::{add_scaled, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of vertices between checks for cancellation.
const VERTICES_PER_CHUNK: usize = 1 << 14;

/// Signed distances from the vertices of a shape to another shape.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedDistances {
    /// Signed distance of each point in model units, with the sign of [`Signs`]; NaN if undefined.
    pub values: Vec<f64>,
    /// Closest point of each point.
    pub closest: Vec<ClosestPoint>,
    /// Number of points whose value is NaN because they may correspond to a point beyond a border of the other shape.
    pub n_beyond_border: usize,
    /// Number of points whose value is NaN because they are farther than the limit.
    pub n_too_far: usize,
}

/// Computes `‖c − x‖` for each point x with closest point c on `surface`, with the sign that [`Signs`] gives.
///
/// The value is NaN, a hole for bands, if the corresponding point may lie beyond a border of the surface, or if c is
/// farther than `limit`. The corresponding point may lie beyond a border if c lies on it and `c − x` is not along the
/// normal there. O(n log m) for n points and a surface of m vertices.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
///
/// # Panics
/// Panics if the numbers of points and normals differ.
pub fn signed_distances(
    points: &[[f64; 3]],
    signs: &Signs,
    surface: &ClosestPointSearch,
    limit: f64,
    progress: Progress<'_>,
) -> Result<SignedDistances, Cancelled> {
    if let Signs::Own(normals) = signs {
        assert_eq!(points.len(), normals.len(), "one normal per point");
    }
    let mut distances =
        SignedDistances { values: Vec::new(), closest: Vec::new(), n_beyond_border: 0, n_too_far: 0 };
    for chunk in points.chunks(VERTICES_PER_CHUNK) {
        progress.check()?;
        distances.closest.par_extend(chunk.par_iter().map(|p| surface.closest(p)));
    }
    for (x, (p, closest)) in points.iter().zip(&distances.closest).enumerate() {
        let offset = subtract(&closest.point, p);
        let distance = norm(&offset);
        let value = if closest.is_border && !is_beside(p, closest, &offset) {
            distances.n_beyond_border += 1;
            f64::NAN
        } else if distance > limit {
            distances.n_too_far += 1;
            f64::NAN
        } else {
            signs.sign(distance, x, &offset, closest)
        };
        distances.values.push(value);
    }
    Ok(distances)
}

/// True if the offset of a point to its closest point is along the normal there, up to the rounding of 32-bit
/// coordinates.
fn is_beside(point: &[f64; 3], closest: &ClosestPoint, offset: &[f64; 3]) -> bool {
    let along = add_scaled(offset, -dot(offset, &closest.normal), &closest.normal);
    let size = point.iter().chain(&closest.point).fold(0.0_f64, |m, c| m.max(c.abs()));
    norm(&along) <= f64::from(f32::EPSILON) * (size + norm(offset))
}

/// Summary statistics of a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Area-weighted root mean square length; NaN without values.
    pub rms: f64,
    /// Area-weighted mean of the first channel; NaN without values.
    pub mean: f64,
    /// Largest length; NaN without values.
    pub greatest: f64,
    /// Vertex with the largest length; 0 without values.
    pub vertex: usize,
}

impl Summary {
    /// Summarizes vectors with `n_channels` components at vertices; vertices with a NaN are skipped. O(n).
    ///
    /// ```
    /// use adwave_register::Summary;
    /// let summary = Summary::new(&[1.0, f64::NAN, -3.0], 1, &[3.0, 9.0, 1.0]);
    /// assert_eq!((summary.rms, summary.mean, summary.greatest, summary.vertex), (3.0_f64.sqrt(), 0.0, 3.0, 2));
    /// ```
    ///
    /// # Panics
    /// Panics if the number of areas differs from the number of vertices.
    pub fn new(values: &[f64], n_channels: usize, areas: &[f64]) -> Self {
        assert_eq!(values.len(), n_channels * areas.len(), "one area per vertex");
        let (mut total, mut squares, mut sum) = (0.0, 0.0, 0.0);
        let (mut greatest, mut vertex) = (f64::NAN, 0);
        for (x, (row, area)) in values.chunks_exact(n_channels).zip(areas).enumerate() {
            let square = row.iter().map(|v| v * v).sum::<f64>();
            if square.is_nan() {
                continue;
            }
            total += area;
            squares += area * square;
            sum += area * row[0];
            if greatest.is_nan() || square.sqrt() > greatest {
                (greatest, vertex) = (square.sqrt(), x);
            }
        }
        Self { rms: (squares / total).sqrt(), mean: sum / total, greatest, vertex }
    }
}
