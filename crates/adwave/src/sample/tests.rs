//! Laws of the samples: closed forms, topology, orientation, counts, quality, noise, repeatability, bad requests.

use super::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;

fn make(name: &str, n_vertices: usize) -> Sample {
    Sample::from_name(name, Some(n_vertices)).expect("a sample")
}

fn area(sample: &Sample) -> f64 {
    sample.faces.iter().map(|face| 0.5 * sample.area_normal(face).norm()).sum()
}

fn volume(sample: &Sample) -> f64 {
    sample.faces.iter().map(|f| sample.corner(f[0]).dot(&sample.area_normal(f)) / 6.0).sum()
}

/// Map from a directed edge to the corner across it; panics if a directed edge occurs twice (inconsistent
/// orientation, or more than two faces at an edge).
fn directed_edges(sample: &Sample) -> BTreeMap<(u32, u32), u32> {
    let mut edges = BTreeMap::new();
    for f in sample.faces.iter() {
        for k in 0..3 {
            let edge = (f[k], f[(k + 1) % 3]);
            assert_ne!(edge.0, edge.1, "face {f:?} names a vertex twice");
            assert!(edges.insert(edge, f[(k + 2) % 3]).is_none(), "edge {edge:?} runs the same way twice");
        }
    }
    edges
}

/// Checks that the mesh is closed and oriented, every vertex has one fan, and there is one component; returns the
/// Euler characteristic.
fn euler_of_closed_manifold(sample: &Sample) -> i64 {
    let edges = directed_edges(sample);
    let n = sample.points.len();
    let mut degree = vec![0_usize; n];
    let mut start = vec![None; n];
    for &(a, b) in edges.keys() {
        assert!(edges.contains_key(&(b, a)), "edge {a}–{b} has one face");
        degree[a as usize] += 1;
        start[a as usize] = Some(b);
    }
    for a in 0..n as u32 {
        // The fan around a vertex, followed from face to face, must meet every edge at the vertex.
        let first = start[a as usize].expect("a vertex has a face");
        let (mut at, mut steps) = (first, 0);
        loop {
            at = edges[&(a, at)];
            steps += 1;
            if at == first || steps > degree[a as usize] {
                break;
            }
        }
        assert_eq!(steps, degree[a as usize], "vertex {a} has more than one fan");
    }
    let mut seen = vec![false; n];
    let mut neighbors = vec![Vec::new(); n];
    for &(a, b) in edges.keys() {
        neighbors[a as usize].push(b);
    }
    let mut open = vec![0_u32];
    while let Some(v) = open.pop() {
        if !std::mem::replace(&mut seen[v as usize], true) {
            open.extend(&neighbors[v as usize]);
        }
    }
    assert!(seen.iter().all(|&s| s), "several components");
    n as i64 - (edges.len() / 2) as i64 + sample.faces.len() as i64
}

/// Smallest angle of each face in degrees, in ascending order.
fn least_angles(sample: &Sample) -> Vec<f64> {
    let mut least: Vec<f64> = sample
        .faces
        .iter()
        .map(|f| {
            (0..3)
                .map(|k| {
                    let [a, b, c] = [0, 1, 2].map(|i| sample.corner(f[(k + i) % 3]));
                    (b - a).angle(&(c - a)).to_degrees()
                })
                .fold(180.0, f64::min)
        })
        .collect();
    least.sort_unstable_by(f64::total_cmp);
    least
}

#[test]
fn sphere_has_any_count_and_tends_to_its_closed_forms() {
    for n in [4, 5, 6, 7, 11, 12, 13, 50, 99, 1000, 1001] {
        let sphere = make("sphere", n);
        assert_eq!(sphere.points.len(), n);
        assert_eq!(euler_of_closed_manifold(&sphere), 2, "{n} vertices");
        assert!(volume(&sphere) > 0.0);
    }
    // Chords lie inside by a part of h² ≈ 4π/n of the radius: 1e-3 at n = 20 000.
    let sphere = make("sphere", 20_000);
    assert!((area(&sphere) / (4.0 * PI) - 1.0).abs() < 1e-3);
    assert!((volume(&sphere) / (4.0 * PI / 3.0) - 1.0).abs() < 1e-3);
    assert!(least_angles(&sphere)[0] > 20.0);
}

#[test]
fn torus_and_knot_tend_to_pappus() {
    // Chords of a grid of n points: a few parts in a thousand at 20 000.
    const CHORDS: f64 = 4e-3;
    let (major, minor) = (torus::MAJOR_RADIUS, torus::MINOR_RADIUS);
    let torus = make("torus", 20_000);
    assert_eq!(euler_of_closed_manifold(&torus), 0);
    assert!((area(&torus) / (4.0 * PI * PI * major * minor) - 1.0).abs() < CHORDS);
    assert!((volume(&torus) / (2.0 * PI * PI * major * minor * minor) - 1.0).abs() < CHORDS);
    assert!(least_angles(&torus)[0] > 35.0);
    let knot = make("knot", 20_000);
    let (length, radius) = (knot::length(), knot::TUBE_RADIUS);
    assert_eq!(euler_of_closed_manifold(&knot), 0);
    assert!((area(&knot) / (2.0 * PI * radius * length) - 1.0).abs() < CHORDS);
    assert!((volume(&knot) / (PI * radius * radius * length) - 1.0).abs() < CHORDS);
    assert!(least_angles(&knot)[0] > 30.0);
}

#[test]
fn plane_is_a_graph_over_the_square() {
    let plane = make("plane", 2_500);
    let over: f64 = plane.faces.iter().map(|f| 0.5 * plane.area_normal(f).y).sum();
    assert!((over - 4.0 * plane::HALF_SIDE * plane::HALF_SIDE).abs() < 1e-12, "rounding of 5000 sums");
    assert!(plane.faces.iter().all(|f| plane.area_normal(f).y > 0.0));
    assert!(plane.points.iter().all(|p| p[1] == plane::height(p[0], p[2])));
    let edges = directed_edges(&plane);
    let n_border = edges.keys().filter(|&&(a, b)| !edges.contains_key(&(b, a))).count();
    // A border edge runs one way only, so this is twice the number of edges.
    let twice_n_edges = edges.len() + n_border;
    assert_eq!(2 * (plane.points.len() + plane.faces.len()) - twice_n_edges, 2);
}

#[test]
fn counts_are_met() {
    for n in [1000, 1013, 1777, 5003, 9999, 30_011] {
        for name in ["torus", "plane", "knot"] {
            let got = make(name, n).points.len();
            assert!(got.abs_diff(n) * 100 <= n, "{name} has {got} vertices, asked for {n}");
        }
    }
}

#[test]
fn creature_is_one_closed_surface_of_genus_zero() {
    for n in [creature::MIN_VERTICES, 3_000, 8_000, 20_000, 50_000] {
        let creature = make("creature", n);
        let got = creature.points.len();
        assert!(got.abs_diff(n) * 50 <= n, "{got} vertices, asked for {n}");
        assert_eq!(euler_of_closed_manifold(&creature), 2, "{n} vertices");
        assert!(volume(&creature) > 0.1, "outward");
        let angles = least_angles(&creature);
        let below = |limit: f64| angles.partition_point(|&a| a < limit) as f64 / angles.len() as f64;
        // Where an edge is as long as a finger is wide a few slivers remain; none is degenerate.
        let least = if n < 8_000 { 1.0 } else { 5.0 };
        assert!(angles[0] > least, "least angle {} at {n}", angles[0]);
        assert!(below(25.0) < 0.01, "{} below 25° at {n}", below(25.0));
    }
}

#[test]
fn bracket_is_closed_of_genus_one_and_tends_to_its_volume() {
    for n in [bracket::MIN_VERTICES, 500, 1_000, 3_000, 10_007, 40_000] {
        let bracket = make("bracket", n);
        let got = bracket.points.len();
        assert!(n < 2_000 || got.abs_diff(n) * 50 <= n, "{got} vertices, asked for {n}");
        assert_eq!(euler_of_closed_manifold(&bracket), 0, "{n} vertices");
        // Chords of the hole add θh²/12 to the area, θ = 2π; h² is about 9/n, twice that where segments are few.
        let error = volume(&bracket) / bracket::volume() - 1.0;
        assert!(error.abs() < 12.0 / n as f64, "{error} at {n}");
        // Half a step at the ends of every other row.
        let least = least_angles(&bracket);
        assert!(least[0] > 12.0, "least angle {} at {n}", least[0]);
        assert!(least[least.len() / 10] > 20.0, "{} at {n}", least[least.len() / 10]);
    }
}

#[test]
fn bracket_has_vertices_all_along_its_sharp_edges() {
    let sample = make("bracket", 10_000);
    let bracket = &sample;
    let edge = bracket.mean_edge_length();
    let edges = directed_edges(bracket);
    let normals: BTreeMap<(u32, u32), V3> = bracket
        .faces
        .iter()
        .flat_map(|f| (0..3).map(move |k| ((f[k], f[(k + 1) % 3]), bracket.area_normal(f).normalize())))
        .collect();
    // All faces meet flat, on an arc by at most its step's angle, or at 90°.
    let mut sharp = 0.0;
    for &(a, b) in edges.keys().filter(|(a, b)| a < b) {
        let angle = normals[&(a, b)].angle(&normals[&(b, a)]).to_degrees();
        if angle > 80.0 {
            assert!((angle - 90.0).abs() < 4.0, "{angle}");
            sharp += (bracket.corner(a) - bracket.corner(b)).norm();
        } else {
            assert!(angle < 60.0 * edge / 0.25 * 1.5, "{angle}");
        }
    }
    // Twice the outline with the hole, and four lines through the depth: two corners of the block, two of the flange.
    let outline = 2.0 * (2.2 + 0.7 + 0.7 + 0.63 + 0.95 + 0.12 + 0.15 * PI + 0.125 * PI);
    let expected = outline + 2.0 * 0.5 * PI + 4.0 * 0.8;
    assert!((sharp / expected - 1.0).abs() < 0.01, "{sharp}, expected {expected}");
}

#[test]
fn creature_is_the_same_shape_at_every_count() {
    // The difference is the skin that the coarser grid cannot resolve.
    let (coarse, fine) = (make("creature", 15_000), make("creature", 60_000));
    assert!((volume(&coarse) / volume(&fine) - 1.0).abs() < 0.01);
    let height = |s: &Sample| s.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    assert!((height(&coarse) - height(&fine)).abs() < 0.02);
}

#[test]
fn same_bits_again_and_on_any_number_of_threads() {
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().expect("threads");
        pool.install(|| make("creature", 6_000))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
    for info in SAMPLE_NAMES {
        let n = info.min_vertices.max(1_000);
        assert_eq!(make(info.name, n), make(info.name, n));
    }
}

#[test]
fn noise_has_the_asked_deviation_along_the_normals() {
    let clean = make("sphere", 20_000);
    let normals = clean.normals();
    let sigma = 0.2 * clean.mean_edge_length();
    let mut noisy = clean.clone();
    noisy.add_noise(NoiseSigma::MeanEdge(0.2), 11).expect("noise");
    let mut heights = Vec::new();
    for ((p, q), n) in clean.points.iter().zip(&noisy.points).zip(&normals) {
        let (shift, normal) = (V3::from(*q) - V3::from(*p), V3::from(*n));
        assert!(shift.cross(&normal).norm() < 1e-12, "rounding");
        heights.push(shift.dot(&normal));
    }
    let n = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / n;
    let deviation = (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / n).sqrt();
    let kurtosis = heights.iter().map(|h| ((h - mean) / deviation).powi(4)).sum::<f64>() / n;
    // Five standard errors: σ/√n of the mean, σ/√(2n) of the deviation, √(24/n) of the kurtosis.
    assert!(mean.abs() < 5.0 * sigma / n.sqrt());
    assert!((deviation / sigma - 1.0).abs() < 5.0 / (2.0 * n).sqrt());
    assert!((kurtosis - 3.0).abs() < 5.0 * (24.0 / n).sqrt());
    let mut again = clean.clone();
    again.add_noise(NoiseSigma::Model(sigma), 11).expect("noise");
    assert_eq!(again, noisy);
    let mut other = clean.clone();
    other.add_noise(NoiseSigma::MeanEdge(0.2), 12).expect("noise");
    assert_ne!(other, noisy);
}

#[test]
fn cloud_is_even_by_area() {
    let torus = make("torus", 4_000);
    let n = 40_000;
    let cloud = torus.draw_cloud(n, 3).expect("a cloud");
    assert_eq!(cloud, torus.draw_cloud(n, 3).expect("a cloud"));
    assert_eq!((cloud.points.len(), cloud.normals.len()), (n, n));
    assert!(cloud.normals.iter().all(|m| (V3::from(*m).norm() - 1.0).abs() < 1e-12));
    // The outer half of a torus has the part 1/2 + r/(πR) of the area.
    let outer =
        cloud.points.iter().filter(|p| p[0].hypot(p[1]) > torus::MAJOR_RADIUS).count() as f64 / n as f64;
    let expected = 0.5 + torus::MINOR_RADIUS / (PI * torus::MAJOR_RADIUS);
    // Five standard errors √(p(1 − p)/n), and a part in a thousand for the chords of the mesh.
    assert!((outer - expected).abs() < 5.0 * (0.25 / n as f64).sqrt() + 1e-3, "{outer}, expected {expected}");
}

#[test]
fn normals_point_outwards() {
    let sphere = make("sphere", 2_000);
    for (p, n) in sphere.points.iter().zip(sphere.normals()) {
        // A vertex normal of a mesh differs from the radius by a part of the edge length, here 0.08.
        assert!(V3::from(*p).dot(&V3::from(n)) > 0.99);
    }
}

#[test]
fn bad_requests_are_errors_that_say_what_to_do() {
    let unknown = Sample::from_name("teapot", None).expect_err("no such sample").to_string();
    assert!(SAMPLE_NAMES.iter().all(|info| unknown.contains(info.name)), "{unknown}");
    for info in SAMPLE_NAMES {
        for n in [0, 1, 3, info.min_vertices - 1, MAX_VERTICES + 1, usize::MAX] {
            let error = Sample::from_name(info.name, Some(n)).expect_err("out of range");
            assert!(
                matches!(error, SampleError::VertexCount { n_vertices, .. } if n_vertices == n),
                "{error}"
            );
        }
        assert!(Sample::from_name(info.name, Some(info.min_vertices)).is_ok(), "{}", info.name);
    }
    let mut points = vec![[0.0; 3]; 3];
    assert!(matches!(add_noise(&mut points, &[], 1.0, 0), Err(SampleError::NormalsMismatch { .. })));
    for sigma in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            add_noise(&mut points, &[[0.0; 3]; 3], sigma, 0),
            Err(SampleError::BadSigma { .. })
        ));
    }
    assert!(make("sphere", 4).draw_cloud(usize::MAX, 0).is_err());
}
