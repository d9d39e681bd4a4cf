//! Directions of the largest curvature.

use crate::parallel;
use crate::shape::Adjacency;
use crate::vector::{Vector, dot, norm, subtract};
use crate::{Cancelled, Progress};
use nalgebra::{Matrix3, Vector3};

/// Smallest pivot, relative to the largest, of neighbors that determine the change of the normals in all directions.
const SINGULAR: f64 = 1e-10;

/// For each vertex the unit direction of the larger principal curvature times the difference κ₁ − κ₂ of both, in 1/unit
/// of `points`: 0 where all directions curve alike, or where neighbors lie on one line. It is a line: v and −v mean the
/// same, and the first coordinate that is not 0 is positive. O(edges).
///
/// The shape operator S is the symmetric matrix that fits the changes of the unit `normals` to the `neighbors` best,
/// `Σ_y |S d_y − Δn_y|²`, both in the tangent plane.
pub(super) fn principal_directions(
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    neighbors: &Adjacency,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    parallel::try_collect(points.len(), progress, |x| {
        direction_at(points, normals, neighbors.row(x), x).unwrap_or_default()
    })
}

fn direction_at(points: &[[f64; 3]], normals: &[[f64; 3]], around: &[u32], x: usize) -> Option<Vector> {
    let normal = Vector3::from(normals[x]);
    let smallest = Vector3::ith(normal.iamin(), 1.0);
    let first = (smallest - normal * normal.dot(&smallest)).try_normalize(0.0)?;
    let second = normal.cross(&first);
    let (first, second): (Vector, Vector) = (first.into(), second.into());
    let size = around.iter().map(|&y| norm(&subtract(&points[y as usize], &points[x]))).fold(0.0, f64::max);
    if size == 0.0 || norm(&normals[x]) == 0.0 {
        return None;
    }
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &y in around {
        let d = subtract(&points[y as usize], &points[x]).map(|c| c / size);
        // A normal on the other side of a cloud or a crease says nothing of the bend.
        if dot(&normals[y as usize], &normals[x]) <= 0.0 {
            continue;
        }
        let change = subtract(&normals[y as usize], &normals[x]);
        let (u, v) = (dot(&d, &first), dot(&d, &second));
        for (row, value) in [
            (Vector3::new(u, v, 0.0), dot(&change, &first)),
            (Vector3::new(0.0, u, v), dot(&change, &second)),
        ] {
            matrix += row * row.transpose();
            right += value * row;
        }
    }
    let largest = matrix.diagonal().max();
    let factor = matrix.cholesky()?;
    let smallest = factor.l_dirty().diagonal().min();
    if smallest * smallest <= SINGULAR * largest {
        return None;
    }
    let [a, b, c]: [f64; 3] = factor.solve(&right).into();
    // The line e^(2iθ) with half of the difference of the eigenvalues as its length.
    let (half, angle) = ((0.5 * (a - c)).hypot(b), 0.5 * b.atan2(0.5 * (a - c)));
    let length = 2.0 * half / size;
    let (sin, cos) = angle.sin_cos();
    let v = [0, 1, 2].map(|k| length * (cos * first[k] + sin * second[k]));
    let leading = v.iter().find(|c| **c != 0.0)?;
    Some(if *leading < 0.0 { v.map(|c| -c) } else { v })
}
