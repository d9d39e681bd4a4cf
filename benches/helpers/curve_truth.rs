//! Denoising of random tracks whose truth is known, beside the best windows that the truth chooses, as tables:
//!
//!     curve_truth [first|second] [SEEDS]
//!
//! The first half of the seeds is for development, the second is looked at in the end.

use adwave::shape::{Graph, Shape};
use adwave_bench_helpers::truth::{AxisNoise, TrackShape};
use adwave_bench_helpers::{BenchOutcome, denoise_by_default, seed_parity};
use rayon::prelude::*;

/// Noise in spacings.
const NOISE: [f64; 5] = [0.05, 0.2, 0.5, 1.0, 3.0];

/// A denoised track.
struct TrackRow {
    /// Root mean square errors relative to the noise: before, after, and of the best windows.
    before: f64,
    after: f64,
    best: f64,
    /// Found / true for each axis with noise.
    found: Vec<f64>,
}

/// Denoised tracks of one kind and kind of noise: a list for each strength.
struct TrackGroup {
    axes: AxisNoise,
    shape: TrackShape,
    rows: Vec<Vec<TrackRow>>,
}

fn main() -> BenchOutcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let first = seed_parity(words.first().map_or("first", String::as_str))?;
    let n_seeds: u64 = words.get(1).map_or(Ok(6), |w| w.parse())?;
    let numbers = NOISE.map(|s| s.to_string()).join(" | ");
    println!("| noise of the axes | curve | adwave: {numbers} | best: {numbers} |");
    println!("| --- | --- |{}", " --: |".repeat(2 * NOISE.len()));
    let mut groups = Vec::new();
    for (axes_name, axes) in AxisNoise::ALL {
        for (name, shape) in TrackShape::ALL {
            let tracks = |&noise: &f64| {
                let row = |k: u64| row(shape, axes, noise, 2 * k + first);
                (0..n_seeds).into_par_iter().map(row).collect::<Result<Vec<TrackRow>, String>>()
            };
            let rows = NOISE.iter().map(tracks).collect::<Result<Vec<_>, _>>()?;
            let cells = |error: &dyn Fn(&TrackRow) -> f64| {
                let cell = |rows: &Vec<TrackRow>| format!("{:.2}", geometric_mean(rows.iter().map(error)));
                rows.iter().map(cell).collect::<Vec<_>>().join(" | ")
            };
            let (ours, best) = (cells(&|r| r.after), cells(&|r| r.best));
            println!("| {axes_name} | {name} | {ours} | {best} |");
            groups.push(TrackGroup { axes, shape, rows });
        }
    }
    print_summary(&groups);
    Ok(())
}

fn row(shape: TrackShape, axes: AxisNoise, noise: f64, seed: u64) -> Result<TrackRow, String> {
    let track = shape.track(axes, noise, seed);
    let edges: Vec<[u32; 2]> = (1..track.noisy.len() as u32).map(|x| [x - 1, x]).collect();
    let curve = Graph::curve(track.noisy.clone(), &edges).map_err(|e| e.to_string())?;
    let denoised = denoise_by_default(&Shape::Graph(curve)).map_err(|e| e.to_string())?;
    let info = denoised.info.curve.ok_or("a curve must have information about its noise, found none")?;
    let ratios = info.noise_by_axis.iter().zip(track.deviations).filter(|(_, truth)| *truth > 0.0);
    Ok(TrackRow {
        before: track.error(&track.noisy),
        after: track.error(&denoised.points),
        best: track.best_window_error(),
        found: ratios.map(|(found, truth)| found / truth).collect(),
    })
}

/// Table by kind of track: the errors relative to the best windows, the noise found, and tracks that became worse.
fn print_summary(groups: &[TrackGroup]) {
    println!(
        "\n| curve | error / best | range over noise | found / true, 1 % to 99 % | worse | worse, rounded |"
    );
    println!("| --- | --: | --: | --: | --: | --: |");
    for (name, shape) in TrackShape::ALL {
        print_tracks(name, groups, |group| group.shape == shape);
    }
    print_tracks("all but random spacing", groups, |group| group.shape != TrackShape::RandomSpacing);
}

fn print_tracks(name: &str, groups: &[TrackGroup], is_own: impl Fn(&TrackGroup) -> bool) {
    let own = || groups.iter().filter(|group| is_own(group));
    let ratios: Vec<f64> = own()
        .flat_map(|group| &group.rows)
        .map(|rows| geometric_mean(rows.iter().map(|r| r.after / r.best)))
        .collect();
    let [least, most] = ratios.iter().fold([f64::INFINITY, 0.0], |[a, b], r| [r.min(a), r.max(b)]);
    let mut found: Vec<f64> =
        own().flat_map(|group| group.rows.iter().flatten()).flat_map(|r| &r.found).copied().collect();
    found.sort_by(f64::total_cmp);
    let quantile = |share: f64| found[((found.len() - 1) as f64 * share).round() as usize];
    let worse = [false, true].map(|is_rounded| {
        let rows: Vec<&TrackRow> = own()
            .filter(|group| (group.axes == AxisNoise::RoundedHeights) == is_rounded)
            .flat_map(|group| group.rows.iter().flatten())
            .collect();
        format!("{} of {}", rows.iter().filter(|r| r.after > r.before).count(), rows.len())
    });
    println!(
        "| {name} | {:.2} | {least:.2} to {most:.2} | {:.2} to {:.2} | {} |",
        geometric_mean(ratios.iter().copied()),
        quantile(0.01),
        quantile(0.99),
        worse.join(" | ")
    );
}

fn geometric_mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    (values.map(f64::ln).sum::<f64>() / n).exp()
}
