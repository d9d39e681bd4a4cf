//! Registration of two meshes of one shape, and correspondence of their features.

use adwave::operator::{OperatorKind, OperatorParams};
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Graph, Mesh, PointCloud, PreparedGeometry, Shape, WeldMode, surface_area};
use adwave::{Decomposer, Progress};
use adwave_register::{
    AlignParams, ConsensusParams, DescribeError, Motion, PairParams, ShapeFeatures, Surface, align,
    common_lengths, consensus, describe_shape, pairs_under, signed_distances,
};

fn prepared(shape: &Shape) -> Decomposer {
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    Decomposer::with_params(shape, &params, Progress::none()).unwrap()
}

/// Noisy creature with about n vertices, after a motion.
fn creature(n_vertices: usize, noise: f64, seed: u64, motion: &Motion) -> Shape {
    let mut sample = Sample::from_name("creature", Some(n_vertices)).unwrap();
    sample.add_noise(NoiseSigma::MeanEdge(noise), seed).unwrap();
    let points = sample.points.iter().map(|p| motion.apply(p)).collect();
    Shape::Mesh(Mesh::new(points, sample.faces).unwrap())
}

fn geometry(shape: &Shape) -> PreparedGeometry {
    PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap()
}

fn both(first: &Shape, second: &Shape) -> [(Decomposer, ShapeFeatures); 2] {
    let walks = [prepared(first), prepared(second)];
    let lengths = common_lengths(&walks[0], &walks[1]).unwrap();
    walks.map(|decomposer| {
        let found = describe_shape(&decomposer, None, &lengths, 1.0, Progress::none()).unwrap();
        (decomposer, found)
    })
}

fn off(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn features_of_two_meshings_are_paired_rightly_whatever_the_motion() {
    let truth = Motion::new([0.3, -2.0, 1.1], [4.0, -1.0, 0.5]);
    let (first, second) = (creature(9000, 0.1, 1, &Motion::default()), creature(14_000, 0.1, 2, &truth));
    let [(decomposer, a), (other, b)] = both(&first, &second);
    assert!(a.is_signed && b.is_signed);
    let params = ConsensusParams::default();
    let found = consensus(&a, &b, &params, Progress::none());
    let found = found.unwrap().unwrap();
    assert!(found.is_clear(), "{} of {}", found.n_agreeing, found.n_by_chance);
    let surface = Surface::new(other.geometry()).unwrap();
    let (motion, info) = align(
        decomposer.geometry().points(),
        &surface,
        found.motion,
        &AlignParams::default(),
        Progress::none(),
    )
    .unwrap();
    let diagonal = decomposer.diagonal();
    let farthest = decomposer
        .geometry()
        .points()
        .iter()
        .map(|p| off(&motion.apply(p), &truth.apply(p)))
        .fold(0.0, f64::max);
    assert!(farthest < 0.002 * diagonal && info.overlap > 0.99, "{farthest}, {info:?}");
    let area = surface_area(other.geometry().points(), other.geometry().triangles());
    let pairs = pairs_under(&a.keys, &b.keys, &motion, area, &PairParams::default());
    let right = |p: &&adwave_register::Pair| {
        off(&truth.apply(&a.keys[p.first].position), &b.keys[p.second].position)
            <= 2.0 * b.keys[p.second].sigma
    };
    let n_right = pairs.iter().filter(right).count();
    assert!(pairs.len() >= 30 && 10 * n_right >= 8 * pairs.len(), "{n_right} of {}", pairs.len());
    assert!(pairs.iter().all(|p| (0.0..=1.0).contains(&p.confidence)));
    // No feature is in two pairs.
    let mut seconds: Vec<usize> = pairs.iter().map(|p| p.second).collect();
    seconds.sort_unstable();
    assert!(seconds.windows(2).all(|w| w[0] < w[1]));
}

#[test]
fn no_motion_is_clear_between_shapes_that_have_nothing_in_common() {
    let torus = Sample::from_name("torus", Some(6000)).unwrap();
    let mut torus = torus;
    torus.add_noise(NoiseSigma::MeanEdge(0.3), 3).unwrap();
    let torus = Shape::Mesh(Mesh::new(torus.points, torus.faces).unwrap());
    let [(_, a), (_, b)] = both(&creature(6000, 0.1, 1, &Motion::default()), &torus);
    let params = ConsensusParams { tries: 20_000, ..ConsensusParams::default() };
    let found = consensus(&a, &b, &params, Progress::none());
    assert!(found.unwrap().is_none_or(|found| !found.is_clear()));
}

#[test]
fn a_fit_finds_motion_and_size_and_is_not_tilted_by_what_differs() {
    let shape = creature(8000, 0.0, 1, &Motion::default());
    let target = geometry(&shape);
    let surface = Surface::new(&target).unwrap();
    let truth = Motion::new([0.05, 0.02, -0.04], [0.02, -0.01, 0.03]);
    for scaled in [false, true] {
        let truth = if scaled { truth.scaled_by(1.03) } else { truth };
        let mut points: Vec<[f64; 3]> = target.points().iter().map(|p| truth.inverse().apply(p)).collect();
        // A tenth of the vertices, all on one side, are displaced.
        let n = points.len();
        for p in points.iter_mut().take(n / 10) {
            p[0] += 0.03 * target.shape().diagonal();
        }
        let params = AlignParams { scaled, ..AlignParams::default() };
        let (motion, _) = align(&points, &surface, Motion::default(), &params, Progress::none()).unwrap();
        let farthest = target.points()[n / 10..]
            .iter()
            .map(|p| off(&motion.then(&truth.inverse()).apply(p), p))
            .fold(0.0, f64::max);
        assert!(farthest < 1e-4 * target.shape().diagonal(), "{scaled}: {farthest}");
    }
}

#[test]
fn distances_have_the_sign_of_the_side_and_none_beyond_a_border() {
    // A flat square and one above it whose right half is missing.
    let grid = |n: u32, height: f64| {
        let points: Vec<[f64; 3]> = (0..=n * 20)
            .flat_map(|i| (0..=20).map(move |j| [f64::from(i) / 20.0, f64::from(j) / 20.0, height]))
            .collect();
        let faces: Vec<[u32; 3]> = (0..n * 20)
            .flat_map(|i| {
                (0..20).flat_map(move |j| {
                    let v = 21 * i + j;
                    [[v, v + 21, v + 22], [v, v + 22, v + 1]]
                })
            })
            .collect();
        Shape::Mesh(Mesh::new(points, adwave::shape::Polygons::from_triangles(&faces)).unwrap())
    };
    let (below, above) = (geometry(&grid(2, 0.0)), geometry(&grid(1, 0.25)));
    let surface = Surface::new(&above).unwrap();
    let normals = vec![[0.0, 0.0, 1.0]; below.points().len()];
    let found =
        signed_distances(below.points(), &normals, &surface, f64::INFINITY, Progress::none()).unwrap();
    for (p, d) in below.points().iter().zip(&found.values) {
        let inner = p[0] > 0.0 && p[0] < 1.0 && p[1] > 0.0 && p[1] < 1.0;
        assert!(if inner { (d - 0.25).abs() < 1e-12 } else { d.is_nan() }, "{p:?}: {d}");
    }
    let turned = vec![[0.0, 0.0, -1.0]; below.points().len()];
    let under = signed_distances(below.points(), &turned, &surface, f64::INFINITY, Progress::none()).unwrap();
    assert!(
        found
            .values
            .iter()
            .zip(&under.values)
            .all(|(a, b)| a.is_nan() == b.is_nan() && (a.is_nan() || *a == -b))
    );
    let near = signed_distances(below.points(), &normals, &surface, 0.2, Progress::none()).unwrap();
    assert!(near.values.iter().all(|d| d.is_nan()) && near.n_too_far > 0);
}

#[test]
fn the_closest_point_of_a_mesh_is_that_of_all_its_triangles() {
    let shape = creature(2000, 0.2, 4, &Motion::default());
    let target = geometry(&shape);
    let surface = Surface::new(&target).unwrap();
    let (_, size) = (0, target.shape().diagonal());
    for k in 0..200 {
        let t = f64::from(k);
        let p = [0.3 * size * (1.7 * t).sin(), 0.3 * size * (2.3 * t).cos(), 0.3 * size * (0.7 * t).sin()];
        let found = surface.closest(&p);
        let mix: [f64; 3] = std::array::from_fn(|c| {
            (0..3).map(|k| found.weights[k] * target.points()[found.corners[k] as usize][c]).sum()
        });
        assert!(off(&mix, &found.point) < 1e-9 * size);
        // Sampling every triangle finds no nearer point.
        let least = target.triangles().iter().flat_map(|t| {
            let corners = t.map(|v| target.points()[v as usize]);
            (0..=4).flat_map(move |i| {
                (0..=4 - i).map(move |j| {
                    let (u, v) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
                    std::array::from_fn(|c| {
                        (1.0 - u - v) * corners[0][c] + u * corners[1][c] + v * corners[2][c]
                    })
                })
            })
        });
        let least = least.map(|q: [f64; 3]| off(&p, &q)).fold(f64::INFINITY, f64::min);
        assert!(off(&p, &found.point) <= least * (1.0 + 1e-12), "{k}");
    }
}

#[test]
fn points_of_a_cloud_stand_for_the_surface_between_them() {
    let sphere = Sample::from_name("sphere", Some(4000)).unwrap();
    let cloud = geometry(&Shape::Cloud(PointCloud::new(sphere.points).unwrap()));
    let surface = Surface::new(&cloud).unwrap();
    for k in 0..100 {
        let t = f64::from(k);
        let p = [(1.7 * t).sin(), (2.3 * t).cos(), (0.7 * t).sin()];
        let length = off(&p, &[0.0; 3]);
        let found = surface.closest(&p.map(|c| 1.01 * c / length));
        assert!(!found.is_border && (off(&found.point, &[0.0; 3]) - 1.0).abs() < 2e-3, "{found:?}");
    }
}

#[test]
fn what_has_no_extent_is_refused() {
    let graph = Decomposer::new(&Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap()));
    let cloud = prepared(&Shape::Cloud(PointCloud::new(vec![[1.0; 3]; 5]).unwrap()));
    let sphere = prepared(&creature(2000, 0.0, 1, &Motion::default()));
    assert!(matches!(common_lengths(&graph, &sphere), Err(DescribeError::NoPositions)));
    assert!(matches!(common_lengths(&sphere, &cloud), Err(DescribeError::NoExtent)));
    // Points on a line do not determine the rotation about it.
    let line: Vec<[f64; 3]> = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    assert_eq!(Motion::fit(&line, &line, &[1.0; 5], false), None);
    assert!(Surface::new(graph.geometry()).is_none());
}
