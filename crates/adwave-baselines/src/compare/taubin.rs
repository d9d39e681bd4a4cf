//! Smoothing by the windowed sinc of Taubin, with half the gain at the same frequency.

use super::parts::{row, smoothing};
use super::{CompareError, Comparison, Subject};
use crate::differential::Differential;
use crate::taubin::WindowedSinc;
use adwave::bands::Bands;
use std::time::Instant;

pub(super) fn compare(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
) -> Result<Comparison, CompareError> {
    let steps = bands.steps[bands.n_levels()];
    // (1 − k/2)^n = ½, which is inside (0, 2).
    let pass_band = (2.0 * (1.0 - (-1.0 / steps).exp2())).clamp(1e-6, 1.9);
    let degree = (8.0 / (1.0 - pass_band / 2.0).acos()).ceil().clamp(10.0, 2000.0) as usize;
    let start = Instant::now();
    let k = Differential::from_walk(subject.walk.diffusion(), subject.walk.geometry().vertex_map().clone());
    let filter = WindowedSinc::new(pass_band, degree)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let theirs = filter.apply(&k, subject.signal, subject.n_channels)?;
    let filtered = start.elapsed().as_secs_f64();
    let rows = vec![
        row("prepare, s", None, prepared),
        row("smooth, s", seconds, filtered),
        row("products with the operator", bands.info.products as f64, degree as f64),
        row("gain at half the pass band", (1.0 - pass_band / 4.0).powf(steps), filter.gain(pass_band / 2.0)),
        row(
            "gain at twice the pass band",
            (1.0 - pass_band.min(1.0)).powf(steps),
            filter.gain((2.0 * pass_band).min(2.0)),
        ),
    ];
    let task = format!("smooth with half the gain at the frequency {pass_band:.4} of the operator");
    Ok(smoothing(subject, task, bands.coarsest(), theirs, rows))
}
