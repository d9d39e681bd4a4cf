//! Polygons: no result depends on the corner that a face names first, and symmetric faces have symmetric results.

use adwave::bands::Schedule;
use adwave::denoise::{DenoiseParams, denoise};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::saliency::{SaliencyParams, saliency};
use adwave::shape::{
    Mesh, MeshArea, Polygons, PreparedGeometry, Shape, WeldMode, enclosed_face_volume, face_areas, face_ring,
    face_vertex_normals, health, mesh_areas, one_ring, total_face_area, vertex_normals,
};
use adwave::signal::{SurfaceSignal, surface_signal};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// Corners of a ring of the cylinder.
const N: u32 = 32;

/// Rings of the cylinder.
const RINGS: u32 = 9;

/// Rounding of sums over a polygon and of some hundred steps, for coordinates of about 1.
const ROUNDING: f64 = 1e-12;

/// A closed cylinder of quads with two polygons as caps.
fn cylinder() -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let point = |k: u32, i: u32| {
        let angle = TAU * f64::from(i) / f64::from(N);
        [angle.cos(), angle.sin(), 0.2 * f64::from(k)]
    };
    let points = (0..RINGS).flat_map(|k| (0..N).map(move |i| point(k, i))).collect();
    let quad = |k: u32, i: u32| {
        let next = (i + 1) % N;
        vec![k * N + i, k * N + next, (k + 1) * N + next, (k + 1) * N + i]
    };
    let mut faces: Vec<Vec<u32>> = (0..RINGS - 1).flat_map(|k| (0..N).map(move |i| quad(k, i))).collect();
    faces.push((0..N).rev().collect());
    faces.push((0..N).map(|i| (RINGS - 1) * N + i).collect());
    (points, faces)
}

/// An open sheet of rough quads that are neither planar nor regular, with a star that is not convex.
fn sheet(seed: u64) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    const SIDE: u32 = 14;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut noise = || 0.3 * (f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5);
    let mut points: Vec<[f64; 3]> = (0..SIDE * SIDE)
        .map(|i| [f64::from(i % SIDE) + noise(), f64::from(i / SIDE) + noise(), noise()])
        .collect();
    let corner = |i: u32| (0..4).map(|k| i + [0, 1, SIDE + 1, SIDE][k]).collect();
    let mut faces: Vec<Vec<u32>> =
        (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE < SIDE - 1).map(corner).collect();
    let first = points.len() as u32;
    for k in 0..10 {
        let (angle, radius) = (TAU * f64::from(k) / 10.0, if k % 2 == 0 { 2.0 } else { 0.5 });
        points.push([20.0 + radius * angle.cos(), radius * angle.sin(), 0.1 * noise()]);
    }
    faces.push((first..first + 10).collect());
    (points, faces)
}

/// The faces with first corners at random.
fn renamed(faces: &[Vec<u32>], seed: u64) -> Vec<Vec<u32>> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let turned = |face: &Vec<u32>| {
        let mut face = face.clone();
        let n = face.len();
        face.rotate_left(random.next_u32() as usize % n);
        face
    };
    faces.iter().map(turned).collect()
}

fn polygons(faces: &[Vec<u32>]) -> Polygons {
    faces.iter().map(Vec::as_slice).collect()
}

fn shape(points: &[[f64; 3]], faces: &[Vec<u32>]) -> Shape {
    Shape::Mesh(Mesh::new(points.to_vec(), polygons(faces)).unwrap())
}

fn params(kind: OperatorKind) -> OperatorParams {
    OperatorParams::default().with_kind(kind)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max)
}

/// Smoothed positions by an operator.
fn smoothed(shape: &Shape, kind: OperatorKind) -> Vec<f64> {
    let decomposer = Decomposer::with_params(shape, &params(kind), Progress::none()).unwrap();
    let points = shape.points().unwrap().as_flattened().to_vec();
    decomposer.decompose(&points, 3, &Schedule::dyadic(5).unwrap()).unwrap().coarsest().to_vec()
}

#[test]
fn results_do_not_depend_on_the_corner_that_is_named_first() {
    let shapes = [cylinder(), sheet(1), sheet(2)];
    for (number, (points, faces)) in shapes.iter().enumerate() {
        let first = shape(points, faces);
        for seed in 0..3 {
            let second = shape(points, &renamed(faces, seed));
            let both = [&first, &second];
            for kind in [OperatorKind::Walk, OperatorKind::Surface] {
                let [a, b] = both.map(|shape| smoothed(shape, kind));
                assert!(largest_difference(&a, &b) <= ROUNDING, "{number} {kind:?}");
                let [a, b] = both.map(|shape| {
                    let decomposer = Decomposer::with_params(shape, &params(kind), Progress::none()).unwrap();
                    let health = decomposer.health();
                    let mut sums = vec![health.area, health.volume.unwrap_or(0.0), decomposer.mean_length()];
                    sums.extend(decomposer.areas());
                    sums
                });
                assert!(largest_difference(&a, &b) <= ROUNDING, "{number} {kind:?}");
            }
            let [a, b] = both.map(|shape| {
                let decomposer = Decomposer::new(shape);
                let schedule = Schedule::dyadic(5).unwrap();
                let normals = decomposer.outward_normals(None, Progress::none()).unwrap().normals;
                let coordinates = shape.points().unwrap().as_flattened();
                let along =
                    decomposer.request(coordinates, 3, &schedule).normal_components(&normals).unwrap();
                saliency(&decomposer, &along, &SaliencyParams::default(), Progress::none()).unwrap().map
            });
            assert!(largest_difference(&a, &b) <= ROUNDING, "saliency of {number}");
            let prepared = both.map(|shape| {
                PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap()
            });
            let [a, b] = [0, 1]
                .map(|k| denoise(&prepared[k], &DenoiseParams::default(), Progress::none()).unwrap().points);
            assert!(largest_difference(a.as_flattened(), b.as_flattened()) <= ROUNDING, "denoised {number}");
            for signal in
                [SurfaceSignal::Normals, SurfaceSignal::MeanCurvature, SurfaceSignal::GaussianCurvature]
            {
                let [a, b] = [0, 1].map(|k| surface_signal(&prepared[k], signal, Progress::none()).unwrap());
                assert!(largest_difference(&a, &b) <= ROUNDING, "{signal:?} of {number}");
            }
        }
    }
}

#[test]
fn a_symmetric_polygon_has_symmetric_results() {
    let (points, faces) = cylinder();
    let shape = shape(&points, &faces);
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        let moved = smoothed(&shape, kind);
        for ring in moved.chunks(3 * N as usize) {
            let radii: Vec<f64> = ring.chunks(3).map(|p| p[0].hypot(p[1])).collect();
            assert!(radii.iter().all(|r| (r - radii[0]).abs() < ROUNDING), "{kind:?}: {radii:?}");
            assert!(ring.chunks(3).all(|p| (p[2] - ring[2]).abs() < ROUNDING), "{kind:?}");
        }
    }
}

#[test]
fn areas_normals_and_volume_are_those_of_the_polygons() {
    let (points, faces) = cylinder();
    let faces = polygons(&faces);
    let cap = 0.5 * f64::from(N) * (TAU / f64::from(N)).sin();
    let side = f64::from(N) * 2.0 * (TAU / f64::from(2 * N)).sin() * 0.2 * f64::from(RINGS - 1);
    assert!((total_face_area(&points, &faces) - 2.0 * cap - side).abs() < ROUNDING);
    assert!((enclosed_face_volume(&points, &faces) - cap * 0.2 * f64::from(RINGS - 1)).abs() < ROUNDING);
    let areas = face_areas(&points, &faces, MeshArea::Barycentric);
    assert!((areas.iter().sum::<f64>() - 2.0 * cap - side).abs() < ROUNDING);
    let quad = side / f64::from(N * (RINGS - 1));
    for (x, area) in areas.iter().enumerate() {
        let is_rim = x < N as usize || x >= (N * (RINGS - 1)) as usize;
        let expected = if is_rim { cap / f64::from(N) + quad / 2.0 } else { quad };
        assert!((area - expected).abs() < ROUNDING, "vertex {x}");
    }
    let normals = face_vertex_normals(&points, &faces);
    assert!((normals[100][0] - points[100][0]).abs() < ROUNDING && normals[100][2].abs() < ROUNDING);
    assert!((normals[0][1] / normals[0][0]).abs() < ROUNDING && normals[0][2] < 0.0);
    // Neither the outline of a flat face nor the number of its corners changes its area.
    let (points, faces) = sheet(3);
    let star = faces.len() - 1;
    let flat: Vec<[f64; 3]> = points.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let area = total_face_area(&flat, &polygons(&faces[star..]));
    assert!((area - 10.0 * 0.5 * 2.0 * 0.5 * (TAU / 10.0).sin()).abs() < ROUNDING);
}

#[test]
fn triangles_have_the_bits_of_the_functions_for_triangles() {
    let (points, _) = sheet(5);
    let triangles: Vec<[u32; 3]> = (0..150).map(|i| [i, i + 1, i + 15]).collect();
    let faces = Polygons::from_triangles(&triangles);
    // A polygon elsewhere leaves the triangles alone.
    let mut with_polygon = faces.clone();
    with_polygon.push(&[196, 198, 200, 202]);
    for faces in [&faces, &with_polygon] {
        for kind in [MeshArea::Barycentric, MeshArea::MixedVoronoi] {
            assert_eq!(face_areas(&points, faces, kind)[..196], mesh_areas(&points, &triangles, kind)[..196]);
        }
        assert_eq!(face_vertex_normals(&points, faces)[..196], vertex_normals(&points, &triangles)[..196]);
        let (ring, expected) = (face_ring(points.len(), faces), one_ring(points.len(), &triangles));
        assert!((0..196).all(|x| ring.row(x) == expected.row(x)));
    }
}

#[test]
fn faces_without_area_or_with_many_corners_give_finite_results() {
    let mut points: Vec<[f64; 3]> =
        (0..50_000).map(|i| (TAU * f64::from(i) / 50_000.0).sin_cos()).map(|(y, x)| [x, y, 0.0]).collect();
    points.extend([[0.0; 3], [1.0, 1.0, 1.0], [2.0; 3], [5.0, 0.0, 0.0]]);
    let n = points.len() as u32;
    let all: Vec<u32> = (0..50_000).collect();
    let faces = [all, vec![n - 4, n - 3, n - 2, n - 3], vec![n - 1; 5], vec![n - 4, n - 1, n - 4, n - 1]];
    let shape = shape(&points, &faces);
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        assert!(smoothed(&shape, kind).iter().all(|c| c.is_finite()), "{kind:?}");
    }
    let geometry = PreparedGeometry::new(&shape, WeldMode::Off, Progress::none()).unwrap();
    let counts = health(&geometry, &geometry.one_ring(), Progress::none()).unwrap();
    assert!((counts.area - TAU / 2.0).abs() < 1e-6);
}
