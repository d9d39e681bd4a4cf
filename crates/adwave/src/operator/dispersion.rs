//! Dispersion of heat on a sphere: how far the mesh's Laplacian is from the sphere's on short waves.
//!
//! Along a wave of the tangent direction e with `−Δf = λf`, Taylor's formula gives
//! `(M⁻¹Lf)(x) = (λ − q_x(e)λ² + …)f(x)`, `q_x(e) = Σ_y w(x,y)((y − x)·e)⁴/(24·M(x))`, so that short waves decay too
//! slowly. On equilateral triangles q is h²/16 in all directions; on squares it is between h²/24 and h²/12, with the mean
//! h²/16.

use std::f64::consts::PI;

use crate::rows::CompressedRows;
use crate::vector::{add_scaled, cross, dot, subtract, unit};
use crate::{Cancelled, Progress, parallel};

/// Directions in half a turn along which q is taken. A quartic form has waves of two and four periods a turn only, so
/// its mean over these is exact.
const N_DIRECTIONS: usize = 8;

/// Share of the places that do not limit the correction: corners at which three or five cells meet, and borders.
const EXCEPTIONS: f64 = 0.01;

/// Mean of q over all directions and places, in squares of the unit of `points`, or twice the smallest q if that is
/// less: `λ + κλ²` is then nowhere farther from the sphere's eigenvalue than `λ`. `points` lie on a sphere about the
/// origin. O(entries).
pub(super) fn mean_dispersion(
    points: &[[f64; 3]],
    weights: &CompressedRows<f64>,
    mass: &[f64],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let of_place = parallel::try_collect(points.len(), progress, |x| {
        let (columns, weights) = weights.row(x);
        if columns.is_empty() || mass[x] <= 0.0 {
            return None;
        }
        let frame = tangent_frame(&points[x])?;
        let mut along = [0.0; N_DIRECTIONS];
        for (&y, w) in columns.iter().zip(weights) {
            let edge = subtract(&points[y as usize], &points[x]);
            let [u, v] = frame.map(|axis| dot(&axis, &edge));
            for (k, sum) in along.iter_mut().enumerate() {
                let (sine, cosine) = (PI * k as f64 / N_DIRECTIONS as f64).sin_cos();
                *sum += w * (cosine * u + sine * v).powi(4);
            }
        }
        let q = along.map(|sum| sum / (24.0 * mass[x]));
        let mean = q.iter().sum::<f64>() / N_DIRECTIONS as f64;
        Some((mean, q.into_iter().fold(f64::INFINITY, f64::min)))
    })?;
    let known = || of_place.iter().flatten();
    let mut least: Vec<f64> = known().map(|(_, least)| *least).collect();
    if least.is_empty() {
        return Ok(0.0);
    }
    let total = parallel::try_sum(points.len(), progress, |x| of_place[x].map_or(0.0, |_| mass[x]))?;
    let mean =
        parallel::try_sum(points.len(), progress, |x| of_place[x].map_or(0.0, |(mean, _)| mass[x] * mean))?;
    let exceptions = (EXCEPTIONS * least.len() as f64) as usize;
    let (_, least, _) = least.select_nth_unstable_by(exceptions, f64::total_cmp);
    let kappa = (mean / total).min(2.0 * *least);
    Ok(if kappa.is_finite() { kappa.max(0.0) } else { 0.0 })
}

/// Two unit vectors at right angles to a point's direction from the origin, and to each other.
fn tangent_frame(point: &[f64; 3]) -> Option<[[f64; 3]; 2]> {
    let up = unit(point)?;
    let steep = (0..3).min_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs()))?;
    let mut axis = [0.0; 3];
    axis[steep] = 1.0;
    let first = unit(&add_scaled(&axis, -dot(&axis, &up), &up))?;
    Some([first, cross(&up, &first)])
}
