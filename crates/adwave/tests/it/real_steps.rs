//! Laws of levels between whole steps: they are powers of the walk's spectrum, to the accuracy that was asked for.

use crate::common;

use adwave::bands::{Bands, BandsError, BandsParams, Engine, Schedule, ScheduleError};
use adwave::basis::{BasisError, BasisParams, basis};
use adwave::operator::{CloudGraph, Diffusion, OperatorParams, local_operator};
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, PreparedGeometry, Shape, VertexMap};
use adwave::{Decomposer, Progress};
use common::one_off::{decompose, forecast_bytes, levels, weighted_bands};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use proptest::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Rounding of f64 over a recurrence of some hundred steps and over an eigen-decomposition, relative to W_f(1).
const ROUNDING: f64 = 2e-12;

/// Eigenvalues below are 0 but for rounding; a small power would blow the difference up.
const ZERO: f64 = 1e-12;

/// The numbers of steps that are compared with the spectrum.
const STEPS: [f64; 7] = [0.25, 0.5, 1.19, 1.41, 2.83, 40.3, 1000.7];

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// A bumpy sheet of triangles.
fn sheet(rows: u32, columns: u32) -> Shape {
    let mut random = random(1);
    let points: Vec<_> = (0..rows * columns)
        .map(|i| {
            let (r, c) = (f64::from(i / columns), f64::from(i % columns));
            [r + 0.3 * random(), c + 0.3 * random(), 3.0 * (0.2 * r).sin() + 0.3 * random()]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..rows - 1)
        .flat_map(|r| (0..columns - 1).map(move |c| r * columns + c))
        .flat_map(|a| [[a, a + 1, a + columns], [a + 1, a + columns + 1, a + columns]])
        .collect();
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).expect("a finite mesh"))
}

/// A grid of squares without diagonals: every step leads from an even node to an odd one, so that Φ₁ has the eigenvalue 0.
fn checkerboard(rows: u32, columns: u32) -> Shape {
    let mut edges = Vec::new();
    for a in 0..rows * columns {
        if a % columns + 1 < columns {
            edges.push((a, a + 1, 1.0));
        }
        if a + columns < rows * columns {
            edges.push((a, a + columns, 1.0));
        }
    }
    Shape::Graph(Graph::new((rows * columns) as usize, &edges).expect("a graph"))
}

fn walk_of(shape: &Shape, params: &OperatorParams) -> Diffusion {
    // In the order of the shape, in which signals are easy to write down.
    let given = PreparedGeometry::new(shape, params.weld, Progress::none()).unwrap();
    assert_eq!(given.n_vertices(), shape.n_vertices(), "nothing to vertex_map");
    Diffusion::new(local_operator(&given, params, Progress::none()).unwrap(), Progress::none()).unwrap()
}

fn split(walk: &Diffusion, signal: &[f64], schedule: &Schedule, params: &BandsParams) -> Bands {
    let vertex_map = VertexMap::identity(walk.n_vertices());
    decompose(walk, &vertex_map, signal, 1, schedule, params, Progress::none()).expect("a valid request")
}

fn real(steps: &[f64]) -> Schedule {
    Schedule::real(steps.to_vec()).expect("increasing steps")
}

fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    (0..n).map(|_| random()).collect()
}

fn norm(weights: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    weights.iter().zip(values).map(|(w, v)| w * v * v).sum::<f64>().sqrt()
}

fn distance(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    norm(weights, a.iter().zip(b).map(|(a, b)| a - b))
}

/// The spectrum of a walk, under whose stationary law it is symmetric.
struct Spectrum {
    eigen: SymmetricEigen<f64, nalgebra::Dyn>,
    roots: Vec<f64>,
}

impl Spectrum {
    fn new(walk: &Diffusion) -> Self {
        let n = walk.n_vertices();
        let roots: Vec<f64> = walk.stationary().iter().map(|p| p.sqrt()).collect();
        let mut dense = DMatrix::zeros(n, n);
        for x in 0..n {
            let (columns, values) = walk.row(x);
            dense[(x, x)] = 1.0 - values.iter().sum::<f64>();
            for (&y, value) in columns.iter().zip(values) {
                dense[(x, y as usize)] += value * roots[x] / roots[y as usize];
            }
        }
        let symmetric = 0.5 * (&dense + dense.transpose());
        assert!((&dense - &symmetric).amax() < 1e-14, "the walk is reversible");
        Self { eigen: SymmetricEigen::new(symmetric), roots }
    }

    /// `(Φ₁ᵃ − Φ₁ᵇ)f`.
    fn band(&self, signal: &[f64], a: f64, b: f64) -> Vec<f64> {
        let start = DVector::from_iterator(signal.len(), signal.iter().zip(&self.roots).map(|(f, r)| f * r));
        let mut coefficients = self.eigen.eigenvectors.transpose() * start;
        for (c, &lambda) in coefficients.iter_mut().zip(&self.eigen.eigenvalues) {
            let power = |n: f64| match lambda {
                _ if n == 0.0 => 1.0,
                small if small < ZERO => 0.0,
                other => other.min(1.0).powf(n),
            };
            *c *= power(a) - power(b);
        }
        let found = &self.eigen.eigenvectors * coefficients;
        found.iter().zip(&self.roots).map(|(v, r)| v / r).collect()
    }

    fn smallest(&self) -> f64 {
        self.eigen.eigenvalues.min()
    }
}

#[test]
fn bands_are_powers_of_the_spectrum_within_the_stated_bound() {
    let cloud = |shape: &Shape| {
        Shape::Cloud(PointCloud::new(shape.points().expect("points").to_vec()).expect("finite"))
    };
    let mesh = sheet(13, 11);
    for (shape, is_bipartite) in
        [(cloud(&mesh), false), (mesh, false), (checkerboard(12, 11), true), (checkerboard(2, 2), true)]
    {
        let walk = walk_of(&shape, &OperatorParams::default());
        let spectrum = Spectrum::new(&walk);
        assert_eq!(spectrum.smallest() < ZERO, is_bipartite, "{}", spectrum.smallest());
        let weights = walk.stationary();
        let signal = noise(walk.n_vertices(), 5);
        let u = norm(weights, spectrum.band(&signal, 0.0, 1.0).into_iter());
        // A quarter of a step on eigenvalues down to 0 reaches a thousandth only.
        let steps = if is_bipartite { &STEPS[2..] } else { &STEPS };
        for accuracy in [1e-2, 1e-6, 1e-8] {
            let bands = split(&walk, &signal, &real(steps), &BandsParams::default().with_accuracy(accuracy));
            assert_eq!(bands.info.engine, Engine::Chebyshev);
            assert_eq!(bands.steps[1..], *steps);
            for (j, pair) in bands.steps.windows(2).enumerate() {
                let exact = spectrum.band(&signal, pair[0], pair[1]);
                let (error, size) =
                    (distance(weights, bands.wavelet(j + 1), &exact), norm(weights, exact.iter().copied()));
                let allowed = accuracy.min(bands.info.error_bound) * size + ROUNDING * u;
                assert!(error <= allowed, "{pair:?} to {accuracy:e}: {error:e} beyond {allowed:e}");
            }
        }
    }
}

#[test]
fn a_mesh_needs_few_products_however_fine_the_steps_are() {
    let shape = sheet(60, 60);
    let walk = walk_of(&shape, &OperatorParams::default());
    let signal: Vec<f64> = shape.points().expect("points").iter().map(|p| p[2]).collect();
    let dyadic = split(&walk, &signal, &Schedule::dyadic(8).unwrap(), &BandsParams::default()).info;
    for voices in [2, 3, 4, 8] {
        let schedule = Schedule::voices(8, voices).unwrap();
        let info = split(&walk, &signal, &schedule, &BandsParams::default()).info;
        assert!(info.error_bound <= 1e-10, "{info:?}");
        assert!(info.products <= 2 * dyadic.products.max(65), "{info:?}, {dyadic:?}");
    }
}

#[test]
fn whole_steps_are_what_they_were_among_others() {
    let shape = sheet(20, 17);
    let walk = walk_of(&shape, &OperatorParams::default());
    let signal = noise(walk.n_vertices(), 2);
    let params = BandsParams::default().with_accuracy(1e-11);
    let powers = split(
        &walk,
        &signal,
        &Schedule::new(vec![1, 2, 5, 40, 90]).unwrap(),
        &params.with_engine(Engine::Powers),
    );
    let among =
        split(&walk, &signal, &real(&[0.7, 1.0, 1.5, 2.0, 4.99, 5.0, 33.3, 40.0, 41.7, 90.0]), &params);
    for (whole, real) in [(1, 2), (2, 4), (3, 6), (4, 8), (5, 10)] {
        let off = distance(walk.stationary(), &powers.scaling(whole), &among.scaling(real));
        assert!(off < 1e-10, "{} steps: {off:e}", powers.steps[whole]);
    }
}

#[test]
fn the_bands_of_voices_sum_to_the_bands_of_octaves() {
    for (shape, accuracy) in [(sheet(30, 23), 1e-10), (checkerboard(15, 12), 1e-6)] {
        let walk = walk_of(&shape, &OperatorParams::default());
        let signal = noise(walk.n_vertices(), 11);
        let params = BandsParams::default().with_accuracy(accuracy);
        let octaves = split(&walk, &signal, &Schedule::dyadic(8).unwrap(), &params);
        for n_voices in [2, 3, 7] {
            let voices = split(&walk, &signal, &Schedule::voices(8, n_voices).unwrap(), &params);
            assert_eq!(voices.n_levels(), 7 * n_voices + 1);
            for octave in 1..8 {
                let bands = &levels(&voices)[(octave - 1) * n_voices + 1..][..n_voices];
                let mut sum = vec![0.0; signal.len()];
                let mut sizes = 0.0;
                for band in bands {
                    sum.iter_mut().zip(band).for_each(|(s, w)| *s += w);
                    sizes += norm(walk.stationary(), band.iter().copied());
                }
                let off = distance(walk.stationary(), &sum, octaves.wavelet(octave + 1));
                // Each voice and the octave may be off by their part.
                assert!(off <= 2.0 * accuracy * sizes, "octave {octave} of {n_voices} voices: {off:e}");
            }
        }
    }
}

#[test]
fn the_levels_of_any_steps_sum_to_the_signal() {
    let shape = sheet(25, 25);
    let decomposer = Decomposer::new(&shape);
    let points = shape.points().unwrap().as_flattened();
    for schedule in [Schedule::voices(9, 4).unwrap(), real(&[0.02, 0.9, 31.9, 32.1, 777.7])] {
        let params = BandsParams::default().with_accuracy(0.1);
        let bands = decomposer.request(points, 3, &schedule).params(&params).bands().unwrap();
        for (sum, f) in bands.reconstruct().iter().zip(points) {
            assert!((sum - f).abs() <= 1e-13, "{sum} for {f}");
        }
    }
}

#[test]
fn steps_add_up() {
    let shape = sheet(20, 17);
    let walk = walk_of(&shape, &OperatorParams::default());
    let signal = noise(walk.n_vertices(), 3);
    let smooth = |signal: &[f64], n: f64| {
        split(&walk, signal, &real(&[n]), &BandsParams::default()).coarsest().to_vec()
    };
    for (a, b) in [(0.5, 0.5), (0.25, 0.3), (1.41, 2.83), (0.0625, 31.9), (1.5, 40.3), (35.1, 36.4)] {
        let (both, sum) = (smooth(&smooth(&signal, a), b), smooth(&signal, a + b));
        let off = distance(walk.stationary(), &both, &sum);
        assert!(off < 3e-10 * norm(walk.stationary(), signal.iter().copied()), "{a} + {b}: {off:e}");
    }
}

#[test]
fn constants_have_no_bands_and_bands_have_no_mean() {
    for shape in [sheet(12, 9), checkerboard(12, 9)] {
        let walk = walk_of(&shape, &OperatorParams::default());
        let schedule = Schedule::voices(6, 3).unwrap();
        let params = BandsParams::default().with_accuracy(1e-6);
        let flat = split(&walk, &[0.1; 108], &schedule, &params);
        assert!(flat.wavelets().flatten().all(|&w| w == 0.0));
        assert!(flat.all_scaling().iter().all(|&s| s == 0.1));
        let signal = noise(108, 4);
        let bands = split(&walk, &signal, &schedule, &params);
        for (j, band) in bands.wavelets().enumerate() {
            let mean: f64 = walk.stationary().iter().zip(band).map(|(p, w)| p * w).sum();
            let size = norm(walk.stationary(), band.iter().copied());
            assert!(size > 0.0 && mean.abs() < ROUNDING * (1.0 + size), "band {}: {mean:e}", j + 1);
        }
        for (sum, f) in bands.reconstruct().iter().zip(&signal) {
            assert!((sum - f).abs() < 1e-15, "{sum} for {f}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let shape = sheet(70, 60);
    let walk = walk_of(&shape, &OperatorParams::default());
    let signal = noise(walk.n_vertices(), 6);
    let schedule = real(&[0.3, 1.41, 5.7, 33.3, 100.1]);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| split(&walk, &signal, &schedule, &BandsParams::default()))
    };
    let one = on(1);
    assert!([2, 3, 7].into_iter().all(|threads| on(threads) == one));
}

#[test]
fn one_polynomial_is_the_weighted_sum_of_the_bands() {
    let shape = sheet(20, 17);
    let walk = walk_of(&shape, &OperatorParams::default());
    let vertex_map = VertexMap::identity(walk.n_vertices());
    let signal = noise(walk.n_vertices(), 7);
    let schedule = real(&[0.5, 1.3, 2.0, 7.7, 50.5]);
    let factors = [2.0, -1.0, 0.5, 0.0, 3.0];
    let params = BandsParams::default();
    let bands = split(&walk, &signal, &schedule, &params);
    let (sum, info) =
        weighted_bands(&walk, &vertex_map, &signal, 1, &schedule, &factors, &params, Progress::none())
            .unwrap();
    assert!(info.error_bound <= params.accuracy);
    for (x, found) in sum.iter().enumerate() {
        let expected: f64 = bands.wavelets().zip(factors).map(|(w, g)| g * w[x]).sum();
        assert!((found - expected).abs() < 1e-9, "vertex {x}: {found}, {expected}");
    }
    let more = forecast_bytes(&walk, &vertex_map, 1, &schedule);
    let less = forecast_bytes(&walk, &vertex_map, 1, &schedule.rounded());
    assert!(more > less, "the vector that measures the error counts");
}

#[test]
fn vertices_that_are_never_entered_keep_the_error_bounded() {
    // Triangles without area fold a vertex into the middle of an edge.
    let Shape::Mesh(mesh) = sheet(20, 20) else { unreachable!() };
    let mut points = mesh.points().to_vec();
    let mut triangles: Vec<[u32; 3]> = mesh.faces().corners().as_chunks::<3>().0.to_vec();
    for (a, b) in [(0, 1), (45, 46), (399, 398)] {
        let (p, q) = (points[a as usize], points[b as usize]);
        points.push(std::array::from_fn(|c| 0.5 * p[c] + 0.5 * q[c]));
        triangles.push([a, b, points.len() as u32 - 1]);
    }
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).expect("finite"));
    let decomposer = walk_of(&shape, &OperatorParams::default());
    assert!(decomposer.stationary().iter().any(|&p| p < 1e-12), "a vertex that is never entered");
    let signal = noise(decomposer.n_vertices(), 8);
    let params = BandsParams::default();
    let half = split(&decomposer, &signal, &real(&[0.5, 1.0, 7.25]), &params);
    assert!(half.info.error_bound <= params.accuracy, "{:?}", half.info);
    let again = split(&decomposer, &half.scaling(1), &real(&[0.5, 6.75]), &params);
    let whole = split(&decomposer, &signal, &Schedule::new(vec![1, 7]).unwrap(), &params);
    for x in 0..decomposer.n_vertices() {
        assert!((again.scaling(1)[x] - whole.scaling(1)[x]).abs() < 1e-8, "vertex {x}");
        assert!((half.scaling(2)[x] - whole.scaling(1)[x]).abs() < 1e-8, "vertex {x}");
        assert!((again.scaling(2)[x] - half.scaling(3)[x]).abs() < 1e-8, "vertex {x}");
    }
}

#[test]
fn voices_and_lengths_are_exact() {
    let voices = Schedule::voices(8, 4).unwrap();
    assert_eq!(voices.n_levels(), 29);
    let sigma = voices.sigma(0.37);
    for pair in sigma[1..].windows(2) {
        assert!((pair[1] / pair[0] - 2.0_f64.powf(0.125)).abs() < 1e-15, "{pair:?}");
    }
    assert_eq!(voices.rounded().steps()[..5], [1.0, 2.0, 3.0, 4.0, 5.0]);
    let widths = [0.05, 0.37, 0.4, 1.11, 9.0];
    let lengths = Schedule::lengths(&widths, 0.37).unwrap();
    for (found, asked) in lengths.sigma(0.37)[1..].iter().zip(widths) {
        assert!((found / asked - 1.0).abs() < 1e-12, "{found} for {asked}");
    }
    // Three and nine steps, but for rounding.
    assert_eq!(lengths.steps()[1], 1.0);
    assert_eq!(lengths.steps()[3], 9.0);
    assert_eq!(Schedule::voices(5, 1).unwrap(), Schedule::dyadic(5).unwrap());
}

#[test]
fn the_strongest_response_to_a_bump_is_at_its_size_whatever_the_octave_is_cut_into() {
    // exp(−r²/2w²) on a flat sheet: W at the top is (1 + σ_a²/w²)⁻¹ − (1 + σ_b²/w²)⁻¹, the largest for σ_aσ_b = w².
    let n = 81_u32;
    let Shape::Mesh(mesh) = sheet(n, n) else { unreachable!() };
    let points: Vec<_> = mesh.points().iter().map(|p| [p[0].round(), p[1].round(), 0.0]).collect();
    let shape = Shape::Mesh(Mesh::new(points.clone(), mesh.faces().clone()).expect("finite"));
    let decomposer = Decomposer::new(&shape);
    let step = decomposer.operator().step_length();
    let top = (n / 2 * n + n / 2) as usize;
    for width in [4.0, 5.0, 6.3] {
        let bump: Vec<f64> = points
            .iter()
            .map(|p| {
                (-((p[0] - points[top][0]).powi(2) + (p[1] - points[top][1]).powi(2)) / (2.0 * width * width))
                    .exp()
            })
            .collect();
        for voices in [2, 4] {
            let schedule = Schedule::voices(9, voices).unwrap();
            let bands = decomposer.decompose(&bump, 1, &schedule).unwrap();
            let at = |j: usize| bands.wavelet(j)[top];
            // Level 1 is not one voice apart from the level before it.
            let best = (2..=bands.n_levels()).max_by(|&i, &j| at(i).total_cmp(&at(j))).unwrap();
            // A step spreads by step² over both directions of the sheet.
            let middle = (bands.sigma[best] * bands.sigma[best - 1] / 2.0).sqrt();
            let voice = 2.0_f64.powf(0.5 / voices as f64);
            assert!(
                middle / width < voice * 1.03 && width / middle < voice * 1.03,
                "width {width}, {voices} voices: {middle}; step {step}"
            );
        }
    }
}

#[test]
fn what_cannot_be_taken_is_refused() {
    for (steps, what) in [
        (vec![0.0], "0 steps"),
        (vec![-1.5], "-1.5"),
        (vec![f64::NAN], "NaN"),
        (vec![0.015], "0.015"),
        (vec![1.0, f64::NAN], "NaN"),
        (vec![1.5, 1.5], "must increase"),
        (vec![1.0, f64::INFINITY], "2^31"),
        (vec![3e9], "2^31"),
        (vec![], "at least one"),
    ] {
        let error = Schedule::real(steps.clone()).unwrap_err().to_string();
        assert!(error.contains(what), "{steps:?}: {error}");
    }
    assert_eq!(Schedule::real(vec![1.0 / 64.0]).unwrap().steps(), [1.0 / 64.0]);
    assert_eq!(Schedule::voices(3, 65), Err(ScheduleError::Voices { n_voices: 65 }));
    assert!(Schedule::lengths(&[0.01], 1.0).is_err());

    let cloud = Shape::Cloud(PointCloud::new(sheet(9, 9).points().unwrap().to_vec()).unwrap());
    let directed = walk_of(&cloud, &OperatorParams::default().with_cloud_graph(CloudGraph::Directed));
    let both_ways = walk_of(&cloud, &OperatorParams::default());
    let (vertex_map, signal) = (VertexMap::identity(81), noise(81, 9));
    let schedule = real(&[1.0, 2.5]);
    let ask = |decomposer: &Diffusion, params: &BandsParams| {
        decompose(decomposer, &vertex_map, &signal, 1, &schedule, params, Progress::none())
            .map(|bands| bands.steps)
    };
    let refused = Err(BandsError::NotWhole { level: 2, steps: 2.5 });
    assert_eq!(ask(&directed, &BandsParams::default()), refused);
    assert_eq!(ask(&both_ways, &BandsParams::default().with_engine(Engine::Powers)), refused);
    assert_eq!(ask(&both_ways, &BandsParams::default()), Ok(vec![0.0, 1.0, 2.5]));
    let rounded = schedule.rounded();
    assert!(
        decompose(&directed, &vertex_map, &signal, 1, &rounded, &BandsParams::default(), Progress::none())
            .is_ok()
    );

    let refused = BasisError::NotWhole { level: 2, steps: 2.5 };
    let all = basis(&both_ways, &BasisParams::new(schedule.clone()), Progress::none());
    assert_eq!(all.unwrap_err(), refused);
    let decomposer = Decomposer::new(&cloud);
    assert_eq!(decomposer.basis_of_vertex(0, &schedule, Progress::none()).unwrap_err(), refused);
}

#[test]
fn a_cancelled_call_makes_no_series_of_any_try() {
    // Stopped when the first products report: the bands that miss the accuracy would need the dear tries next.
    let walk = walk_of(&checkerboard(12, 12), &OperatorParams::default());
    let schedule = Schedule::voices(6, 64).expect("a schedule");
    let stop = AtomicBool::new(false);
    let report = |_: u64, _: u64| stop.store(true, Ordering::Relaxed);
    let progress = Progress::none().with_report(&report).with_cancel(&stop);
    let start = Instant::now();
    let vertex_map = VertexMap::identity(144);
    let found =
        decompose(&walk, &vertex_map, &noise(144, 3), 1, &schedule, &BandsParams::default(), progress);
    assert!(matches!(found, Err(BandsError::Cancelled(_))), "{found:?}");
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn an_accuracy_out_of_reach_is_said_with_what_is_reached() {
    // Half a step of a wave that turns round at every step: λ^½ near λ = 0 has no good polynomial.
    let walk = walk_of(&checkerboard(30, 1), &OperatorParams::default());
    let signal = noise(30, 10);
    let vertex_map = VertexMap::identity(30);
    let ask = |accuracy| {
        let params = BandsParams::default().with_accuracy(accuracy);
        decompose(&walk, &vertex_map, &signal, 1, &real(&[1.0, 1.05, 2.0]), &params, Progress::none())
    };
    match ask(1e-10) {
        Err(BandsError::Missed { level: 2, accuracy, reached }) => {
            assert!(accuracy == 1e-10 && (1e-10..1e-5).contains(&reached), "{reached:e}");
            let bands = ask(2.0 * reached).expect("what is reached is met");
            assert!(bands.info.error_bound <= 2.0 * reached);
        }
        other => panic!("{other:?}"),
    }
    // A wave that one step ends has no later band.
    let wave: Vec<f64> = (0..30).map(|i| f64::from(1 - 2 * (i % 2))).collect();
    let bands = real(&[1.0, 1.05]);
    match decompose(&walk, &vertex_map, &wave, 1, &bands, &BandsParams::default(), Progress::none()) {
        Err(error @ BandsError::Missed { level: 2, .. }) => {
            assert!(error.to_string().contains("all but vanishes"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_graph_any_signal_any_steps(
        edges in prop::collection::vec((0_u32..12, 0_u32..12, 0.01_f64..10.0), 1..40),
        signal in prop::collection::vec(-5.0_f64..5.0, 12),
        start in 0.8_f64..3.0,
        growth in 1.05_f64..9.0,
    ) {
        let edges: Vec<_> = edges.into_iter().filter(|(a, b, _)| a != b).collect();
        let shape = Shape::Graph(Graph::new(12, &edges).expect("a graph"));
        let walk = walk_of(&shape, &OperatorParams::default());
        let schedule = real(&[start, start * growth, start * growth * growth]);
        let params = BandsParams::default().with_accuracy(1e-6);
        let vertex_map = VertexMap::identity(12);
        let spectrum = walk.stationary().iter().all(|&p| p > 0.0).then(|| Spectrum::new(&walk));
        let bands = match decompose(&walk, &vertex_map, &signal, 1, &schedule, &params, Progress::none()) {
            Ok(bands) => bands,
            Err(BandsError::Missed { reached, .. }) => {
                // The last degree but one reaches rounding for all eigenvalues from 1e-4 on.
                prop_assert!(reached > 1e-6);
                prop_assert!(spectrum.is_none_or(|s| s.smallest() < 1e-4), "refused without need");
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        };
        if let Some(spectrum) = spectrum {
            let u = norm(walk.stationary(), spectrum.band(&signal, 0.0, 1.0).into_iter());
            for (j, pair) in bands.steps.windows(2).enumerate() {
                let exact = spectrum.band(&signal, pair[0], pair[1]);
                let size = norm(walk.stationary(), exact.iter().copied());
                let off = distance(walk.stationary(), bands.wavelet(j + 1), &exact);
                // An eigenvalue that is 0 but for rounding is known to 1e-16 only.
                prop_assert!(off <= 1e-6 * size + 1e-10 * u, "{:?}: {:e} of {:e}", pair, off, size);
            }
        }
    }
}
