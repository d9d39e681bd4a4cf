//! Gaussian noise along vertex normals, and points drawn from a surface; both with a seed.

use super::{Sample, SampleError};
use crate::shape::MAX_COORDINATE;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Standard deviation of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoiseSigma {
    /// Standard deviation in model units.
    Model(f64),
    /// Standard deviation as a multiple of the mean length of the mesh's distinct edges, as in figure 10 of the paper.
    MeanEdge(f64),
}

/// Bound of the normal deviates of 64-bit random numbers.
const LARGEST_DEVIATE: f64 = 100.0;

/// Moves every point along its normal by a normal deviate: p ← p + σ·g·n with g ~ N(0, 1), one g per point.
///
/// `sigma` is in model units and `normals` have unit length. The same seed gives the same noise. O(points).
///
/// ```
/// let mut points = vec![[0.0, 0.0, 0.0]; 2];
/// adwave::sample::add_noise(&mut points, &[[0.0, 0.0, 1.0]; 2], 0.1, 7)?;
/// assert_eq!((points[0][0], points[0][1]), (0.0, 0.0));
/// assert!(points[0][2] != points[1][2] && points[0][2].abs() < 1.0);
/// # Ok::<(), adwave::sample::SampleError>(())
/// ```
///
/// # Errors
/// [`SampleError::NormalsMismatch`] if the slices have different lengths, [`SampleError::BadSigma`] if `sigma` is
/// negative, infinite or NaN.
pub fn add_noise(
    points: &mut [[f64; 3]],
    normals: &[[f64; 3]],
    sigma: f64,
    seed: u64,
) -> Result<(), SampleError> {
    if points.len() != normals.len() {
        return Err(SampleError::NormalsMismatch { n_points: points.len(), n_normals: normals.len() });
    }
    check_sigma(sigma)?;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for (point, normal) in points.iter_mut().zip(normals) {
        let deviate: f64 = StandardNormal.sample(&mut random);
        for (x, n) in point.iter_mut().zip(normal) {
            *x += sigma * deviate * n;
        }
    }
    Ok(())
}

/// Refuses a standard deviation that is negative, NaN, or so large that a value may exceed the largest coordinate.
pub(super) fn check_sigma(sigma: f64) -> Result<(), SampleError> {
    if (0.0..=MAX_COORDINATE / LARGEST_DEVIATE).contains(&sigma) {
        Ok(())
    } else {
        Err(SampleError::BadSigma { sigma })
    }
}

/// Draws `n_points` points uniformly by area from the faces of `sample`, with the unit normals of their faces: the
/// face by inversion of the cumulative area, then uniform barycentric coordinates.
pub(super) fn draw_cloud(sample: &Sample, n_points: usize, seed: u64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let mut running = Vec::with_capacity(sample.faces.len());
    let mut total = 0.0;
    for face in sample.faces.iter() {
        total += 0.5 * sample.area_normal(face).norm();
        running.push(total);
    }
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    // 53 random bits give a double in [0, 1).
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..n_points)
        .map(|_| {
            let wanted = uniform() * total;
            let face = running.partition_point(|&area| area <= wanted).min(running.len() - 1);
            let corners = sample.faces.get(face);
            let [a, b, c] = [0, 1, 2].map(|k| sample.corner(corners[k]));
            let (root, v) = (uniform().sqrt(), uniform());
            let p = a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v);
            (<[f64; 3]>::from(p), <[f64; 3]>::from(sample.area_normal(corners).normalize()))
        })
        .unzip()
}
