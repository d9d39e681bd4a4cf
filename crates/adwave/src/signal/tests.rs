//! Closed forms: sphere, torus, plane, cylinder; signs; scaling.

use super::*;
use crate::sample::Sample;
use crate::shape::{Mesh, PointCloud, Polygons, WeldMode};

/// Error of a discrete curvature: second order in the edge length, which is about 2 % of the radius here, on
/// triangles of different shapes.
const DISCRETE: f64 = 0.02;
/// Error of a curvature fitted to 20 points.
const FITTED: f64 = 0.02;
/// Sums over a sphere: angle defects telescope, so only rounding is left.
const ROUNDING: f64 = 1e-9;

fn mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points, faces).unwrap())
}

fn signal(shape: &Shape, kind: SurfaceSignal) -> Vec<f64> {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    surface_signal(&geometry, kind, Progress::none()).unwrap()
}

fn median_error(values: &[f64], expected: impl Fn(usize) -> f64) -> f64 {
    let mut errors: Vec<f64> = values.iter().enumerate().map(|(x, v)| (v - expected(x)).abs()).collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

#[test]
fn a_sphere_of_radius_r_has_mean_curvature_one_over_r_and_gaussian_one_over_r_squared() {
    let sphere = Sample::from_name("sphere", Some(4000)).unwrap();
    for r in [1.0, 3.0, 1e-60, 1e60] {
        let points: Vec<[f64; 3]> = sphere.points.iter().map(|p| p.map(|c| c * r)).collect();
        let shapes = [
            (mesh(points.clone(), sphere.faces.clone()), DISCRETE),
            (Shape::Cloud(PointCloud::new(points).unwrap()), FITTED),
        ];
        for (shape, tolerance) in shapes {
            let mean = signal(&shape, SurfaceSignal::MeanCurvature);
            assert!(median_error(&mean, |_| 1.0 / r) < tolerance / r);
            let gaussian = signal(&shape, SurfaceSignal::GaussianCurvature);
            assert!(median_error(&gaussian, |_| 1.0 / (r * r)) < 2.0 * tolerance / (r * r));
            let index = signal(&shape, SurfaceSignal::ShapeIndex);
            assert!(index.iter().all(|s| (-1.0..=1.0).contains(s)));
            assert!(median_error(&index, |_| 1.0) < 0.15); // √(H² − K) grows with the root of the error
        }
    }
}

#[test]
fn turning_the_faces_over_turns_the_sign() {
    let sphere = Sample::from_name("sphere", Some(500)).unwrap();
    let turned: Polygons = sphere
        .faces
        .iter()
        .map(|f| f.iter().rev().copied().collect::<Vec<_>>())
        .collect::<Vec<_>>()
        .iter()
        .map(Vec::as_slice)
        .collect();
    let out = signal(&mesh(sphere.points.clone(), sphere.faces), SurfaceSignal::MeanCurvature);
    let inside = signal(&mesh(sphere.points, turned), SurfaceSignal::MeanCurvature);
    assert!(out.iter().zip(&inside).all(|(a, b)| (a + b).abs() < ROUNDING && *a > 0.0));
}

#[test]
fn gaussian_curvature_integrates_to_four_pi_on_a_sphere_and_to_zero_on_a_torus() {
    for (name, expected) in [("sphere", 4.0 * std::f64::consts::PI), ("torus", 0.0)] {
        let sample = Sample::from_name(name, Some(3000)).unwrap();
        let shape = mesh(sample.points, sample.faces);
        let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
        let curvature = mesh_curvature(geometry.points(), geometry.triangles());
        let areas = crate::shape::mesh_areas(geometry.points(), geometry.triangles(), MeshArea::MixedVoronoi);
        let total: f64 = curvature.gaussian.iter().zip(areas).map(|(k, a)| k * a).sum();
        assert!((total - expected).abs() < ROUNDING, "{name}: {total}");
    }
}

#[test]
fn curvature_of_a_torus_is_that_of_its_closed_form() {
    // Radii 1 and 0.4 round the z axis: κ₁ = 1/0.4, κ₂ = cos φ/(1 + 0.4 cos φ).
    let sample = Sample::from_name("torus", Some(8000)).unwrap();
    let principal = |p: &[f64; 3]| {
        let rho = (p[0] * p[0] + p[1] * p[1]).sqrt();
        ((rho - 1.0) / 0.4, 1.0 / 0.4)
    };
    let kappa = |p: &[f64; 3]| principal(p).0 / (p[0] * p[0] + p[1] * p[1]).sqrt();
    let points = sample.points.clone();
    let shapes = [mesh(points.clone(), sample.faces), Shape::Cloud(PointCloud::new(points.clone()).unwrap())];
    for shape in &shapes {
        let mean = signal(shape, SurfaceSignal::MeanCurvature);
        let error = median_error(&mean, |x| 0.5 * (kappa(&points[x]) + 2.5));
        assert!(error < 2.0 * DISCRETE, "{error}");
        let gaussian = signal(shape, SurfaceSignal::GaussianCurvature);
        let error = median_error(&gaussian, |x| kappa(&points[x]) * 2.5);
        assert!(error < 4.0 * DISCRETE, "{error}");
    }
}

#[test]
fn an_open_plane_is_flat_up_to_its_border() {
    let mut points = Vec::new();
    for i in 0..12 {
        for j in 0..12 {
            points.push([f64::from(i) + 0.1 * f64::from(j), f64::from(j), 0.0]);
        }
    }
    let mut faces = Vec::new();
    for i in 0..11_u32 {
        for j in 0..11 {
            let a = 12 * i + j;
            faces.extend([[a, a + 12, a + 13], [a, a + 13, a + 1]]);
        }
    }
    let shape = mesh(points, Polygons::from_triangles(&faces));
    for kind in [SurfaceSignal::MeanCurvature, SurfaceSignal::GaussianCurvature, SurfaceSignal::ShapeIndex] {
        assert!(signal(&shape, kind).iter().all(|h| h.abs() < 1e-12), "{kind:?}");
    }
}

#[test]
fn normals_of_a_cloud_point_out_of_a_closed_surface() {
    let sample = Sample::from_name("knot", Some(6000)).unwrap();
    let expected = signal(&mesh(sample.points.clone(), sample.faces), SurfaceSignal::Normals);
    let cloud = Shape::Cloud(PointCloud::new(sample.points).unwrap());
    let normals = signal(&cloud, SurfaceSignal::Normals);
    let agree = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() > 0.9;
    let n_alike = normals.chunks_exact(3).zip(expected.chunks_exact(3)).filter(|&pair| agree(pair)).count();
    assert!(n_alike * 100 > 99 * normals.len() / 3, "{n_alike} of {}", normals.len() / 3);
}

#[test]
fn the_sharpest_caps_and_pits_are_no_saddles() {
    // The apex of a cone of triangles has an angle defect over a small area: K > 2H².
    let curvature = Curvature { mean: vec![1.0, -1.0, 1.0, 0.0], gaussian: vec![2.1, 9.0, 1.5, 1.0] };
    assert_eq!(curvature.shape_index(1e-6), [1.0, -1.0, 1.0, 0.0]);
    let spikes: Vec<[f64; 3]> = (0..8)
        .map(|i| f64::from(i) * std::f64::consts::FRAC_PI_4)
        .map(|a| [a.cos(), a.sin(), 0.0])
        .chain([[0.0, 0.0, 4.0], [0.0, 0.0, -4.0]])
        .collect();
    let faces: Vec<[u32; 3]> = (0..8_u32).flat_map(|i| [[i, (i + 1) % 8, 8], [(i + 1) % 8, i, 9]]).collect();
    let index = signal(&mesh(spikes, Polygons::from_triangles(&faces)), SurfaceSignal::ShapeIndex);
    assert_eq!(index[8..], [1.0, 1.0]);
}

#[test]
fn the_border_of_a_cloud_is_its_rim() {
    let grid: Vec<[f64; 3]> = (0..900).map(|i| [f64::from(i % 30), f64::from(i / 30), 0.0]).collect();
    let near = crate::shape::nearest_neighbors(&grid, 10).adjacency;
    let expected: Vec<usize> =
        (0..900).filter(|&i| [i % 30, i / 30].iter().any(|&k| k == 0 || k == 29)).collect();
    assert_eq!(cloud_border(&grid, &near), expected);
    let sphere = Sample::from_name("sphere", Some(2000)).unwrap().points;
    assert_eq!(
        cloud_border(&sphere, &crate::shape::nearest_neighbors(&sphere, 10).adjacency),
        Vec::<usize>::new()
    );
}

#[test]
fn degenerate_shapes_give_finite_signals_and_graphs_an_error() {
    let clouds = [
        vec![[1.0, 2.0, 3.0]],
        vec![[1.0, 2.0, 3.0]; 40],
        (0..40).map(|i| [f64::from(i), 0.0, 0.0]).collect(),
        (0..7).map(|i| [f64::from(i % 3), f64::from(i / 3), 1e-300]).collect(),
    ];
    for points in clouds {
        let n = points.len() as u32;
        let faces: Vec<[u32; 3]> = (0..n).map(|i| [i, (i + 1) % n, (i + 2) % n]).collect();
        let cloud = Shape::Cloud(PointCloud::new(points.clone()).unwrap());
        for kind in SurfaceSignal::ALL {
            assert!(signal(&cloud, kind).iter().all(|v| v.is_finite()), "{kind:?}");
        }
        let mesh = mesh(points, Polygons::from_triangles(&faces));
        for kind in [SurfaceSignal::MeanCurvature, SurfaceSignal::GaussianCurvature] {
            assert!(signal(&mesh, kind).iter().all(|v| v.is_finite()), "{kind:?}");
        }
        let geometry = PreparedGeometry::new(&mesh, WeldMode::EqualPositions, Progress::none()).unwrap();
        let error = surface_signal(&geometry, SurfaceSignal::Density, Progress::none()).unwrap_err();
        assert!(error.to_string().contains("cloud"));
    }
}

#[test]
fn a_torus_curves_most_around_its_tube() {
    let torus = Sample::from_name("torus", Some(6000)).unwrap();
    let ring = |p: &[f64; 3]| p[0].hypot(p[1]);
    let (outer, inner) = torus
        .points
        .iter()
        .map(ring)
        .fold((0.0_f64, f64::INFINITY), |(most, least), r| (most.max(r), least.min(r)));
    let (big, small) = (0.5 * (outer + inner), 0.5 * (outer - inner));
    let shapes = [
        mesh(torus.points.clone(), torus.faces.clone()),
        Shape::Cloud(PointCloud::new(torus.points.clone()).unwrap()),
    ];
    for shape in shapes {
        let lines = signal(&shape, SurfaceSignal::PrincipalDirection);
        let lines: &[[f64; 3]] = lines.as_chunks().0;
        let lengths: Vec<f64> = lines.iter().map(|v| v.iter().map(|c| c * c).sum::<f64>().sqrt()).collect();
        let off = median_error(&lengths, |x| big / (small * ring(&torus.points[x])));
        assert!(off < 0.03 / small, "{off}");
        // Orthogonal to the direction around the axis.
        let along = |x: usize| {
            let (p, v) = (torus.points[x], lines[x]);
            (v[1] * p[0] - v[0] * p[1]) / (ring(&p) * lengths[x])
        };
        let along: Vec<f64> = (0..lines.len()).map(along).collect();
        assert!(median_error(&along, |_| 0.0) < 0.02);
    }
    // A sphere curves alike in all directions; what is left is the error of normals on uneven triangles.
    let sphere = Sample::from_name("sphere", Some(2000)).unwrap();
    let lines = signal(&mesh(sphere.points, sphere.faces), SurfaceSignal::PrincipalDirection);
    assert!(median_error(&lines, |_| 0.0) < 0.03 && lines.iter().all(|v| v.abs() < 0.4));
}
