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

/// The curve's point and its derivative by u, where u runs once through the knot in [0, 1].
fn curve(u: f64) -> [V3; 2] {
    let (a, b) = (TAU * TURNS, TAU * WINDINGS);
    let ((sa, ca), (sb, cb)) = ((a * u).sin_cos(), (b * u).sin_cos());
    let out = MAJOR_RADIUS + MINOR_RADIUS * cb;
    let turn = -MINOR_RADIUS * b * sb;
    [
        V3::new(out * ca, out * sa, MINOR_RADIUS * sb),
        V3::new(turn * ca - out * a * sa, turn * sa + out * a * ca, MINOR_RADIUS * b * cb),
    ]
}

/// Length of the knot, model units. The tube's area is 2π·[`TUBE_RADIUS`] times it, its volume π·radius² times it
/// (Pappus).
pub(super) fn length() -> f64 {
    let n = LENGTH_PIECES as f64;
    (0..LENGTH_PIECES).map(|i| curve((i as f64 + 0.5) / n)[1].norm() / n).sum()
}

/// Circles in the normal planes of the curve, from a frame that turns as little as possible along it; what is missing
/// to close it after one round is spread evenly, so that the triangles are sheared as little as can be.
pub(super) fn knot(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let ratio = length() / (TAU * TUBE_RADIUS) * ROW_HEIGHT;
    let (rings, around) = grid_shape(n_vertices, ratio);
    // The grid asks for whole and half steps.
    let n_steps = 2 * rings;
    let normals = least_turning_normals(n_steps);
    closed_grid(rings, around, |u, v| {
        let step = (u * n_steps as f64).round() as usize % n_steps;
        let [point, derivative] = curve(step as f64 / n_steps as f64);
        let normal = normals[step];
        let binormal = derivative.normalize().cross(&normal);
        // ∂u × ∂v points outwards when v turns this way.
        let (sin, cos) = (TAU * v).sin_cos();
        point + (normal * cos - binormal * sin) * TUBE_RADIUS
    })
}

/// Unit normals at `n_steps` even steps of u (`wang2008`: two reflections take each frame to the next).
fn least_turning_normals(n_steps: usize) -> Vec<V3> {
    let mut normals = Vec::with_capacity(n_steps + 1);
    let [mut point, derivative] = curve(0.0);
    let mut tangent = derivative.normalize();
    let mut normal = tangent.cross(&V3::z()).normalize();
    normals.push(normal);
    for i in 1..=n_steps {
        let [next, derivative] = curve(i as f64 / n_steps as f64);
        let next_tangent = derivative.normalize();
        let chord = next - point;
        let reflect = |w: V3, axis: V3| w - axis * (2.0 * w.dot(&axis) / axis.norm_squared());
        let across = next_tangent - reflect(tangent, chord);
        normal = reflect(reflect(normal, chord), across);
        normals.push(normal);
        (point, tangent) = (next, next_tangent);
    }
    let last = normals.pop().expect("a frame at the end");
    let missing = last.cross(&normals[0]).dot(&tangent).atan2(last.dot(&normals[0]));
    for (i, normal) in normals.iter_mut().enumerate() {
        let (sin, cos) = (missing * i as f64 / n_steps as f64).sin_cos();
        let tangent = curve(i as f64 / n_steps as f64)[1].normalize();
        *normal = *normal * cos + tangent.cross(normal) * sin;
    }
    normals
}
