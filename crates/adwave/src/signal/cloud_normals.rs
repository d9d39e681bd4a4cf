//! Normals of a point cloud, oriented alike.

use crate::parallel::{self, unstopped};
use crate::shape::{Adjacency, Neighbourhoods};
use crate::signal::Frame;
use crate::{Cancelled, Progress};
use nalgebra::{Matrix3, Vector3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{PI, TAU};

/// The angle between one neighbour and the next, seen from a point, at which it lies on the border: 180° on a straight one,
/// 90° at a corner from inside, about 60° at most within an even cloud of ten neighbours.
const BORDER_GAP: f64 = 0.75 * PI;

/// Unit normals of a cloud: of the plane that fits each point's neighbourhood best; zero where all its neighbours coincide
/// with it. O(n k log n).
///
/// Their sign is spread from neighbour to neighbour along a minimum spanning tree, where the planes differ least, from the
/// point of each connected part that lies furthest from that part's centre, whose normal points away from it: outwards on a
/// closed surface, to one side everywhere on an open one.
///
/// Source: `hoppe1992`.
///
/// # Panics
/// Unless `near` has as many neighbourhoods as there are points.
pub fn cloud_normals(points: &[[f64; 3]], near: &Neighbourhoods) -> Vec<[f64; 3]> {
    unstopped(try_cloud_normals(points, near, Progress::none()))
}

/// [`cloud_normals`], stopped when the call is.
pub(crate) fn try_cloud_normals(
    points: &[[f64; 3]],
    near: &Neighbourhoods,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut normals: Vec<Vector3<f64>> = vec![Vector3::zeros(); points.len()];
    parallel::try_for_rows(&mut normals, 1, POINTS_AT_A_TIME, progress, |first, normals| {
        for (x, normal) in (first..).zip(normals) {
            *normal = plane_normal(points, near.adjacency.of(x), x);
        }
    })?;
    let joined = near.adjacency.union_with_transpose(progress)?;
    orient(points, &joined, &mut normals, progress)?;
    Ok(normals.into_iter().map(Into::into).collect())
}

/// Normals of points that moved a little, each to the side of its old one. O(n k).
pub(crate) fn aligned_normals(
    points: &[[f64; 3]],
    neighbours: &Adjacency,
    old: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut normals = crate::pages::zeros(points.len());
    parallel::try_for_rows(
        &mut normals,
        1,
        POINTS_AT_A_TIME,
        progress,
        |first, normals: &mut [[f64; 3]]| {
            for (x, normal) in (first..).zip(normals) {
                let n = plane_normal(points, neighbours.of(x), x);
                *normal = if n.dot(&Vector3::from(old[x])) < 0.0 { -n } else { n }.into();
            }
        },
    )?;
    Ok(normals)
}

/// Points that a thread treats, or that one walk over the cloud meets, between two looks at whether to go on.
const POINTS_AT_A_TIME: usize = 1 << 10;

/// The direction in which a point and its neighbours spread least.
fn plane_normal(points: &[[f64; 3]], near: &[u32], x: usize) -> Vector3<f64> {
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

/// The points on the border of a cloud: those whose neighbours leave a gap of 135° or more in the plane that fits them best,
/// or that have none; by rising index. O(n k).
///
/// Source: the angle criterion of `bendels2006`.
pub(crate) fn cloud_border(points: &[[f64; 3]], neighbours: &Adjacency) -> Vec<usize> {
    let is_border = |x: &usize| {
        let normal = plane_normal(points, neighbours.of(*x), *x);
        if normal == Vector3::zeros() {
            return true;
        }
        let frame = Frame::new(points[*x], normal);
        let local = neighbours.of(*x).iter().map(|&y| frame.local(&points[y as usize]));
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

/// A step of the tree, the one between the most similar planes first, then by the points' order.
struct Step {
    turn: f64,
    to: u32,
    from: u32,
}

impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        other.turn.total_cmp(&self.turn).then(other.to.cmp(&self.to)).then(other.from.cmp(&self.from))
    }
}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Step {}

fn orient(
    points: &[[f64; 3]],
    near: &Adjacency,
    normals: &mut [Vector3<f64>],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut done = vec![false; points.len()];
    let (mut queue, mut n_done) = (BinaryHeap::new(), 0_usize);
    for seed in seeds(points, near, normals, progress)? {
        done[seed] = true;
        let mut x = seed;
        loop {
            for &to in near.of(x).iter().filter(|&&y| !done[y as usize]) {
                let turn = 1.0 - normals[x].dot(&normals[to as usize]).abs();
                queue.push(Step { turn, to, from: x as u32 });
            }
            let Some(step) = std::iter::from_fn(|| queue.pop()).find(|step| !done[step.to as usize]) else {
                break;
            };
            x = step.to as usize;
            done[x] = true;
            n_done += 1;
            if n_done.is_multiple_of(POINTS_AT_A_TIME) {
                progress.check()?;
            }
            if normals[x].dot(&normals[step.from as usize]) < 0.0 {
                normals[x] = -normals[x];
            }
        }
    }
    Ok(())
}

/// The point of each connected part that lies furthest from the part's centre, its normal turned away from there.
fn seeds(
    points: &[[f64; 3]],
    near: &Adjacency,
    normals: &mut [Vector3<f64>],
    progress: Progress<'_>,
) -> Result<Vec<usize>, Cancelled> {
    let mut seen = vec![false; points.len()];
    let mut seeds = Vec::new();
    for start in 0..points.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut part = vec![start as u32];
        let mut at = 0;
        while at < part.len() {
            for &y in near.of(part[at] as usize) {
                if !std::mem::replace(&mut seen[y as usize], true) {
                    part.push(y);
                }
            }
            at += 1;
            if at.is_multiple_of(POINTS_AT_A_TIME) {
                progress.check()?;
            }
        }
        let position = |x: u32| Vector3::from(points[x as usize]);
        let centre = part.iter().map(|&x| position(x) / part.len() as f64).sum::<Vector3<f64>>();
        let furthest = part.iter().copied().fold((start as u32, -1.0), |best, x| {
            let d = (position(x) - centre).norm_squared();
            if d > best.1 { (x, d) } else { best }
        });
        let seed = furthest.0 as usize;
        if normals[seed].dot(&(Vector3::from(points[seed]) - centre)) < 0.0 {
            normals[seed] = -normals[seed];
        }
        seeds.push(seed);
    }
    Ok(seeds)
}
