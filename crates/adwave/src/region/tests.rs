//! Distances along meshes: exact on planes, whatever the cells.

use super::front::{Corners, FrontSearch, FrontSource, SourceExtent};
use crate::Progress;
use crate::shape::{distance, one_ring};

/// Rounding of distances that are sums of straight lines, relative.
const ROUNDING: f64 = 1e-9;

/// Vertices along a side of a grid.
const SIDE: u32 = 41;

/// Pseudo-random numbers in [0, 1).
fn random_numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A flat grid whose inner vertices are moved by up to `jitter`, with random diagonals, stretched and sheared.
fn plane(seed: u64, jitter: f64, stretch: f64, shear: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut random = random_numbers(seed);
    let mut points = Vec::new();
    for k in 0..SIDE * SIDE {
        let (i, j) = (k % SIDE, k / SIDE);
        let is_inner = |i: u32| i > 0 && i + 1 < SIDE;
        let size = if is_inner(i) && is_inner(j) { jitter } else { 0.0 };
        let (x, y) = (f64::from(i) + size * (random() - 0.5), f64::from(j) + size * (random() - 0.5));
        points.push([x + shear * y, stretch * y, 0.0]);
    }
    let mut triangles = Vec::new();
    for k in 0..(SIDE - 1) * (SIDE - 1) {
        let a = k / (SIDE - 1) * SIDE + k % (SIDE - 1);
        let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
        triangles.extend(if random() < 0.5 { [[a, b, d], [a, d, c]] } else { [[a, b, c], [b, d, c]] });
    }
    (points, triangles)
}

fn point_source(vertex: usize, point: [f64; 3], start: f64) -> FrontSource {
    FrontSource { vertex, point, start, extent: SourceExtent::Point, number: 0 }
}

fn distances(points: &[[f64; 3]], triangles: &[[u32; 3]], sources: &[FrontSource], radius: f64) -> Vec<f64> {
    let ring = one_ring(points.len(), triangles);
    let corners = Corners::new(triangles, &ring, Progress::none()).unwrap();
    let mut search = FrontSearch::default();
    // A search leaves nothing to the next.
    search.run(&corners, points, &[point_source(0, points[0], 0.0)], radius, Progress::none()).unwrap();
    search.run(&corners, points, sources, radius, Progress::none()).unwrap();
    (0..points.len()).map(|x| search.distance(x)).collect()
}

/// Turns a plane in space.
fn turn_plane(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    points
        .iter()
        .map(|[x, _, _]| [0.6 * x, 0.8 * x, 0.0].map(|c| c + 7.0))
        .zip(points)
        .map(|(p, q)| [p[0], p[1], q[1]])
        .collect()
}

#[test]
fn distances_on_a_plane_are_those_of_space_whatever_the_cells() {
    let source = (SIDE * SIDE / 2) as usize;
    for (jitter, shear) in [(0.0, 0.0), (0.45, 0.0), (0.3, 1.5), (0.0, -3.0)] {
        for stretch in [1.0, 0.5, 0.2, 0.1, 0.02, 30.0] {
            for seed in 0..3 {
                let (flat, triangles) = plane(seed, jitter, stretch, shear);
                let points = turn_plane(&flat);
                let radius = 9.0 * stretch.max(1.0);
                let found =
                    distances(&points, &triangles, &[point_source(source, points[source], 0.0)], radius);
                for (x, d) in found.iter().enumerate() {
                    let expected = distance(&points[x], &points[source]);
                    if (expected - radius).abs() < ROUNDING * radius {
                        continue;
                    }
                    if expected > radius {
                        assert!(*d > radius, "vertex {x}: {d} instead of {expected}");
                    } else {
                        let error = (d - expected).abs();
                        // Close to the radius, a line may pass between vertices that are too far away to count.
                        let most = if expected < 0.9 * radius { ROUNDING } else { 0.01 };
                        assert!(
                            error <= most * radius,
                            "{stretch} {shear} {seed}, vertex {x}: {d}, {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn several_sources_have_the_distance_of_the_nearest() {
    for seed in 0..4 {
        let (points, triangles) = plane(seed, 0.4, 0.3, 0.0);
        let mut random = random_numbers(100 + seed);
        let mut draw = || (random() * f64::from(SIDE * SIDE)) as usize;
        let sources: Vec<FrontSource> =
            (0..5).map(|_| draw()).map(|x| point_source(x, points[x], 0.0)).collect();
        let found = distances(&points, &triangles, &sources, 12.0);
        for (x, d) in found.iter().enumerate() {
            let expected = sources.iter().map(|s| distance(&points[x], &s.point)).fold(12.0, f64::min);
            assert!(
                (d.min(12.0) / expected.max(1e-9) - 1.0).abs() < 1e-6 || expected < 1e-9,
                "{x}: {d} {expected}"
            );
        }
    }
}

#[test]
fn a_start_distance_is_added() {
    let (points, triangles) = plane(1, 0.4, 1.0, 0.0);
    let source = (SIDE * SIDE / 2) as usize;
    let plain = distances(&points, &triangles, &[point_source(source, points[source], 0.0)], 6.0);
    let later = distances(&points, &triangles, &[point_source(source, points[source], 2.0)], 8.0);
    for (a, b) in plain.iter().zip(later).filter(|(a, _)| **a < 5.99) {
        assert!((a + 2.0 - b).abs() < ROUNDING);
    }
}

#[test]
fn a_front_bends_around_the_end_of_a_slit() {
    // Triangles at the vertices of a half-line are taken out.
    let (points, triangles) = plane(0, 0.0, 1.0, 0.0);
    let (row, last) = (20.0, 25.0);
    let in_slit = |v: u32| points[v as usize][1] == row && points[v as usize][0] <= last;
    let triangles: Vec<[u32; 3]> = triangles.into_iter().filter(|t| !t.iter().any(|&v| in_slit(v))).collect();
    let source = (10 * SIDE + 10) as usize;
    let found = distances(&points, &triangles, &[point_source(source, points[source], 0.0)], 60.0);
    let (from, behind) = (points[source], (30 * SIDE + 10) as usize);
    // The way leads around the tip of the slit, past the vertices beside it.
    let to = |x: f64, y: f64| distance(&from, &[x, y, 0.0]);
    let (least, most) = (2.0 * to(last, row), 2.0 * to(last + 1.0, row - 1.0) + 2.0);
    assert!((least..=most).contains(&found[behind]), "{} {least} {most}", found[behind]);
    // In front of the slit nothing changes.
    for (x, d) in found.iter().enumerate().filter(|(x, _)| points[*x][1] < row) {
        assert!((d - distance(&points[x], &from)).abs() < ROUNDING * 60.0, "{x}");
    }
}

#[test]
fn distances_do_not_depend_on_the_order_of_the_triangles() {
    let (points, mut triangles) = plane(3, 0.4, 0.2, 0.5);
    let points: Vec<[f64; 3]> =
        points.iter().map(|[x, y, _]| [*x, *y, (0.7 * x).sin() * (2.0 * y).cos()]).collect();
    let sources = [point_source(700, points[700], 0.0), point_source(900, points[900], 0.5)];
    let first = distances(&points, &triangles, &sources, 8.0);
    triangles.reverse();
    for t in &mut triangles {
        t.rotate_left(1);
    }
    assert_eq!(first, distances(&points, &triangles, &sources, 8.0));
}

#[test]
fn triangles_without_area_and_folds_give_finite_distances() {
    let points =
        [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [3.0, 0.0, 0.0]];
    let triangles = [[0, 1, 2], [0, 1, 3], [1, 2, 4], [3, 4, 1], [2, 5, 5], [0, 3, 1]];
    let found = distances(&points, &triangles, &[point_source(0, points[0], 0.0)], 10.0);
    assert_eq!(found[..3], [0.0, 1.0, 2.0]);
    assert!((found[3] - 2.0_f64.sqrt()).abs() < ROUNDING && found[5] == 3.0, "{found:?}");
    for size in [1e-200, 1e90] {
        let scaled = points.map(|p| p.map(|c| c * size));
        let found = distances(&scaled, &triangles, &[point_source(0, scaled[0], 0.0)], 10.0 * size);
        assert!(found.iter().all(|d| d.is_finite()), "{found:?}");
    }
}
