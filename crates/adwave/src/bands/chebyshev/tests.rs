//! Laws of the recurrence.

use super::*;

use crate::operator::{OperatorParams, local_operator, surface_diffusion};
use crate::shape::{Graph, PreparedGeometry, Shape};
use crate::sparse::PreparedDiffusion;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A cycle of `n` vertices, each connected to the next `width` vertices.
fn ring_geometry(n: u32, width: u32) -> PreparedGeometry {
    let edge = |u: u32| (1..=width).map(move |e| (u, (u + e) % n, 1.0 + f64::from((u + e) % 3)));
    let edges: Vec<_> = (0..n).flat_map(edge).collect();
    let shape = Shape::Graph(Graph::new(n as usize, &edges).expect("edges of the graph"));
    PreparedGeometry::new(&shape, OperatorParams::default().weld, Progress::none()).expect("nobody stops it")
}

/// The walk on such a cycle.
fn ring(n: u32, width: u32) -> Arc<Diffusion> {
    let (geometry, params) = (ring_geometry(n, width), OperatorParams::default());
    let operator = local_operator(&geometry, &params, Progress::none()).expect("nobody stops it");
    Arc::new(Diffusion::new(operator, Progress::none()).expect("nobody stops it"))
}

/// The walk on a cycle of `n` vertices with 3 neighbors to each side, on another of 7, and on 5 vertices without edges.
fn ring_and_others(n: u32) -> Arc<Diffusion> {
    let edges: Vec<_> = (0..n)
        .flat_map(|u| (1..=3).map(move |e| (u, (u + e) % n, 1.0)))
        .chain((0..7).map(|u| (n + u, n + (u + 1) % 7, 2.0)))
        .collect();
    let shape = Shape::Graph(Graph::new(n as usize + 12, &edges).expect("edges of the graph"));
    let params = OperatorParams::default();
    let geometry = PreparedGeometry::new(&shape, params.weld, Progress::none()).expect("nobody stops it");
    let operator = local_operator(&geometry, &params, Progress::none()).expect("nobody stops it");
    Arc::new(Diffusion::new(operator, Progress::none()).expect("nobody stops it"))
}

/// A diffusion operator prepared for the recurrence.
fn evaluator(diffusion: Arc<Diffusion>) -> ChebyshevEvaluator {
    let operator = Arc::new(PreparedDiffusion::new(diffusion));
    ChebyshevEvaluator::new(operator, Progress::none()).expect("nobody stops it")
}

fn evaluate(
    prepared: &ChebyshevEvaluator,
    signal: &[f64],
    d: usize,
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    evaluate_all_terms(Precision::Double, prepared, SignalView { values: signal, n_channels: d }, progress)
}

fn evaluate_all_terms(
    precision: Precision,
    prepared: &ChebyshevEvaluator,
    signal: SignalView<'_>,
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    let series: Vec<Series> =
        [(0, 1), (8, 16), (64, 128)].map(|(a, b)| Series::band(a, b, Growth::Bounded)).to_vec();
    let mut bands = vec![vec![0.0; signal.values.len()]; series.len()];
    let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
    let (passes, output) = (&mut PassPlan::default(), RowOutput::Channels);
    let polynomials = Polynomials { series: &series, guard: &[], passes, output, precision };
    prepared.evaluate(signal, polynomials, 0.0, &mut outs, progress)?; // all terms
    Ok(bands)
}

#[test]
fn tiles_in_place_and_apart_give_the_bits_of_the_recurrence_one_step_at_a_time() {
    // Cycles with 2 neighbors have small halos; those with 140 have halos larger than two vectors.
    for (n, width, d) in [(20_000, 1, 3), (9000, 3, 5), (1500, 140, 2), (700, 2, 1)] {
        let diffusion = ring(n, width);
        let signal: Vec<f64> = (0..n as usize * d).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
        let prepared = PreparedDiffusion::new(diffusion);
        let plain = Arc::new(prepared.with_tiles(n as usize, 1));
        let plain = ChebyshevEvaluator::new(plain, Progress::none()).expect("nobody stops it");
        let fused = ChebyshevEvaluator::new(Arc::new(prepared), Progress::none()).expect("nobody stops it");
        for precision in [Precision::Double, Precision::Single] {
            let all = |evaluator: &ChebyshevEvaluator| {
                let signal = SignalView { values: &signal, n_channels: d };
                evaluate_all_terms(precision, evaluator, signal, Progress::none()).expect("nobody stops it")
            };
            let found = all(&fused);
            assert!(found == all(&plain), "{n}, {precision}");
            // Again, with vectors that an earlier call returned to the pool.
            assert!(found == all(&fused), "{n}, {precision}");
        }
    }
}

#[test]
fn wide_blocks_agree_with_narrow_ones_on_any_number_of_threads() {
    /// Rounding of up to 128 steps of values up to 101.
    const ROUNDING: f64 = 1e-10;
    let params = OperatorParams::default();
    let heat = surface_diffusion(&ring_geometry(3000, 9), &params, Progress::none());
    let heat = heat.expect("nobody stops it").diffusion;
    assert!((0..3000).any(|x| heat.diagonal(x) != 0.5), "the steps of heat are not lazy");
    for diffusion in [ring(3000, 9), Arc::new(heat)] {
        let prepared = evaluator(diffusion);
        for d in [16, 20, 33, 70] {
            let signal: Vec<f64> = (0..3000 * d).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
            let wide = evaluate(&prepared, &signal, d, Progress::none()).expect("nobody stops it");
            for channel in [0, 1, d / 2, d - 1] {
                let alone: Vec<f64> = signal.iter().skip(channel).step_by(d).copied().collect();
                let narrow = evaluate(&prepared, &alone, 1, Progress::none()).expect("nobody stops it");
                for (wide, narrow) in wide.iter().zip(&narrow) {
                    let of_wide = wide.iter().skip(channel).step_by(d);
                    let worst = of_wide.zip(narrow).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
                    assert!(worst < ROUNDING, "{d} channels: {worst}");
                }
            }
            let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
            let again = pool.install(|| evaluate(&prepared, &signal, d, Progress::none()));
            assert!(wide == again.expect("nobody stops it"), "{d} channels by three threads");
        }
    }
}

#[test]
fn a_single_wide_sum_takes_one_step_at_a_time_with_the_same_result() {
    const ROUNDING: f64 = 1e-10;
    let prepared = evaluator(ring(2000, 5));
    let signal: Vec<f64> = (0..2000 * 24).map(|i| f64::from((i * 17 + i / 5) % 89)).collect();
    let all = evaluate(&prepared, &signal, 24, Progress::none()).expect("nobody stops it");
    for (level, (a, b)) in [(0, 1), (8, 16), (64, 128)].into_iter().enumerate() {
        let series = [Series::band(a, b, Growth::Bounded)];
        let mut band = vec![0.0; signal.len()];
        let passes = &mut PassPlan::default();
        let polynomials = Polynomials {
            series: &series,
            guard: &[],
            passes,
            output: RowOutput::Channels,
            precision: Precision::Double,
        };
        let view = SignalView { values: &signal, n_channels: 24 };
        prepared
            .evaluate(view, polynomials, 0.0, &mut [&mut band], Progress::none())
            .expect("nobody stops it");
        let worst = band.iter().zip(&all[level]).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
        assert!(worst < ROUNDING, "band {level}: {worst}");
    }
}

#[test]
fn a_call_that_is_told_to_stop_does_so_at_once() {
    /// Far more time than an idle machine needs; the whole computation takes many times as long.
    const AT_ONCE: Duration = Duration::from_secs(2);
    let diffusion = ring(300_000, 3);
    let signal: Vec<f64> = (0..900_000).map(|i| f64::from((i * 31) % 101)).collect();
    let mut n_stopped = 0;
    for delay in [0, 3, 11, 29, 71, 113] {
        let (stop, told) = (AtomicBool::new(false), std::sync::Mutex::new(None));
        let progress = Progress::none().with_cancel(&stop);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(delay));
                *told.lock().expect("a clock") = Some(Instant::now());
                stop.store(true, Ordering::Relaxed);
            });
            let outcome = loop {
                // Repeated, because a fast machine finishes before it is cancelled.
                let operator = Arc::new(PreparedDiffusion::new(Arc::clone(&diffusion)));
                let prepared = ChebyshevEvaluator::new(operator, progress);
                let done = prepared.and_then(|prepared| evaluate(&prepared, &signal, 3, progress));
                if let Err(cancelled) = done {
                    break cancelled;
                }
            };
            assert_eq!(outcome, Cancelled);
            let told = told.lock().expect("a clock").expect("told before it stops");
            assert!(told.elapsed() < AT_ONCE, "{:?} after it was told to stop", told.elapsed());
            n_stopped += 1;
        });
    }
    assert_eq!(n_stopped, 6);
}

#[test]
fn a_second_call_gives_up_where_it_wants_more_than_the_first() {
    let mut passes = PassPlan::default();
    assert_eq!(
        [passes.aim(0, 0, 30), passes.aim(0, 1, 20), passes.aim(1, 0, 9)],
        [Some(30), Some(20), Some(9)]
    );
    passes.repeat();
    assert_eq!((passes.aim(0, 0, 12), passes.aim(0, 1, 20)), (Some(30), Some(20)));
    assert!(!passes.differ());
    assert_eq!(passes.aim(1, 0, 10), None); // a single call would have aimed at 10
    assert!(passes.differ());
}

#[test]
fn what_is_prepared_can_be_shared_between_threads() {
    fn shared<T: Send + Sync + 'static>() {}
    shared::<ChebyshevEvaluator>();
    shared::<Arc<ChebyshevEvaluator>>();
}

/// The sum of the bands 1 … 8 and the band 5 … 8 in a number format, with their cost and error.
fn evaluate_in(
    precision: Precision,
    prepared: &ChebyshevEvaluator,
    signal: SignalView<'_>,
    accuracy: f64,
) -> (Vec<Vec<f64>>, EvaluationInfo) {
    let series = [(0, 8), (5, 8)].map(|(a, b)| Series::band(a, b, Growth::Bounded));
    let mut bands = vec![vec![f64::NAN; signal.values.len()]; series.len()];
    let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
    let (passes, output) = (&mut PassPlan::default(), RowOutput::Channels);
    let polynomials = Polynomials { series: &series, guard: &[], passes, output, precision };
    let info = prepared.evaluate(signal, polynomials, accuracy, &mut outs, Progress::none());
    (bands, info.expect("nobody stops it"))
}

/// Norm of the difference of two signals in the norm of the operator, relative to the second.
fn relative_difference(weights: &[f64], found: &[f64], exact: &[f64]) -> f64 {
    let d = exact.len() / weights.len();
    let norm = |value: &dyn Fn(usize) -> f64| {
        (0..exact.len()).map(|i| weights[i / d] * value(i).powi(2)).sum::<f64>().sqrt()
    };
    norm(&|i| found[i] - exact[i]) / norm(&|i| exact[i])
}

#[test]
fn single_precision_keeps_to_its_bound_on_any_number_of_threads() {
    let params = OperatorParams::default();
    let heat = surface_diffusion(&ring_geometry(3000, 9), &params, Progress::none());
    let heat = Arc::new(heat.expect("nobody stops it").diffusion);
    // Fewer rows than channels, rows of one, several and many groups, and a part without edges.
    for diffusion in [ring(3000, 9), ring(40, 2), ring(500, 140), heat, ring_and_others(900)] {
        let weights = diffusion.stationary().to_vec();
        let prepared = evaluator(diffusion);
        let n = weights.len();
        let many = [(16, 0.0, 1.0), (47, 1e6, 1.0), (64, 0.0, 1e-100), (130, -3.0, 1e100)];
        let few = [(1, 0.0, 1.0), (2, 1e6, 1e-30), (3, 0.0, 1e30), (4, -3.0, 1e100), (5, 0.0, 1e-100)];
        for (d, offset, size) in many.into_iter().chain(few) {
            let value = |i: usize| size * (offset + ((i * 31 + i / 7) % 101) as f64 / 101.0);
            let values: Vec<f64> = (0..n * d).map(value).collect();
            let signal = SignalView { values: &values, n_channels: d };
            let (exact, double) = evaluate_in(Precision::Double, &prepared, signal, 1e-12);
            let (found, info) = evaluate_in(Precision::Single, &prepared, signal, 1e-3);
            assert!(double.single_products == 0 && info.single_products > 0);
            assert!((1e-7..1e-2).contains(&info.error_bound), "{n}, {d}: {}", info.error_bound);
            for (found, exact) in found.iter().zip(&exact) {
                let error = relative_difference(&weights, found, exact);
                assert!(error <= info.error_bound, "{n}, {d}: {error:e} beyond {:e}", info.error_bound);
                assert!(error > 1e-10, "{n}, {d}: not computed in single precision");
            }
            let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
            let again = pool.install(|| evaluate_in(Precision::Single, &prepared, signal, 1e-3).0);
            assert!(found == again, "{n}, {d}: three threads");
        }
    }
}

#[test]
fn single_precision_has_no_bound_where_norms_underflow_or_overflow() {
    let prepared = evaluator(ring(300, 3));
    for (size, n_channels) in [(1e-200, 16), (1e200, 16), (1e-200, 3), (1e200, 3)] {
        let values: Vec<f64> = (0..300 * 16).map(|i| size * f64::from(i % 7)).collect();
        let signal = SignalView { values: &values[..300 * n_channels], n_channels };
        let (_, info) = evaluate_in(Precision::Single, &prepared, signal, 1e-3);
        assert!(info.single_products > 0 && info.error_bound == f64::INFINITY, "{size}: {info:?}");
        assert_eq!(evaluate_in(Precision::Auto, &prepared, signal, 1e-3).1.single_products, 0);
    }
}

#[test]
fn automatic_precision_is_single_only_where_its_bound_keeps_to_the_accuracy() {
    let weights = ring(3000, 9).stationary().to_vec();
    let prepared = evaluator(ring(3000, 9));
    for n_channels in [1, 3, 100] {
        assert_automatic_precision(&prepared, &weights, n_channels);
    }
}

fn assert_automatic_precision(prepared: &ChebyshevEvaluator, weights: &[f64], n_channels: usize) {
    let rough: Vec<f64> = (0..3000 * n_channels).map(|i| ((i * 31 + i / 7) % 101) as f64).collect();
    let signal = SignalView { values: &rough, n_channels };
    let mut formats = Vec::new();
    for accuracy in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-10] {
        let (found, info) = evaluate_in(Precision::Auto, prepared, signal, accuracy);
        assert!(info.error_bound <= accuracy, "{accuracy:e}: {:e}", info.error_bound);
        formats.push(info.single_products > 0);
        if info.single_products == 0 {
            let (exact, _) = evaluate_in(Precision::Double, prepared, signal, accuracy);
            for (found, exact) in found.iter().zip(&exact) {
                assert!(relative_difference(weights, found, exact) <= 2.0 * accuracy);
            }
        }
    }
    assert!(formats[0] && !formats[5], "{formats:?}");
    assert!(formats.is_sorted_by(|a, b| a >= b), "{formats:?}");
}

#[test]
fn constants_give_exact_zeros_in_single_precision() {
    let prepared = evaluator(ring(300, 3));
    for n_channels in [3, 20] {
        let signal = SignalView { values: &vec![0.1; 300 * n_channels], n_channels };
        let (found, info) = evaluate_in(Precision::Single, &prepared, signal, 1e-3);
        assert!(found.iter().flatten().all(|&v| v == 0.0));
        assert_eq!(info.error_bound, 0.0);
    }
}

#[test]
fn few_channels_take_half_the_memory_in_single_precision() {
    let prepared = evaluator(ring(3000, 9));
    let values: Vec<f64> = (0..9000).map(|i| f64::from(i % 89)).collect();
    let signal = SignalView { values: &values, n_channels: 3 };
    evaluate_in(Precision::Double, &prepared, signal, 1e-3);
    let bytes = |format| prepared.working_bytes(3, format);
    let (without, double) = (bytes(BlockPrecision::Single), bytes(BlockPrecision::Double));
    // Two vectors at least, and values around the tiles.
    assert!(double - without >= 4 * 2 * 9000, "{double} and {without} bytes");
    evaluate_in(Precision::Single, &prepared, signal, 1e-3);
    let nnz = prepared.operator.rows().expect("rows").nnz() as u64;
    let entries = bytes(BlockPrecision::Single) - without;
    assert!((4 * nnz..4 * 4 * nnz).contains(&entries), "{entries} bytes of {nnz} entries");
    assert_eq!(bytes(BlockPrecision::Double) - bytes(BlockPrecision::Single), double - without);
}
