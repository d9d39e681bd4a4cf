//! Curves: heat by arc length, end points that stay, welding, constraints, and denoising without tuning.

use adwave::bands::{DEFAULT_EXTENT, FWHM, Schedule};
use adwave::denoise::{DenoiseParams, denoise};
use adwave::operator::{EndPoints, OperatorKind, OperatorParams};
use adwave::positions::{Borders, MoveDirection, PositionParams, constrain_positions};
use adwave::region::{Length, parse_region};
use adwave::shape::{Graph, GraphError, PreparedGeometry, Shape, ShapeError, WeldMode, curve_length};
use adwave::{Decomposer, LevelSpec, Progress};
use nalgebra::DMatrix;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::{PI, TAU};

/// Bands have a relative error of 1e-10 by default.
const ACCURACY: f64 = 1e-8;

type Point = [f64; 3];

fn curve(points: &[Point], edges: &[[u32; 2]]) -> Shape {
    Shape::Graph(Graph::curve(points.to_vec(), edges).unwrap())
}

fn path_edges(n: usize) -> Vec<[u32; 2]> {
    (1..n as u32).map(|i| [i - 1, i]).collect()
}

fn loop_edges(n: usize) -> Vec<[u32; 2]> {
    (0..n as u32).map(|i| [i, (i + 1) % n as u32]).collect()
}

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = Pcg64Mcg::seed_from_u64(seed);
    move || f64::from(state.next_u32()) / f64::from(u32::MAX)
}

fn distance(p: &Point, q: &Point) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()
}

/// Positions after the last of `levels` dyadic levels.
fn smooth(shape: &Shape, levels: usize) -> Vec<Point> {
    let decomposer = Decomposer::new(shape);
    let points = shape.points().unwrap().as_flattened();
    let bands = decomposer.decompose(points, 3, &Schedule::dyadic(levels).unwrap()).unwrap();
    for (sum, f) in bands.reconstruct().iter().zip(points) {
        assert!((sum - f).abs() <= 1e-12 * f.abs().max(1.0), "{sum} {f}");
    }
    bands.coarsest().as_chunks().0.to_vec()
}

#[test]
fn an_irregular_straight_line_stays_where_it_is() {
    let mut random = random(1);
    let mut t: Vec<f64> = (0..200).map(|_| random() * random()).collect();
    t.sort_by(f64::total_cmp);
    let points: Vec<Point> = t.iter().map(|t| [1.0 + 3.0 * t, -2.0 * t, 5.0 * t]).collect();
    let after = smooth(&curve(&points, &path_edges(200)), 8);
    for (p, q) in points.iter().zip(&after) {
        assert!(distance(p, q) < ACCURACY, "{p:?} {q:?}");
    }
}

/// A tree with a branch, a loop and uneven edges.
fn tree() -> (Vec<Point>, Vec<[u32; 2]>) {
    let mut random = random(7);
    let points = (0..14).map(|i| [f64::from(i) * 0.3 + random(), random(), random()]).collect();
    let edges = [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 4],
        [2, 5],
        [5, 6],
        [6, 7],
        [7, 8],
        [8, 9],
        [9, 6],
        [4, 10],
        [10, 11],
        [12, 13],
    ];
    (points, edges.to_vec())
}

#[test]
fn bands_are_those_of_the_dense_exponential() {
    let (points, edges) = tree();
    let n = points.len();
    for end_points in [EndPoints::Keep, EndPoints::Free] {
        let mut generator = DMatrix::<f64>::zeros(n, n);
        let (mut mass, mut degree, mut length) = (vec![0.0; n], vec![0; n], 0.0);
        for &[a, b] in &edges {
            let (a, b) = (a as usize, b as usize);
            let l = distance(&points[a], &points[b]);
            length += l;
            for (x, y) in [(a, b), (b, a)] {
                generator[(x, y)] += 1.0 / l;
                generator[(x, x)] -= 1.0 / l;
                mass[x] += 0.5 * l;
                degree[x] += 1;
            }
        }
        let tau = (length / n as f64).powi(2) / 4.0;
        for x in 0..n {
            let is_kept = end_points == EndPoints::Keep && degree[x] == 1;
            for y in 0..n {
                generator[(x, y)] *= if is_kept { 0.0 } else { tau / mass[x] };
            }
        }
        let params = OperatorParams::default().with_end_points(end_points);
        let shape = curve(&points, &edges);
        let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
        assert_eq!(decomposer.operator_kind(), OperatorKind::Surface);
        assert!((decomposer.operator().step_length() - length / n as f64).abs() < 1e-12);
        assert!((decomposer.areas().iter().sum::<f64>() - length).abs() < 1e-12);
        let bands =
            decomposer.decompose(points.as_flattened(), 3, &Schedule::real(vec![0.5, 3.0]).unwrap()).unwrap();
        let signal = DMatrix::from_row_slice(n, 3, points.as_flattened());
        for (level, steps) in [(1, 0.5), (2, 3.0)] {
            let expected = (generator.clone() * steps).exp() * &signal;
            let found = bands.scaling(level);
            for x in 0..n {
                for c in 0..3 {
                    let (e, f) = (expected[(x, c)], found[3 * x + c]);
                    assert!((e - f).abs() < ACCURACY, "{end_points:?} level {level} vertex {x}: {e} {f}");
                }
            }
        }
    }
}

#[test]
fn a_wave_on_a_circle_decays_at_its_rate_and_widths_are_lengths() {
    let n = 200;
    let circle: Vec<Point> =
        (0..n).map(|i| TAU * f64::from(i) / f64::from(n)).map(|t| [t.cos(), t.sin(), 0.0]).collect();
    let shape = curve(&circle, &loop_edges(n as usize));
    let decomposer = Decomposer::new(&shape);
    let wave: Vec<f64> = (0..n).map(|i| (3.0 * TAU * f64::from(i) / f64::from(n)).cos()).collect();
    let sigma = 0.3;
    let levels = LevelSpec::Widths(vec![Length::Units(sigma)]).resolve(&decomposer, DEFAULT_EXTENT).unwrap();
    let bands = decomposer.decompose(&wave, 1, &levels.schedule).unwrap();
    // σ² = 4t, and the wave of frequency 3 decays as exp(−9t).
    let decay = (-9.0 * sigma * sigma / 4.0).exp();
    for (s, f) in bands.coarsest().iter().zip(&wave) {
        assert!((s - decay * f).abs() < 1e-3, "{s} {}", decay * f);
    }
    // A spike becomes a bump that is half as high at half of its width.
    let mut spike = vec![0.0; n as usize];
    spike[0] = 1.0;
    let bump = decomposer.decompose(&spike, 1, &levels.schedule).unwrap().coarsest().to_vec();
    let half = (0.5 * FWHM * sigma / (TAU / f64::from(n))).round() as usize;
    assert!((bump[half] / bump[0] - 0.5).abs() < 0.05, "{} {}", bump[half], bump[0]);
}

#[test]
fn ends_and_lone_vertices_stay_and_branches_move() {
    let (points, edges) = tree();
    let after = smooth(&curve(&points, &edges), 4);
    let moved = |x: usize| distance(&points[x], &after[x]);
    for x in [0, 11, 12, 13] {
        assert_eq!(moved(x), 0.0, "vertex {x}");
    }
    for x in [2, 3, 6, 8] {
        assert!(moved(x) > 1e-3, "vertex {x}");
    }
    let mut more = points.clone();
    more.push([9.0; 3]);
    let with_lone = smooth(&curve(&more, &edges), 4);
    assert_eq!(with_lone[14], [9.0; 3]);
    for (p, q) in after.iter().zip(&with_lone) {
        assert!(distance(p, q) < 1e-12);
    }
}

#[test]
fn ends_at_one_place_are_joined_and_crossings_are_not() {
    // A square whose first point is repeated at the end, as edges of their own points.
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let soup: Vec<Point> = (0..4).flat_map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
    let edges: Vec<[u32; 2]> = (0..4).map(|k| [2 * k, 2 * k + 1]).collect();
    let geometry =
        PreparedGeometry::new(&curve(&soup, &edges), WeldMode::EqualPositions, Progress::none()).unwrap();
    assert_eq!((geometry.n_vertices(), geometry.curve_ends().len()), (4, 0));
    let apart = PreparedGeometry::new(&curve(&soup, &edges), WeldMode::Off, Progress::none()).unwrap();
    assert_eq!((apart.n_vertices(), apart.curve_ends().len()), (8, 8));
    // Two tracks that cross at a point of both; one has a stop with three records.
    let cross: Vec<Point> = [-1.0, 0.0, 1.0]
        .iter()
        .map(|x| [*x, 0.0, 0.0])
        .chain([-1.0, 0.0, 0.0, 0.0, 1.0].iter().map(|y| [0.0, *y, 0.0]))
        .collect();
    let edges = [[0, 1], [1, 2], [3, 4], [4, 5], [5, 6], [6, 7]];
    let geometry =
        PreparedGeometry::new(&curve(&cross, &edges), WeldMode::EqualPositions, Progress::none()).unwrap();
    assert_eq!((geometry.n_vertices(), geometry.curve_ends().len()), (6, 4));
    let edges = geometry.curve_edges().unwrap();
    assert!((0..edges.n_rows()).all(|x| edges.row(x).len() <= 2));
}

#[test]
fn given_weights_win_over_lengths() {
    let (points, edges) = tree();
    let weighted: Vec<(u32, u32, f64)> =
        edges.iter().zip(1..).map(|(&[a, b], k)| (a, b, f64::from(k))).collect();
    let graph = Graph::new(points.len(), &weighted).unwrap();
    let plain = Decomposer::new(&Shape::Graph(graph.clone()));
    let placed = Decomposer::new(&Shape::Graph(graph.with_positions(points.clone()).unwrap()));
    let schedule = Schedule::dyadic(5).unwrap();
    let signal: Vec<f64> = points.iter().map(|p| p[1]).collect();
    let bits = |d: &Decomposer| {
        d.decompose(&signal, 1, &schedule)
            .unwrap()
            .reconstruct()
            .iter()
            .map(|v| v.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&plain), bits(&placed));
    assert!(plain.extent() == 0.0 && placed.extent() > 0.0);
    assert!(placed.operator().step_length() > 0.0 && placed.operator_kind() == OperatorKind::Walk);
}

#[test]
fn positions_move_in_the_allowed_directions() {
    let mut random = random(3);
    let points: Vec<Point> = (0..60).map(|i| [f64::from(i) + 0.3 * random(), random(), random()]).collect();
    let shape = curve(&points, &path_edges(60));
    let decomposer = Decomposer::new(&shape);
    let after: Vec<Point> = points.iter().map(|p| p.map(|c| c + 0.1)).collect();
    let constrained = |along, borders| {
        let params = PositionParams::default().with_along(along).with_borders(borders);
        constrain_positions(&decomposer, &points, after.clone(), &params, Progress::none()).unwrap()
    };
    for borders in [Borders::Natural, Borders::Keep] {
        let free = constrained(None, borders);
        assert!(free[0] == points[0] && free[59] == points[59] && free[1..59] == after[1..59]);
    }
    assert_eq!(constrained(None, Borders::Free), after);
    let z = constrained(Some(MoveDirection::Z), Borders::Free);
    assert!(z.iter().zip(&points).all(|(p, q)| p[0] == q[0] && p[1] == q[1] && p[2] > q[2]));
    let (across, along) = (
        constrained(Some(MoveDirection::Normal), Borders::Natural),
        constrained(Some(MoveDirection::Surface), Borders::Natural),
    );
    for x in 1..59 {
        let tangent: Vec<f64> = (0..3).map(|c| points[x + 1][c] - points[x - 1][c]).collect();
        let dot: f64 = (0..3).map(|c| tangent[c] * (across[x][c] - points[x][c])).sum();
        assert!(dot.abs() < 1e-12);
        let sum: Point = std::array::from_fn(|c| across[x][c] + along[x][c] - points[x][c]);
        assert!(distance(&sum, &after[x]) < 1e-12);
    }
}

#[test]
fn hostile_curves_give_finite_results_or_errors() {
    let line = |n: u32, scale: f64| {
        (0..n).map(|i| [scale * f64::from(i), scale * f64::from(i % 3), 0.0]).collect::<Vec<Point>>()
    };
    let shapes: [(Vec<Point>, Vec<[u32; 2]>); 9] = [
        (line(2, 1.0), vec![[0, 1]]),
        (line(2, 1.0), vec![[0, 0], [1, 1]]),
        (line(3, 1.0), vec![]),
        (vec![[2.0; 3]; 6], path_edges(6)),
        (line(5, 1.0), vec![[0, 1], [1, 0], [0, 1], [1, 1], [1, 2], [2, 3], [3, 3]]),
        (line(40, 1e-200), path_edges(40)),
        (line(40, 1e95), path_edges(40)),
        ([line(20, 1.0), line(20, 1e-12)].concat(), path_edges(40)),
        (
            vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1e-300, 0.0], [2.0, 0.0, 0.0], [0.0; 3]],
            loop_edges(6),
        ),
    ];
    for (k, (points, edges)) in shapes.iter().enumerate() {
        let shape = curve(points, edges);
        for weld in [WeldMode::EqualPositions, WeldMode::Off] {
            let params = OperatorParams::default().with_weld(weld);
            let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
            let schedule = decomposer.default_schedule().schedule;
            let bands = decomposer.decompose(points.as_flattened(), 3, &schedule).unwrap();
            assert!(bands.coarsest().iter().all(|v| v.is_finite()), "curve {k} {weld:?}");
            let weights = parse_region("ball:vertex=0,radius=10%").unwrap().weights(
                decomposer.metric(),
                &|_| None,
                &[],
                Progress::none(),
            );
            assert!(
                weights.is_ok() || points.len() < 4 || decomposer.extent() == 0.0,
                "curve {k}: {weights:?}"
            );
            let geometry = PreparedGeometry::new(&shape, weld, Progress::none()).unwrap();
            let denoised = denoise(&geometry, &DenoiseParams::default(), Progress::none()).unwrap();
            assert!(denoised.points.as_flattened().iter().all(|v| v.is_finite()), "curve {k} {weld:?}");
            assert!(decomposer.basis_of_vertex(0, &schedule, Progress::none()).is_ok(), "curve {k} {weld:?}");
        }
    }
    let bad = Graph::curve(vec![[0.0; 3], [f64::NAN, 0.0, 0.0]], &[[0, 1]]).unwrap_err();
    assert!(matches!(bad, GraphError::Position(ShapeError::NotFinite { vertex: 1, .. })));
    let bad = Graph::curve(vec![[0.0; 3]], &[[0, 1]]).unwrap_err();
    assert!(matches!(bad, GraphError::NodeOutOfRange { node: 1, .. }));
    let bad = Graph::new(2, &[]).unwrap().with_positions(vec![[0.0; 3]]).unwrap_err();
    assert_eq!(bad, GraphError::PositionCount { found: 1, n_nodes: 2 });
}

#[test]
fn functions_of_a_vertex_sum_to_one_and_zero() {
    let (points, edges) = tree();
    let decomposer = Decomposer::new(&curve(&points, &edges));
    for vertex in [0, 2, 8] {
        let found =
            decomposer.basis_of_vertex(vertex, &Schedule::dyadic(4).unwrap(), Progress::none()).unwrap();
        assert!((found.scaling_function.iter().sum::<f64>() - 1.0).abs() < ACCURACY);
        assert!(found.wavelet.iter().sum::<f64>().abs() < ACCURACY);
    }
}

/// A curve for the denoiser.
struct Track {
    name: &'static str,
    points: Vec<Point>,
    is_closed: bool,
    /// Largest allowed ratio of the error to the noise, for noise of 2 % to 20 % of the spacing.
    ratio: f64,
}

fn tracks() -> Vec<Track> {
    let mut random = random(11);
    let helix = |t: f64| [t.cos(), t.sin(), t / 5.0];
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5], [0.0, 1.0, 1.5]];
    let between =
        |p: &Point, q: &Point, t: f64| -> Point { std::array::from_fn(|c| p[c] + t * (q[c] - p[c])) };
    let mut bent: Vec<Point> = corners
        .windows(2)
        .flat_map(|c| (0..40).map(move |i| between(&c[0], &c[1], f64::from(i) / 40.0)))
        .collect();
    bent.push(corners[4]);
    let waves: Vec<[f64; 4]> = (1..6).map(|j| [random(), random(), random(), f64::from(j)]).collect();
    let wavy = |t: f64| -> Point {
        std::array::from_fn(|c| {
            waves.iter().map(|w| (w[c] - 0.5) / w[3] * (w[3] * PI * t + 5.0 * w[(c + 1) % 3]).sin()).sum()
        })
    };
    let mut uneven: Vec<f64> = (0..200).map(|_| 4.0 * PI * random()).collect();
    uneven.sort_by(f64::total_cmp);
    let track = |name, points, is_closed, ratio| Track { name, points, is_closed, ratio };
    vec![
        track("helix", (0..120).map(|i| helix(4.0 * PI * f64::from(i) / 119.0)).collect(), false, 0.65),
        track(
            "circle",
            (0..100).map(|i| TAU * f64::from(i) / 100.0).map(|t| [t.cos(), t.sin(), 0.0]).collect(),
            true,
            0.6,
        ),
        track("corners", bent, false, 0.5),
        track("waves", (0..300).map(|i| wavy(f64::from(i) / 300.0)).collect(), false, 0.6),
        track("uneven helix", uneven.iter().map(|&t| helix(t)).collect(), false, 0.95),
        track("uneven line", uneven.iter().map(|&t| [t, 0.5 * t, 0.0]).collect(), false, 0.95),
    ]
}

impl Track {
    fn shape(&self, points: &[Point]) -> Shape {
        curve(points, &if self.is_closed { loop_edges(points.len()) } else { path_edges(points.len()) })
    }

    fn spacing(&self) -> f64 {
        let Shape::Graph(graph) = self.shape(&self.points) else { unreachable!() };
        curve_length(&graph, &self.points) / graph.adjacency().nnz() as f64 * 2.0
    }
}

fn denoised(shape: &Shape) -> Vec<Point> {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    denoise(&geometry, &DenoiseParams::default(), Progress::none()).unwrap().points
}

fn rms(points: &[Point], truth: &[Point]) -> f64 {
    let sum: f64 = points.iter().zip(truth).map(|(p, q)| distance(p, q).powi(2)).sum();
    (sum / points.len() as f64).sqrt()
}

#[test]
fn noise_never_grows_and_curves_without_noise_stay() {
    for track in tracks() {
        let spacing = track.spacing();
        let moved = denoised(&track.shape(&track.points));
        let worst = moved.iter().zip(&track.points).map(|(p, q)| distance(p, q)).fold(0.0, f64::max);
        assert!(worst <= 1e-3 * spacing, "{}: {worst} of {spacing}", track.name);
        for (share, seed) in [(0.005, 1), (0.02, 2), (0.05, 3), (0.1, 4), (0.2, 5), (0.5, 6), (1.0, 7)] {
            let mut state = Pcg64Mcg::seed_from_u64(seed);
            let mut noisy = |c: f64| -> f64 {
                let deviate: f64 = StandardNormal.sample(&mut state);
                c + share * spacing * deviate
            };
            let points: Vec<Point> = track.points.iter().map(|p| p.map(&mut noisy)).collect();
            let after = denoised(&track.shape(&points));
            if !track.is_closed {
                assert!(after[0] == points[0] && after.last() == points.last(), "{}", track.name);
            }
            let ratio = rms(&after, &track.points) / rms(&points, &track.points);
            println!("{} {share}: {ratio:.3}", track.name);
            let limit = if (0.02..=0.2).contains(&share) { track.ratio } else { 1.0 };
            assert!(ratio <= limit, "{} with noise {share}: {ratio}", track.name);
        }
    }
}

#[test]
fn corners_stay_sharp() {
    let tracks = tracks();
    let track = tracks.iter().find(|track| track.name == "corners").unwrap();
    let noise = 0.05 * track.spacing();
    let mut state = Pcg64Mcg::seed_from_u64(5);
    let mut noisy = |c: f64| -> f64 {
        let deviate: f64 = StandardNormal.sample(&mut state);
        c + noise * deviate
    };
    let points: Vec<Point> = track.points.iter().map(|p| p.map(&mut noisy)).collect();
    let after = denoised(&track.shape(&points));
    for corner in [40, 80, 120] {
        let off = distance(&after[corner], &track.points[corner]);
        assert!(off < 2.5 * noise, "corner {corner} by {} of the noise", off / noise);
    }
}

#[test]
fn branches_and_weighted_graphs_are_denoised() {
    // Three arms from one point.
    let mut points = vec![[0.0; 3]];
    let mut edges = Vec::new();
    for (arm, direction) in [[1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.3]].iter().enumerate() {
        for k in 1..=40_u32 {
            let last = if k == 1 { 0 } else { points.len() as u32 - 1 };
            points.push(direction.map(|c| c * f64::from(k)));
            edges.push([last, points.len() as u32 - 1]);
        }
        assert_eq!(points.len(), 40 * (arm + 1) + 1);
    }
    let mut state = Pcg64Mcg::seed_from_u64(9);
    let mut noisy = |c: f64| -> f64 {
        let deviate: f64 = StandardNormal.sample(&mut state);
        c + 0.1 * deviate
    };
    let noise: Vec<Point> = points.iter().map(|p| p.map(&mut noisy)).collect();
    let by_length = denoised(&curve(&noise, &edges));
    let weighted: Vec<(u32, u32, f64)> = edges.iter().map(|&[a, b]| (a, b, 2.0)).collect();
    let graph = Graph::new(points.len(), &weighted).unwrap().with_positions(noise.clone()).unwrap();
    assert_eq!(by_length, denoised(&Shape::Graph(graph)));
    assert!(rms(&by_length, &points) < 0.5 * rms(&noise, &points), "{}", rms(&by_length, &points));
}

/// Tracks whose noise is larger than their steps: the true positions and the measured ones.
fn noisy_tracks(seed: u64) -> Vec<(&'static str, Vec<Point>, Vec<Point>)> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut deviate = || -> f64 { StandardNormal.sample(&mut random) };
    let truth: Vec<Point> =
        (0..600).map(f64::from).map(|t| [t, 40.0 * (t / 60.0).sin(), 10.0 * (t / 100.0).cos()]).collect();
    let all = truth.iter().map(|p| p.map(|c| c + 3.0 * deviate())).collect();
    let height = truth.iter().map(|p| [p[0], p[1], p[2] + 3.0 * deviate()]).collect();
    vec![("all axes", truth.clone(), all), ("height", truth, height)]
}

#[test]
fn noise_larger_than_the_steps_of_a_track_is_smoothed_by_the_length_of_the_way() {
    for seed in 0..5 {
        for (name, truth, noisy) in noisy_tracks(seed) {
            let shape = curve(&noisy, &path_edges(noisy.len()));
            let before = rms(&noisy, &truth);
            // The walk knows the way, which is 700 long, and not the path of the noise of three times that.
            let decomposer = Decomposer::new(&shape);
            let way = curve_length(&Graph::curve(truth.clone(), &path_edges(600)).unwrap(), &truth);
            let length: f64 = decomposer.areas().iter().sum();
            assert!((length / way - 1.0).abs() < 0.2, "{name}: {length} of {way}");
            let schedule = decomposer.default_schedule().schedule;
            let bands = decomposer.decompose(shape.points().unwrap().as_flattened(), 3, &schedule).unwrap();
            let smooth: Vec<Point> = bands.coarsest().as_chunks().0.to_vec();
            assert!(rms(&smooth, &truth) < 0.45 * before, "{name}: {} of {before}", rms(&smooth, &truth));
            let left = rms(&denoised(&shape), &truth);
            assert!(left < 0.5 * before, "{name}: {left} of {before}");
        }
    }
}

#[test]
fn zigzags_and_clean_tracks_keep_their_lengths() {
    let zigzag: Vec<Point> = (0..200).map(|k| [0.1 * f64::from(k), 3.0 * f64::from(k % 2), 0.0]).collect();
    let stairs: Vec<Point> = (0..200).map(|k| [f64::from(k / 2), f64::from((k + 1) / 2), 0.0]).collect();
    let spiral: Vec<Point> =
        (0..200).map(|k| 0.1 * f64::from(k)).map(|t| [t * t.cos(), t * t.sin(), 0.0]).collect();
    for points in [zigzag, stairs, spiral] {
        let shape = curve(&points, &path_edges(points.len()));
        let Shape::Graph(graph) = &shape else { unreachable!() };
        let (length, path) =
            (Decomposer::new(&shape).areas().iter().sum::<f64>(), curve_length(graph, &points));
        assert!((length / path - 1.0).abs() < 1e-9, "{length} of {path}");
    }
}

#[test]
fn noise_does_not_stretch_a_curve() {
    for seed in 0..3 {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut deviate = || -> f64 { StandardNormal.sample(&mut random) };
        // Steps of 0.4 to 1.6: uneven spacing alone changes no length.
        let mut t = 0.0;
        let truth: Vec<Point> = (0..600)
            .map(|_| {
                t += 1.0 + 0.6 * deviate().clamp(-1.0, 1.0);
                [t, 40.0 * (t / 60.0).sin(), 10.0 * (t / 100.0).cos()]
            })
            .collect();
        let way = curve_length(&Graph::curve(truth.clone(), &path_edges(600)).unwrap(), &truth);
        for noise in [0.0, 0.05, 0.2, 0.35, 0.5] {
            let noisy: Vec<Point> = truth.iter().map(|p| p.map(|c| c + noise * deviate())).collect();
            let shape = curve(&noisy, &path_edges(600));
            let length: f64 = Decomposer::new(&shape).areas().iter().sum();
            let limit = if noise == 0.0 { 1e-9 } else { 0.04 };
            assert!((length / way - 1.0).abs() < limit, "noise {noise}: {length} of {way}");
        }
    }
}
