//! A tube round a torus knot.

use super::implicit::V3;
use super::ring::{closed_grid, grid_shape};
use std::f64::consts::TAU;

/// The knot winds this often round the axis …
const TURNS: f64 = 2.0;
/// … while it winds this often round the torus.
const WINDINGS: f64 = 3.0;
/// Radii of the torus that the knot lies on, model units.
const MAJOR_RADIUS: f64 = 0.7;
const MINOR_RADIUS: f64 = 0.3;
/// Radius of the tube, model units; less than half the distance of two strands.
pub(super) const TUBE_RADIUS: f64 = 0.18;
/// Below 24 rings of 4 the strands would cut each other.
pub(super) const MIN_VERTICES: usize = 96;
/// Rows of equilateral triangles are √3/2 as high as wide.
const ROW_HEIGHT: f64 = 0.866;
/// Pieces for the length of the curve; the midpoint rule on a closed smooth curve is exact to rounding long before.
const LENGTH_PIECES: usize = 4096;

/// The curve's point and its derivatives by u, where u runs once through the knot in [0, 1].
fn curve(u: f64) -> [V3; 3] {
    let (a, b) = (TAU * TURNS, TAU * WINDINGS);
    let ((sa, ca), (sb, cb)) = ((a * u).sin_cos(), (b * u).sin_cos());
    let out = MAJOR_RADIUS + MINOR_RADIUS * cb;
    let (out1, out2) = (-MINOR_RADIUS * b * sb, -MINOR_RADIUS * b * b * cb);
    [
        V3::new(out * ca, out * sa, MINOR_RADIUS * sb),
        V3::new(out1 * ca - out * a * sa, out1 * sa + out * a * ca, MINOR_RADIUS * b * cb),
        V3::new(
            out2 * ca - 2.0 * out1 * a * sa - out * a * a * ca,
            out2 * sa + 2.0 * out1 * a * ca - out * a * a * sa,
            -MINOR_RADIUS * b * b * sb,
        ),
    ]
}

/// Length of the knot, model units. The tube's area is 2π·[`TUBE_RADIUS`] times it, its volume π·radius² times it
/// (Pappus).
pub(super) fn length() -> f64 {
    let n = LENGTH_PIECES as f64;
    (0..LENGTH_PIECES).map(|i| curve((i as f64 + 0.5) / n)[1].norm() / n).sum()
}

/// Circles in the normal planes of the curve, counted from its principal normal, which turns smoothly with it
/// because the curvature of a torus knot of these radii never vanishes.
pub(super) fn knot(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let ratio = length() / (TAU * TUBE_RADIUS) * ROW_HEIGHT;
    let (rings, around) = grid_shape(n_vertices, ratio);
    closed_grid(rings, around, |u, v| {
        let [point, first, second] = curve(u);
        let tangent = first.normalize();
        let normal = (second - tangent * second.dot(&tangent)).normalize();
        let binormal = tangent.cross(&normal);
        // ∂u × ∂v = tangent × (direction of growing v) points outwards when v turns this way.
        let (sin, cos) = (TAU * v).sin_cos();
        point + (normal * cos - binormal * sin) * TUBE_RADIUS
    })
}
