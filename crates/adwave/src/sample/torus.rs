//! The torus around the z axis.

use super::implicit::V3;
use super::ring::{closed_grid, grid_shape};
use std::f64::consts::TAU;

/// Distance of the tube's middle from the axis, model units.
pub(super) const MAJOR_RADIUS: f64 = 1.0;
/// Radius of the tube, model units.
pub(super) const MINOR_RADIUS: f64 = 0.4;
/// Smallest number of vertices: three rings of four.
pub(super) const MIN_VERTICES: usize = 12;
/// Height of a row of equilateral triangles relative to their side: √3/2.
const ROW_HEIGHT: f64 = 0.866;

/// Torus ((R + r cos v) cos u, (R + r cos v) sin u, r sin v), with area 4π²Rr and volume 2π²Rr².
pub(super) fn torus(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let (rings, around) = grid_shape(n_vertices, MAJOR_RADIUS / MINOR_RADIUS * ROW_HEIGHT);
    closed_grid(rings, around, |u, v| {
        let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let out = MAJOR_RADIUS + MINOR_RADIUS * cv;
        V3::new(out * cu, out * su, MINOR_RADIUS * sv)
    })
}
