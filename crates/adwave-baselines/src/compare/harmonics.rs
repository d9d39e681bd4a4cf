//! Smoothing by manifold harmonics with the gain of heat, set to ½ at the frequency where adwave's gain is ½.

use super::shared::{row, smoothing};
use super::{CompareError, Comparison, ComparisonInput};
use crate::harmonics::{Harmonics, Remainder};
use crate::laplacian::{LaplacianMatrices, LaplacianParams};
use crate::linalg::EigenParams;
use adwave::Progress;
use adwave::bands::Bands;
use adwave::operator::Semigroup;
use std::time::Instant;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let laplacian = LaplacianMatrices::new(input.shape, &LaplacianParams::default())?;
    let harmonics = Harmonics::new(&laplacian, input.n_harmonics, &EigenParams::default(), progress)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let sigma = bands.sigma[bands.n_levels()];
    // In a plane the mean square distance after the time t is 4t, so a step of length s has the gain 1 − λs²/4 to first
    // order.
    let (steps, semigroup) = (bands.steps[bands.n_levels()], input.decomposer.operator().semigroup());
    let exponent = match semigroup {
        // (1 − λσ²/4n)^n = ½ at λσ²/4 = n(1 − 2^(−1/n))
        Semigroup::Steps | Semigroup::PlainSteps => {
            std::f64::consts::LN_2 / (steps * (1.0 - (-1.0 / steps).exp2()))
        }
        Semigroup::Heat { .. } => 1.0,
    };
    let gain = |frequency: f64| (-exponent * (frequency * sigma).powi(2) / 4.0).exp();
    let theirs = harmonics.filter(input.signal, input.n_channels, gain, Remainder::Drop)?;
    let filtered = start.elapsed().as_secs_f64();
    let last = harmonics.values.last().copied().unwrap_or(0.0).max(0.0).sqrt();
    let rows = vec![
        row("prepare, s", input.prepare_seconds, prepared),
        row("smooth, s", seconds, filtered),
        row("harmonics", None, harmonics.len() as f64),
        row("gain dropped above the last harmonic", None, gain(last)),
    ];
    let task =
        format!("smooth by the heat of width {sigma:.4} (model units), half the gain at the same frequency");
    Ok(smoothing(input, task, bands.coarsest(), theirs, rows))
}
