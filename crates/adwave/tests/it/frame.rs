//! Bounds of the bands as a frame, and shares of variance.

use adwave::bands::Schedule;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, Shape};
use adwave::{Decomposer, Progress};

/// Lower frame bounds of dyadic levels, of docs/THEORY.md.
const LOWER: [(usize, f64); 6] = [(1, 0.5), (2, 0.3471), (4, 0.2051), (6, 0.1747), (8, 0.1705), (12, 0.1699)];

/// Share of ‖f‖² that the bands of an eigenvector of Φ₁ have together: Σ (λ^n_(j−1) − λ^n_j)² + λ^(2n_J).
fn gain(eigenvalue: f64, schedule: &Schedule) -> f64 {
    let steps = schedule.steps_from_zero();
    let power = |n: f64| eigenvalue.powf(n);
    let bands: f64 = steps.windows(2).map(|n| (power(n[0]) - power(n[1])).powi(2)).sum();
    bands + power(2.0 * steps[steps.len() - 1])
}

#[test]
fn the_lower_frame_bound_is_that_of_the_page() {
    for (n_levels, expected) in LOWER {
        let schedule = Schedule::dyadic(n_levels).unwrap();
        let gains = || (0..=200_000).map(|k| gain(f64::from(k) / 200_000.0, &schedule));
        let lower = gains().fold(f64::INFINITY, f64::min);
        assert!((lower - expected).abs() < 5e-5, "{n_levels} levels: {lower}");
        assert!((gains().fold(0.0, f64::max) - 1.0).abs() < 1e-12, "the upper bound is 1");
    }
}

/// Energy Σ_j ‖W_f(j)‖² + ‖S_f(J)‖² in the norm of the stationary distribution, divided by ‖f‖².
fn energy(decomposer: &Decomposer, signal: &[f64], schedule: &Schedule) -> f64 {
    let bands = decomposer.decompose(signal, 1, schedule).unwrap();
    let weights = decomposer.stationary();
    let square = |f: &[f64]| -> f64 { weights.iter().zip(f).map(|(m, x)| m * x * x).sum() };
    bands.as_slice().chunks_exact(signal.len()).map(square).sum::<f64>() / square(signal)
}

#[test]
fn waves_on_a_cycle_attain_the_bounds() {
    // Waves are eigenvectors of the walk on a cycle, with ½ + ½·cos of the angle of a step.
    let n = 360;
    let edges: Vec<_> = (0..n).map(|i| (i, (i + 1) % n, 1.0)).collect();
    let decomposer = Decomposer::new(&Shape::Graph(Graph::new(n as usize, &edges).unwrap()));
    for (n_levels, lower) in LOWER {
        let schedule = Schedule::dyadic(n_levels).unwrap();
        let mut least = f64::INFINITY;
        for wave in 0..=180 {
            let angle = std::f64::consts::TAU * f64::from(wave) / f64::from(n);
            let signal: Vec<f64> = (0..n).map(|x| (angle * f64::from(x)).cos()).collect();
            let found = energy(&decomposer, &signal, &schedule);
            let expected = gain(0.5 + 0.5 * angle.cos(), &schedule);
            assert!((found - expected).abs() < 1e-8, "{n_levels} levels, wave {wave}: {found} {expected}");
            least = least.min(found);
        }
        assert!(least >= lower - 5e-5 && least < lower + 0.02, "{n_levels} levels: {least}");
    }
}

#[test]
fn energies_lie_between_the_bounds_and_shares_of_variance_sum_to_one() {
    let sample = Sample::from_name("creature", Some(2000)).unwrap();
    let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
    let n = shape.n_vertices();
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        let params = OperatorParams::default().with_kind(kind);
        let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
        let weights = decomposer.stationary();
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        for seed in 0..6_u64 {
            let noise = |x: usize| ((x as u64 * 2_654_435_761 + seed * 97) % 1000) as f64 / 1000.0;
            let smooth = |x: usize| (0.01 * (seed + 1) as f64 * x as f64).sin();
            let signal: Vec<f64> = (0..n).map(|x| if seed % 2 == 0 { noise(x) } else { smooth(x) }).collect();
            let schedule = Schedule::dyadic(8).unwrap();
            let found = energy(&decomposer, &signal, &schedule);
            assert!((0.1705 - 1e-4..=1.0 + 1e-8).contains(&found), "{kind}: {found}");
            let bands = decomposer.decompose(&signal, 1, &schedule).unwrap();
            let shares = bands.shares(&weights).unwrap();
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{kind}");
            assert!(shares.iter().all(|share| *share > -1e-9), "{kind}: {shares:?}");
            // The definition: what the variance of S_j loses.
            let variance = |f: &[f64]| {
                let mean: f64 = weights.iter().zip(f).map(|(m, x)| m * x).sum();
                weights.iter().zip(f).map(|(m, x)| m * (x - mean).powi(2)).sum::<f64>()
            };
            for (j, share) in shares[..8].iter().enumerate() {
                let lost = variance(&bands.scaling(j)) - variance(&bands.scaling(j + 1));
                assert!((share - lost / variance(&signal)).abs() < 1e-9, "{kind}, band {}", j + 1);
            }
        }
        let constant = decomposer.decompose(&vec![2.0; n], 1, &Schedule::dyadic(3).unwrap()).unwrap();
        let shares = constant.shares(&weights).unwrap();
        assert!(shares.iter().all(|share| share.is_finite()));
        assert!(constant.shares(&weights[1..]).is_err());
    }
}
