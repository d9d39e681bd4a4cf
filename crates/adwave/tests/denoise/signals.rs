//! Noise taken off signals: steps stay, smooth signals lose hardly anything against the best smoothing there is.

use adwave::bands::Schedule;
use adwave::denoise::{DenoiseError, DenoiseParams, denoise_signal};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};

fn decomposer(n_vertices: usize) -> (Decomposer, Vec<[f64; 3]>) {
    let sample = Sample::by_name("creature", Some(n_vertices)).unwrap();
    let points = sample.points.clone();
    (Decomposer::new(&Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())), points)
}

/// Normal deviates without pattern, the same in every run: sums of twelve uniform ones (splitmix64).
fn noise(n: usize) -> Vec<f64> {
    let mut state = 5_u64;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..n).map(|_| (0..12).map(|_| uniform()).sum()).collect()
}

fn square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64
}

fn denoised(decomposer: &Decomposer, noisy: &[f64]) -> Vec<f64> {
    denoise_signal(decomposer, noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap().values
}

/// The least error of any number of steps of the walk.
fn best_single_scale(decomposer: &Decomposer, noisy: &[f64], truth: &[f64]) -> f64 {
    let steps: Vec<f64> = (0..34).map(|k| 2.0_f64.powf(f64::from(k) / 4.0 - 0.5)).collect();
    let bands = decomposer.decompose(noisy, 1, &Schedule::real(steps).unwrap()).unwrap();
    let mut now = noisy.to_vec();
    let mut least = square(&now, truth);
    for w in bands.wavelets() {
        now.iter_mut().zip(w).for_each(|(s, w)| *s -= w);
        least = least.min(square(&now, truth));
    }
    least
}

#[test]
fn signals_with_steps_gain_over_the_best_smoothing_and_smooth_ones_lose_hardly_anything() {
    let (decomposer, points) = decomposer(20_000);
    let size = decomposer.diagonal();
    let step = |p: &[f64; 3]| f64::from((6.0 * p[1] / size).rem_euclid(1.0) < 0.5) * 2.0 - 1.0;
    let smooth = |p: &[f64; 3]| (8.0 * p[0] / size).sin() + (9.0 * p[1] / size).cos();
    let noise = noise(points.len());
    for snr in [1.0, 3.0, 10.0] {
        for (name, signal, least_gain) in [
            ("step", &step as &dyn Fn(&[f64; 3]) -> f64, 2.0),
            ("smooth", &smooth, if snr > 1.0 { -0.3 } else { -0.5 }),
        ] {
            let truth: Vec<f64> = points.iter().map(signal).collect();
            let noisy: Vec<f64> = truth.iter().zip(&noise).map(|(f, e)| f + e / snr).collect();
            let error = square(&denoised(&decomposer, &noisy), &truth);
            let gain = 10.0 * (best_single_scale(&decomposer, &noisy, &truth) / error).log10();
            println!("{name}, {snr}: {gain} dB");
            assert!(gain >= least_gain, "{name}, signal to noise {snr}: {gain} dB");
        }
    }
}

#[test]
fn the_error_is_foretold() {
    let (decomposer, points) = decomposer(20_000);
    let truth: Vec<f64> = points.iter().map(|p| (5.0 * p[1] / decomposer.diagonal()).sin()).collect();
    let noisy: Vec<f64> = truth.iter().zip(noise(points.len())).map(|(f, e)| f + 0.3 * e).collect();
    let result = denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap();
    let info = &result.info[0];
    assert!((info.noise / 0.3 - 1.0).abs() < 0.03, "{info:?}");
    assert!((info.risk[0] / 0.09 - 1.0).abs() < 0.05, "{info:?}");
    let after = square(&result.values, &truth);
    assert!((info.risk[1] - after).abs() < 0.02 * 0.09, "{} for {after}", info.risk[1]);
}

#[test]
fn masked_vertices_constants_and_colours_with_an_alpha_stay_what_they_are() {
    let (decomposer, points) = decomposer(3000);
    let constant = vec![7.5; points.len()];
    assert_eq!(denoised(&decomposer, &constant), constant);
    let mut gaps: Vec<f64> = noise(points.len());
    gaps[17] = f64::NAN;
    let masked = decomposer.masked(&gaps.iter().map(|v| v.is_nan()).collect::<Vec<_>>()).unwrap();
    let result = denoised(&masked, &gaps);
    assert!(result[17].is_nan() && result.iter().filter(|v| v.is_nan()).count() == 1);
    let error =
        denoise_signal(&decomposer, &gaps, 1, &DenoiseParams::default(), Progress::none()).unwrap_err();
    assert!(matches!(error, DenoiseError::NotFinite { vertex: 17, .. }), "{error}");
    let error =
        denoise_signal(&decomposer, &gaps, 2, &DenoiseParams::default(), Progress::none()).unwrap_err();
    assert!(matches!(error, DenoiseError::SignalLength { .. }), "{error}");
    let rgba: Vec<f64> = noise(points.len()).iter().flat_map(|e| [*e, 2.0 * e, 0.5, 255.0]).collect();
    let result = denoise_signal(&decomposer, &rgba, 4, &DenoiseParams::default(), Progress::none()).unwrap();
    assert_eq!(result.info.iter().map(|i| i.channels.clone()).collect::<Vec<_>>(), [vec![0, 1, 2], vec![3]]);
    assert!(result.values.chunks_exact(4).all(|row| row[3] == 255.0));
}
