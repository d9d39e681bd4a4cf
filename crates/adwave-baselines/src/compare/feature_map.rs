//! Critical points of a signal smoothed by the heat equation, at the widths of the levels.

use super::shared::{norms, row};
use super::{CompareError, Comparison, ComparisonInput, Outcome};
use crate::feature_map::feature_map;
use adwave::Progress;
use adwave::bands::Bands;
use adwave::features::{FeatureParams, features};
use std::time::Instant;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    if input.n_channels != 1 {
        return Err(CompareError::Channels(input.n_channels));
    }
    let start = Instant::now();
    let ours = features(input.decomposer, &norms(input, bands), &FeatureParams::default(), progress)?;
    let found = start.elapsed().as_secs_f64();
    let times: Vec<f64> = bands.sigma[2..bands.n_levels()].iter().map(|s| s * s / 4.0).collect();
    let start = Instant::now();
    let theirs = feature_map(input.shape, input.signal, &times, progress)?;
    let their_seconds = start.elapsed().as_secs_f64();
    let n = input.shape.n_vertices();
    let (mut our_field, mut their_field) = (vec![0.0; n], vec![0.0; n]);
    let mut rows =
        vec![row("prepare, s", input.prepare_seconds, None), row("find, s", seconds + found, their_seconds)];
    for f in &ours {
        our_field[f.vertex] = f.level as f64;
    }
    for (k, level) in theirs.iter().enumerate() {
        let j = k + 2;
        for p in &level.points {
            their_field[p.vertex] = j as f64;
        }
        let count = ours.iter().filter(|f| f.level == j).count();
        rows.push(row(&format!("features at level {j}"), count as f64, level.points.len() as f64));
        rows.push(row(&format!("sum of indices at level {j}"), None, level.index_sum as f64));
    }
    let outcome = |values| vec![Outcome { name: "feature_level".to_owned(), n_channels: 1, values }];
    let task = "find features at the widths of the levels".to_owned();
    Ok(Comparison { task, rows, adwave: outcome(our_field), other: outcome(their_field) })
}
