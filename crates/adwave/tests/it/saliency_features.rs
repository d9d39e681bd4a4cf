//! Laws of saliency and features: constants give none, and the way a shape is placed, scaled, listed or refined does not matter.

use crate::common;

use adwave::bands::{Bands, Schedule, Wavelets};
use adwave::features::{
    Feature, FeatureError, FeatureParams, Refinement, Response, ThresholdScope, describe, features,
    match_features, select_spread,
};
use adwave::mask::missing;
use adwave::measure::{Change, RepeatabilityParams, change, n_right, repeatability, share_by_chance};
use adwave::operator::OperatorParams;
use adwave::saliency::{SaliencyError, SaliencyParams, Weighting, saliency, saliency_per_level};
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, Shape, WeldMode};
use adwave::{Decomposer, Progress};

/// Sums of a few bands in another order.
const ROUNDING: f64 = 1e-12;
/// Rounding of rotation or scaling, through the walk, relative to the map's largest value.
const COMMUTES: f64 = 1e-6;

const RESPONSES: [Response; 4] =
    [Response::Normalized, Response::Literal, Response::Channels, Response::Sigma];
const WEIGHTINGS: [Weighting; 5] =
    [Weighting::PerLevel, Weighting::AsPrinted, Weighting::Normalized, Weighting::Ranks, Weighting::Uniform];

fn mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points, faces).unwrap())
}

/// A sphere with nine bumps of three widths.
fn potato(n: usize) -> Sample {
    let mut sample = Sample::from_name("sphere", Some(n)).unwrap();
    let tops: Vec<[f64; 3]> = (0..9).map(|k| sample.points[(2 * k + 1) * n / 18]).collect();
    for p in &mut sample.points {
        let bump = |(k, top): (usize, &[f64; 3])| {
            let width = [0.15, 0.22, 0.3][k % 3];
            let square: f64 = (0..3).map(|c| (p[c] - top[c]).powi(2)).sum();
            (1.0 + 0.1 * k as f64) * width * (-square / (width * width)).exp()
        };
        let radius = 1.0 + tops.iter().enumerate().map(bump).sum::<f64>();
        *p = p.map(|c| c * radius);
    }
    sample
}

fn walk(shape: &Shape) -> Decomposer {
    Decomposer::new(shape)
}

fn bands(decomposer: &Decomposer, signal: &[f64], n_channels: usize, levels: usize) -> Wavelets {
    let schedule = Schedule::dyadic(levels).unwrap();
    decomposer.request(signal, n_channels, &schedule).wavelets().unwrap()
}

/// The bands in the order of the shape.
fn to_shape_order(decomposer: &Decomposer, signal: &[f64], n_channels: usize, levels: usize) -> Bands {
    decomposer.decompose(signal, n_channels, &Schedule::dyadic(levels).unwrap()).unwrap()
}

fn coordinate_features(shape: &Shape, levels: usize, params: &FeatureParams) -> Vec<Feature> {
    let walk = walk(shape);
    let bands = bands(&walk, shape.points().unwrap().as_flattened(), 3, levels);
    features(&walk, &bands, params, Progress::none()).unwrap()
}

#[test]
fn a_constant_signal_has_no_saliency_and_no_features() {
    let sample = potato(3000);
    for shape in
        [mesh(sample.points.clone(), sample.faces), Shape::Cloud(PointCloud::new(sample.points).unwrap())]
    {
        let walk = walk(&shape);
        for channels in [1, 3] {
            let bands = bands(&walk, &vec![0.3; channels * shape.n_vertices()], channels, 7);
            for weighting in WEIGHTINGS {
                let params = SaliencyParams::paper().with_weighting(weighting);
                let map = saliency(&walk, &bands, &params, Progress::none()).unwrap().map;
                assert!(map.iter().all(|&v| v == 0.0), "{weighting:?}");
            }
            for response in RESPONSES {
                let params = FeatureParams::default().with_response(response).with_theta(1e-9);
                assert_eq!(features(&walk, &bands, &params, Progress::none()).unwrap(), [], "{response:?}");
            }
        }
    }
}

#[test]
fn scaling_a_shape_scales_sigma_and_leaves_the_set_unchanged() {
    let sample = potato(6000);
    let params = FeatureParams::default().with_refinement(Refinement::Quadratic).with_max_edge_ratio(10.0);
    let reference = coordinate_features(&mesh(sample.points.clone(), sample.faces.clone()), 7, &params);
    assert!(reference.len() > 5, "{}", reference.len());
    for scale in [1e-6, 0.5, 300.0] {
        let points = sample.points.iter().map(|p| p.map(|c| c * scale)).collect();
        let scaled = coordinate_features(&mesh(points, sample.faces.clone()), 7, &params);
        assert_eq!(scaled.len(), reference.len());
        for (a, b) in scaled.iter().zip(&reference) {
            assert_eq!((a.vertex, a.level), (b.vertex, b.level));
            assert!((a.sigma / (scale * b.sigma) - 1.0).abs() < COMMUTES);
            assert!((a.strength / b.strength - 1.0).abs() < COMMUTES);
        }
    }
}

#[test]
fn any_order_of_the_vertices_and_any_number_of_threads_gives_the_same_bits() {
    let sample = potato(5000);
    let n = sample.points.len();
    // A permutation without fixed structure: multiply by a number coprime to n.
    let step = (7919..8919).find(|s| gcd(*s, n) == 1).unwrap();
    let place: Vec<usize> = (0..n).map(|x| x * step % n).collect();
    let mut points = vec![[0.0; 3]; n];
    for (x, &to) in place.iter().enumerate() {
        points[to] = sample.points[x];
    }
    let faces: Vec<Vec<u32>> =
        sample.faces.iter().map(|f| f.iter().map(|&c| place[c as usize] as u32).collect()).collect();
    let shuffled = mesh(points, faces.iter().map(Vec::as_slice).collect());
    let plain = mesh(sample.points, sample.faces);
    for response in RESPONSES {
        let params = FeatureParams::default()
            .with_response(response)
            .with_refinement(Refinement::Quadratic)
            .with_best(40);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let a = one.install(|| coordinate_features(&plain, 7, &params));
        let b = coordinate_features(&shuffled, 7, &params);
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert_eq!(&Feature { vertex: place[a.vertex], ..a.clone() }, b);
        }
    }
    let map = |shape: &Shape| {
        let walk = walk(shape);
        let bands = bands(&walk, shape.points().unwrap().as_flattened(), 3, 7);
        saliency(&walk, &bands, &SaliencyParams::paper(), Progress::none()).unwrap().map
    };
    let (a, b) = (map(&plain), map(&shuffled));
    assert!((0..n).all(|x| a[x].to_bits() == b[place[x]].to_bits()));
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn ties_leave_exactly_one_feature() {
    // Two neighboring nodes with the same value by symmetry; both rows of the walk are mirror images.
    let edges: Vec<_> = (1..40).map(|i| (i - 1, i, 1.0)).collect();
    let graph = Shape::Graph(Graph::new(40, &edges).unwrap());
    let walk = walk(&graph);
    let mut signal = [0.0; 40];
    (signal[19], signal[20]) = (1.0, 1.0);
    let bands = bands(&walk, &signal, 1, 6);
    let map = walk.vertex_map();
    assert_eq!(bands.wavelet(4)[map.welded(19)], bands.wavelet(4)[map.welded(20)]);
    let params = FeatureParams::default().with_response(Response::Literal);
    let found = features(&walk, &bands, &params, Progress::none()).unwrap();
    let tops: Vec<usize> = found.iter().filter(|f| f.sign() > 0).map(|f| f.vertex).collect();
    // Which of the two comes first is the numbering's to say.
    assert!(tops == [19] || tops == [20], "{tops:?}");
}

#[test]
fn the_map_is_the_sum_of_its_levels_and_weighs_them_as_stated() {
    let sample = potato(3000);
    let shape = mesh(sample.points, sample.faces);
    let walk = walk(&shape);
    let bands = bands(&walk, shape.points().unwrap().as_flattened(), 3, 6);
    for weighting in WEIGHTINGS {
        let params = SaliencyParams::paper().with_weighting(weighting).with_skip(1);
        let whole = saliency(&walk, &bands, &params, Progress::none()).unwrap();
        let levels = saliency_per_level(&walk, &bands, &params, Progress::none()).unwrap();
        assert_eq!(levels.len(), 5);
        for x in (0..whole.map.len()).step_by(97) {
            let sum: f64 = levels.iter().map(|(_, map)| map[x]).sum();
            assert!((whole.map[x] - sum).abs() <= ROUNDING * sum);
        }
        let (level, map) = &levels[2];
        assert_eq!((level.level, level.sigma), (4, bands.sigma[4]));
        let (w, vertex_map) = (bands.wavelet(4), walk.vertex_map());
        let norm = |x: usize| w[3 * vertex_map.welded(x)..][..3].iter().map(|v| v * v).sum::<f64>().sqrt();
        if weighting == Weighting::Ranks {
            let below = (0..map.len()).filter(|&x| norm(x) < norm(5)).count();
            assert!((map[5] - below as f64 / (map.len() - 1) as f64).abs() < ROUNDING);
            continue;
        }
        let alpha = match weighting {
            Weighting::PerLevel => (level.max - level.mean).powi(2),
            Weighting::AsPrinted => (level.max - norm(5)).powi(2),
            Weighting::Normalized => 1.0 / level.mean,
            Weighting::Ranks | Weighting::Uniform => 1.0,
            other => unreachable!("{other:?} is not among those of this test"),
        };
        assert!((map[5] - alpha * norm(5)).abs() <= ROUNDING * map[5].abs());
    }
}

#[test]
fn a_border_fades_out_of_a_map_and_nothing_else_does() {
    // Beyond σ a straight border draws coordinates by less than a tenth of what it does at itself, and there the level has
    // only begun to fade in.
    const LEFT: f64 = 0.03;
    let faded = SaliencyParams::paper().with_weighting(Weighting::Uniform).with_border_sigmas(1.0);
    let plain = faded.with_border_sigmas(None);
    let largest = |map: &[f64]| map.iter().copied().fold(0.0, f64::max);
    // A flat plane has nothing but its border. The last level is wider than the plane and has nothing left at all.
    let (plane, faces) = common::plane(60);
    let shape = mesh(plane.clone(), faces);
    let decomposer = walk(&shape);
    let split = bands(&decomposer, shape.points().unwrap().as_flattened(), 3, 14);
    let (with, without) = (
        saliency(&decomposer, &split, &faded, Progress::none()).unwrap(),
        saliency(&decomposer, &split, &plain, Progress::none()).unwrap(),
    );
    assert!(largest(&with.map) < LEFT * largest(&without.map), "{}", largest(&with.map));
    let last = with.levels.last().unwrap();
    assert!(last.sigma > 1.0 && (last.mean, last.max) == (0.0, 0.0));
    for weighting in WEIGHTINGS {
        let map =
            saliency(&decomposer, &split, &faded.with_weighting(weighting), Progress::none()).unwrap().map;
        assert!(map.iter().all(|v| v.is_finite() && *v >= 0.0), "{weighting:?}");
    }
    // S = 0 leaves out the border's own vertices.
    let map = saliency(&decomposer, &split, &faded.with_border_sigmas(0.0), Progress::none()).unwrap().map;
    for ((p, with), without) in plane.iter().zip(&map).zip(&without.map) {
        let on_border = p[0].abs() == 1.0 || p[1].abs() == 1.0;
        assert_eq!(*with, if on_border { 0.0 } else { *without }, "{p:?}");
    }
    // What is far enough from the border keeps its value to the last bit.
    let wave: Vec<f64> = plane.iter().map(|p| (9.0 * p[0]).sin() * (7.0 * p[1]).cos()).collect();
    let split = bands(&decomposer, &wave, 1, 6);
    let [with, without] =
        [&faded, &plain].map(|params| saliency(&decomposer, &split, params, Progress::none()).unwrap().map);
    let far = 1.0 - 2.0 * split.sigma[6];
    let inside = |p: &[f64; 3]| p[0].abs() < far && p[1].abs() < far;
    assert!(plane.iter().filter(|p| inside(p)).count() > 500);
    for x in (0..wave.len()).filter(|&x| inside(&plane[x])) {
        assert_eq!(with[x], without[x]);
    }
    // A closed surface has no border.
    let closed = potato(2000);
    let shape = mesh(closed.points, closed.faces);
    let decomposer = Decomposer::new(&shape);
    let split = bands(&decomposer, shape.points().unwrap().as_flattened(), 3, 6);
    for weighting in WEIGHTINGS {
        let [with, without] = [&faded, &plain].map(|p| {
            saliency(&decomposer, &split, &p.with_weighting(weighting), Progress::none()).unwrap().map
        });
        assert!(with == without, "{weighting:?}");
    }
    for sigmas in [-1.0, f64::NAN, f64::INFINITY] {
        let error =
            saliency(&decomposer, &split, &faded.with_border_sigmas(sigmas), Progress::none()).unwrap_err();
        assert!(error.to_string().contains(&sigmas.to_string()), "{error}");
    }
}

#[test]
fn a_mask_is_left_out_and_not_spread() {
    let sample = potato(4000);
    let shape = mesh(sample.points.clone(), sample.faces);
    let whole = walk(&shape);
    let top = sample.points.iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
    let mut signal: Vec<f64> = sample.points.iter().map(|p| p[0] + p[1] * p[2]).collect();
    for (value, _) in signal.iter_mut().zip(&sample.points).filter(|(_, p)| p[2] > 0.8 * top) {
        *value = f64::NAN;
    }
    let flags = missing(&signal, 1).unwrap();
    assert!(flags.iter().any(|&f| f) && !flags.iter().all(|&f| f));
    let masked = whole.masked(&flags).unwrap();
    let split = bands(&masked, &signal, 1, 6);
    let in_order = to_shape_order(&masked, &signal, 1, 6);
    for band in in_order.as_slice().chunks_exact(signal.len()) {
        assert!(band.iter().zip(&flags).all(|(v, &out)| v.is_nan() == out));
    }
    // What stands in the gap makes no difference, and constants stay constant up to its rim.
    let filled: Vec<f64> = signal.iter().map(|v| if v.is_nan() { 1e9 } else { *v }).collect();
    let same = bands(&masked, &filled, 1, 6);
    assert!(same.wavelet(6).iter().zip(split.wavelet(6)).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())));
    let constant: Vec<f64> = signal.iter().map(|v| if v.is_nan() { *v } else { 2.5 }).collect();
    let still = bands(&masked, &constant, 1, 6);
    assert!(still.levels.iter().flatten().all(|w| w.is_nan() || *w == 0.0));
    // Rows are distributions over what is left.
    let left_out = masked.mask_flags().unwrap();
    for x in 0..left_out.len() {
        let (columns, weights) = masked.rows("a test").unwrap().row(x);
        assert!(columns.iter().all(|&y| !left_out[y as usize] && !left_out[x]));
        let sum: f64 = weights.iter().sum();
        assert!(columns.is_empty() || (sum - 0.5).abs() < ROUNDING);
    }
    let map = saliency(&masked, &split, &SaliencyParams::paper(), Progress::none()).unwrap().map;
    assert!(map.iter().zip(&flags).all(|(v, &out)| v.is_nan() == out));
    let found =
        features(&masked, &split, &FeatureParams::default().with_theta(1.6), Progress::none()).unwrap();
    assert!(found.iter().all(|f| !flags[f.vertex]));
    let energy = in_order.energy(&masked.areas()).unwrap();
    assert!(energy.iter().all(|e| e.is_finite() && *e > 0.0));
    let nothing = whole.masked(&vec![true; flags.len()]).unwrap_err().to_string();
    assert!(nothing.contains("NaN at all"), "{nothing}");
}

#[test]
fn a_mask_that_is_empty_changes_nothing_beyond_rounding() {
    let sample = potato(2000);
    let shape = Shape::Cloud(PointCloud::new(sample.points).unwrap());
    let whole = walk(&shape);
    let masked = whole.masked(&vec![false; shape.n_vertices()]).unwrap();
    let signal: Vec<f64> = shape.points().unwrap().iter().map(|p| p[0]).collect();
    let (a, b) = (bands(&whole, &signal, 1, 5), bands(&masked, &signal, 1, 5));
    let largest = a.wavelet(5).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(a.wavelet(5).iter().zip(b.wavelet(5)).all(|(x, y)| (x - y).abs() < COMMUTES * largest));
    assert!((whole.operator().step_length() / masked.operator().step_length() - 1.0).abs() < ROUNDING);
}

#[test]
fn a_seam_of_welded_vertices_does_not_change_what_is_found() {
    let sample = potato(3000);
    // Every triangle with vertices of its own, as STL has it.
    let corners: Vec<[f64; 3]> = sample.faces.corners().iter().map(|&c| sample.points[c as usize]).collect();
    let soup: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let params = FeatureParams::default();
    let whole = coordinate_features(&mesh(sample.points, sample.faces), 6, &params);
    let soup = coordinate_features(&mesh(corners, Polygons::from_triangles(&soup)), 6, &params);
    assert_eq!(whole.len(), soup.len());
    assert!(whole.iter().zip(&soup).all(|(a, b)| a.position == b.position && a.level == b.level));
}

#[test]
fn options_reject_and_keep_what_they_say() {
    let (plane, faces) = common::plane(60);
    let ridge: Vec<f64> = plane.iter().map(|p| (-(p[0] * p[0]) / 0.01).exp()).collect();
    let bump: Vec<f64> =
        plane.iter().map(|p| (-((p[0] - 0.2).powi(2) + (p[1] - 0.1).powi(2)) / 0.02).exp()).collect();
    let shape = mesh(plane, faces);
    let walk = walk(&shape);
    let default = FeatureParams::default().with_theta(1.2).with_response(Response::Literal);
    let ridge = bands(&walk, &ridge, 1, 8);
    assert!(!features(&walk, &ridge, &default, Progress::none()).unwrap().is_empty());
    assert_eq!(features(&walk, &ridge, &default.with_max_edge_ratio(10.0), Progress::none()).unwrap(), []);
    let bump = bands(&walk, &bump, 1, 8);
    let found =
        features(&walk, &bump, &default.with_max_edge_ratio(10.0).with_border_sigmas(1.0), Progress::none())
            .unwrap();
    assert!(found.iter().any(|f| f.response > 0.0));
    assert_eq!(features(&walk, &bump, &default.with_border_sigmas(50.0), Progress::none()).unwrap(), []);
    let all = features(&walk, &bump, &default, Progress::none()).unwrap();
    let strongest = all.iter().max_by(|a, b| a.strength.total_cmp(&b.strength)).unwrap();
    assert_eq!(
        features(&walk, &bump, &default.with_best(1), Progress::none()).unwrap(),
        std::slice::from_ref(strongest)
    );
    assert_eq!(select_spread(&all, usize::MAX), all);
}

#[test]
fn a_rough_component_does_not_hide_a_smooth_one_when_each_has_its_threshold() {
    let (plane, faces) = common::plane(40);
    let n = plane.len();
    let bump = |p: &[f64; 3]| (-(p[0] * p[0] + p[1] * p[1]) / 0.02).exp();
    let mut signal: Vec<f64> = plane.iter().map(|p| 1e-3 * bump(p)).collect();
    signal.extend(plane.iter().map(|p| (9.0 * p[0]).sin() * (11.0 * p[1]).cos()));
    let mut points = plane.clone();
    points.extend(plane.iter().map(|p| [p[0] + 9.0, p[1], p[2]]));
    let mut both = faces.clone();
    for face in faces.iter() {
        both.push(&face.iter().map(|&c| c + n as u32).collect::<Vec<_>>());
    }
    let shape = mesh(points, both);
    let walk = walk(&shape);
    let bands = bands(&walk, &signal, 1, 7);
    let literal = FeatureParams::default().with_response(Response::Literal);
    let smooth = |scope| {
        let found = features(&walk, &bands, &literal.with_scope(scope), Progress::none()).unwrap();
        found.iter().filter(|f| f.vertex < n).count()
    };
    assert_eq!(smooth(ThresholdScope::Shape), 0);
    assert!(smooth(ThresholdScope::Component) > 0);
}

#[test]
fn features_are_found_again_when_the_shape_is_turned_and_scaled_and_descriptors_match_them() {
    let sample = potato(6000);
    let shape = mesh(sample.points, sample.faces);
    let reference_walk = walk(&shape);
    let reference_bands = bands(&reference_walk, shape.points().unwrap().as_flattened(), 3, 8);
    let params = FeatureParams::default();
    let reference = features(&reference_walk, &reference_bands, &params, Progress::none()).unwrap();
    let descriptors = describe(&reference_walk, &reference_bands, &reference);
    for step in [Change::Rotation { seed: 3 }, Change::Scaling { factor: 7.0 }] {
        let changed = change(&shape, &reference_walk, &step).unwrap();
        let walk = walk(&changed.shape);
        let bands = bands(&walk, changed.shape.points().unwrap().as_flattened(), 3, 8);
        let found = features(&walk, &bands, &params, Progress::none()).unwrap();
        for level in repeatability(&reference, &found, &changed, &RepeatabilityParams::default()) {
            assert_eq!(level.n_found, level.n_reference, "{step:?}");
        }
        let matches = match_features(&descriptors, &describe(&walk, &bands, &found), 1.0);
        assert_eq!(matches.len(), reference.len());
        assert!(matches.iter().all(|m| reference[m.first].vertex == found[m.second].vertex));
    }
    // Nothing is found again of what is not there.
    let same = change(&shape, &reference_walk, &Change::Scaling { factor: 1.0 }).unwrap();
    // Every feature of an unchanged shape is right; chance finds fewer, and none where there is none.
    let params = RepeatabilityParams::default();
    assert_eq!(n_right(&reference, &reference, &same, &params), reference.len());
    assert_eq!(n_right(&[], &reference, &same, &params), 0);
    let chance = |found: &[Feature], area| share_by_chance(&reference, found, &same, &params, area);
    let disc = std::f64::consts::PI * reference[0].sigma.powi(2);
    assert_eq!(chance(&[], 1.0), 0.0);
    assert!(
        chance(&reference, 1e3 * disc) > 0.0
            && chance(&reference, 1e6 * disc) < chance(&reference, 1e3 * disc)
    );
    // One feature, and one as wide: the share of its disc.
    let one = share_by_chance(&reference[..1], &reference[..1], &same, &params, 4.0 * disc);
    assert!((one - 0.25).abs() < 1e-12, "{one}");
    assert!(chance(&reference, 0.0).is_nan());
    let none = repeatability(&reference, &[], &same, &RepeatabilityParams::default());
    assert!(none.iter().all(|l| l.n_found == 0 && l.share() == 0.0));
}

#[test]
fn bad_parameters_are_named() {
    let sample = potato(1000);
    let shape = mesh(sample.points, sample.faces);
    let walk = walk(&shape);
    let two = bands(&walk, shape.points().unwrap().as_flattened(), 3, 2);
    assert_eq!(
        features(&walk, &two, &FeatureParams::default(), Progress::none()),
        Err(FeatureError::TooFewLevels { n_levels: 2 })
    );
    let error = saliency(&walk, &two, &SaliencyParams::paper(), Progress::none()).unwrap_err();
    assert_eq!(error, SaliencyError::NoLevelLeft { skip: 2, n_levels: 2 });
    let three = bands(&walk, shape.points().unwrap().as_flattened(), 3, 3);
    for theta in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = features(&walk, &three, &FeatureParams::default().with_theta(theta), Progress::none())
            .unwrap_err();
        assert!(error.to_string().contains('θ'));
    }
    assert!(
        features(&walk, &three, &FeatureParams::default().with_max_edge_ratio(0.5), Progress::none())
            .is_err()
    );
    assert!(
        features(&walk, &three, &FeatureParams::default().with_border_sigmas(f64::NAN), Progress::none())
            .is_err()
    );
    let other = Shape::Cloud(PointCloud::new(vec![[0.0; 3], [1.0; 3]]).unwrap());
    let other = Decomposer::with_params(
        &other,
        &OperatorParams::default().with_weld(WeldMode::Off),
        Progress::none(),
    )
    .expect("nobody can stop this");
    assert!(matches!(
        features(&other, &three, &FeatureParams::default(), Progress::none()),
        Err(FeatureError::OtherShape { n_vertices: 2, .. })
    ));
}
