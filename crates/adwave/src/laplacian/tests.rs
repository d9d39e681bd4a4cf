use super::*;
use crate::sample::Sample;
use crate::shape::{Mesh, PointCloud, Polygons, WeldMode, surface_area};
use proptest::prelude::*;

/// Rounding of sums of a few thousand terms.
const ROUNDING: f64 = 1e-11;

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> PreparedGeometry {
    let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(triangles)).unwrap();
    PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none()).unwrap()
}

fn sample(name: &str, n: usize) -> PreparedGeometry {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    let mesh = Mesh::new(sample.points, sample.faces).unwrap();
    PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none()).unwrap()
}

fn laplacian(geometry: &PreparedGeometry) -> Laplacian {
    Laplacian::new(geometry, 10, Progress::none()).unwrap()
}

/// The product `(L f)(x)`.
fn product(l: &Laplacian, f: &[f64]) -> Vec<f64> {
    let row = |x: usize| {
        let (columns, weights) = l.weights().row(x);
        columns.iter().zip(weights).map(|(&y, w)| w * (f[x] - f[y as usize])).sum()
    };
    (0..f.len()).map(row).collect()
}

fn is_symmetric_and_positive(l: &Laplacian) -> bool {
    let n = l.areas().len();
    (0..n).all(|x| {
        let (columns, weights) = l.weights().row(x);
        columns.iter().zip(weights).all(|(&y, &w)| {
            w > 0.0 && w.is_finite() && y as usize != x && l.weights().get(y as usize, x) == w
        })
    }) && l.areas().iter().all(|m| m.is_finite() && *m >= 0.0)
}

/// A grid with displaced inner vertices, so that some triangles are obtuse.
fn uneven_plane(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let inside = |i: u32, j: u32| i > 0 && j > 0 && i < n - 1 && j < n - 1;
    let shift = |i: u32, j: u32, k: u32| {
        if inside(i, j) { 0.4 * f64::from((i * 7 + j * 5 + k) % 9) / 9.0 } else { 0.0 }
    };
    let points = (0..n)
        .flat_map(|i| {
            (0..n).map(move |j| [f64::from(i) + shift(i, j, 0), f64::from(j) + shift(i, j, 4), 0.0])
        })
        .collect();
    let triangles = (0..n - 1)
        .flat_map(|i| (0..n - 1).map(move |j| n * i + j))
        .flat_map(|a| [[a, a + n, a + n + 1], [a, a + n + 1, a + 1]])
        .collect();
    (points, triangles)
}

#[test]
fn masses_sum_to_the_area_and_weights_are_symmetric_and_positive() {
    for name in ["sphere", "torus", "knot", "creature", "plane"] {
        let geometry = sample(name, 2000);
        let area = surface_area(geometry.points(), geometry.triangles());
        let l = laplacian(&geometry);
        assert!((l.areas().iter().sum::<f64>() / area - 1.0).abs() < ROUNDING, "{name}");
        assert!(is_symmetric_and_positive(&l), "{name}");
        assert!(!l.info().is_covered || name == "plane", "{name}");
    }
}

#[test]
fn linear_functions_are_harmonic_inside_a_flat_mesh_whatever_way_its_triangles_run() {
    let (points, mut triangles) = uneven_plane(12);
    for turned in [false, true] {
        if turned {
            triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
        }
        let geometry = mesh(&points, &triangles);
        let l = laplacian(&geometry);
        assert_eq!(l.info().is_covered, turned || l.info().is_covered);
        assert!(l.info().n_flips > 0 && is_symmetric_and_positive(&l));
        let f: Vec<f64> = geometry.points().iter().map(|p| 2.0 * p[0] - 3.0 * p[1]).collect();
        for (p, v) in geometry.points().iter().zip(product(&l, &f)) {
            let inside = (0..2).all(|c| p[c] > 1.5 && p[c] < 9.5);
            assert!(!inside || v.abs() < ROUNDING, "{p:?}: {v:e}");
        }
    }
}

#[test]
fn the_cover_of_a_surface_has_the_weights_of_the_surface() {
    let geometry = sample("torus", 800);
    let sheet = laplacian(&geometry);
    let mut triangles = geometry.triangles().to_vec();
    triangles[5].swap(1, 2);
    let covered = mesh_laplacian(geometry.points(), &triangles, MassCells::Thirds, Progress::none()).unwrap();
    assert!(covered.info().is_covered && !sheet.info().is_covered);
    for x in 0..geometry.n_vertices() {
        assert!((sheet.areas()[x] / covered.areas()[x] - 1.0).abs() < 1e-9);
        let (columns, weights) = sheet.weights().row(x);
        for (&y, w) in columns.iter().zip(weights) {
            assert!((w - covered.weights().get(x, y as usize)).abs() < 1e-8, "{x} {y}");
        }
    }
}

#[test]
fn an_obtuse_corner_at_the_border_has_no_negative_weight() {
    // A thin kite: the diagonal 0–1 is opposite two obtuse angles, and without it the border is.
    let points = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, -0.1, 0.0]];
    for triangles in [&[[0, 1, 2], [1, 0, 3]][..], &[[0, 1, 2]]] {
        let geometry = mesh(&points, triangles);
        let l = laplacian(&geometry);
        let area = surface_area(geometry.points(), geometry.triangles());
        assert!(is_symmetric_and_positive(&l));
        assert!((l.areas().iter().sum::<f64>() / area - 1.0).abs() < ROUNDING);
        assert!((0..3).all(|x| !l.weights().row(geometry.vertex_map().welded(x)).0.is_empty()));
    }
}

#[test]
fn three_sheets_at_an_edge_share_what_flows() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -0.5, 0.8], [0.5, -0.5, -0.8]];
    let geometry = mesh(&points, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    let l = laplacian(&geometry);
    assert!(l.info().is_covered && is_symmetric_and_positive(&l));
    let [far, low, high] = [2, 3, 4].map(|x| geometry.vertex_map().welded(x));
    let at = |x: usize| l.weights().row(x).1.iter().sum::<f64>();
    assert!((at(low) - at(high)).abs() < ROUNDING && at(far) > 0.0);
}

#[test]
fn faces_without_area_are_made_proper() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]];
    let geometry = mesh(&points, &[[0, 1, 2], [0, 1, 3], [3, 3, 0]]);
    let l = laplacian(&geometry);
    assert!(l.info().lengthened > 0.0 && l.info().lengthened < 1e-3 && is_symmetric_and_positive(&l));
    assert!((0..4).all(|x| l.areas()[geometry.vertex_map().welded(x)] > 0.0));
    assert_eq!(l.areas()[geometry.vertex_map().welded(4)], 0.0);
}

#[test]
fn a_cloud_knows_the_plane_up_to_its_border() {
    for shift in [0.0, 0.3] {
        let at = |i: i32, j: i32| {
            let off = |k: i32| shift * f64::from((i * 7 + j * 5 + k) % 9) / 9.0;
            [f64::from(i) + off(0), f64::from(j) + off(4), 0.0]
        };
        let points: Vec<_> =
            (0..30).flat_map(|i| (0..30).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
        let cloud = Shape::Cloud(PointCloud::new(points).unwrap());
        let geometry = PreparedGeometry::new(&cloud, WeldMode::default(), Progress::none()).unwrap();
        let l = laplacian(&geometry);
        assert!(is_symmetric_and_positive(&l));
        let f: Vec<f64> = geometry.points().iter().map(|p| 2.0 * p[0] - 3.0 * p[1]).collect();
        for (x, v) in product(&l, &f).iter().enumerate() {
            let p = geometry.points()[x];
            let inside = (0..2).all(|c| p[c] > 3.0 && p[c] < 26.0);
            assert!(!inside || v.abs() < 1e-9, "{p:?}: {v:e}");
        }
        let total: f64 = l.areas().iter().sum();
        // A ragged border may be filled in places.
        assert!((total / (29.0 * 29.0) - 1.0).abs() < if shift > 0.0 { 0.05 } else { 1e-9 }, "{total}");
    }
}

#[test]
fn points_on_a_line_are_joined_along_it() {
    let points = (0..30).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let cloud = Shape::Cloud(PointCloud::new(points).unwrap());
    let geometry = PreparedGeometry::new(&cloud, WeldMode::default(), Progress::none()).unwrap();
    let l = laplacian(&geometry);
    assert!(is_symmetric_and_positive(&l));
    for x in 0..30 {
        let p = geometry.points()[x][0];
        let (columns, weights) = l.weights().row(x);
        assert!(columns.iter().all(|&y| (geometry.points()[y as usize][0] - p).abs() < 1.5), "{columns:?}");
        // The second derivative of x² is 2.
        let f = |y: usize| geometry.points()[y][0].powi(2);
        let sum: f64 = columns.iter().zip(weights).map(|(&y, w)| w * (f(y as usize) - f(x))).sum();
        assert!(
            !(10.5..18.5).contains(&p) || (sum / l.areas()[x] - 2.0).abs() < 1e-9,
            "{}",
            sum / l.areas()[x]
        );
    }
}

#[test]
fn a_graph_has_its_weights() {
    let shape = Shape::Graph(Graph::new(2, &[(0, 1, 2.5)]).unwrap());
    let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()).unwrap();
    let l = laplacian(&geometry);
    assert_eq!((l.weights().get(0, 1), l.areas()), (2.5, vec![1.0, 1.0]));
}

proptest! {
    #[test]
    fn any_triangles_give_finite_weights(
        points in prop::collection::vec(prop::array::uniform3(-3_i8..4), 3..12),
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 1..30),
    ) {
        let n = points.len() as u32;
        let points: Vec<[f64; 3]> = points.into_iter().map(|p| p.map(f64::from)).collect();
        let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|t| t.map(|c| c % n)).collect();
        let geometry = mesh(&points, &triangles);
        let l = laplacian(&geometry);
        prop_assert!(is_symmetric_and_positive(&l));
        let cloud = Shape::Cloud(PointCloud::new(points).unwrap());
        let geometry = PreparedGeometry::new(&cloud, WeldMode::default(), Progress::none()).unwrap();
        prop_assert!(is_symmetric_and_positive(&laplacian(&geometry)));
    }
}
