//! Registration of two meshes of one shape, and correspondence of their features.

use adwave::operator::{OperatorKind, OperatorParams};
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Graph, Mesh, PointCloud, PreparedGeometry, Shape, WeldMode};
use adwave::{Cancelled, Decomposer, Progress};
use adwave_register::{
    AlignParams, CLEAR_CONFIDENCE, ClosestPointSearch, DescribeError, Motion, PairParams, Registrand,
    Registration, SearchParams, Signs, align, closest_fit, common_lengths, describe_shape, fit_in_place,
    pairs_under, register, signed_distances,
};
use cases::Terrain;

mod cases;

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

fn both(first: &Shape, second: &Shape) -> [Registrand; 2] {
    described(first, second, None)
}

/// Both shapes with their significant features, or with those of a threshold θ.
fn described(first: &Shape, second: &Shape, theta: Option<f64>) -> [Registrand; 2] {
    let decomposers = [prepared(first), prepared(second)];
    let lengths = common_lengths(&decomposers[0], &decomposers[1]).unwrap();
    decomposers.map(|decomposer| {
        let found = describe_shape(&decomposer, None, &lengths, theta, Progress::none()).unwrap();
        Registrand::new(&decomposer, found, Progress::none()).unwrap().unwrap()
    })
}

fn registration(first: &Shape, second: &Shape, params: &SearchParams) -> Registration {
    let [a, b] = both(first, second);
    register(&a, &b, params, Progress::none()).unwrap()
}

/// Largest distance between the images of points under two motions, relative to their extent.
fn farthest(points: &[[f64; 3]], motion: &Motion, truth: &Motion) -> f64 {
    let distance = points.iter().map(|p| off(&motion.apply(p), &truth.apply(p))).fold(0.0, f64::max);
    distance / adwave::shape::diagonal(points)
}

fn off(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn features_of_two_meshings_are_paired_rightly_whatever_the_motion() {
    let truth = Motion::new([0.3, -2.0, 1.1], [4.0, -1.0, 0.5]);
    let (first, second) = (creature(9000, 0.1, 1, &Motion::default()), creature(14_000, 0.1, 2, &truth));
    let [a, b] = both(&first, &second);
    assert!(a.features.is_signed && b.features.is_signed);
    let found = register(&a, &b, &SearchParams::default(), Progress::none()).unwrap();
    let best = found.clear().unwrap_or_else(|| panic!("{found:?}"));
    let error = farthest(first.points().unwrap(), &best.motion, &truth);
    assert!(error < 0.002 && best.fit.overlap > 0.99, "{error}, {best:?}");
    assert!(found.equal.is_empty() && found.confidence() == CLEAR_CONFIDENCE, "{:?}", found.equal);
    let found_pairs = |a: &Registrand, b: &Registrand| {
        let keys = [&a.features.keys, &b.features.keys];
        let pairs = pairs_under(keys[0], keys[1], &[best.motion], &PairParams::default());
        let right = |p: &&adwave_register::Pair| {
            let [first, second] = [&keys[0][p.first], &keys[1][p.second]];
            off(&truth.apply(&first.position), &second.position) <= 1.05 * second.sigma
        };
        let n_right = pairs.iter().filter(right).count();
        assert_eq!(n_right, pairs.len(), "right pairs of all");
        pairs
    };
    // More than half of the significant features of the first have a partner.
    let pairs = found_pairs(&a, &b);
    assert!(2 * pairs.len() > a.features.keys.len(), "{} of {}", pairs.len(), a.features.keys.len());
    let [c, d] = described(&first, &second, Some(1.0));
    assert!(found_pairs(&c, &d).len() >= 30);
    assert!(pairs.iter().all(|p| (0.0..=1.0).contains(&p.confidence)));
    // No feature is in two pairs.
    let mut seconds: Vec<usize> = pairs.iter().map(|p| p.second).collect();
    seconds.sort_unstable();
    assert!(seconds.windows(2).all(|w| w[0] < w[1]));
}

#[test]
fn no_motion_is_clear_between_shapes_that_have_nothing_in_common() {
    let mut torus = Sample::from_name("torus", Some(6000)).unwrap();
    torus.add_noise(NoiseSigma::MeanEdge(0.3), 3).unwrap();
    let torus = Shape::Mesh(Mesh::new(torus.points, torus.faces).unwrap());
    let creature = creature(6000, 0.1, 1, &Motion::default());
    for scaled in [false, true] {
        let params = SearchParams::default().with_scaled(scaled);
        let found = registration(&creature, &torus, &params);
        assert!(found.clear().is_none(), "{:?}", found.best);
        assert!(found.candidates.iter().all(|found| found.motion.scale() > 0.0));
    }
    for seed in 0..3 {
        let patches = [2 * seed, 2 * seed + 1].map(|s| Terrain::new(s).patch(0.0, 0.0, 60, 60).shape());
        let found = registration(&patches[0], &patches[1], &SearchParams::default());
        assert!(found.clear().is_none(), "terrains {seed}: {:?}", found.best);
    }
}

#[test]
fn halves_that_share_no_vertex_have_no_motion() {
    let creature = Sample::from_name("creature", Some(8000)).unwrap();
    let triangles = adwave::shape::triangulate(&creature.points, &creature.faces);
    let surface = cases::Surface { points: creature.points, triangles };
    for direction in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
        let [a, b] = surface.parts(&direction, 0.45, 0.55);
        let found = registration(&a.shape(), &b.shape(), &SearchParams::default());
        assert!(found.clear().is_none(), "{direction:?}: {:?}", found.best);
    }
}

#[test]
fn overlapping_terrains_are_brought_together() {
    for (seed, overlap) in [(0, 0.5_f64), (1, 0.5), (2, 0.3)] {
        let terrain = Terrain::new(seed);
        let shift = (80.0 * (1.0 - overlap)).round();
        let truth = cases::Random::new(seed).motion(30.0);
        let first = terrain.patch(0.0, 0.0, 80, 80).noisy(0.1, 1);
        // The second grid lies between the points of the first.
        let second = terrain.patch(shift + 0.4, 0.6, 80, 79).noisy(0.1, 2).moved(&truth);
        let found = registration(&first.shape(), &second.shape(), &SearchParams::default());
        let best = found.clear().unwrap_or_else(|| panic!("{seed}: {found:?}"));
        let error = farthest(&first.points, &best.motion, &truth);
        assert!(error < 0.005, "{seed}: {error}");
    }
}

#[test]
fn equal_motions_are_all_listed() {
    // A cross of four equal bumps on a round, flat dish fits after every quarter turn.
    let height = |x: f64, y: f64| {
        let bump = |cx: f64, cy: f64| (-((x - cx).powi(2) + (y - cy).powi(2)) / 6.0).exp();
        let dent = |cx: f64, cy: f64| -0.7 * (-((x - cx).powi(2) + (y - cy).powi(2)) / 3.0).exp();
        [(12.0, 3.0), (-3.0, 12.0), (-12.0, -3.0), (3.0, -12.0)]
            .map(|(cx, cy)| 2.0 * bump(cx, cy))
            .iter()
            .sum::<f64>()
            + [(5.0, 8.0), (-8.0, 5.0), (-5.0, -8.0), (8.0, -5.0)]
                .map(|(cx, cy)| 2.0 * dent(cx, cy))
                .iter()
                .sum::<f64>()
    };
    let mut dish = Terrain::new(1).patch(-20.0, -20.0, 41, 41);
    for p in &mut dish.points {
        p[2] = height(p[0], p[1]);
    }
    let dish = dish.cut_round(19.0);
    let truth = Motion::new([0.4, 0.2, -0.3], [1.0, 2.0, 3.0]);
    let (first, second) = (dish.clone().noisy(0.02, 1), dish.noisy(0.02, 2).moved(&truth));
    let found = registration(&first.shape(), &second.shape(), &SearchParams::default());
    let best = found.clear().unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(found.equal.len(), 3, "{found:?}");
    assert!((found.confidence() - CLEAR_CONFIDENCE / 4.0).abs() < 1e-12);
    let is_right = |motion: &Motion| farthest(&first.points, motion, &truth) < 0.01;
    let n_right = found.equal.iter().chain([best]).filter(|found| is_right(&found.motion)).count();
    assert_eq!(n_right, 1);
}

#[test]
fn a_motion_and_its_angle_are_numbers_for_equal_shapes() {
    let points: Vec<[f64; 3]> = creature(2000, 0.0, 1, &Motion::default()).points().unwrap().to_vec();
    let found = Motion::fit(&points, &points, &vec![1.0; points.len()], false).unwrap();
    assert!(found.degrees() < 1e-6, "{}", found.degrees());
    for degrees in [1e-7_f64, 0.3, 90.0, 179.9, 180.0] {
        let turn = Motion::new([0.0, degrees.to_radians(), 0.0], [1.0; 3]);
        assert!((turn.degrees() - degrees).abs() < 1e-9 * degrees.max(1.0), "{degrees}: {}", turn.degrees());
    }
}

#[test]
fn a_ball_with_bumps_is_turned_back_and_a_plain_ball_has_no_motion() {
    let ball = |bumps: bool, seed: u64| {
        let mut sample = Sample::from_name("sphere", Some(6000)).unwrap();
        sample.add_noise(NoiseSigma::MeanEdge(0.01), seed).unwrap();
        let sizes =
            [([0.9, 0.3, 0.2], 0.1, 0.1), ([0.0, 0.0, 1.0], 0.06, 0.15), ([0.0, 1.0, 0.0], 0.05, 0.2)];
        for p in sample.points.iter_mut().filter(|_| bumps) {
            let height = |(c, a, w): &([f64; 3], f64, f64)| a * (-off(p, c).powi(2) / (2.0 * w * w)).exp();
            let growth = 1.0 + sizes.iter().map(height).sum::<f64>();
            *p = p.map(|c| growth * c);
        }
        Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
    };
    let first = ball(true, 1);
    for degrees in [10.0_f64, 100.0] {
        let truth = Motion::new([0.3, -0.6, 0.7416].map(|c| c * degrees.to_radians()), [0.0; 3]);
        let points = first.points().unwrap().iter().map(|p| truth.apply(p)).collect();
        let Shape::Mesh(mesh) = &first else { unreachable!() };
        let second = Shape::Mesh(Mesh::new(points, mesh.faces().clone()).unwrap());
        let [a, b] = both(&first, &second);
        let in_place = fit_in_place(&a, &b, Progress::none()).unwrap();
        // A start at 10° may end at the bumps, a start at 100° cannot.
        assert!(degrees < 90.0 || in_place.is_none());
        let found = in_place.or(closest_fit(&a, &b, Progress::none()).unwrap()).unwrap();
        let error = farthest(first.points().unwrap(), &found.motion, &truth);
        assert!(error < 0.002 && found.is_certain, "{degrees}: {error}, {found:?}");
    }
    let found = registration(&ball(false, 1), &ball(false, 2), &SearchParams::default());
    assert!(found.clear().is_none(), "{:?}", found.best);
}

#[test]
fn a_fit_finds_motion_and_size_and_is_not_tilted_by_what_differs() {
    let shape = creature(8000, 0.0, 1, &Motion::default());
    let target = geometry(&shape);
    let surface = ClosestPointSearch::new(&target, Progress::none()).unwrap().unwrap();
    let truth = Motion::new([0.05, 0.02, -0.04], [0.02, -0.01, 0.03]);
    for scaled in [false, true] {
        let truth = if scaled { truth.scaled_by(1.03) } else { truth };
        let mut points: Vec<[f64; 3]> = target.points().iter().map(|p| truth.inverse().apply(p)).collect();
        // A tenth of the vertices, all on one side, are displaced.
        let n = points.len();
        for p in points.iter_mut().take(n / 10) {
            p[0] += 0.03 * target.shape().diagonal();
        }
        let params = AlignParams::default().with_scaled(scaled);
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
    let surface = ClosestPointSearch::new(&above, Progress::none()).unwrap().unwrap();
    let normals = Signs::Own(vec![[0.0, 0.0, 1.0]; below.points().len()]);
    let found =
        signed_distances(below.points(), &normals, &surface, f64::INFINITY, Progress::none()).unwrap();
    for (p, d) in below.points().iter().zip(&found.values) {
        // The outline of the square above is exactly above, not beyond its border.
        assert!(if p[0] <= 1.0 { (d - 0.25).abs() < 1e-12 } else { d.is_nan() }, "{p:?}: {d}");
    }
    let turned = Signs::Own(vec![[0.0, 0.0, -1.0]; below.points().len()]);
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
    let surface = ClosestPointSearch::new(&target, Progress::none()).unwrap().unwrap();
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
    let surface = ClosestPointSearch::new(&cloud, Progress::none()).unwrap().unwrap();
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
    assert!(matches!(ClosestPointSearch::new(graph.geometry().unwrap(), Progress::none()), Ok(None)));
}

#[test]
fn a_search_that_is_cancelled_is_not_built() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    let sphere = Sample::from_name("sphere", Some(1000)).unwrap();
    let cloud = Shape::Cloud(PointCloud::new(sphere.points.clone()).unwrap());
    let mesh = Shape::Mesh(Mesh::new(sphere.points, sphere.faces).unwrap());
    for shape in [mesh, cloud] {
        assert!(matches!(ClosestPointSearch::new(&geometry(&shape), progress), Err(Cancelled)));
    }
}
