//! Bands about a local linear fit: slopes stay, whatever the samples.

use adwave::bands::Schedule;
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::filter::{Preset, WeightedLayer};
use adwave::local_fit::LocalFit;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::{Graph, PointCloud, Shape};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Sums of some hundred products, relative to the extent.
const EXACT: f64 = 1e-9;

/// Standard deviation of the noise.
const NOISE: f64 = 0.05;

/// The bar for a noisy slope, relative to the noise. A mean over as many points without a slope leaves 0.31.
const LEFT: f64 = 0.35;

const SIDE: f64 = 60.0;

struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        self.0.next_u64() as f64 / 2.0_f64.powi(64)
    }

    /// The sum of twelve uniform numbers has the variance of one normal number.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// Samples of a square, about 1.3 apart.
fn samplings() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let mut random = Random::new(4);
    let n = 2200;
    let uniform = (0..n).map(|_| [SIDE * random.next(), SIDE * random.next()]).collect();
    let denser = (0..n).map(|_| [SIDE * random.next().powi(2), SIDE * random.next()]).collect();
    let centers: Vec<[f64; 2]> = (0..25).map(|_| [SIDE * random.next(), SIDE * random.next()]).collect();
    let mut clustered: Vec<[f64; 2]> = (0..n / 2)
        .map(|i| {
            let c = centers[i % centers.len()];
            [c[0] + 2.0 * random.normal(), c[1] + 2.0 * random.normal()]
        })
        .filter(|p| p.iter().all(|c| (0.0..SIDE).contains(c)))
        .collect();
    clustered.extend((0..n / 2).map(|_| [SIDE * random.next(), SIDE * random.next()]));
    let lines = |jitter: f64, random: &mut Random| {
        let line = |k: i32| (0..90).map(move |i| (f64::from(i) * 0.66, f64::from(k) * 2.5));
        (0..24)
            .flat_map(line)
            .map(|(x, y)| [x + jitter * random.normal(), y + jitter * random.normal()])
            .collect()
    };
    let (straight, jittered) = (lines(0.0, &mut random), lines(0.05, &mut random));
    let hole = (0..n)
        .map(|_| [SIDE * random.next(), SIDE * random.next()])
        .filter(|p| (p[0] - 30.0).hypot(p[1] - 30.0) > 12.0)
        .collect();
    vec![
        ("uniform", uniform),
        ("denser to one side", denser),
        ("clustered", clustered),
        ("scan lines", straight),
        ("jittered scan lines", jittered),
        ("with a hole", hole),
    ]
}

fn cloud(points: Vec<[f64; 3]>, kind: OperatorKind) -> Decomposer {
    let shape = Shape::Cloud(PointCloud::new(points).expect("points"));
    let params = OperatorParams::default().with_kind(kind);
    Decomposer::with_params(&shape, &params, Progress::none()).expect("nobody stops it")
}

/// A field after the preset `suppress` on as many levels.
fn smooth(decomposer: &Decomposer, field: &[f64], n_levels: usize, fit: LocalFit) -> Vec<f64> {
    let schedule = Schedule::dyadic(n_levels).expect("levels");
    let layer = WeightedLayer::everywhere(Preset::Suppress.gains(n_levels));
    let request = decomposer.request(field, 1, &schedule).local_fit(fit);
    request.filter_layers(&[layer]).expect("a filter")
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

fn furthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn planes_of_any_slope_stay_however_they_are_sampled() {
    for (name, samples) in samplings() {
        for slope in [0.0, 0.5, 3.0] {
            for offset in [0.0, 5e6] {
                let height = |p: &[f64; 2]| slope * (p[0] - 0.3 * p[1]);
                let points: Vec<[f64; 3]> =
                    samples.iter().map(|p| [p[0] + offset, p[1] + 0.1 * offset, height(p)]).collect();
                let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
                for kind in [OperatorKind::Walk, OperatorKind::Surface] {
                    let decomposer = cloud(points.clone(), kind);
                    for n_levels in [1, 4, 7] {
                        // Coordinates of 5e6 are rounded to 1e-9 themselves.
                        let exact = EXACT * SIDE + 1e-14 * offset * slope;
                        let off =
                            furthest(&smooth(&decomposer, &heights, n_levels, LocalFit::Linear), &heights);
                        assert!(off <= exact, "{name}, {kind}, slope {slope}, {n_levels} levels: {off:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_linear_field_over_a_tilted_plane_stays_and_its_mean_does_not() {
    for (name, samples) in samplings() {
        let points: Vec<[f64; 3]> = samples.iter().map(|p| [p[0], p[1], 0.4 * p[0] + p[1]]).collect();
        let field: Vec<f64> = points.iter().map(|p| 7.0 + 1e-3 * (p[0] - 2.0 * p[1] + 0.5 * p[2])).collect();
        let decomposer = cloud(points, OperatorKind::Walk);
        let off = furthest(&smooth(&decomposer, &field, 5, LocalFit::Linear), &field);
        assert!(off <= 1e-3 * EXACT * SIDE, "{name}: {off:e}");
        let of_mean = furthest(&smooth(&decomposer, &field, 5, LocalFit::Constant), &field);
        assert!(of_mean > 1e-4, "{name}: {of_mean:e}");
    }
}

#[test]
fn noise_on_a_slope_is_smoothed_as_on_a_level() {
    let (_, samples) = samplings().swap_remove(0);
    for slope in [0.0, 0.5, 1.0, 3.0] {
        let mut random = Random::new(9);
        let truth: Vec<f64> = samples.iter().map(|p| slope * p[0]).collect();
        let noisy: Vec<f64> = truth.iter().map(|z| z + NOISE * random.normal()).collect();
        let points = samples.iter().zip(&noisy).map(|(p, z)| [p[0], p[1], *z]).collect();
        let decomposer = cloud(points, OperatorKind::Walk);
        let left = rms(&smooth(&decomposer, &noisy, 4, LocalFit::Linear), &truth) / NOISE;
        assert!(left <= LEFT, "slope {slope}: {left}");
        let params = DenoiseParams::default();
        let denoised = denoise_signal(&decomposer, &noisy, 1, &params, Progress::none()).expect("denoised");
        let left = rms(&denoised.values, &truth) / NOISE;
        assert!(left <= LEFT, "slope {slope}: {left} after denoising");
        let noise = denoised.info[0].noise;
        assert!((noise / NOISE - 1.0).abs() < 0.1, "slope {slope}: noise {noise}");
    }
}

#[test]
fn a_plane_without_noise_has_no_noise() {
    for (name, samples) in samplings() {
        let points: Vec<[f64; 3]> = samples.iter().map(|p| [p[0], p[1], 0.5 * p[0] - p[1]]).collect();
        let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let decomposer = cloud(points, OperatorKind::Walk);
        let params = DenoiseParams::default();
        let denoised = denoise_signal(&decomposer, &heights, 1, &params, Progress::none()).expect("denoised");
        assert!(denoised.info[0].noise <= EXACT, "{name}: {}", denoised.info[0].noise);
        assert!(furthest(&denoised.values, &heights) <= EXACT * SIDE, "{name}");
    }
}

#[test]
fn a_field_without_slopes_is_denoised_as_about_its_mean() {
    let (_, samples) = samplings().swap_remove(0);
    let mut random = Random::new(11);
    let noisy: Vec<f64> = samples.iter().map(|_| 2.0 + NOISE * random.normal()).collect();
    let decomposer = cloud(samples.iter().map(|p| [p[0], p[1], 0.0]).collect(), OperatorKind::Walk);
    let error = |fit| {
        let params = DenoiseParams::default().with_local_fit(fit);
        let denoised = denoise_signal(&decomposer, &noisy, 1, &params, Progress::none()).expect("denoised");
        rms(&denoised.values, &vec![2.0; noisy.len()])
    };
    let [linear, constant] = [LocalFit::Linear, LocalFit::Constant].map(error);
    assert!(linear <= constant + 0.02 * NOISE, "{linear} and {constant}");
}

#[test]
fn a_cliff_is_not_harmed() {
    let (_, samples) = samplings().swap_remove(0);
    let cliff: Vec<f64> = samples.iter().map(|p| if p[0] > 30.0 { 5.0 } else { 0.0 }).collect();
    let decomposer = cloud(samples.iter().map(|p| [p[0], p[1], 0.0]).collect(), OperatorKind::Walk);
    let [linear, constant] =
        [LocalFit::Linear, LocalFit::Constant].map(|fit| rms(&smooth(&decomposer, &cliff, 4, fit), &cliff));
    assert!(linear <= 1.05 * constant, "{linear} and {constant}");
}

#[test]
fn bands_sum_to_the_field_and_gains_of_one_keep_its_bits() {
    let (_, samples) = samplings().swap_remove(2);
    let points: Vec<[f64; 3]> = samples.iter().map(|p| [p[0], p[1], (0.2 * p[0]).sin()]).collect();
    // Three channels: a height, a wave, and noise; and a vertex in ten is masked.
    let mut random = Random::new(2);
    let mut field: Vec<f64> =
        points.iter().flat_map(|p| [p[2], (0.3 * p[1]).cos(), random.normal()]).collect();
    let schedule = Schedule::dyadic(5).expect("levels");
    let whole = cloud(points, OperatorKind::Walk);
    let flags: Vec<bool> = (0..samples.len()).map(|x| x % 10 == 3).collect();
    for (x, _) in flags.iter().enumerate().filter(|(_, masked)| **masked) {
        field[3 * x..][..3].fill(f64::NAN);
    }
    let decomposer = whole.masked(&flags).expect("some are left");
    let request = decomposer.request(&field, 3, &schedule).local_fit(LocalFit::Linear);
    let bands = request.bands().expect("bands");
    for (sum, f) in bands.reconstruct().iter().zip(&field) {
        assert!(sum.is_nan() == f.is_nan() && (f.is_nan() || (sum - f).abs() <= 1e-13));
    }
    let ones = request.filter_layers(&[WeightedLayer::everywhere(vec![1.0; 5])]).expect("a filter");
    assert!(ones.iter().zip(&field).all(|(a, b)| a.to_bits() == b.to_bits()));
    // Channels are independent of each other, and the editor and `bands_into` agree with the bands.
    let mut buffer = vec![0.0; 6 * field.len()];
    request.bands_into(&mut buffer).expect("bands");
    let same = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
    };
    assert!(same(&buffer, bands.as_slice()));
    for c in 0..3 {
        let alone: Vec<f64> = field.iter().skip(c).step_by(3).copied().collect();
        let alone =
            decomposer.request(&alone, 1, &schedule).local_fit(LocalFit::Linear).bands().expect("bands");
        let together: Vec<f64> = bands.wavelet(3).iter().skip(c).step_by(3).copied().collect();
        assert!(same(alone.wavelet(3), &together), "channel {c}");
    }
}

#[test]
fn a_graph_without_positions_has_a_constant_fit() {
    let edges: Vec<_> = (0..99).map(|i| (i, i + 1, 1.0)).collect();
    let decomposer = Decomposer::new(&Shape::Graph(Graph::new(100, &edges).expect("a path")));
    let field: Vec<f64> = (0..100).map(f64::from).collect();
    let [linear, constant] =
        [LocalFit::Linear, LocalFit::Constant].map(|fit| smooth(&decomposer, &field, 4, fit));
    assert_eq!(linear, constant);
    assert_eq!(decomposer.applied_local_fit(LocalFit::Linear), LocalFit::Constant);
}
