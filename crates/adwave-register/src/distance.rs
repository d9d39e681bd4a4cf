//! How far one shape lies from another, with a sign.

use crate::{Closest, Surface};
use adwave::vector::{dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Vertices between two looks at whether to stop.
const VERTICES_AT_A_TIME: usize = 1 << 14;

/// Distances from the vertices of a shape to another.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedDistances {
    /// One for each point: > 0 where the other shape lies on the side that the normal points to; NaN where there is none.
    pub values: Vec<f64>,
    /// The closest points.
    pub closest: Vec<Closest>,
    /// Points whose closest lies on the border of the other shape.
    pub n_beyond_border: usize,
    /// Points farther than the limit.
    pub n_too_far: usize,
}

/// `‖c − x‖` with the sign of `n·(c − x)` for each point x with unit normal n, c the closest point of `surface`. NaN, which bands take as a
/// hole, where c lies on a border (what x corresponds to lies beyond it) or farther than `limit`. O(n log m).
///
/// # Errors
/// [`Cancelled`].
///
/// # Panics
/// Unless there is a normal for each point.
pub fn signed_distances(
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    surface: &Surface,
    limit: f64,
    progress: Progress<'_>,
) -> Result<SignedDistances, Cancelled> {
    assert_eq!(points.len(), normals.len(), "a normal for each point");
    let mut found =
        SignedDistances { values: Vec::new(), closest: Vec::new(), n_beyond_border: 0, n_too_far: 0 };
    for chunk in points.chunks(VERTICES_AT_A_TIME) {
        progress.check()?;
        found.closest.par_extend(chunk.par_iter().map(|p| surface.closest(p)));
    }
    for ((p, n), closest) in points.iter().zip(normals).zip(&found.closest) {
        let away = subtract(&closest.point, p);
        let (distance, side) = (norm(&away), dot(&away, n));
        let value = if closest.is_border {
            found.n_beyond_border += 1;
            f64::NAN
        } else if distance > limit {
            found.n_too_far += 1;
            f64::NAN
        } else {
            distance.copysign(side)
        };
        found.values.push(value);
    }
    Ok(found)
}

/// A difference in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Root of the mean square length by area; NaN where nothing has a value.
    pub rms: f64,
    /// Mean of the first channel by area.
    pub mean: f64,
    /// Greatest length; NaN where nothing has a value.
    pub greatest: f64,
    /// Where that is.
    pub vertex: usize,
}

impl Summary {
    /// Of vectors or numbers at vertices, `n_channels` each; those with a NaN count for nothing. O(n).
    ///
    /// ```
    /// use adwave_register::Summary;
    /// let found = Summary::new(&[1.0, f64::NAN, -3.0], 1, &[3.0, 9.0, 1.0]);
    /// assert_eq!((found.rms, found.mean, found.greatest, found.vertex), (3.0_f64.sqrt(), 0.0, 3.0, 2));
    /// ```
    ///
    /// # Panics
    /// Unless there is an area for each vertex.
    pub fn new(values: &[f64], n_channels: usize, areas: &[f64]) -> Self {
        assert_eq!(values.len(), n_channels * areas.len(), "an area for each vertex");
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
