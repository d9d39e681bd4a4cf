//! Discs that represent the points of a cloud.

use adwave::shape::{Neighborhoods, diagonal, try_nearest_neighbors};
use adwave::signal::cloud_normals;
use adwave::vector::{Vector, add_scaled, dot, unit};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of neighbors that determine the size and the direction of a disc.
const NEIGHBORS: usize = 12;

/// Radius of a disc as a multiple of the local spacing, wide enough that evenly sampled discs leave no gaps.
const OVERLAP: f64 = 0.95;

/// Largest radius as a multiple of the median radius, so that an isolated point does not hide the others.
const LARGEST: f64 = 3.0;

/// Radius of a single disc, in diagonals of the shape.
const LONE: f64 = 0.02;

/// One disc per point.
#[derive(Debug)]
pub(crate) struct Splats {
    /// Radii in model units.
    pub(crate) radii: Vec<f64>,
    /// Unit normals of either sign; zero if the neighbors determine no plane.
    pub(crate) normals: Vec<Vector>,
}

impl Splats {
    /// Computes discs as wide as the local spacing, in the tangent planes of the points' neighbors. O(n log n).
    pub(crate) fn new(points: &[Vector], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = points.len();
        let diagonal = diagonal(points);
        let lone = if diagonal > 0.0 { LONE * diagonal } else { 1.0 };
        if n <= 3 {
            return Ok(Self { radii: vec![lone; n], normals: vec![[0.0; 3]; n] });
        }
        let near = try_nearest_neighbors(points, NEIGHBORS, progress)?;
        progress.check()?;
        let own: Vec<f64> = near.radius.par_iter().map(|r| OVERLAP * r).collect();
        let mut sorted: Vec<f64> = own.iter().copied().filter(|r| *r > 0.0).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(lone).min(lone);
        // The k-th of k neighbors in a plane is about √k spacings away; a disc of one spacing is enough.
        let spread = (NEIGHBORS as f64 / std::f64::consts::PI).sqrt();
        let radii =
            own.iter().map(|r| r.clamp(median / LARGEST, median * LARGEST).min(lone * LARGEST) / spread);
        let radii = radii.collect();
        let normals = cloud_normals(points, &near);
        progress.check()?;
        let normals = smooth_normals(&normals, &near);
        progress.check()?;
        Ok(Self { radii, normals })
    }
}

/// Averages each normal over the point and its neighbors with matching signs; otherwise noise in the planes would
/// appear as glitter.
fn smooth_normals(normals: &[Vector], near: &Neighborhoods) -> Vec<Vector> {
    let mean = |x: usize| {
        let own = &normals[x];
        let add = |sum: Vector, &y: &u32| {
            let other = &normals[y as usize];
            add_scaled(&sum, if dot(own, other) < 0.0 { -1.0 } else { 1.0 }, other)
        };
        unit(&near.adjacency.row(x).iter().fold(*own, add)).unwrap_or(*own)
    };
    (0..normals.len()).into_par_iter().with_min_len(1024).map(mean).collect()
}
