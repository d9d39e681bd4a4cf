//! Comparison with the saliency map of `lee2005`.

use super::shared::{norms, row};
use super::{CompareError, Comparison, ComparisonInput, Outcome};
use crate::lee::lee_saliency;
use adwave::Progress;
use adwave::bands::Bands;
use adwave::measure::{rank_correlation, shared_top};
use adwave::saliency::{SaliencyParams, saliency};
use std::time::Instant;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let ours = saliency(input.decomposer, &norms(input, bands), &SaliencyParams::paper(), progress)?.map;
    let mapped = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let theirs = lee_saliency(input.shape, progress)?;
    let their_seconds = start.elapsed().as_secs_f64();
    let narrowest = theirs.sigma[0];
    // Lee's σ is that of a Gaussian along an axis; ours is the root mean square distance in the plane, of two axes.
    let by_axis = |sigma: f64| sigma / std::f64::consts::SQRT_2;
    let rows = vec![
        row("prepare, s", input.prepare_seconds, None),
        row("map, s", seconds + mapped, their_seconds),
        row("narrowest width (by axis), model units", bands.sigma.get(3).copied().map(by_axis), narrowest),
        row(
            "widest width (by axis), model units",
            by_axis(bands.sigma[bands.n_levels()]),
            2.0 * theirs.sigma[4],
        ),
        row("rank correlation of the two", None, rank_correlation(&ours, &theirs.saliency)),
        row("shared part of the top 5 %", None, shared_top(&ours, &theirs.saliency, 0.05)),
    ];
    let outcome = |values| vec![Outcome { name: "saliency".to_owned(), n_channels: 1, values }];
    Ok(Comparison {
        task: "map what stands out".to_owned(),
        rows,
        adwave: outcome(ours),
        other: outcome(theirs.saliency),
    })
}
