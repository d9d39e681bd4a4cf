//! Meshes that are simplified in parts: what holds for small ones holds for them, on any number of threads.

mod common;

use adwave::Progress;
use adwave::shape::{Mesh, Polygons};
use adwave_simplify::{
    Border, MeshParams, MeshTarget, SimplifiedMesh, Triangles, Why, simplify_mesh, surface_distance,
};
use common::{edges, euler_characteristic};
use std::collections::BTreeSet;

/// Number of squares along a side, with more vertices than meshes have that one queue simplifies.
const LARGE: u32 = 366;

/// The same with fewer.
const SMALL: u32 = 360;

/// Sheet of waves and bumps, n × n squares with two triangles each.
fn waves(n: u32) -> Mesh {
    let side = n + 1;
    let points = (0..side * side).map(|k| {
        let (x, y) = (f64::from(k % side) / f64::from(n), f64::from(k / side) / f64::from(n));
        [x, y, 0.05 * (9.0 * x).sin() * (7.0 * y).cos() + 0.004 * (61.0 * x * y).sin()]
    });
    let squares = (0..n * n).map(|s| s / n * side + s % n);
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]).collect();
    Mesh::new(points.collect(), Polygons::from_triangles(&triangles)).unwrap()
}

/// The waves closed to a torus.
fn torus(n: u32) -> Mesh {
    let turn = |k: u32| f64::from(k) / f64::from(n) * std::f64::consts::TAU;
    let points = (0..n * n).map(|k| {
        let (u, v) = (turn(k / n), turn(k % n));
        let r = 0.5 + 0.02 * (5.0 * u).sin() * (3.0 * v).cos();
        [(2.0 + r * v.cos()) * u.cos(), (2.0 + r * v.cos()) * u.sin(), r * v.sin()]
    });
    let squares = (0..n * n).flat_map(|k| {
        let at = |i: u32, j: u32| (k / n + i) % n * n + (k % n + j) % n;
        [[at(0, 0), at(1, 0), at(0, 1)], [at(1, 0), at(1, 1), at(0, 1)]]
    });
    Mesh::new(points.collect(), Polygons::from_triangles(&squares.collect::<Vec<_>>())).unwrap()
}

fn simplify(mesh: &Mesh, labels: Option<&[u32]>, params: MeshParams) -> SimplifiedMesh {
    simplify_mesh(mesh, labels, &params.with_measure(false), Progress::none()).unwrap()
}

/// Largest distances from the original to the simplified mesh and back.
fn distances(mesh: &Mesh, simplified: &SimplifiedMesh) -> [f64; 2] {
    let points: Vec<[f64; 3]> = simplified.kept.iter().map(|&x| mesh.points()[x as usize]).collect();
    let original = Triangles { points: mesh.points(), triangles: mesh.faces().triangles().unwrap() };
    let simplified = Triangles { points: &points, triangles: &simplified.triangles };
    [(original, simplified), (simplified, original)]
        .map(|(from, to)| surface_distance(from, to, Progress::none()).unwrap().unwrap().greatest)
}

#[test]
fn parts_end_at_the_number_asked_for_and_are_as_good_as_one_queue() {
    let params = MeshParams::new(MeshTarget::Vertices(5000));
    let greatest = [LARGE, SMALL].map(|n| {
        let mesh = torus(n);
        let simplified = simplify(&mesh, None, params);
        assert_eq!((simplified.kept.len(), simplified.why), (5000, Why::Reached));
        assert_eq!(euler_characteristic(&simplified.triangles), 0, "{n}");
        assert!(edges(&simplified.triangles).values().all(|&n_faces| n_faces == 2));
        distances(&mesh, &simplified)
    });
    let [[of_large, to_large], [of_small, to_small]] = greatest;
    assert!(of_large < 1.25 * of_small && to_large < 1.25 * to_small, "{greatest:?}");
}

#[test]
fn parts_keep_a_distance_with_about_as_few_vertices_on_any_number_of_threads() {
    let limit = 5e-4;
    let params = MeshParams::new(MeshTarget::Error(limit));
    let counts = [LARGE, SMALL].map(|n| {
        let mesh = waves(n);
        let simplified = simplify(&mesh, None, params);
        let found = distances(&mesh, &simplified);
        // The proof may need fewer pieces than this measure has.
        assert!(found.iter().all(|&greatest| greatest <= 1.01 * limit), "{found:?}");
        assert_eq!(
            (simplified.within.map(|within| within <= limit), simplified.why),
            (Some(true), Why::Reached)
        );
        assert_eq!(euler_characteristic(&simplified.triangles), 1, "{n}");
        if n == LARGE {
            let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let again = one.install(|| simplify(&mesh, None, params));
            assert!(again.kept == simplified.kept && again.triangles == simplified.triangles);
        }
        simplified.kept.len()
    });
    assert!((counts[0] as f64) < 1.1 * counts[1] as f64 && counts[0] > 100, "{counts:?}");
}

#[test]
fn parts_keep_borders_and_seams() {
    let mesh = waves(LARGE);
    let side = LARGE + 1;
    let triangles = mesh.faces().triangles().unwrap();
    // Two charts, whose seam runs through many parts: left and right of a line.
    let is_left = |t: &[u32; 3]| t.iter().all(|x| x % side <= LARGE / 2);
    let labels: Vec<u32> = triangles.iter().flat_map(|t| [u32::from(is_left(t)); 3]).collect();
    let on_seam = |x: u32| x % side == LARGE / 2;
    let on_border =
        |x: u32| x.is_multiple_of(side) || x % side == LARGE || x / side == 0 || x / side == LARGE;
    for target in [MeshTarget::Ratio(0.05), MeshTarget::Error(1e-3)] {
        let simplified = simplify(&mesh, Some(&labels), MeshParams::new(target).with_border(Border::Kept));
        assert_eq!(simplified.kept.iter().filter(|x| on_border(**x)).count() as u32, 4 * LARGE, "{target:?}");
        assert_eq!(euler_characteristic(&simplified.triangles), 1);
        // Faces continue a corner with their label, and no face crosses the seam.
        let name = |x: u32| simplified.kept[x as usize];
        for (t, corners) in simplified.triangles.iter().zip(&simplified.corners) {
            let [a, b, c] = corners.map(|corner| labels[corner as usize]);
            assert!(a == b && b == c);
            let sides: BTreeSet<bool> =
                t.iter().map(|&x| name(x)).filter(|&x| !on_seam(x)).map(|x| x % side < LARGE / 2).collect();
            assert!(sides.len() <= 1 && (sides.is_empty() || sides.contains(&(a == 1))), "{target:?}");
        }
        // The seam is a path of edges from border to border.
        let along = edges(&simplified.triangles);
        let along = along.keys().filter(|edge| edge.iter().all(|&x| on_seam(name(x)))).count();
        let kept = simplified.kept.iter().filter(|x| on_seam(**x)).count();
        assert_eq!(along + 1, kept, "{target:?}");
    }
}
