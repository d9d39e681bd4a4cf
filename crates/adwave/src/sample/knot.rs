//! A tube around a torus knot.

use super::implicit::V3;
use super::ring::{closed_grid, grid_shape};
use std::f64::consts::TAU;

/// Number of turns of the knot around the axis.
const TURNS: f64 = 2.0;
/// Number of windings of the knot around the torus.
const WINDINGS: f64 = 3.0;
/// Radii of the torus that contains the knot, model units.
const MAJOR_RADIUS: f64 = 0.7;
const MINOR_RADIUS: f64 = 0.3;
/// Radius of the tube, model units; less than half the distance of two strands.
pub(super) const TUBE_RADIUS: f64 = 0.18;
/// Smallest number of vertices: with fewer than 24 rings of 4 the strands would intersect.
pub(super) const MIN_VERTICES: usize = 96;
/// Height of a row of equilateral triangles relative to their side: √3/2.
const ROW_HEIGHT: f64 = 0.866;
/// Number of pieces for the length of the curve; the midpoint rule on a closed smooth curve is exact to rounding
/// with far fewer.
const LENGTH_PIECES: usize = 4096;

/// Point of the curve and its derivative by u, where u runs once through the knot in [0, 1].
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

/// Length of the knot, model units. By Pappus the area of the tube is 2π·[`TUBE_RADIUS`] times the length, and its
/// volume π·radius² times the length.
pub(super) fn length() -> f64 {
    let n = LENGTH_PIECES as f64;
    (0..LENGTH_PIECES).map(|i| curve((i as f64 + 0.5) / n)[1].norm() / n).sum()
}

/// Builds circles in the normal planes of the curve, from a rotation-minimizing frame; the angle missing to close
/// it after one round is spread evenly, so that the triangles are sheared as little as possible.
pub(super) fn knot(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let ratio = length() / (TAU * TUBE_RADIUS) * ROW_HEIGHT;
    let (rings, around) = grid_shape(n_vertices, ratio);
    // The grid needs whole and half steps.
    let n_steps = 2 * rings;
    let normals = least_turning_normals(n_steps);
    closed_grid(rings, around, |u, v| {
        let step = (u * n_steps as f64).round() as usize % n_steps;
        let [point, derivative] = curve(step as f64 / n_steps as f64);
        let normal = normals[step];
        let binormal = derivative.normalize().cross(&normal);
        // ∂u × ∂v points outwards if v turns this way.
        let (sin, cos) = (TAU * v).sin_cos();
        point + (normal * cos - binormal * sin) * TUBE_RADIUS
    })
}

/// Unit normals at `n_steps` even steps of u, by double reflection from each frame to the next (`wang2008`).
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
