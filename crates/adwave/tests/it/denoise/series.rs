//! Denoising of series in space and time: the noise found, the error against the best smoothing of one width in space and
//! one in time, chosen by the truth, and the error that is promised.

use adwave::bands::Schedule;
use adwave::denoise::{DenoiseError, DenoiseParams, NoiseModel, denoise_series};
use adwave::grid::Grid;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::time::TimeAxis;
use adwave::{Decomposer, Progress};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

const SIDE: usize = 24;
const FRAMES: usize = 60;

fn plane() -> Decomposer {
    let grid = Grid::new(&[SIDE, SIDE], &[1.0, 1.0]).unwrap();
    Decomposer::from_domain(grid.clone(), grid.heat()).unwrap()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64).sqrt()
}

fn normal(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| StandardNormal.sample(&mut random)).collect()
}

/// Series by name: value at a place (row, column) and a frame.
fn series(name: &str) -> Vec<f64> {
    let still = normal(SIDE * SIDE, 5);
    let value = |x: usize, t: f64| {
        let (r, c) = ((x / SIDE) as f64, (x % SIDE) as f64);
        let spot = |r0: f64, c0: f64, w: f64| (-((r - r0).powi(2) + (c - c0).powi(2)) / (2.0 * w * w)).exp();
        match name {
            "steady detail" => 3.0 * still[x],
            "slow wave" => (0.3 * c + 0.08 * t).cos(),
            "active spots" => 2.0 * still[x] + spot(8.0, 8.0, 3.0) * (0.5 * t).sin(),
            "moving spot" => spot(12.0, 4.0 + 0.25 * t, 2.5),
            "fast and smooth" => (0.05 * r).cos() * (1.9 * t).sin(),
            _ => 0.0,
        }
    };
    (0..SIDE * SIDE * FRAMES).map(|i| value(i / FRAMES, (i % FRAMES) as f64)).collect()
}

#[test]
fn a_series_loses_more_noise_than_by_any_widths_in_space_and_time() {
    let (plane, axis) = (plane(), TimeAxis::new(FRAMES, 1.0).unwrap());
    let names =
        ["steady detail", "slow wave", "active spots", "moving spot", "fast and smooth", "nothing but noise"];
    for (k, name) in names.into_iter().enumerate() {
        for sigma in [0.1, 0.5] {
            let truth = series(name);
            let noise = normal(truth.len(), 100 + k as u64);
            let noisy: Vec<f64> = truth.iter().zip(&noise).map(|(m, e)| m + sigma * e).collect();
            let found = denoise_series(&plane, &axis, &noisy, 1, &DenoiseParams::default(), Progress::none())
                .unwrap();
            let (error, info) = (rms(&found.values, &truth), &found.info);
            assert!((info.noise / sigma - 1.0).abs() < 0.1, "{name} {sigma}: {}", info.noise);
            let mut best = f64::INFINITY;
            for steps in [0.0, 1.0, 4.0, 16.0, 64.0] {
                let space = if steps == 0.0 {
                    noisy.clone()
                } else {
                    let schedule = Schedule::real(vec![steps]).unwrap();
                    plane.decompose(&noisy, FRAMES, &schedule).unwrap().coarsest().to_vec()
                };
                for width in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 1e3] {
                    let mut smooth = space.clone();
                    if width > 0.0 {
                        axis.smooth(&mut smooth, 1, width, Progress::none()).unwrap();
                    }
                    best = best.min(rms(&smooth, &truth));
                }
            }
            assert!(error <= 1.15 * best + 0.02 * sigma, "{name} {sigma}: {error} against {best}");
            // A few percent of the noise found are as many of the square that is promised.
            let (promised, square) = (info.risk[1], error * error);
            assert!(
                (promised - square).abs() < 0.5 * square + 0.1 * sigma * sigma,
                "{name} {sigma}: {info:?}"
            );
            assert!(info.weights.iter().all(|w| (w.iter().sum::<f64>() - 1.0).abs() < 1e-9));
        }
    }
}

#[test]
fn masked_places_keep_their_values_and_noise_of_other_kinds_is_refused() {
    let (plane, axis) = (plane(), TimeAxis::new(FRAMES, 1.0).unwrap());
    let mut noisy = normal(SIDE * SIDE * FRAMES, 3);
    noisy[7 * FRAMES..8 * FRAMES].fill(f64::NAN);
    let params = DenoiseParams::default();
    let error = denoise_series(&plane, &axis, &noisy, 1, &params, Progress::none()).unwrap_err();
    assert!(matches!(error, DenoiseError::NotFinite { vertex: 7, .. }));
    let masked: Vec<bool> = (0..SIDE * SIDE).map(|x| x == 7).collect();
    let plane = plane.masked(&masked).unwrap();
    let found = denoise_series(&plane, &axis, &noisy, 1, &params, Progress::none()).unwrap();
    assert!((0..noisy.len()).all(|i| found.values[i].is_nan() == (i / FRAMES == 7)));
    let counts = params.with_noise_model(NoiseModel::Poisson);
    let error = denoise_series(&plane, &axis, &noisy, 1, &counts, Progress::none()).unwrap_err();
    assert_eq!(error, DenoiseError::NotInTime { model: NoiseModel::Poisson });
    let wrong = denoise_series(&plane, &axis, &noisy[1..], 1, &params, Progress::none()).unwrap_err();
    assert!(matches!(wrong, DenoiseError::SignalLength { .. }));
}

#[test]
fn noise_alone_is_found_to_its_sampling_error() {
    let sample = Sample::from_name("sphere", Some(6000)).unwrap();
    let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
    let axis = TimeAxis::new(14, 1.0).unwrap();
    for (kind, seed) in [(OperatorKind::Walk, 1), (OperatorKind::Surface, 2), (OperatorKind::Walk, 3)] {
        let params = OperatorParams::default().with_kind(kind);
        let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
        let noise = normal(14 * decomposer.n_vertices(), seed);
        let found =
            denoise_series(&decomposer, &axis, &noise, 1, &DenoiseParams::default(), Progress::none());
        let found = found.unwrap().info.noise;
        // One frame is off by about 1.5 %, and the median of nine by 0.6 %.
        assert!((0.982..1.018).contains(&found), "{kind:?} {seed}: {found}");
    }
}
