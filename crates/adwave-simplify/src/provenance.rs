//! Corners and faces of the original that the corners and triangles of the result continue.

use crate::geometry::{center, doubled_normal, length};
use crate::surface::{TriangleSearch, TriangleSurface};
use crate::wedges::Wedges;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Finds, for each corner of the triangles, the corner of the original at the same wedge whose face has the most
/// similar orientation. At a vertex with several normals this corner is on the correct side of the crease. O(corners).
pub(crate) fn corners(wedges: &Wedges, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut starts = vec![0_u32; wedges.points.len() + 1];
    for &wedge in wedges.triangles.as_flattened() {
        starts[wedge as usize + 1] += 1;
    }
    for k in 1..starts.len() {
        starts[k] += starts[k - 1];
    }
    let mut next = starts.clone();
    let mut at_wedge = vec![(0_u32, 0_u32); wedges.triangles.len() * 3];
    for (t, (triangle, corners)) in wedges.triangles.iter().zip(&wedges.corners).enumerate() {
        for (&wedge, &corner) in triangle.iter().zip(corners) {
            at_wedge[next[wedge as usize] as usize] = (t as u32, corner);
            next[wedge as usize] += 1;
        }
    }
    let normal = |triangle: [u32; 3]| {
        let n = doubled_normal(triangle.map(|w| wedges.points[w as usize]));
        let norm = length(n).max(f64::MIN_POSITIVE);
        n.map(|x| x / norm)
    };
    let best = |facing: &[f64; 3], wedge: u32| {
        let range = starts[wedge as usize] as usize..starts[wedge as usize + 1] as usize;
        let similarity = |t: u32| -> f64 {
            normal(wedges.triangles[t as usize]).iter().zip(facing).map(|(a, b)| a * b).sum()
        };
        let first = at_wedge[range.start];
        at_wedge[range]
            .iter()
            .fold((first.1, f64::NEG_INFINITY), |best, &(t, corner)| {
                let value = similarity(t);
                if value > best.1 { (corner, value) } else { best }
            })
            .0
    };
    let match_corners = |triangle: &[u32; 3]| {
        let facing = normal(*triangle);
        triangle.map(|wedge| best(&facing, wedge))
    };
    triangles.par_iter().map(match_corners).collect()
}

/// Finds the triangle of the original nearest to the center of each triangle. If that one is beyond a seam, the result
/// is the triangle in `origins`, from which the triangle was made. O(triangles log triangles).
pub(crate) fn nearest_triangles(
    wedges: &Wedges,
    triangles: &[[u32; 3]],
    origins: &[u32],
    charts: &[u32],
    original: &TriangleSurface,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let nearest = |(triangle, &origin): (&[u32; 3], &u32)| {
        progress.check()?;
        let middle = center(&triangle.map(|w| wedges.points[w as usize]));
        let near = original.nearest_from(middle, origin).1;
        Ok(if charts[near as usize] == charts[origin as usize] { near } else { origin })
    };
    triangles.par_iter().zip(origins).map(nearest).collect()
}
