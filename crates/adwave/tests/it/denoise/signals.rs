//! Noise taken off signals: steps stay, smooth signals lose hardly anything against the best smoothing there is.

use adwave::bands::Schedule;
use adwave::denoise::{DenoiseError, DenoiseParams, NoiseModel, denoise_signal};
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, Shape};
use adwave::{Decomposer, Progress};

fn decomposer(n_vertices: usize) -> (Decomposer, Vec<[f64; 3]>) {
    let sample = Sample::from_name("creature", Some(n_vertices)).unwrap();
    let points = sample.points.clone();
    (Decomposer::new(&Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())), points)
}

/// Normal deviates without pattern, the same in every run: sums of twelve uniform ones (splitmix64).
fn noise(n: usize) -> Vec<f64> {
    noise_of(n, 5)
}

/// Noise for any seed.
pub(crate) fn noise_of(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
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
    let (decomposer, points) = decomposer(10_000);
    let size = decomposer.diagonal();
    let step = |p: &[f64; 3]| f64::from((6.0 * p[1] / size).rem_euclid(1.0) < 0.5) * 2.0 - 1.0;
    let smooth = |p: &[f64; 3]| (8.0 * p[0] / size).sin() + (9.0 * p[1] / size).cos();
    for snr in [1.0, 3.0, 10.0] {
        for (name, signal, least_gain) in
            [("step", &step as &dyn Fn(&[f64; 3]) -> f64, 2.0), ("smooth", &smooth, -0.3)]
        {
            let truth: Vec<f64> = points.iter().map(signal).collect();
            let gain = |seed: u64| {
                let noise = noise_of(points.len(), seed);
                let noisy: Vec<f64> = truth.iter().zip(noise).map(|(f, e)| f + e / snr).collect();
                let error = square(&denoised(&decomposer, &noisy), &truth);
                10.0 * (best_single_scale(&decomposer, &noisy, &truth) / error).log10()
            };
            let gains = [5, 17, 29, 41].map(gain);
            println!("{name}, {snr}: {gains:?} dB");
            let mean = gains.iter().sum::<f64>() / 4.0;
            assert!(mean >= least_gain, "{name}, signal to noise {snr}: {gains:?} dB");
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
fn masked_vertices_constants_and_colors_with_an_alpha_stay_what_they_are() {
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

/// On a sphere, and on a flat torus, all of whose vertices are alike: the risk that is foretold, the error that is met, the best
/// that any one scaling function could do, and the variance of each band.
#[test]
fn white_noise_is_foretold_and_the_mixture_is_nearly_the_best() {
    let side = 128_u32;
    let at = |i: u32, j: u32| (j % side) * side + i % side;
    let edges: Vec<(u32, u32, f64)> = (0..side)
        .flat_map(|j| {
            (0..side).flat_map(move |i| {
                [(i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(k, l)| (at(i, j), at(k, l), 1.0))
            })
        })
        .collect();
    let torus = Decomposer::new(&Shape::Graph(Graph::new((side * side) as usize, &edges).unwrap()));
    let angle = |k: u32| f64::from(k) / f64::from(side) * std::f64::consts::TAU;
    let on_torus: Vec<f64> =
        (0..side * side).map(|v| (2.0 * angle(v % side)).sin() + (3.0 * angle(v / side)).cos()).collect();
    let sphere = Sample::from_name("sphere", Some(16_000)).unwrap();
    let on_sphere: Vec<f64> = sphere.points.iter().map(|p| 4.0 * p[0] * p[1] + p[2]).collect();
    let sphere = Decomposer::new(&Shape::Mesh(Mesh::new(sphere.points, sphere.faces).unwrap()));
    for (name, decomposer, truth) in [("torus", torus, on_torus), ("sphere", sphere, on_sphere)] {
        let noise = noise(truth.len());
        let noisy: Vec<f64> = truth.iter().zip(&noise).map(|(f, e)| f + 0.5 * e).collect();
        let result = denoise_signal(
            &decomposer,
            &noisy,
            1,
            &DenoiseParams::default().with_noise(0.5),
            Progress::none(),
        );
        let result = result.unwrap();
        let error = square(&result.values, &truth);
        let foretold = result.info[0].risk;
        assert!((foretold[0] / 0.25 - 1.0).abs() < 0.02, "{name}: {foretold:?}");
        assert!((foretold[1] - error).abs() < 0.02 * 0.25, "{name}: {foretold:?}, {error} met");
        // The variance of each band of pure noise, by what the row of Ψ_j at a vertex holds.
        let schedule = Schedule::dyadic(4).unwrap();
        let bands = decomposer.decompose(&noise, 1, &schedule).unwrap();
        let best = best_single_scale(&decomposer, &noisy, &truth);
        assert!(error < 1.03 * best, "{name}: {error}, {best} by the best scale");
        let every = truth.len() / 40;
        for j in 1..=4 {
            let of_band = Schedule::dyadic(j).unwrap();
            let gain = |x: usize| decomposer.basis_of_vertex(x, &of_band, Progress::none()).unwrap();
            let gains =
                (0..40).map(|k| gain(k * every).wavelet.iter().map(|w| w * w).sum::<f64>()).sum::<f64>()
                    / 40.0;
            let met = square(bands.wavelet(j), &vec![0.0; truth.len()]);
            assert!((met / gains - 1.0).abs() < 0.02, "{name}, level {j}: {gains} foretold, {met} met");
        }
    }
}

#[test]
fn the_noise_of_a_rough_field_is_not_overestimated() {
    let sample = Sample::from_name("sphere", Some(6000)).unwrap();
    let points = sample.points.clone();
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap()));
    // Waves down to five edges, of which the short ones are as large as the long ones.
    let phases = noise(4 * 60);
    let wave = |p: &[f64; 3], k: usize| {
        let [x, y, z, phase] = [0, 1, 2, 3].map(|c| phases[4 * k + c]);
        let length = (x * x + y * y + z * z).sqrt();
        let frequency = 4.0 * 6.0_f64.powf(k as f64 / 59.0);
        (frequency * (x * p[0] + y * p[1] + z * p[2]) / length + 9.0 * phase).sin()
    };
    let truth: Vec<f64> = points.iter().map(|p| (0..60).map(|k| wave(p, k)).sum()).collect();
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let deviation = (truth.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / truth.len() as f64).sqrt();
    for share in [0.1, 0.3, 1.0] {
        let added = share * deviation;
        let noisy: Vec<f64> =
            truth.iter().zip(noise_of(truth.len(), 11)).map(|(v, e)| v + added * e).collect();
        let found =
            denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap();
        let level = found.info[0].noise / added;
        println!("{share}: {level}");
        // One difference alone finds more than twice the noise at 0.1.
        assert!((0.9..1.25).contains(&level), "{share}: {level} times the noise");
        assert!(square(&found.values, &truth) < 0.9 * square(&noisy, &truth), "{share}");
    }
}

/// Counts with a mean of 3 to 40, from sums of exponential waiting times.
fn counts(means: &[f64], seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let mut count = |mean: f64| {
        let (mut time, mut n) = (-uniform().ln(), 0.0);
        while time < mean {
            n += 1.0;
            time -= uniform().ln();
        }
        n
    };
    means.iter().map(|m| count(*m)).collect()
}

#[test]
fn counts_and_relative_noise_are_smoothed_without_bias_where_their_model_is_given() {
    let (decomposer, points) = decomposer(20_000);
    let size = decomposer.diagonal();
    // Bright on one side, dim on the other, with a step.
    let truth: Vec<f64> = points
        .iter()
        .map(|p| if p[1] > 0.0 { 40.0 } else { 6.0 + 3.0 * (9.0 * p[0] / size).sin() })
        .collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let relative = |values: &[f64]| {
        let square = |(v, m): (&f64, &f64)| ((v - m) / m).powi(2);
        (values.iter().zip(&truth).map(square).sum::<f64>() / truth.len() as f64).sqrt()
    };
    let speckle: Vec<f64> =
        truth.iter().zip(noise(truth.len())).map(|(m, e)| m * (0.3 * e - 0.045).exp()).collect();
    for (model, noisy, deviation) in
        [(NoiseModel::Poisson, counts(&truth, 7), 1.0), (NoiseModel::Multiplicative, speckle, 0.3)]
    {
        let by = |model| {
            let params = DenoiseParams::default().with_noise_model(model);
            denoise_signal(&decomposer, &noisy, 1, &params, Progress::none()).unwrap()
        };
        let (found, plain) = (by(model), by(NoiseModel::Gaussian));
        let info = &found.info[0];
        println!(
            "{model}: noise {}, error {} of {}, gaussian {}, mean {} of {}",
            info.noise,
            relative(&found.values),
            relative(&noisy),
            relative(&plain.values),
            mean(&found.values),
            mean(&truth)
        );
        assert!((info.noise / deviation - 1.0).abs() < 0.05, "{model}: {info:?}");
        assert!((mean(&found.values) / mean(&noisy) - 1.0).abs() < 0.01, "{model}: {}", mean(&found.values));
        assert!(relative(&found.values) < 0.35 * relative(&noisy), "{model}: {}", relative(&found.values));
        assert!(relative(&found.values) < relative(&plain.values), "{model}");
        assert!(found.values.iter().all(|v| *v >= 0.0));
    }
}

#[test]
fn magnitudes_lose_the_bias_of_their_noise() {
    let (decomposer, points) = decomposer(20_000);
    let size = decomposer.diagonal();
    // A background of 0, a dim part, and a bright one with slopes.
    let truth: Vec<f64> = points
        .iter()
        .map(|p| match 10.0 * p[0] / size {
            y if y < -1.0 => 0.0,
            y if y < 1.0 => 4.0,
            _ => 20.0 + 4.0 * (9.0 * p[1] / size).sin(),
        })
        .collect();
    for deviation in [1.0, 2.5] {
        let parts = [5, 6].map(|seed| noise_of(truth.len(), seed));
        let noisy: Vec<f64> = (0..truth.len())
            .map(|v| (truth[v] + deviation * parts[0][v]).hypot(deviation * parts[1][v]))
            .collect();
        let by = |model| {
            let params = DenoiseParams::default().with_noise_model(model);
            denoise_signal(&decomposer, &noisy, 1, &params, Progress::none()).unwrap()
        };
        let (found, plain) = (by(NoiseModel::Rician), by(NoiseModel::Gaussian));
        let error = |values: &[f64]| square(values, &truth).sqrt();
        let bias = |values: &[f64]| {
            let background = (0..truth.len()).filter(|v| truth[*v] == 0.0);
            background.clone().map(|v| values[v]).sum::<f64>() / background.count() as f64 / deviation
        };
        let text = format!(
            "{deviation}: noise {}, error {} of {}, gaussian {}, background {} of {}",
            found.info[0].noise,
            error(&found.values),
            error(&noisy),
            error(&plain.values),
            bias(&found.values),
            bias(&noisy)
        );
        println!("{text}");
        assert!((found.info[0].noise / deviation - 1.0).abs() < 0.08, "{text}");
        assert!(error(&found.values) < 0.6 * error(&plain.values), "{text}");
        assert!(bias(&found.values) < 0.35 && bias(&plain.values) > 1.0, "{text}");
    }
}

#[test]
fn values_that_a_model_forbids_are_refused_unless_masked() {
    let (decomposer, points) = decomposer(3000);
    let mut values: Vec<f64> = counts(&vec![20.0; points.len()], 3);
    values[17] = -1.0;
    let by = |decomposer: &Decomposer, values: &[f64], model| {
        let params = DenoiseParams::default().with_noise_model(model);
        denoise_signal(decomposer, values, 1, &params, Progress::none())
    };
    let error = by(&decomposer, &values, NoiseModel::Poisson).unwrap_err();
    assert!(matches!(error, DenoiseError::ImpossibleValue { vertex: 17, .. }), "{error}");
    assert!(error.to_string().contains("vertex 17 has -1"), "{error}");
    let error = by(&decomposer, &values, NoiseModel::Rician).unwrap_err();
    assert!(error.to_string().contains("of at least 0"), "{error}");
    let is_masked: Vec<bool> = values.iter().map(|v| *v <= 0.0).collect();
    let masked = decomposer.masked(&is_masked).unwrap();
    for model in [NoiseModel::Poisson, NoiseModel::Multiplicative] {
        let found = by(&masked, &values, model).unwrap();
        assert_eq!(found.values[17], -1.0);
        let rest = || (0..values.len()).filter(|v| !is_masked[*v]);
        let off = |of: &[f64]| rest().map(|v| (of[v] - 20.0).powi(2)).sum::<f64>();
        assert!(off(&found.values) < 0.1 * off(&values), "{model}");
    }
    values[17] = 5.0;
    values[18] = 0.0;
    assert!(by(&decomposer, &values, NoiseModel::Poisson).is_ok());
    assert!(by(&decomposer, &values, NoiseModel::Rician).is_ok());
    let error = by(&decomposer, &values, NoiseModel::Multiplicative).unwrap_err();
    assert!(error.to_string().contains("above 0"), "{error}");
    let constant = vec![7.5; points.len()];
    for model in NoiseModel::ALL {
        assert_eq!(by(&decomposer, &constant, *model).unwrap().values, constant);
    }
}

#[test]
fn repeated_measurements_are_one_and_jumps_of_a_seam_stay() {
    // Every place of a cloud is measured three times.
    let n = 30;
    let places: Vec<[f64; 3]> = (0..n * n).map(|k| [f64::from(k % n), f64::from(k / n), 0.0]).collect();
    for n_times in [2, 3, 5] {
        let rows = places.repeat(n_times);
        let cloud = Decomposer::new(&Shape::Cloud(PointCloud::new(rows.clone()).unwrap()));
        let truth: Vec<f64> = rows.iter().map(|p| 7.0 + (0.1 * p[0]).sin()).collect();
        let noisy: Vec<f64> = truth.iter().zip(noise_of(rows.len(), 3)).map(|(f, e)| f + 5.0 * e).collect();
        let found = denoise_signal(&cloud, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap();
        let error = square(&found.values, &truth).sqrt();
        assert!(error < 0.7, "{n_times}: {error}");
        let info = &found.info[0];
        assert!((info.risk[0].sqrt() / 5.0 - 1.0).abs() < 0.1, "{n_times}: {:?}", info.risk);
        assert!((info.noise_of_rows / 5.0 - 1.0).abs() < 0.1 && info.jumps == 0, "{info:?}");
        assert_eq!(info.repeated, places.len());
        let (first, second) = found.values.split_at(places.len());
        assert_eq!(first, &second[..places.len()]);
    }
    // Two sheets meet at a line, and the field jumps there.
    let sheet = |x: i32| (0..400).map(move |k| [f64::from(x + k % 20), f64::from(k / 20), 0.0]);
    let points: Vec<[f64; 3]> = sheet(0).chain(sheet(19)).collect();
    let corner = |v: u32| [[v, v + 1, v + 21], [v, v + 21, v + 20]];
    let faces: Vec<[u32; 3]> =
        (0..800_u32).filter(|v| v % 20 < 19 && v % 400 < 380).flat_map(corner).collect();
    let mesh = Mesh::new(points, Polygons::from_triangles(&faces)).unwrap();
    let decomposer = Decomposer::new(&Shape::Mesh(mesh));
    let truth: Vec<f64> = (0..800).map(|v| if v < 400 { 10.0 } else { 20.0 }).collect();
    let noisy: Vec<f64> = truth.iter().zip(noise_of(800, 8)).map(|(f, e)| f + 0.5 * e).collect();
    let found = denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap();
    assert_eq!((found.info[0].jumps, found.info[0].repeated), (20, 0));
    for v in (0..400).filter(|v| v % 20 == 19) {
        let jump = found.values[v - 19 + 400] - found.values[v];
        assert!((jump - 10.0).abs() < 3.0, "{v}: {jump}");
    }
}
