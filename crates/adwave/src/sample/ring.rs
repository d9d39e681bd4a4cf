//! Grids of rings that close in both directions, for the torus and the knot.

use super::implicit::V3;

/// Numbers of rings and of vertices per ring, the latter even, whose product is nearest to `n_vertices` among those
/// with a proportion near `ratio` = rings / vertices per ring.
pub(super) fn grid_shape(n_vertices: usize, ratio: f64) -> (usize, usize) {
    let ideal = (n_vertices as f64 / ratio).sqrt();
    let (low, high) = ((0.8 * ideal) as usize / 2, (1.2 * ideal) as usize / 2 + 1);
    (low.max(2)..=high.max(2))
        .map(|half| {
            let around = 2 * half;
            let rings = ((n_vertices as f64 / around as f64).round() as usize).max(3);
            (rings, around)
        })
        // The nearest count; among equals the squarest cells.
        .min_by_key(|&(rings, around)| {
            let off = ((around as f64 / ideal).ln().abs() * 1e6) as usize;
            ((rings * around).abs_diff(n_vertices), off)
        })
        .expect("the range holds at least one number")
}

/// Vertices `place(u, v)`, with u and v in turns, and triangles of a closed grid of `rings` × `around` vertices.
/// Every other line of constant v is shifted by half a step in u, so that the triangles are nearly isosceles.
/// Counter-clockwise about the direction ∂u × ∂v.
pub(super) fn closed_grid(
    rings: usize,
    around: usize,
    place: impl Fn(f64, f64) -> V3,
) -> (Vec<V3>, Vec<[u32; 3]>) {
    let index = |i: usize, j: usize| (i % rings * around + j % around) as u32;
    let mut points = Vec::with_capacity(rings * around);
    let mut triangles = Vec::with_capacity(2 * rings * around);
    for i in 0..rings {
        for j in 0..around {
            let shift = if j % 2 == 0 { 0.0 } else { 0.5 };
            points.push(place((i as f64 + shift) / rings as f64, j as f64 / around as f64));
            let (a, b, c, d) = (index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
            if j % 2 == 0 {
                triangles.extend([[a, b, d], [b, c, d]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (points, triangles)
}
