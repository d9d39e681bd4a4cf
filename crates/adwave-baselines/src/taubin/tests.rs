use super::*;
use crate::differential::Weights;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, Shape};

#[test]
fn the_cycle_shows_the_gains() {
    // On a cycle cosines are eigenfunctions: K cos(θi) = (1 − cos θ) cos(θi).
    let n = 60_u32;
    let edges: Vec<_> = (0..n).map(|i| (i, (i + 1) % n, 1.0)).collect();
    let cycle = Shape::Graph(Graph::new(n as usize, &edges).unwrap());
    let k = Differential::new(&cycle, Weights::Uniform).unwrap();
    let filter = WindowedSinc::new(0.3, 25).unwrap();
    for frequency in [0, 1, 5, 12, 30] {
        let theta = 2.0 * PI * f64::from(frequency) / f64::from(n);
        let f: Vec<f64> = (0..n).map(|i| (theta * f64::from(i)).cos()).collect();
        let eigenvalue = 1.0 - theta.cos();
        let expected = filter.gain(eigenvalue);
        for (out, f) in filter.apply(&k, &f, 1).unwrap().iter().zip(&f) {
            assert!((out - expected * f).abs() < 1e-12, "{frequency}");
        }
        let (lambda, mu) = (0.33, -0.34);
        let gain = ((1.0 - lambda * eigenvalue) * (1.0 - mu * eigenvalue)).powi(7);
        for (out, f) in lambda_mu(&k, &f, 1, LambdaMu { lambda, mu }, 7).unwrap().iter().zip(&f) {
            assert!((out - gain * f).abs() < 1e-12, "{frequency}");
        }
    }
}

#[test]
fn the_windowed_sinc_passes_and_stops() {
    for pass_band in [0.05, 0.3, 1.0] {
        let filter = WindowedSinc::new(pass_band, 60).unwrap();
        assert!((filter.gain(0.0) - 1.0).abs() < 1e-13);
        // VTK searches until the gain at that frequency is within 0.001 of 1.
        assert!((filter.gain(pass_band) - 0.9995).abs() < 1e-9, "{}", filter.gain(pass_band));
        assert!(filter.gain(2.0).abs() < 0.01);
    }
}

#[test]
fn half_the_gain_is_where_it_is_asked_for() {
    for frequency in [0.005, 0.0427, 0.3, 1.0, 1.9] {
        let degree = (8.0 / (1.0 - frequency / 2.0_f64).acos()).ceil().max(10.0) as usize;
        let filter = WindowedSinc::half_gain(frequency, degree).unwrap();
        assert!((filter.gain(frequency) - 0.5).abs() < 1e-9, "{frequency}: {}", filter.gain(frequency));
        assert!((filter.gain(0.0) - 1.0).abs() < 1e-13);
        let (LambdaMu { lambda, mu }, iterations) = lambda_mu_with_half_gain(frequency);
        assert!(lambda > 0.0 && mu < -lambda, "{frequency}: {mu}");
        let gain = ((1.0 - lambda * frequency) * (1.0 - mu * frequency)).abs().powf(iterations as f64);
        assert!((gain - 0.5).abs() < 1e-6, "{frequency}: {gain}");
    }
}

#[test]
fn constants_stay_to_the_last_bit_and_noise_falls() {
    let sample = Sample::from_name("sphere", Some(2000)).unwrap();
    let n = sample.points.len();
    let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
    let k = Differential::new(&shape, Weights::Uniform).unwrap();
    let filter = WindowedSinc::new(0.1, 20).unwrap();
    assert!(filter.apply(&k, &vec![0.3; n], 1).unwrap().iter().all(|&v| v == 0.3));
    let noise: Vec<f64> = (0..n).map(|i| ((i * 7919) % 101) as f64 / 101.0 - 0.5).collect();
    let square = |f: &[f64]| f.iter().map(|v| v * v).sum::<f64>();
    assert!(square(&filter.apply(&k, &noise, 1).unwrap()) < 0.1 * square(&noise));
}

#[test]
fn wrong_parameters_are_errors() {
    assert!(
        WindowedSinc::new(0.0, 5).is_err()
            && WindowedSinc::new(f64::NAN, 5).is_err()
            && WindowedSinc::new(0.1, 0).is_err()
    );
    let k = Differential::new(&Shape::Graph(Graph::new(1, &[]).unwrap()), Weights::Uniform).unwrap();
    assert!(lambda_mu(&k, &[1.0], 1, LambdaMu { lambda: 0.5, mu: -0.4 }, 1).is_err());
    assert_eq!(lambda_mu(&k, &[1.0], 1, LambdaMu { lambda: 0.5, mu: -0.6 }, 3).unwrap(), [1.0]);
}
