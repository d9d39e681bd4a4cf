//! Laws of denoised curves whose noise differs between the axes, or is hidden by rounding.

use super::{denoised, rms};
use adwave::denoise::{CurveDenoising, DenoiseInfo, DenoiseParams};
use adwave::shape::{Graph, Shape};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

type Point = [f64; 3];

/// Number of vertices of a track.
const N: usize = 400;

fn path(points: &[Point]) -> Shape {
    let edges: Vec<[u32; 2]> = (1..points.len() as u32).map(|k| [k - 1, k]).collect();
    Shape::Graph(Graph::curve(points.to_vec(), &edges).unwrap())
}

/// A winding track with hills, of edges about 1 long.
fn track() -> Vec<Point> {
    (0..N).map(|k| k as f64).map(|t| [0.8 * t, 25.0 * (t / 40.0).sin(), 6.0 * (t / 70.0).cos()]).collect()
}

/// Adds noise of a standard deviation for each axis.
fn noisy(points: &[Point], sigma: Point, seed: u64) -> Vec<Point> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut deviate = || -> f64 { StandardNormal.sample(&mut random) };
    points.iter().map(|p| std::array::from_fn(|a| p[a] + sigma[a] * deviate())).collect()
}

fn smooth(points: &[Point]) -> (Vec<Point>, DenoiseInfo, CurveDenoising) {
    let found = denoised(&path(points), &DenoiseParams::default());
    let curve = found.info.curve.unwrap();
    (found.points, found.info, curve)
}

/// Root mean square difference along each axis.
fn rms_by_axis(a: &[Point], b: &[Point]) -> Point {
    std::array::from_fn(|c| {
        let square: f64 = a.iter().zip(b).map(|(p, q)| (p[c] - q[c]).powi(2)).sum();
        (square / a.len() as f64).sqrt()
    })
}

#[test]
fn noise_is_found_and_removed_along_each_axis() {
    let truth = track();
    for seed in 0..6 {
        for sigma in [
            [1.0; 3],
            [0.1; 3],
            [1.0, 1.0, 2.7],
            [0.2, 0.2, 0.6],
            [0.3, 1.5, 0.3],
            [0.5, 0.5, 0.0],
            [0.0, 0.0, 2.0],
        ] {
            let points = noisy(&truth, sigma, seed);
            let (after, info, curve) = smooth(&points);
            let (before, left) = (rms_by_axis(&points, &truth), rms_by_axis(&after, &truth));
            for axis in 0..3 {
                let found = curve.noise_by_axis[axis];
                if sigma[axis] == 0.0 {
                    assert!(found == 0.0 && left[axis] == 0.0, "{sigma:?}, axis {axis}: {found}");
                } else {
                    let ratio = found / sigma[axis];
                    assert!((0.75..1.33).contains(&ratio), "{sigma:?}, axis {axis}: {ratio}");
                    assert!(
                        left[axis] < 0.5 * before[axis],
                        "{sigma:?}, axis {axis}: {left:?} of {before:?}"
                    );
                }
                let furthest =
                    points.iter().zip(&after).map(|(p, q)| (p[axis] - q[axis]).abs()).fold(0.0, f64::max);
                assert!(furthest <= 3.0 * found * (1.0 + 1e-9), "{sigma:?}, axis {axis}: {furthest}");
            }
            let noisy: Vec<f64> = curve.noise_by_axis.into_iter().filter(|s| *s > 0.0).collect();
            let mean = (noisy.iter().map(|s| s * s).sum::<f64>() / noisy.len() as f64).sqrt();
            assert!((info.noise / mean - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn axes_can_be_exchanged() {
    let truth = track();
    for sigma in [[0.4; 3], [1.0, 1.0, 2.7], [0.5, 0.5, 0.0], [0.1, 0.4, 1.6]] {
        let points = noisy(&truth, sigma, 4);
        let (after, _, curve) = smooth(&points);
        for order in [[1, 2, 0], [1, 0, 2]] {
            let exchange = |p: &Point| order.map(|a| p[a]);
            let (other, _, other_curve) = smooth(&points.iter().map(exchange).collect::<Vec<_>>());
            let expected: Vec<Point> = after.iter().map(exchange).collect();
            assert!(rms(&other, &expected) < 1e-9, "{sigma:?}: {}", rms(&other, &expected));
            let noise = exchange(&curve.noise_by_axis);
            assert!((0..3).all(|a| (other_curve.noise_by_axis[a] - noise[a]).abs() < 1e-9), "{sigma:?}");
        }
    }
}

#[test]
fn noise_in_edges_is_relative_to_the_way_and_not_to_the_path_of_the_noise() {
    let truth = track();
    let way: f64 = truth.windows(2).map(|w| rms(&w[..1], &w[1..])).sum();
    for sigma in [0.1, 0.5, 1.0, 3.0] {
        let (_, info, curve) = smooth(&noisy(&truth, [sigma; 3], 2));
        let [before, after] = curve.length;
        assert!((after / way - 1.0).abs() < 0.12, "{sigma}: {after} of {way}");
        assert!(before > (1.0 + 0.5 * sigma.min(1.0).powi(2)) * way, "{sigma}: {before} of {way}");
        let expected = sigma * (N - 1) as f64 / way;
        assert!((0.75..1.33).contains(&(info.noise_in_edges / expected)), "{sigma}: {}", info.noise_in_edges);
    }
}

#[test]
fn rounded_heights_are_not_taken_for_exact_ones() {
    for sigma in [0.0, 0.5] {
        let truth = track();
        let mut points = noisy(&truth, [sigma, sigma, 0.0], 3);
        for p in &mut points {
            p[2] = p[2].round();
        }
        let (after, _, curve) = smooth(&points);
        assert_eq!(curve.rounding, [0.0, 0.0, 1.0]);
        assert!(curve.noise_by_axis[2] >= 12.0_f64.sqrt().recip() * (1.0 - 1e-9), "{curve:?}");
        let (before, left) = (rms_by_axis(&points, &truth)[2], rms_by_axis(&after, &truth)[2]);
        assert!(left < 0.7 * before, "{sigma}: {left} of {before}");
    }
    // A path between the points of a lattice is exact.
    let corner = |k: usize| [k % 200, (k + 50) % 200].map(|k| k.clamp(50, 100) as f64);
    let lattice: Vec<Point> = (0..800).map(|k| [corner(k)[0], corner(k)[1], (k / 200) as f64]).collect();
    let (after, _, curve) = smooth(&lattice);
    assert_eq!((curve.noise_by_axis, after), ([0.0; 3], lattice));
}

#[test]
fn odd_curves_are_denoised_or_stay() {
    let line: Vec<Point> = (0..60).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    for n in [2, 3, 5, 60] {
        let (after, ..) = smooth(&line[..n]);
        assert_eq!(after, line[..n]);
    }
    let (after, info, _) = smooth(&[[1.0, 2.0, 3.0]; 9]);
    assert_eq!((after, info.noise), (vec![[1.0, 2.0, 3.0]; 9], 0.0));
    // One axis is constant: it stays so, whatever noise the others have.
    let flat: Vec<Point> = noisy(&track(), [0.5, 0.5, 0.0], 1).iter().map(|p| [p[0], p[1], 7.0]).collect();
    let (after, _, curve) = smooth(&flat);
    assert!(after.iter().all(|p| p[2] == 7.0) && curve.noise_by_axis[2] == 0.0);
    // A stop: many points at one place, each with its own noise.
    let mut truth = track();
    truth.splice(200..200, vec![truth[200]; 80]);
    let points = noisy(&truth, [0.5, 0.5, 1.3], 8);
    let (after, ..) = smooth(&points);
    assert!(rms(&after, &truth) < 0.5 * rms(&points, &truth));
}

/// Mean squared error along an axis of the best quadratic fit in windows of one size, which the truth chooses; away from
/// the ends.
fn best_quadratic(points: &[Point], truth: &[Point], axis: usize) -> f64 {
    let error = |reach: usize| {
        let offsets = || (0..=2 * reach).map(|k| k as f64 - reach as f64);
        let [n, square, fourth] = [0, 2, 4].map(|power| offsets().map(|u| u.powi(power)).sum::<f64>());
        let weights: Vec<f64> =
            offsets().map(|u| (fourth - square * u * u) / (n * fourth - square * square)).collect();
        let fit = |i: usize| -> f64 {
            weights.iter().zip(&points[i - reach..=i + reach]).map(|(w, p)| w * p[axis]).sum()
        };
        (INNER..N - INNER).map(|i| (fit(i) - truth[i][axis]).powi(2)).sum::<f64>() / (N - 2 * INNER) as f64
    };
    (2..=INNER).map(error).fold(f64::INFINITY, f64::min)
}

/// Number of vertices at either end that are left out of a comparison.
const INNER: usize = 60;

#[test]
fn errors_on_smooth_curves_are_near_those_of_the_best_quadratic_fit() {
    let truth = track();
    for sigma in [[0.05; 3], [0.5; 3], [2.0; 3], [0.3, 0.3, 0.8], [1.0, 1.0, 2.7]] {
        let (mut left, mut best) = (0.0, 0.0);
        for seed in 20..30 {
            let points = noisy(&truth, sigma, seed);
            let (after, ..) = smooth(&points);
            let inner = rms_by_axis(&after[INNER..N - INNER], &truth[INNER..N - INNER]);
            left += (0..3).map(|a| (inner[a] / sigma[a]).powi(2)).sum::<f64>();
            best += (0..3).map(|a| best_quadratic(&points, &truth, a) / sigma[a].powi(2)).sum::<f64>();
        }
        let ratio = (left / best).sqrt();
        println!("noise {sigma:?}: {ratio:.2} times the error of the best quadratic fit");
        assert!(ratio < 1.25, "{sigma:?}: {ratio}");
    }
}
