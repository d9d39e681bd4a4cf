use super::*;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, surface_area};
use proptest::prelude::*;

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Shape {
    Shape::Mesh(Mesh::new(points.to_vec(), Polygons::from_triangles(triangles)).unwrap())
}

fn sample(name: &str, n: usize) -> Shape {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

fn laplacian(shape: &Shape, triangulation: Triangulation) -> LaplacianMatrices {
    LaplacianMatrices::new(shape, &LaplacianParams::default().with_triangulation(triangulation)).unwrap()
}

/// Rounding error of sums of a few thousand terms.
const ROUNDING: f64 = 1e-11;

#[test]
fn masses_sum_to_the_area_and_constants_have_no_energy() {
    for name in ["sphere", "torus", "knot", "creature"] {
        let shape = sample(name, 2000);
        let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()).unwrap();
        let area = surface_area(geometry.points(), geometry.triangles());
        for triangulation in [Triangulation::AsGiven, Triangulation::IntrinsicDelaunay] {
            let l = laplacian(&shape, triangulation);
            assert!((l.mass.iter().sum::<f64>() / area - 1.0).abs() < ROUNDING, "{name}");
            assert!(l.stiffness.product(&vec![1.0; l.n()]).iter().all(|v| v.abs() < ROUNDING), "{name}");
        }
        assert_eq!(laplacian(&shape, Triangulation::IntrinsicDelaunay).info.n_negative, 0, "{name}");
    }
}

#[test]
fn linear_functions_are_harmonic_on_a_flat_mesh() {
    // A grid whose inner vertices are displaced, so that some triangles are obtuse.
    let n = 12_u32;
    let inside = |i: u32, j: u32| i > 0 && j > 0 && i < n - 1 && j < n - 1;
    let shift = |i: u32, j: u32, k: u32| {
        if inside(i, j) { 0.4 * f64::from((i * 7 + j * 5 + k) % 9) / 9.0 } else { 0.0 }
    };
    let points: Vec<[f64; 3]> = (0..n)
        .flat_map(|i| {
            (0..n).map(move |j| [f64::from(i) + shift(i, j, 0), f64::from(j) + shift(i, j, 4), 0.0])
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..n - 1)
        .flat_map(|i| (0..n - 1).map(move |j| n * i + j))
        .flat_map(|a| [[a, a + n, a + n + 1], [a, a + n + 1, a + 1]])
        .collect();
    let shape = mesh(&points, &triangles);
    for triangulation in [Triangulation::AsGiven, Triangulation::IntrinsicDelaunay] {
        let l = laplacian(&shape, triangulation);
        let mut f = vec![0.0; l.n()];
        for (x, p) in points.iter().enumerate() {
            f[l.vertex_map.welded(x)] = 2.0 * p[0] - 3.0 * p[1];
        }
        let sf = l.stiffness.product(&f);
        for x in (0..n * n).filter(|x| inside(x / n, x % n)) {
            assert!(sf[l.vertex_map.welded(x as usize)].abs() < ROUNDING, "{x}");
        }
    }
    assert!(laplacian(&shape, Triangulation::IntrinsicDelaunay).info.n_flips > 0);
}

#[test]
fn flips_leave_no_negative_weight() {
    // A thin kite: both angles opposite the diagonal 0–1 are obtuse.
    let points = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, -0.1, 0.0]];
    let kite = mesh(&points, &[[0, 1, 2], [1, 0, 3]]);
    assert_eq!(laplacian(&kite, Triangulation::AsGiven).info.n_negative, 1);
    // The border edge opposite an obtuse angle counts too.
    let obtuse = mesh(&points[..3], &[[0, 1, 2]]);
    assert_eq!(laplacian(&obtuse, Triangulation::AsGiven).info.n_negative, 1);
    let l = laplacian(&kite, Triangulation::IntrinsicDelaunay);
    assert!(l.info.n_flips >= 1 && l.info.n_negative == 0);
}

#[test]
fn faces_without_area_are_made_proper() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]];
    let l = laplacian(&mesh(&points, &[[0, 1, 2], [0, 1, 3], [3, 3, 0]]), Triangulation::IntrinsicDelaunay);
    assert!(l.info.lengthened > 0.0 && l.info.lengthened < 1e-3 && l.info.n_massless == 1);
    assert!((0..4).all(|x| l.mass[l.vertex_map.welded(x)] > 0.0));
}

#[test]
fn the_cloud_laplacian_knows_the_plane() {
    let points = (0..40).flat_map(|i| (0..40).map(move |j| [f64::from(i), f64::from(j), 0.0])).collect();
    let cloud = Shape::Cloud(PointCloud::new(points).unwrap());
    let l = laplacian(&cloud, Triangulation::default());
    let geometry = PreparedGeometry::new(&cloud, WeldMode::default(), Progress::none()).unwrap();
    let square: Vec<f64> = geometry.points().iter().map(|p| p[0] * p[0] + p[1] * p[1]).collect();
    let middle = geometry.points().iter().position(|p| p[0] == 20.0 && p[1] == 20.0).unwrap();
    let laplace = -l.stiffness.product(&square)[middle] / l.mass[middle];
    // Most points have the same surroundings as the middle one.
    assert!((laplace - 4.0).abs() < 1e-9, "{laplace}");
}

#[test]
fn a_graph_has_degrees_minus_weights() {
    let l = laplacian(&Shape::Graph(Graph::new(2, &[(0, 1, 2.5)]).unwrap()), Triangulation::default());
    assert_eq!((l.stiffness.get(0, 0), l.stiffness.get(0, 1)), (2.5, -2.5));
}

proptest! {
    #[test]
    fn any_triangles_give_finite_weights_and_a_positive_energy(
        points in prop::collection::vec(prop::array::uniform3(-3_i8..4), 3..12),
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 1..30),
        f in prop::collection::vec(-1.0_f64..1.0, 12),
    ) {
        let n = points.len() as u32;
        let points: Vec<[f64; 3]> = points.into_iter().map(|p| p.map(f64::from)).collect();
        let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|t| t.map(|c| c % n)).collect();
        for triangulation in [Triangulation::AsGiven, Triangulation::IntrinsicDelaunay] {
            let l = laplacian(&mesh(&points, &triangles), triangulation);
            let f = &f[..l.n()];
            let energy: f64 = l.stiffness.product(f).iter().zip(f).map(|(s, f)| s * f).sum();
            let scale: f64 = l.stiffness.diagonal().iter().map(|d| d.abs()).sum::<f64>() + 1.0;
            prop_assert!(energy >= -1e-12 * scale, "{}", energy);
            prop_assert!(l.mass.iter().all(|m| m.is_finite() && *m >= 0.0));
        }
    }
}
