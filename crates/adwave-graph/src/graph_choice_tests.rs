//! Tests of the choice on counts whose rates are known.

use super::*;
use crate::{ImputationInput, impute_by_channel_into};
use adwave::bands::Precision;
use rand_distr::{Distribution, Poisson};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// Rates and counts of cells on a closed curve, n × channels; every other channel is ten times as large.
fn ring(n: usize, n_channels: usize, depth: f64) -> (Vec<f64>, Vec<f64>) {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let mut rates = Vec::new();
    for x in 0..n {
        for g in 0..n_channels {
            let turns = 1.0 + (g % 2) as f64;
            let start = (mix(g as u64) % 1000) as f64 / 1000.0;
            let angle = std::f64::consts::TAU * (turns * x as f64 / n as f64 + start);
            let size = if g % 2 == 0 { 1.0 } else { 10.0 };
            rates.push(depth * size * (1.0 + 0.9 * angle.sin()));
        }
    }
    let counts = rates.iter().map(|&r| Poisson::new(r.max(1e-9)).unwrap().sample(&mut random)).collect();
    (rates, counts)
}

fn dense(values: &[f64], n_channels: usize) -> CountMatrix<'_> {
    CountMatrix { values: CountValues::Dense(values), n_channels }
}

fn choose(values: &[f64], n_channels: usize) -> Option<GraphChoice> {
    choose_graph(&dense(values, n_channels), GraphChoiceParams::default(), Progress::none()).unwrap()
}

/// Imputed values on a graph of all channels.
fn impute(values: &[f64], n_channels: usize, graph: ComparedGraph, steps: &[u32]) -> Vec<f64> {
    let counts = dense(values, n_channels);
    let powers = cell_walk(&counts, &graph, Progress::none()).unwrap();
    let channels: Vec<usize> = (0..n_channels).collect();
    let mut out = vec![0.0; values.len()];
    let (transformation, precision) = (Transformation::default(), Precision::Double);
    let input = ImputationInput { counts, transformation, channels: &channels, precision };
    impute_by_channel_into(&powers, input, steps, &mut out, Progress::none()).unwrap();
    out
}

/// Mean over the channels of the squared error relative to the variance of the rates.
fn mean_error(values: &[f64], rates: &[f64], n_channels: usize) -> f64 {
    let n = (rates.len() / n_channels) as f64;
    let of_channel = |g: usize| {
        let pairs = || values.iter().zip(rates).skip(g).step_by(n_channels);
        let mean = pairs().map(|(_, r)| r).sum::<f64>() / n;
        let error: f64 = pairs().map(|(v, r)| (v - r).powi(2)).sum();
        error / pairs().map(|(_, r)| (r - mean).powi(2)).sum::<f64>()
    };
    (0..n_channels).map(of_channel).sum::<f64>() / n_channels as f64
}

#[test]
fn the_choice_is_close_to_the_best_of_all_graphs_and_times() {
    let (n, n_channels) = (500, 60);
    for depth in [0.3, 2.0] {
        let (rates, counts) = ring(n, n_channels, depth);
        let choice = choose(&counts, n_channels).unwrap();
        let own = mean_error(&impute(&counts, n_channels, choice.best, &choice.steps), &rates, n_channels);
        let mut least = f64::INFINITY;
        for graph in &choice.compared {
            for steps in [1, 2, 3, 4, 6, 8, 12, 16] {
                let found = impute(&counts, n_channels, *graph, &vec![steps; n_channels]);
                let error = mean_error(&found, &rates, n_channels);
                least = least.min(error);
            }
        }
        assert!(own < 1.25 * least, "depth {depth}: {own} against {least}, {choice:?}");
        let before = ComparedGraph { n_components: 50, n_neighbors: 15, ..choice.compared[0] };
        let before =
            mean_error(&impute(&counts, n_channels, before, &vec![1; n_channels]), &rates, n_channels);
        assert!(own < 0.5 * before, "depth {depth}: {own} against {before}");
    }
}

#[test]
fn small_channels_take_more_steps_than_large_ones() {
    let (n, n_channels) = (600, 200);
    let (_, counts) = ring(n, n_channels, 0.5);
    let choice = choose(&counts, n_channels).unwrap();
    let mean = |odd: usize| {
        let steps = choice.steps.iter().skip(odd).step_by(2);
        steps.map(|&t| f64::from(t)).sum::<f64>() / (n_channels / 2) as f64
    };
    assert!(mean(0) > 1.3 * mean(1), "{} {}", mean(0), mean(1));
}

#[test]
fn the_order_of_cells_and_channels_does_not_matter() {
    let (n, n_channels) = (120, 40);
    let (_, counts) = ring(n, n_channels, 1.0);
    let choice = choose(&counts, n_channels).unwrap();
    let (cell, channel) = (|x: usize| (x * 7 + 3) % n, |g: usize| (g * 3 + 1) % n_channels);
    let moved: Vec<f64> = (0..n)
        .flat_map(|x| (0..n_channels).map(move |g| (x, g)))
        .map(|(x, g)| counts[cell(x) * n_channels + channel(g)])
        .collect();
    let again = choose(&moved, n_channels).unwrap();
    let steps: Vec<u32> = (0..n_channels).map(|g| choice.steps[channel(g)]).collect();
    assert_eq!(again, GraphChoice { steps, ..choice.clone() });
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in counts.chunks(n_channels) {
        for (c, &v) in row.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            columns.push(c as u32);
            values.push(v);
        }
        offsets.push(columns.len());
    }
    let rows = CompressedRows::new(offsets, columns, values, n_channels).unwrap();
    let sparse = CountMatrix { values: CountValues::Sparse(&rows), n_channels };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let found = threads.install(|| choose_graph(&sparse, GraphChoiceParams::default(), Progress::none()));
    assert_eq!(found.unwrap().unwrap(), choice);
}

#[test]
fn constant_channels_zeros_and_few_cells_make_no_trouble() {
    let (n, n_channels) = (120, 40);
    let (_, mut counts) = ring(n, n_channels, 1.0);
    for row in counts.chunks_mut(n_channels) {
        row[3] = 2.0;
        row[8] = 0.0;
    }
    let choice = choose(&counts, n_channels).unwrap();
    assert_eq!(choice.steps[3], choice.best.steps);
    assert_eq!(choice.steps[8], choice.best.steps);
    assert!(choice.best.loss.is_finite() && choice.compared.iter().all(|graph| graph.loss.is_finite()));
    assert_eq!(choose(&vec![0.0; n * n_channels], n_channels), None);
    assert_eq!(choose(&vec![4.0; n * n_channels], n_channels), None);
    assert_eq!(choose(&counts[..n_channels], n_channels), None);
    assert_eq!(choose(&[], n_channels), None);
    let same_cells: Vec<f64> = counts[..n_channels].iter().copied().cycle().take(n * n_channels).collect();
    assert_eq!(choose(&same_cells, n_channels), None);
    for bad in [f64::NAN, -1.0] {
        counts[5] = bad;
        let params = GraphChoiceParams::default();
        let error = choose_graph(&dense(&counts, n_channels), params, Progress::none()).unwrap_err();
        assert!(error.to_string().contains("value 5 of node 0"), "{error}");
    }
}
