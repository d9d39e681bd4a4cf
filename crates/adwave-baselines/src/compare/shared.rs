//! Functions shared by several comparisons.

use super::{Comparison, ComparisonInput, Outcome, Row};
use adwave::bands::{Bands, Wavelets};
use adwave::measure::rms;
use std::time::Instant;

pub(super) fn row(quantity: &str, adwave: impl Into<Option<f64>>, other: impl Into<Option<f64>>) -> Row {
    Row { quantity: quantity.to_owned(), level: None, adwave: adwave.into(), other: other.into() }
}

/// Largest absolute difference of two signals over all vertices and channels.
pub(super) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest Euclidean norm of the difference of two signals at a vertex, over its channels.
pub(super) fn largest_distance(a: &[f64], b: &[f64], n_channels: usize) -> f64 {
    let rows = a.chunks_exact(n_channels).zip(b.chunks_exact(n_channels));
    let squares = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>());
    squares.fold(0.0, f64::max).sqrt()
}

/// Compares both smoothed signals with the original and with each other.
pub(super) fn smoothing(
    input: &ComparisonInput<'_>,
    task: String,
    ours: &[f64],
    theirs: Vec<f64>,
    mut rows: Vec<Row>,
) -> Comparison {
    let (f, d) = (input.signal, input.n_channels);
    rows.push(row("rms change of the signal", rms(f, ours, d), rms(f, &theirs, d)));
    rows.push(row(
        "largest change of the signal at a vertex",
        largest_distance(f, ours, d),
        largest_distance(f, &theirs, d),
    ));
    rows.push(row("rms difference of the two", None, rms(ours, &theirs, d)));
    let outcome = |values: Vec<f64>| vec![Outcome { name: "smoothed".to_owned(), n_channels: d, values }];
    Comparison { task, rows, adwave: outcome(ours.to_vec()), other: outcome(theirs) }
}

/// Reconstructs `S_f(J) + Σ W_f(j)`, and also returns the seconds that this takes.
pub(super) fn reconstruct(bands: &Bands) -> (Vec<f64>, f64) {
    let start = Instant::now();
    let sum = bands.reconstruct();
    (sum, start.elapsed().as_secs_f64())
}

/// Norms of the wavelets, in the form that saliency and features need.
pub(super) fn norms(input: &ComparisonInput<'_>, bands: &Bands) -> Wavelets {
    bands.to_wavelets(input.decomposer.vertex_map()).into_norms()
}

/// Extracts channel `c` of a signal.
pub(super) fn channel(f: &[f64], n_channels: usize, c: usize) -> Vec<f64> {
    f.iter().skip(c).step_by(n_channels).copied().collect()
}

/// Interleaves channels to a signal, vertex by vertex.
pub(super) fn interleave(channels: &[Vec<f64>]) -> Vec<f64> {
    let n = channels.first().map_or(0, Vec::len);
    (0..n).flat_map(|x| channels.iter().map(move |c| c[x])).collect()
}

/// Converts the bands to results.
pub(super) fn wavelets(bands: &Bands) -> Vec<Outcome> {
    let outcome = |(k, values): (usize, &[f64])| Outcome {
        name: format!("W{}", k + 1),
        n_channels: bands.n_channels,
        values: values.to_vec(),
    };
    bands.wavelets().enumerate().map(outcome).collect()
}
