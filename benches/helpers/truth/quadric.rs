//! Least error of quadrics over one number of neighbors.

use super::closest::Tree;
use super::exact::ExactCloud;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use rayon::prelude::*;

/// Least root mean square distance from the surface, in model units, of points that quadrics move, over the sizes of
/// neighborhoods: **the truth chooses** one size for the whole cloud. The quadrics are unweighted least-squares fits
/// over the nearest noisy points, the point itself among them.
pub fn best_quadric_error(cloud: &ExactCloud, noisy: &[[f64; 3]], sizes: &[usize]) -> f64 {
    let tree = Tree::new(noisy);
    let most = sizes.iter().copied().max().unwrap_or(0);
    let squares = |(x, p): (usize, &[f64; 3])| -> Vec<f64> {
        let near: Vec<Vector3<f64>> =
            tree.nearest(p, most).iter().map(|&y| Vector3::from(noisy[y as usize])).collect();
        let square = |&size: &usize| {
            let moved = projection_to_quadric(&near[..size.min(near.len())], &Vector3::from(*p));
            cloud.distance(x, &moved.into()).powi(2)
        };
        sizes.iter().map(square).collect()
    };
    let squares: Vec<Vec<f64>> = noisy.par_iter().enumerate().map(squares).collect();
    let mean = |k: usize| squares.iter().map(|of_sizes| of_sizes[k]).sum::<f64>() / noisy.len() as f64;
    (0..sizes.len()).map(mean).fold(f64::INFINITY, f64::min).sqrt()
}

/// Point moved along the normal of the best plane through points to their quadric above that plane; the point itself if
/// the points determine no quadric.
fn projection_to_quadric(points: &[Vector3<f64>], p: &Vector3<f64>) -> Vector3<f64> {
    let center = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let spread: Matrix3<f64> = points.iter().map(|q| (q - center) * (q - center).transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let [u, v] = [1, 2].map(|k| eigen.eigenvectors.column((eigen.eigenvalues.imin() + k) % 3));
    let size = (spread.trace() / points.len() as f64).sqrt();
    let monomials = |q: &Vector3<f64>| {
        let (x, y) = (u.dot(&(q - center)) / size, v.dot(&(q - center)) / size);
        Vector6::new(1.0, x, y, x * x, x * y, y * y)
    };
    let (mut matrix, mut right) = (Matrix6::zeros(), Vector6::zeros());
    for q in points {
        let m = monomials(q);
        matrix += m * m.transpose();
        right += m * normal.dot(&(q - center));
    }
    let Some(factor) = matrix.cholesky() else { return *p };
    p + normal * (factor.solve(&right).dot(&monomials(p)) - normal.dot(&(p - center)))
}

#[cfg(test)]
mod tests {
    use super::super::{CloudNoise, ExactShape, Sampling};
    use super::*;

    #[test]
    fn a_quadric_keeps_a_saddle_and_reduces_noise_by_its_degrees_of_freedom() {
        let saddle = ExactCloud::new(ExactShape::Saddle, Sampling::Even, 2000, 4);
        let points = &saddle.clean.points;
        assert!(best_quadric_error(&saddle, points, &[15]) < 0.01 * saddle.clean.spacing);
        let plane = ExactCloud::new(ExactShape::Plane, Sampling::Even, 2000, 4);
        let noisy = CloudNoise::Normal(0.2).apply(&plane.clean, 1).points;
        // In the middle of a disk, a quadric has four times the variance of a mean, and more at the border.
        let left = best_quadric_error(&plane, &noisy, &[15, 60]) / plane.noise(&noisy);
        let least = (4.0_f64 / 60.0).sqrt();
        assert!((0.9 * least..1.4 * least).contains(&left), "{left}");
    }
}
