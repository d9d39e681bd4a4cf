//! What several comparisons share.

use super::{Comparison, Outcome, Row, Subject};
use adwave::bands::{Bands, Wavelets};
use adwave::measure::rms;
use std::time::Instant;

pub(super) fn row(quantity: &str, adwave: impl Into<Option<f64>>, other: impl Into<Option<f64>>) -> Row {
    Row { quantity: quantity.to_owned(), adwave: adwave.into(), other: other.into() }
}

/// The largest difference of two signals in any channel.
pub(super) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The largest Euclidean norm, over the channels of a vertex, of the difference of two signals; as `rms` takes it.
pub(super) fn largest_distance(a: &[f64], b: &[f64], n_channels: usize) -> f64 {
    let rows = a.chunks_exact(n_channels).zip(b.chunks_exact(n_channels));
    let squares = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>());
    squares.fold(0.0, f64::max).sqrt()
}

/// Both smoothed signals, against the signal and against each other.
pub(super) fn smoothing(
    subject: &Subject<'_>,
    task: String,
    ours: &[f64],
    theirs: Vec<f64>,
    mut rows: Vec<Row>,
) -> Comparison {
    let (f, d) = (subject.signal, subject.n_channels);
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

/// `S_f(J) + Σ W_f(j)`, and how long it takes.
pub(super) fn put_together(bands: &Bands) -> (Vec<f64>, f64) {
    let start = Instant::now();
    let sum = bands.reconstruct();
    (sum, start.elapsed().as_secs_f64())
}

/// The norms of the wavelets, for saliency and features.
pub(super) fn norms(subject: &Subject<'_>, bands: &Bands) -> Wavelets {
    bands.to_wavelets(subject.decomposer.geometry().vertex_map()).into_norms()
}

/// One channel of a signal.
pub(super) fn channel(f: &[f64], n_channels: usize, c: usize) -> Vec<f64> {
    f.iter().skip(c).step_by(n_channels).copied().collect()
}

/// Channels side by side.
pub(super) fn interleave(channels: &[Vec<f64>]) -> Vec<f64> {
    let n = channels.first().map_or(0, Vec::len);
    (0..n).flat_map(|x| channels.iter().map(move |c| c[x])).collect()
}

/// The bands as results.
pub(super) fn wavelets(bands: &Bands) -> Vec<Outcome> {
    let outcome = |(k, values): (usize, &[f64])| Outcome {
        name: format!("W{}", k + 1),
        n_channels: bands.n_channels,
        values: values.to_vec(),
    };
    bands.wavelets().enumerate().map(outcome).collect()
}
