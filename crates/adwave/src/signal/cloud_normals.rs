//! Consistently oriented normals of a point cloud.

use crate::parallel::{self, expect_not_cancelled};
use crate::shape::orientation::orient;
use crate::shape::{Adjacency, Neighborhoods, try_nearest_neighbors};
use crate::signal::TangentFrame;
use crate::{Cancelled, Progress};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Angle between successive neighbors, seen from a point, beyond which it lies on the border: 180° on a straight
/// border, 90° at a corner from inside, about 60° at most within an even cloud of ten neighbors.
const BORDER_GAP: f64 = 0.75 * PI;

/// Number of nearest neighbors of the planes of [`normals_facing`]: enough for noise as large as the points are apart.
const FACING_NEIGHBORS: usize = 48;

/// Cosine between a normal and the line of sight up to which the side is open: noise may turn the plane over.
const GRAZING: f64 = 0.2;

/// Unit normals of a cloud: those of the plane that fits each point's neighborhood best; zero if all its neighbors
/// coincide with it. O(n k log n).
///
/// Their sign is propagated between neighbors along a minimum spanning tree, by reflecting one normal in the plane
/// half-way to the other point. On a circle through both points this gives the other normal, whether they are side
/// by side or on opposite sides of a thin part, where comparing directions would turn it inside out. Then each
/// connected part is oriented outwards by the volume that its discs enclose. A sheet that encloses none, such as a
/// terrain, is oriented so that the mean of its normals points along the positive side of their dominant axis.
///
/// Source: `hoppe1992` for the tree, `xie2003` for the reflection.
///
/// # Panics
/// Unless `near` has one neighborhood per point.
pub fn cloud_normals(points: &[[f64; 3]], near: &Neighborhoods) -> Vec<[f64; 3]> {
    expect_not_cancelled(try_cloud_normals(points, near, Progress::none()))
}

/// [`cloud_normals`]; stops if the call is cancelled.
pub(crate) fn try_cloud_normals(
    points: &[[f64; 3]],
    near: &Neighborhoods,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut normals: Vec<Vector3<f64>> = vec![Vector3::zeros(); points.len()];
    parallel::try_visit_rows(&mut normals, 1, POINTS_AT_A_TIME, progress, |first, normals| {
        for (x, normal) in (first..).zip(normals) {
            *normal = plane_normal(points, near.adjacency.row(x), x);
        }
    })?;
    let joined = near.adjacency.union_with_transpose(progress)?;
    orient(points, &joined, &near.radius, &mut normals, progress)?;
    Ok(normals.into_iter().map(Into::into).collect())
}

/// Unit normals of the planes that fit each point and its `neighbors` best, on either side; zero if they all
/// coincide with it. O(n k).
///
/// ```
/// use adwave::{Progress, rows::Pattern, signal::plane_normals};
/// let neighbors = Pattern::new(vec![0, 2, 2, 2], vec![1, 2], 3)?;
/// let normals = plane_normals(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &neighbors, Progress::none())?;
/// assert!((normals[0][2].abs() - 1.0).abs() < 1e-12 && normals[1] == [0.0; 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless there is one row of neighbors per point.
pub fn plane_normals(
    points: &[[f64; 3]],
    neighbors: &Adjacency,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    assert_eq!(neighbors.n_rows(), points.len(), "a row of neighbors for each point");
    each_plane_normal(points, neighbors, |_, n| n, progress)
}

/// Unit normals of the planes that fit each point and its nearest neighbors best, on the side of the viewpoint from which
/// the point was seen. The neighbors are points that were seen from the same place, so that those on the other side of a
/// thin wall have no part in the plane. Zero where the plane is seen at a grazing angle, or without enough neighbors.
/// Points of the two sides of a wall have opposite normals then, which keep the sides of a cloud apart
/// ([`PointCloud::with_sides`](crate::shape::PointCloud::with_sides)). O(n log n).
///
/// ```
/// use adwave::{Progress, signal::normals_facing};
/// let side = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z], [1.0, 1.0, z]];
/// let wall = [side(0.0), side(0.1)].concat();
/// let seen_from = [[[0.5, 0.5, -9.0]; 4], [[0.5, 0.5, 9.0]; 4]].concat();
/// let normals = normals_facing(&wall, &seen_from, Progress::none())?;
/// assert!(normals[..4].iter().all(|n| n[2] < -0.9) && normals[4..].iter().all(|n| n[2] > 0.9));
/// # Ok::<(), adwave::Cancelled>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless there is a viewpoint for each point.
pub fn normals_facing(
    points: &[[f64; 3]],
    viewpoints: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    assert_eq!(viewpoints.len(), points.len(), "a viewpoint for each point");
    let mut seen_from: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
    for (x, place) in viewpoints.iter().enumerate() {
        seen_from.entry(place.map(f64::to_bits)).or_default().push(x);
    }
    let mut normals = vec![[0.0; 3]; points.len()];
    for (place, seen) in seen_from {
        let place = Vector3::from(place.map(f64::from_bits));
        let own: Vec<[f64; 3]> = seen.iter().map(|&x| points[x]).collect();
        let near = try_nearest_neighbors(&own, FACING_NEIGHBORS, progress)?;
        let facing = |i: usize, n: Vector3<f64>| {
            let sight = place - Vector3::from(own[i]);
            let along = n.dot(&sight);
            if along.abs() <= GRAZING * sight.norm() { Vector3::zeros() } else { n * along.signum() }
        };
        let found = each_plane_normal(&own, &near.adjacency, facing, progress)?;
        for (x, normal) in seen.into_iter().zip(found) {
            normals[x] = normal;
        }
    }
    Ok(normals)
}

/// Normals of points that moved slightly, each on the side of its old one. O(n k).
pub(crate) fn aligned_normals(
    points: &[[f64; 3]],
    neighbors: &Adjacency,
    old: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let aligned = |x: usize, n: Vector3<f64>| if n.dot(&Vector3::from(old[x])) < 0.0 { -n } else { n };
    each_plane_normal(points, neighbors, aligned, progress)
}

/// Applies `made` to the normal of each point.
fn each_plane_normal(
    points: &[[f64; 3]],
    neighbors: &Adjacency,
    made: impl Fn(usize, Vector3<f64>) -> Vector3<f64> + Sync + Send,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut normals = crate::pages::zeros(points.len());
    parallel::try_visit_rows(
        &mut normals,
        1,
        POINTS_AT_A_TIME,
        progress,
        |first, normals: &mut [[f64; 3]]| {
            for (x, normal) in (first..).zip(normals) {
                *normal = made(x, plane_normal(points, neighbors.row(x), x)).into();
            }
        },
    )?;
    Ok(normals)
}

/// Number of points that a thread processes, or that a traversal of the cloud visits, between two checks for
/// cancellation.
pub(super) const POINTS_AT_A_TIME: usize = 1 << 10;

/// Direction in which a point and its neighbors spread least.
pub(super) fn plane_normal(points: &[[f64; 3]], near: &[u32], x: usize) -> Vector3<f64> {
    let origin = Vector3::from(points[x]);
    let offsets = near.iter().map(|&y| Vector3::from(points[y as usize]) - origin);
    let size = offsets.clone().map(|d| d.amax()).fold(0.0, f64::max);
    if size == 0.0 {
        return Vector3::zeros();
    }
    let mean = offsets.clone().sum::<Vector3<f64>>() / (near.len() as f64 + 1.0);
    let spread = |m: Matrix3<f64>, d: Vector3<f64>| {
        let d = (d - mean) / size;
        m + d * d.transpose()
    };
    let covariance = offsets.fold(spread(Matrix3::zeros(), Vector3::zeros()), spread);
    let eigen = covariance.symmetric_eigen();
    eigen.eigenvectors.column(eigen.eigenvalues.imin()).normalize()
}

/// Points on the border of a cloud, in ascending order: those whose neighbors leave a gap of 135° or more in their
/// best-fitting plane, or that have none. O(n k).
///
/// Source: the angle criterion of `bendels2006`.
pub(crate) fn cloud_border(points: &[[f64; 3]], neighbors: &Adjacency) -> Vec<usize> {
    let is_border = |x: &usize| {
        let normal = plane_normal(points, neighbors.row(*x), *x);
        if normal == Vector3::zeros() {
            return true;
        }
        let frame = TangentFrame::new(points[*x], normal);
        let local = neighbors.row(*x).iter().map(|&y| frame.local(&points[y as usize]));
        let mut angles: Vec<f64> = local.map(|p| p.y.atan2(p.x)).collect();
        angles.sort_unstable_by(f64::total_cmp);
        let round = angles[0] + TAU - angles[angles.len() - 1];
        angles.windows(2).map(|pair| pair[1] - pair[0]).fold(round, f64::max) > BORDER_GAP
    };
    let chunks = parallel::map_chunks(points.len(), POINTS_AT_A_TIME, |range| {
        range.filter(is_border).collect::<Vec<usize>>()
    });
    chunks.into_iter().flatten().collect()
}
