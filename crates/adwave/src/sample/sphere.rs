//! The unit sphere.

use super::implicit::V3;
use std::f64::consts::{PI, TAU};

/// Height of a row of equilateral triangles relative to their side: √3/2.
const ROW_HEIGHT: f64 = 0.866;

/// Builds rings of latitude between two poles with exactly `n_vertices` ≥ 4 vertices; the number in each ring
/// follows its length, and neighboring rings are joined by a greedy strip. Unlike a subdivided icosahedron, with
/// 10·f² + 2 vertices, it allows any count.
pub(super) fn sphere(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    if n_vertices == 4 {
        let third = 1.0 / 3.0_f64.sqrt();
        let points = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        return (points.map(|p| V3::from(p) * third).to_vec(), triangles);
    }
    let counts = ring_counts(n_vertices);
    let mut points = vec![V3::new(0.0, 1.0, 0.0)];
    let mut triangles = Vec::with_capacity(2 * n_vertices - 4);
    let mut before = Ring { first: 0, count: 1, phase: 0.0 };
    // A vertex represents 4π/n of the area, so the cumulative count gives the height of a ring's middle.
    let mut seen = 1.0;
    for &count in &counts {
        let height = 1.0 - 2.0 * (seen + 0.5 * count as f64) / n_vertices as f64;
        let radius = (1.0 - height * height).sqrt();
        // Shifted by half a step from the ring before, so that strips start with an isosceles triangle.
        let phase = before.phase + 0.5 / count as f64;
        let ring = Ring { first: points.len(), count, phase };
        for k in 0..count {
            let (sin, cos) = (TAU * ring.turn(k)).sin_cos();
            points.push(V3::new(radius * sin, height, radius * cos));
        }
        join(&before, &ring, &mut triangles);
        before = ring;
        seen += count as f64;
    }
    let pole = Ring { first: points.len(), count: 1, phase: before.phase };
    points.push(V3::new(0.0, -1.0, 0.0));
    join(&before, &pole, &mut triangles);
    (points, triangles)
}

/// A circle of latitude: vertices `first..first + count`, the first at `phase` turns.
struct Ring {
    first: usize,
    count: usize,
    phase: f64,
}

impl Ring {
    fn turn(&self, k: usize) -> f64 {
        self.phase + k as f64 / self.count as f64
    }

    fn vertex(&self, k: usize) -> u32 {
        (self.first + k % self.count) as u32
    }
}

/// Number of vertices of each ring; with the two poles they sum to `n_vertices`.
fn ring_counts(n_vertices: usize) -> Vec<usize> {
    // n triangulated vertices with spacing s cover 4π = n·s²·√3/2.
    let spacing = (4.0 * PI / (n_vertices as f64 * ROW_HEIGHT)).sqrt();
    let n_rings = ((PI / (spacing * ROW_HEIGHT)).round() as usize).saturating_sub(1).max(1);
    let n_rings = n_rings.min((n_vertices - 2) / 3);
    let lengths: Vec<f64> = (1..=n_rings).map(|r| (PI * r as f64 / (n_rings + 1) as f64).sin()).collect();
    let scale = (n_vertices - 2) as f64 / lengths.iter().sum::<f64>();
    // Rounding the cumulative sum instead of each count makes the total exact.
    let (mut running, mut given) = (0.0, 0);
    let mut counts: Vec<usize> = lengths
        .iter()
        .map(|length| {
            running += length * scale;
            let count = (running.round() as usize - given).max(3);
            given += count;
            count
        })
        .collect();
    // Vertices that the minimum of three added near the poles are removed from the widest ring.
    let widest = n_rings / 2;
    counts[widest] = counts[widest] + (n_vertices - 2) - given;
    counts
}

/// The strip of triangles between a ring and the one below, always across the nearer of the two next vertices.
fn join(upper: &Ring, lower: &Ring, triangles: &mut Vec<[u32; 3]>) {
    let steps = |ring: &Ring| if ring.count == 1 { 0 } else { ring.count };
    let (mut i, mut j) = (0, 0);
    while i < steps(upper) || j < steps(lower) {
        let (a, b) = (upper.vertex(i), lower.vertex(j));
        let step_lower = i == steps(upper) || (j < steps(lower) && lower.turn(j + 1) < upper.turn(i + 1));
        if step_lower {
            triangles.push([a, b, lower.vertex(j + 1)]);
            j += 1;
        } else {
            triangles.push([a, b, upper.vertex(i + 1)]);
            i += 1;
        }
    }
}
