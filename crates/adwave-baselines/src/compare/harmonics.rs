//! Smoothing by manifold harmonics, with the gain of the same heat.

use super::parts::{row, smoothing};
use super::{CompareError, Comparison, Subject};
use crate::harmonics::{Harmonics, Remainder};
use crate::laplacian::{Laplacian, LaplacianParams};
use crate::linalg::EigenParams;
use adwave::Progress;
use adwave::bands::Bands;
use std::time::Instant;

pub(super) fn compare(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let laplacian = Laplacian::new(subject.shape, &LaplacianParams::default())?;
    let harmonics = Harmonics::new(&laplacian, subject.n_harmonics, &EigenParams::default(), progress)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let sigma = bands.sigma[bands.n_levels()];
    // The mean square distance after the time t is 4t in a plane.
    let gain = |frequency: f64| (-(frequency * sigma).powi(2) / 4.0).exp();
    let theirs = harmonics.filter(subject.signal, subject.n_channels, gain, Remainder::Drop)?;
    let filtered = start.elapsed().as_secs_f64();
    let last = harmonics.values.last().copied().unwrap_or(0.0).max(0.0).sqrt();
    let rows = vec![
        row("prepare, s", None, prepared),
        row("smooth, s", seconds, filtered),
        row("harmonics", None, harmonics.len() as f64),
        row("gain dropped above the last harmonic", None, gain(last)),
    ];
    let task = format!("smooth by the heat of width {sigma:.4} (model units)");
    Ok(smoothing(subject, task, bands.coarsest(), theirs, rows))
}
