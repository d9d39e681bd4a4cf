use super::*;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, health};
use proptest::prelude::*;

fn sample(name: &str, n: usize) -> Shape {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

fn euler(shape: &Shape) -> i64 {
    let geometry = PreparedGeometry::new(shape, WeldMode::default(), Progress::none()).unwrap();
    let ring = one_ring(geometry.n_vertices(), geometry.triangles());
    health(&geometry, &ring, Progress::none()).unwrap().euler_characteristic.unwrap()
}

fn alternating_sum(points: &[CriticalPoint]) -> i64 {
    let sign = |p: &CriticalPoint| if p.kind == CriticalKind::Saddle { -(p.multiplicity as i64) } else { 1 };
    points.iter().map(sign).sum()
}

#[test]
fn maxima_minus_saddles_plus_minima_is_the_euler_characteristic_of_every_closed_sample() {
    let functions: [fn(&[f64; 3]) -> f64; 4] =
        [|p| p[0], |p| (9.0 * p[1]).sin() * p[2], |_| 0.0, |p| (p[0] * 1e3).fract()];
    for (name, expected) in [("sphere", 2), ("torus", 0), ("knot", 0), ("creature", 2)] {
        let shape = sample(name, 3000);
        assert_eq!(euler(&shape), expected, "{name}");
        let size = shape.diagonal();
        for f in functions {
            let signal: Vec<f64> = shape.points().unwrap().iter().map(f).collect();
            let times = [0.0, 1e-5, 1e-3].map(|t| t * size * size);
            for level in feature_map(&shape, &signal, &times, Progress::none()).unwrap() {
                assert_eq!(alternating_sum(&level.points), expected, "{name} at {}", level.time);
                assert_eq!(level.index_sum, expected, "{name} at {}", level.time);
            }
        }
    }
}

#[test]
fn a_monkey_saddle_counts_twice() {
    let mut points = vec![[0.0, 0.0, 0.0]];
    let mut triangles = Vec::new();
    for i in 0..12_u32 {
        let angle = f64::from(i) * std::f64::consts::PI / 6.0;
        points.push([angle.cos(), angle.sin(), 0.0]);
        triangles.push([0, 1 + i, 1 + (i + 1) % 12]);
    }
    // Re z³, rotated so that no value on the ring is 0.
    let f: Vec<f64> = points
        .iter()
        .map(|p| if p[0] == 0.0 && p[1] == 0.0 { 0.0 } else { (3.0 * p[1].atan2(p[0]) + 0.4).cos() })
        .collect();
    let (found, sum) = critical_points(&triangles, &f);
    let center = found.iter().find(|p| p.vertex == 0).unwrap();
    assert_eq!((center.kind, center.multiplicity), (CriticalKind::Saddle, 2));
    assert_eq!(sum, 1, "a disc");
}

#[test]
fn heat_takes_critical_points_away_and_keeps_the_mean() {
    let shape = sample("sphere", 3000);
    let signal: Vec<f64> = (0..shape.n_vertices()).map(|i| ((i * 7919) % 1009) as f64).collect();
    let size = shape.diagonal();
    let times = [0.0, 1e-3 * size * size, 1e-2 * size * size];
    let levels = feature_map(&shape, &signal, &times, Progress::none()).unwrap();
    assert!(
        levels[0].points.len() > 4 * levels[1].points.len()
            && levels[1].points.len() > 4 * levels[2].points.len()
    );
    let laplacian = LaplacianMatrices::new(&shape, &LaplacianParams::default()).unwrap();
    let mean = |f: &[f64]| {
        laplacian.vertex_map.mean(f, 1).iter().zip(&laplacian.mass).map(|(f, m)| f * m).sum::<f64>()
    };
    assert!((mean(&levels[2].smoothed) / mean(&signal) - 1.0).abs() < 1e-8);
}

#[test]
fn harmonics_of_the_sphere_decay_as_their_eigenvalue_says() {
    let shape = sample("sphere", 4000);
    let points = shape.points().unwrap();
    let radius = shape.diagonal() / 12.0_f64.sqrt();
    let signal: Vec<f64> = points.iter().map(|p| p[2]).collect();
    let time = 0.3 * radius * radius;
    let level = &feature_map(&shape, &signal, &[time], Progress::none()).unwrap()[0];
    let expected = (-2.0 * 0.3_f64).exp();
    // z is the eigenfunction of λ = 2/r², up to the discretization error of the mesh.
    for (s, f) in level.smoothed.iter().zip(&signal) {
        assert!((s - expected * f).abs() < 0.01 * radius, "{s} {f}");
    }
}

#[test]
fn wrong_input_is_named() {
    let cloud = Shape::Cloud(PointCloud::new(vec![[0.0; 3]]).unwrap());
    assert_eq!(feature_map(&cloud, &[0.0], &[], Progress::none()), Err(FeatureMapError::NotAMesh));
    let shape = sample("sphere", 200);
    let f = vec![1.0; shape.n_vertices()];
    assert!(matches!(
        feature_map(&shape, &f[1..], &[], Progress::none()),
        Err(FeatureMapError::Signal { .. })
    ));
    for time in [-1.0, f64::NAN, 1e30] {
        assert!(matches!(
            feature_map(&shape, &f, &[time], Progress::none()),
            Err(FeatureMapError::Time { index: 0, .. })
        ));
    }
}

proptest! {
    #[test]
    fn indices_sum_to_the_euler_characteristic_of_any_triangles(
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..9), 1..25),
        f in prop::collection::vec(-2_i8..3, 9),
    ) {
        let triangles: Vec<[u32; 3]> =
            triangles.into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect();
        let f: Vec<f64> = f.into_iter().map(f64::from).collect();
        let ring = one_ring(9, &triangles);
        let vertices = (0..9).filter(|&x| !ring.row(x).is_empty()).count() as i64;
        let mut faces: Vec<[u32; 3]> = triangles.iter().map(|t| { let mut t = *t; t.sort_unstable(); t }).collect();
        faces.sort_unstable();
        faces.dedup();
        let expected = vertices - (ring.nnz() / 2) as i64 + faces.len() as i64;
        prop_assert_eq!(critical_points(&triangles, &f).1, expected);
    }
}

#[test]
fn no_faces_have_no_critical_points() {
    let shape = Shape::Mesh(Mesh::new(vec![[0.0; 3]], Polygons::new()).unwrap());
    let levels = feature_map(&shape, &[4.0], &[0.0, 1.0], Progress::none()).unwrap();
    assert!(levels.iter().all(|l| l.points.is_empty() && l.smoothed == [4.0]));
}
