//! Laws of the engines: the recurrence gives what repeated products give, to the accuracy that was asked for.

use crate::common;

use adwave::bands::{Bands, BandsError, BandsParams, Engine, Precision, Schedule, Transform};
use adwave::operator::{CloudGraph, Diffusion, OperatorParams, local_operator};
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, PreparedGeometry, Shape, VertexMap};
use adwave::{Cancelled, Progress};
use adwave_io::{ReadLimits, read_path};
use adwave_test_data::data_test;
use common::octahedral_sphere;
use common::one_off::{decompose, forecast_bytes, levels, weighted_bands};
use proptest::prelude::*;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Rounding of f64 that some hundred products and sums may add up, relative to the band.
const ROUNDING: f64 = 1e-12;

/// A sheet of `rows × columns` vertices, bumpy by `noise` of its spacing.
fn sheet(rows: usize, columns: usize, noise: f64) -> Shape {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut points = Vec::new();
    for r in 0..rows {
        for c in 0..columns {
            let height = 3.0 * (r as f64 * 0.2).sin() + noise * random();
            points.push([r as f64 + noise * random(), c as f64 + noise * random(), height]);
        }
    }
    let mut triangles = Vec::new();
    for r in 0..rows as u32 - 1 {
        for c in 0..columns as u32 - 1 {
            let (a, step) = (r * columns as u32 + c, columns as u32);
            triangles.push([a, a + 1, a + step]);
            triangles.push([a + 1, a + step + 1, a + step]);
        }
    }
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).expect("a finite mesh"))
}

fn prepare(shape: &Shape, params: &OperatorParams) -> (PreparedGeometry, Diffusion) {
    let geometry = PreparedGeometry::new(shape, params.weld, Progress::none()).unwrap();
    let diffusion =
        Diffusion::new(local_operator(&geometry, params, Progress::none()).unwrap(), Progress::none())
            .unwrap();
    (geometry, diffusion)
}

fn cycle(n: u32) -> Diffusion {
    let edges: Vec<_> = (0..n).map(|u| (u, (u + 1) % n, 1.0)).collect();
    let graph = Graph::new(n as usize, &edges).expect("a cycle");
    // In the order of the nodes, in which waves are easy to write down.
    let geometry = PreparedGeometry::from_ordered_graph(graph);
    Diffusion::new(
        local_operator(&geometry, &OperatorParams::default(), Progress::none()).unwrap(),
        Progress::none(),
    )
    .unwrap()
}

fn split(
    diffusion: &Diffusion,
    vertex_map: &VertexMap,
    signal: &[f64],
    d: usize,
    schedule: &Schedule,
    params: &BandsParams,
) -> Bands {
    decompose(diffusion, vertex_map, signal, d, schedule, params, Progress::none()).expect("a valid request")
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum::<f64>().sqrt()
}

/// Largest `‖W − W′‖ / ‖W′‖` over the levels.
fn worst(found: &[Vec<f64>], exact: &[Vec<f64>]) -> f64 {
    assert_eq!(found.len(), exact.len());
    found
        .iter()
        .zip(exact)
        .map(|(w, e)| {
            let error = norm(w.iter().zip(e).map(|(w, e)| w - e));
            if error == 0.0 { 0.0 } else { error / norm(e.iter().copied()) }
        })
        .fold(0.0, f64::max)
}

fn engines_agree(shape: &Shape, operator: &OperatorParams, signal: &[f64], d: usize, schedule: &Schedule) {
    let (geometry, diffusion) = prepare(shape, operator);
    let powers = split(
        &diffusion,
        geometry.vertex_map(),
        signal,
        d,
        schedule,
        &BandsParams::default().with_engine(Engine::Powers),
    );
    assert_eq!(powers.info.engine, Engine::Powers);
    for accuracy in [1e-2, 1e-5, 1e-9, 1e-13] {
        let params = BandsParams::default().with_accuracy(accuracy).with_engine(Engine::Chebyshev);
        let bands = split(&diffusion, geometry.vertex_map(), signal, d, schedule, &params);
        assert_eq!(bands.info.engine, Engine::Chebyshev);
        assert!(bands.info.error_bound <= accuracy, "{} for {accuracy}", bands.info.error_bound);
        // The bound is one of the norm under the stationary law; the plain norm of these shapes differs by less than 10.
        let error = worst(&levels(&bands), &levels(&powers));
        assert!(error <= 10.0 * accuracy + ROUNDING, "error {error} for accuracy {accuracy}");
    }
}

fn coordinates(shape: &Shape) -> Vec<f64> {
    shape.points().expect("points").as_flattened().to_vec()
}

#[test]
fn engines_agree_on_dyadic_levels_voices_and_odd_steps() {
    let schedules = [
        Schedule::dyadic(9).expect("valid"),
        Schedule::dyadic(1).expect("valid"),
        Schedule::voices(6, 3).expect("valid").rounded(),
        Schedule::new(vec![3, 4, 77, 78, 400]).expect("valid"),
    ];
    for noise in [0.0, 0.3] {
        let shape = sheet(40, 31, noise);
        for schedule in &schedules {
            engines_agree(&shape, &OperatorParams::default(), &coordinates(&shape), 3, schedule);
        }
    }
}

#[test]
fn engines_agree_on_white_noise_and_on_one_vertex_that_differs() {
    let shape = sheet(30, 30, 0.1);
    let noise: Vec<f64> = (0..900).map(|i| f64::from(i * 7919 % 1009) / 1009.0).collect();
    let mut delta = vec![0.0; 900];
    delta[455] = 1.0;
    for signal in [noise, delta] {
        engines_agree(&shape, &OperatorParams::default(), &signal, 1, &Schedule::dyadic(8).expect("valid"));
    }
}

#[test]
fn engines_agree_on_clouds_and_wide_rings() {
    let shape = sheet(25, 25, 0.4);
    let cloud = Shape::Cloud(PointCloud::new(shape.points().expect("points").to_vec()).expect("finite"));
    let schedule = Schedule::dyadic(7).expect("valid");
    engines_agree(&cloud, &OperatorParams::default(), &coordinates(&cloud), 3, &schedule);
    engines_agree(&shape, &OperatorParams::default().with_rings(3), &coordinates(&shape), 3, &schedule);
}

#[test]
fn vertices_without_area_keep_the_error_bounded() {
    // Zero-area triangles fold a vertex into the middle of an edge, outside every triangle with area.
    let Shape::Mesh(mesh) = sheet(20, 20, 0.1) else { unreachable!() };
    let mut points = mesh.points().to_vec();
    let mut triangles: Vec<[u32; 3]> = mesh.faces().corners().as_chunks::<3>().0.to_vec();
    for (a, b) in [(0, 1), (45, 46), (46, 47), (399, 398)] {
        let (p, q) = (points[a as usize], points[b as usize]);
        points.push(std::array::from_fn(|c| 0.5 * p[c] + 0.5 * q[c]));
        triangles.push([a, b, points.len() as u32 - 1]);
    }
    let (x, y) = (points.len() as u32 - 3, points.len() as u32 - 2);
    triangles.push([x, y, x]);
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).expect("finite"));
    let (_, diffusion) = prepare(&shape, &OperatorParams::default());
    let transient = (0..diffusion.n_vertices()).filter(|&x| diffusion.stationary()[x] < 1e-12).count();
    assert!(transient >= 3, "the test needs vertices that are never entered, not {transient}");
    let schedule = Schedule::dyadic(9).expect("valid");
    engines_agree(&shape, &OperatorParams::default(), &coordinates(&shape), 3, &schedule);
}

#[test]
fn on_a_cycle_every_wave_is_damped_by_its_eigenvalue() {
    let n = 60_u32;
    let diffusion = cycle(n);
    let schedule = Schedule::dyadic(12).expect("valid");
    let params = BandsParams::default().with_accuracy(1e-12);
    for wave in [1, 3, 10] {
        let theta = f64::from(wave) * std::f64::consts::TAU / f64::from(n);
        let signal: Vec<f64> = (0..n).map(|x| (theta * f64::from(x)).cos()).collect();
        let bands = split(&diffusion, &VertexMap::identity(n as usize), &signal, 1, &schedule, &params);
        let lambda = 0.5 + 0.5 * theta.cos();
        for (j, &steps) in schedule.steps().iter().enumerate() {
            let scale = lambda.powf(steps);
            for (s, f) in bands.scaling(j + 1).iter().zip(&signal) {
                assert!((s - scale * f).abs() <= 1e-11, "wave {wave}, {steps} steps: {s} for {}", scale * f);
            }
        }
    }
}

#[test]
fn deep_levels_reach_the_mean() {
    let diffusion = cycle(50);
    let signal: Vec<f64> = (0..50).map(|x| f64::from(x * x % 17)).collect();
    let mean = signal.iter().sum::<f64>() / 50.0;
    let bands = split(
        &diffusion,
        &VertexMap::identity(50),
        &signal,
        1,
        &Schedule::dyadic(20).expect("valid"),
        &BandsParams::default(),
    );
    assert!(bands.scaling(20).iter().all(|s| (s - mean).abs() < 1e-8), "{:?}", bands.scaling(20));
    assert!(bands.info.products < 20_000, "{:?}", bands.info);
}

#[test]
fn constants_have_no_bands_at_all() {
    let shape = sheet(12, 9, 0.2);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    for engine in [Engine::Powers, Engine::Chebyshev] {
        let params = BandsParams::default().with_engine(engine);
        let bands = split(
            &diffusion,
            geometry.vertex_map(),
            &[0.1; 108],
            1,
            &Schedule::dyadic(8).expect("valid"),
            &params,
        );
        assert!(bands.wavelets().flatten().all(|&w| w == 0.0));
        assert!(bands.all_scaling().iter().all(|&s| s == 0.1));
    }
}

#[test]
fn several_channels_are_single_ones_within_the_accuracy() {
    // Not to the bit: the degree follows the norm over the channels of a block.
    let shape = sheet(17, 23, 0.3);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let schedule = Schedule::dyadic(7).expect("valid");
    let n = 17 * 23;
    for d in [1, 2, 3, 4, 5, 7, 9] {
        let signal: Vec<f64> = (0..n * d).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
        let all = split(&diffusion, geometry.vertex_map(), &signal, d, &schedule, &BandsParams::default());
        for c in 0..d {
            let single: Vec<f64> = signal.iter().skip(c).step_by(d).copied().collect();
            let one =
                split(&diffusion, geometry.vertex_map(), &single, 1, &schedule, &BandsParams::default());
            let channel: Vec<Vec<f64>> =
                all.wavelets().map(|w| w.iter().skip(c).step_by(d).copied().collect()).collect();
            assert!(worst(&channel, &levels(&one)) <= 10.0 * 1e-9);
        }
    }
}

#[test]
fn exact_levels_are_the_same_bits_for_one_channel_and_for_many() {
    // Up to n = 8 all terms are taken whatever the signal.
    let shape = sheet(17, 23, 0.3);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let schedule = Schedule::dyadic(4).expect("valid");
    let params = BandsParams::default().with_accuracy(1e-13);
    let signal = coordinates(&shape);
    let all = split(&diffusion, geometry.vertex_map(), &signal, 3, &schedule, &params);
    for c in 0..3 {
        let single: Vec<f64> = signal.iter().skip(c).step_by(3).copied().collect();
        let one = split(&diffusion, geometry.vertex_map(), &single, 1, &schedule, &params);
        for (w, one) in all.wavelets().zip(&levels(&one)) {
            assert!(w.iter().skip(c).step_by(3).eq(one));
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let shape = sheet(90, 70, 0.3);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let signal = coordinates(&shape);
    let schedule = Schedule::dyadic(9).expect("valid");
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            split(&diffusion, geometry.vertex_map(), &signal, 3, &schedule, &BandsParams::default())
        })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(3));
}

#[test]
fn a_directed_cloud_falls_back_to_powers() {
    let shape = sheet(15, 15, 0.4);
    let cloud = Shape::Cloud(PointCloud::new(shape.points().expect("points").to_vec()).expect("finite"));
    let params = OperatorParams::default().with_cloud_graph(CloudGraph::Directed);
    let (geometry, diffusion) = prepare(&cloud, &params);
    let schedule = Schedule::dyadic(5).expect("valid");
    let ask = BandsParams::default().with_engine(Engine::Chebyshev);
    let bands = split(&diffusion, geometry.vertex_map(), &coordinates(&cloud), 3, &schedule, &ask);
    assert_eq!(bands.info.engine, Engine::Powers);
    assert_eq!(bands.info.products, 16);
    assert!(
        norm(bands.reconstruct().iter().zip(&coordinates(&cloud)).map(|(a, b)| a - b)) < ROUNDING * 100.0
    );
}

#[test]
fn one_vertex_and_isolated_vertices_keep_their_values() {
    let graph = Graph::new(4, &[(0, 1, 2.0)]).expect("a graph");
    let (_, diffusion) = prepare(&Shape::Graph(graph), &OperatorParams::default());
    let schedule = Schedule::dyadic(6).expect("valid");
    let bands = split(
        &diffusion,
        &VertexMap::identity(4),
        &[1.0, 3.0, 5.0, 7.0],
        1,
        &schedule,
        &BandsParams::default(),
    );
    assert_eq!(*bands.coarsest(), [2.0, 2.0, 5.0, 7.0]);
    let (_, single) = prepare(&Shape::Graph(Graph::new(1, &[]).expect("a node")), &OperatorParams::default());
    let bands = split(&single, &VertexMap::identity(1), &[4.0, 5.0], 2, &schedule, &BandsParams::default());
    assert_eq!(*bands.coarsest(), [4.0, 5.0]);
    assert!(bands.wavelets().flatten().all(|&w| w == 0.0));
}

#[test]
fn a_weighted_sum_of_bands_is_the_sum_of_the_weighted_bands() {
    let shape = sheet(21, 34, 0.3);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let schedule = Schedule::dyadic(8).expect("valid");
    let factors = [-1.0, -0.5, 0.0, 2.0, 1.0, 0.25, -1.0, 3.0];
    let signal = coordinates(&shape);
    for engine in [Engine::Powers, Engine::Chebyshev] {
        let params = BandsParams::default().with_engine(engine);
        let bands = split(&diffusion, geometry.vertex_map(), &signal, 3, &schedule, &params);
        let mut expected = vec![0.0; signal.len()];
        for (factor, band) in factors.iter().zip(&levels(&bands)) {
            expected.iter_mut().zip(band).for_each(|(e, w)| *e += factor * w);
        }
        let (found, info) = weighted_bands(
            &diffusion,
            geometry.vertex_map(),
            &signal,
            3,
            &schedule,
            &factors,
            &params,
            Progress::none(),
        )
        .expect("valid");
        assert!(worst(&[found], &[expected]) <= 10.0 * params.accuracy);
        assert_eq!(info.engine, engine);
    }
}

#[test]
fn welded_vertices_that_differ_are_summed_back() {
    let Shape::Mesh(mesh) = sheet(6, 6, 0.1) else { unreachable!() };
    // Every triangle with corners of its own, as an STL file has them.
    let corners: Vec<[f64; 3]> = mesh.faces().corners().iter().map(|&c| mesh.points()[c as usize]).collect();
    let soup: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let shape = Shape::Mesh(Mesh::new(corners, Polygons::from_triangles(&soup)).expect("finite"));
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let n = shape.n_vertices();
    let signal: Vec<f64> = (0..n).map(|i| (i * 13 % 29) as f64).collect();
    let schedule = Schedule::dyadic(6).expect("valid");
    let bands = split(&diffusion, geometry.vertex_map(), &signal, 1, &schedule, &BandsParams::default());
    for (x, (a, b)) in bands.reconstruct().iter().zip(&signal).enumerate() {
        assert!((a - b).abs() < 1e-12, "vertex {x}: {a} for {b}");
    }
    for x in 0..n {
        for y in 0..x {
            if geometry.vertex_map().welded(x) == geometry.vertex_map().welded(y) {
                assert!((1..=6).all(|j| bands.scaling(j)[x] == bands.scaling(j)[y]));
            }
        }
    }
    let factors = [2.0, 0.0, 1.0, 0.0, 0.0, -1.0];
    let (sum, _) = weighted_bands(
        &diffusion,
        geometry.vertex_map(),
        &signal,
        1,
        &schedule,
        &factors,
        &BandsParams::default(),
        Progress::none(),
    )
    .expect("valid");
    for x in 0..n {
        let expected: f64 = factors.iter().zip(&levels(&bands)).map(|(g, w)| g * w[x]).sum();
        assert!((sum[x] - expected).abs() < 1e-7, "vertex {x}: {} for {expected}", sum[x]);
    }
}

#[test]
fn accuracies_that_cannot_be_promised_are_refused() {
    let diffusion = cycle(5);
    let schedule = Schedule::dyadic(3).expect("valid");
    for accuracy in [0.0, -1.0, 1e-14, 0.5, f64::NAN, f64::INFINITY] {
        let params = BandsParams::default().with_accuracy(accuracy);
        let refused = decompose(
            &diffusion,
            &VertexMap::identity(5),
            &[0.0; 5],
            1,
            &schedule,
            &params,
            Progress::none(),
        );
        assert!(matches!(refused, Err(BandsError::Accuracy { .. })), "{accuracy}");
    }
}

#[test]
fn a_request_beyond_memory_is_refused_with_the_forecast() {
    let diffusion = cycle(500);
    let (vertex_map, schedule) = (VertexMap::identity(500), Schedule::dyadic(10).expect("valid"));
    let needed = forecast_bytes(&diffusion, &vertex_map, 3, &schedule);
    assert!(needed >= 500 * 3 * 8 * 11, "W_1 … W_10 and S_10");
    let ask = |max_bytes| {
        let params = BandsParams::default().with_max_bytes(max_bytes);
        decompose(&diffusion, &vertex_map, &[0.0; 1500], 3, &schedule, &params, Progress::none())
    };
    assert_eq!(ask(needed - 1).unwrap_err(), BandsError::TooLarge { needed, available: needed - 1 });
    assert!(ask(needed).is_ok());
}

#[test]
fn a_request_to_stop_is_obeyed() {
    let diffusion = cycle(200);
    let signal: Vec<f64> = (0..200).map(f64::from).collect();
    let stop = AtomicBool::new(false);
    for engine in [Engine::Powers, Engine::Chebyshev] {
        stop.store(false, std::sync::atomic::Ordering::Relaxed);
        let report = |done, _| {
            if done >= 20 {
                stop.store(true, std::sync::atomic::Ordering::Relaxed);
            }
        };
        let stopped = decompose(
            &diffusion,
            &VertexMap::identity(200),
            &signal,
            1,
            &Schedule::dyadic(32).expect("valid"),
            &BandsParams::default().with_engine(engine),
            Progress::none().with_report(&report).with_cancel(&stop),
        );
        assert_eq!(stopped.unwrap_err(), BandsError::Cancelled(Cancelled));
    }
}

#[test]
fn signals_near_the_ends_of_double_precision_give_finite_bands() {
    let diffusion = cycle(40);
    let schedule = Schedule::dyadic(7).expect("valid");
    let reference: Vec<f64> = (0..40).map(|x| f64::from(x * x % 23)).collect();
    let expected =
        split(&diffusion, &VertexMap::identity(40), &reference, 1, &schedule, &BandsParams::default());
    for scale in [1e-250, 1e250] {
        let signal: Vec<f64> = reference.iter().map(|v| v * scale).collect();
        let bands =
            split(&diffusion, &VertexMap::identity(40), &signal, 1, &schedule, &BandsParams::default());
        let back: Vec<Vec<f64>> = bands.wavelets().map(|w| w.iter().map(|v| v / scale).collect()).collect();
        assert!(worst(&back, &levels(&expected)) <= 1e-8);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_graph_any_signal_any_schedule(
        edges in prop::collection::vec((0_u32..30, 0_u32..30, 0.01..10.0_f64), 0..120),
        signal in prop::collection::vec(-1e3..1e3_f64, 60),
        gaps in prop::collection::vec(1_u64..40, 1..6),
    ) {
        let shape = Shape::Graph(Graph::new(30, &edges).expect("valid edges"));
        let (_, diffusion) = prepare(&shape, &OperatorParams::default());
        let steps = gaps.iter().scan(0, |n, gap| { *n += gap; Some(*n) }).collect();
        let schedule = Schedule::new(steps).expect("increasing");
        let vertex_map = VertexMap::identity(30);
        let chebyshev = split(&diffusion, &vertex_map, &signal, 2, &schedule, &BandsParams::default());
        let params = BandsParams::default().with_engine(Engine::Powers);
        let powers = split(&diffusion, &vertex_map, &signal, 2, &schedule, &params);
        let weighted = |values: &[f64]| {
            let square = |(i, v): (usize, &f64)| diffusion.stationary()[i / 2] * v * v;
            values.iter().enumerate().map(square).sum::<f64>().sqrt()
        };
        for (w, e) in chebyshev.wavelets().zip(&levels(&powers)) {
            let error: Vec<f64> = w.iter().zip(e).map(|(w, e)| w - e).collect();
            // A band that vanishes beside the signal is known to the rounding of the signal.
            prop_assert!(weighted(&error) <= 1e-9 * weighted(e) + ROUNDING * weighted(&signal));
        }
        for (a, b) in chebyshev.reconstruct().iter().zip(&signal) {
            prop_assert!((a - b).abs() <= 1e-9);
        }
    }
}

#[test]
fn a_prepared_transform_can_be_used_again() {
    let shape = sheet(20, 20, 0.2);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let transform = Transform::new(diffusion, &BandsParams::default()).expect("valid");
    let schedule = Schedule::dyadic(6).expect("valid");
    let first = transform
        .bands(geometry.vertex_map(), &coordinates(&shape), 3, &schedule, Progress::none())
        .expect("valid");
    let ones = vec![1.0; 400];
    transform.bands(geometry.vertex_map(), &ones, 1, &schedule, Progress::none()).expect("valid");
    let again = transform
        .bands(geometry.vertex_map(), &coordinates(&shape), 3, &schedule, Progress::none())
        .expect("valid");
    assert_eq!(first, again);
}

#[test]
fn on_a_fine_sphere_every_band_is_accurate_beside_itself() {
    // W_f(1) is some 1e-5 of the radius here: an error beside the coordinates would show.
    let shape = octahedral_sphere(6);
    let coordinates = coordinates(&shape);
    let (geometry, diffusion) = prepare(&shape, &OperatorParams::default());
    let schedule = Schedule::dyadic(9).expect("valid");
    let bands = split(&diffusion, geometry.vertex_map(), &coordinates, 3, &schedule, &BandsParams::default());
    let size = |w: &[f64]| norm(w.iter().copied()) / norm(coordinates.iter().copied());
    assert!(size(bands.wavelet(1)) < 1e-3, "{}", size(bands.wavelet(1)));
    engines_agree(&shape, &OperatorParams::default(), &coordinates, 3, &schedule);
}

#[data_test]
fn scanned_shapes_keep_the_stated_accuracy() {
    for name in ["paper/common-3d-test-models/stanford-bunny.obj", "paper/libigl-tutorial-data/armadillo.obj"]
    {
        let path = Path::new(adwave_test_data::folder!()).join(name);
        let shape = read_path(&path, &ReadLimits::default()).expect("a mesh").into_shape().expect("a mesh");
        let schedule = Schedule::dyadic(9).expect("valid");
        engines_agree(&shape, &OperatorParams::default(), &coordinates(&shape), 3, &schedule);
    }
}

/// Bands in single precision are off by no more than their bound.
fn single_agrees(shape: &Shape, operator: &OperatorParams, signal: &[f64], d: usize, schedule: &Schedule) {
    let (geometry, diffusion) = prepare(shape, operator);
    let bands = |accuracy, precision| {
        let params = BandsParams::default().with_accuracy(accuracy).with_precision(precision);
        split(&diffusion, geometry.vertex_map(), signal, d, schedule, &params)
    };
    let (exact, single) = (bands(1e-12, Precision::Double), bands(1e-4, Precision::Single));
    assert_eq!((exact.info.precision, single.info.precision), (Precision::Double, Precision::Single));
    let (error, bound) = (worst(&levels(&single), &levels(&exact)), single.info.error_bound);
    // The bound is one of the norm under the stationary law; the plain norm of these shapes differs by less than 10.
    assert!(error > 1e-9 && error <= 10.0 * bound && bound < 0.1, "error {error:e} for a bound of {bound:e}");
    let auto = bands(1e-10, Precision::Auto);
    assert_eq!(auto.info.precision, Precision::Double);
}

#[test]
fn single_precision_keeps_to_its_bound_on_meshes_and_clouds() {
    let mesh = sheet(30, 30, 0.3);
    let points = coordinates(&mesh);
    let cloud = Shape::Cloud(PointCloud::new(mesh.points().expect("points").to_vec()).expect("finite"));
    let schedule = Schedule::dyadic(7).expect("valid");
    for d in 1..=4 {
        let signal: Vec<f64> = (0..900 * d).map(|i| points[i % points.len()] + (i % d) as f64).collect();
        single_agrees(&mesh, &OperatorParams::default(), &signal, d, &schedule);
        single_agrees(&cloud, &OperatorParams::default(), &signal, d, &schedule);
    }
}

#[data_test]
fn single_precision_keeps_to_its_bound_on_scanned_shapes() {
    for name in ["paper/common-3d-test-models/stanford-bunny.obj", "paper/libigl-tutorial-data/armadillo.obj"]
    {
        let path = Path::new(adwave_test_data::folder!()).join(name);
        let shape = read_path(&path, &ReadLimits::default()).expect("a mesh").into_shape().expect("a mesh");
        let schedule = Schedule::dyadic(8).expect("valid");
        single_agrees(&shape, &OperatorParams::default(), &coordinates(&shape), 3, &schedule);
    }
}
