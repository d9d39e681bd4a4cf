//! Bands of an image or a volume by sampled kernels: Gaussians of the same widths, or the starlet.

use super::shared::row;
use super::{CompareError, Comparison, ComparisonInput, Method, Outcome, Row};
use crate::grid_smoothing::{GridPlaces, SmoothedLevels, gaussian_levels, starlet_levels};
use adwave::bands::Bands;
use std::time::Instant;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    places: &GridPlaces<'_>,
    bands: &Bands,
    seconds: f64,
    method: Method,
) -> Result<Comparison, CompareError> {
    let n_levels = bands.n_levels();
    let start = Instant::now();
    let theirs = if method == Method::Starlet {
        starlet_levels(places, input.signal, input.n_channels, n_levels)
    } else {
        gaussian_levels(places, input.signal, input.n_channels, &bands.sigma[1..])
            .ok_or_else(|| CompareError::WideKernel { sigma: bands.sigma[n_levels] })?
    };
    let other_seconds = start.elapsed().as_secs_f64();
    let ours = (1..=n_levels).map(|j| bands.scaling(j).into_owned()).collect();
    let ours = SmoothedLevels { levels: ours, sigma: bands.sigma[1..].to_vec() };
    let [ours, theirs] = [ours, theirs].map(|smoothed| Levels { smoothed, input, places });
    let mut rows =
        vec![row("prepare, s", input.prepare_seconds, None), row("bands, s", seconds, other_seconds)];
    for level in 1..=n_levels {
        rows.extend(rows_of_level(&ours, &theirs, level));
    }
    let missing = if places.kept.is_some() {
        "; its values are divided by the smoothed mask where places have no data, and heat does not cross the mask"
    } else {
        ""
    };
    let task = match method {
        Method::Starlet => format!("bands and rest; starlet with the B3 spline, mirrored borders{missing}"),
        _ => format!(
            "bands and rest; Gaussians sampled up to 4 standard deviations, borders reflect, as gaussian_filter of SciPy{missing}"
        ),
    };
    Ok(Comparison { task, rows, adwave: ours.outcomes(), other: theirs.outcomes() })
}

/// Smoothed values of one method.
struct Levels<'a> {
    smoothed: SmoothedLevels,
    input: &'a ComparisonInput<'a>,
    places: &'a GridPlaces<'a>,
}

impl Levels<'_> {
    /// S_j; the signal for level 0.
    fn scaling(&self, level: usize) -> &[f64] {
        if level == 0 { self.input.signal } else { &self.smoothed.levels[level - 1] }
    }

    fn wavelet(&self, level: usize) -> Vec<f64> {
        self.scaling(level - 1).iter().zip(self.scaling(level)).map(|(a, b)| a - b).collect()
    }

    /// Values at places with data.
    fn values_with_data<'v>(&'v self, values: &'v [f64]) -> impl Iterator<Item = f64> + 'v {
        let rows = values.chunks_exact(self.input.n_channels).enumerate();
        let has_data = |x: usize| self.places.kept.is_none_or(|kept| kept[x]);
        rows.filter(move |(x, _)| has_data(*x)).flat_map(|(_, row)| row).copied().filter(|v| v.is_finite())
    }

    fn mean(&self, values: &[f64]) -> f64 {
        self.values_with_data(values).sum::<f64>() / self.values_with_data(values).count() as f64
    }

    fn rms(&self, values: &[f64]) -> f64 {
        let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
        self.mean(&squares).sqrt()
    }

    /// Depth of the smallest value of S_j below the smallest value of the signal.
    fn undershoot(&self, level: usize) -> f64 {
        let smallest = |values| self.values_with_data(values).fold(f64::INFINITY, f64::min);
        (smallest(self.input.signal) - smallest(self.scaling(level))).max(0.0)
    }

    fn change_of_mean(&self, level: usize) -> f64 {
        self.mean(self.scaling(level)) - self.mean(self.input.signal)
    }

    /// The bands W_1 … W_J and the rest S_J.
    fn outcomes(&self) -> Vec<Outcome> {
        let n_levels = self.smoothed.levels.len();
        let outcome = |name: String, values| Outcome { name, n_channels: self.input.n_channels, values };
        let bands = (1..=n_levels).map(|level| outcome(format!("W{level}"), self.wavelet(level)));
        bands.chain([outcome(format!("S{n_levels}"), self.scaling(n_levels).to_vec())]).collect()
    }
}

fn rows_of_level(ours: &Levels<'_>, theirs: &Levels<'_>, level: usize) -> [Row; 5] {
    let (own, other) = (ours.wavelet(level), theirs.wavelet(level));
    let difference: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
    let relative = Some(ours.rms(&difference) / ours.rms(&own)).filter(|share| share.is_finite());
    let rows = [
        row("σ", ours.smoothed.sigma[level - 1], theirs.smoothed.sigma[level - 1]),
        row("rms of W", ours.rms(&own), theirs.rms(&other)),
        row("W differs by", None, relative),
        row("S below data", ours.undershoot(level), theirs.undershoot(level)),
        row("mean of S off by", ours.change_of_mean(level), theirs.change_of_mean(level)),
    ];
    rows.map(|row| Row { level: Some(level), ..row })
}
