//! Signed distances from one shape to another.

use crate::{ClosestPoint, ClosestPointSearch};
use adwave::vector::{dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of vertices between checks for cancellation.
const VERTICES_PER_CHUNK: usize = 1 << 14;

/// Signed distances from the vertices of a shape to another shape.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedDistances {
    /// Distance of each point in model units: positive if the other shape lies on the side of the normal; NaN if undefined.
    pub values: Vec<f64>,
    /// Closest point of each point.
    pub closest: Vec<ClosestPoint>,
    /// Number of points whose closest point lies on the border of the other shape.
    pub n_beyond_border: usize,
    /// Number of points beyond the limit.
    pub n_too_far: usize,
}

/// Computes `‖c − x‖` with the sign of `n·(c − x)` for each point x with unit normal n and closest point c on `surface`.
///
/// The value is NaN, a hole for bands, if c lies on a border (the corresponding point may lie beyond it) or is farther than
/// `limit`. O(n log m).
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
///
/// # Panics
/// Panics if the numbers of points and normals differ.
pub fn signed_distances(
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    surface: &ClosestPointSearch,
    limit: f64,
    progress: Progress<'_>,
) -> Result<SignedDistances, Cancelled> {
    assert_eq!(points.len(), normals.len(), "one normal per point");
    let mut distances =
        SignedDistances { values: Vec::new(), closest: Vec::new(), n_beyond_border: 0, n_too_far: 0 };
    for chunk in points.chunks(VERTICES_PER_CHUNK) {
        progress.check()?;
        distances.closest.par_extend(chunk.par_iter().map(|p| surface.closest(p)));
    }
    for ((p, n), closest) in points.iter().zip(normals).zip(&distances.closest) {
        let offset = subtract(&closest.point, p);
        let (distance, side) = (norm(&offset), dot(&offset, n));
        let value = if closest.is_border {
            distances.n_beyond_border += 1;
            f64::NAN
        } else if distance > limit {
            distances.n_too_far += 1;
            f64::NAN
        } else {
            distance.copysign(side)
        };
        distances.values.push(value);
    }
    Ok(distances)
}

/// Summary statistics of a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Area-weighted root mean square length; NaN without values.
    pub rms: f64,
    /// Area-weighted mean of the first channel.
    pub mean: f64,
    /// Largest length; NaN without values.
    pub greatest: f64,
    /// Vertex with the largest length.
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
