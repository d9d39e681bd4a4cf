//! Presets section: the effect of each preset filter.

use super::Subject;
use super::drawing::{SignalPictures, Studio};
use crate::page::{Block, Figure, Section};
use crate::table::{NONE, Table, column, digits};
use adwave::filter::Preset;
use rayon::prelude::*;
use std::time::Instant;

/// Effect of a preset.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetSummary {
    /// Name of the preset.
    pub name: &'static str,
    /// Gains g_1 … g_J of the bands, fine to coarse.
    pub gains: Vec<f64>,
    /// Root mean square of the change at a vertex, in units of the signal.
    pub rms: f64,
    /// Largest change at a vertex, in units of the signal.
    pub max: f64,
    /// Vertex with the largest change; `None` if no vertex changes.
    pub vertex: Option<usize>,
    /// Ratio of the volume after the preset to the volume before, for a closed surface whose positions are the signal.
    pub volume_ratio: Option<f64>,
    /// Seconds spent on the computation.
    pub seconds: f64,
}

/// Result of a preset: its effect, and the signal after it.
struct PresetResult {
    summary: PresetSummary,
    values: Vec<f64>,
}

/// Makes the section; `volume` is that of the original shape, if it encloses one.
pub(super) fn section(
    subject: &Subject<'_>,
    studio: &mut Studio<'_>,
    volume: Option<f64>,
) -> (Section, Vec<PresetSummary>) {
    let mut section = Section::new("presets", "Presets");
    section.say(
        "Five filters, as `adwave filter --preset NAME` applies them: each band is multiplied by a gain, then the bands are added \
         up. A gain of 1 keeps a band, 0 removes it, more than 1 amplifies it. The rest S_J does not change.",
    );
    let edited: Vec<PresetResult> =
        Preset::ALL.iter().map(|&preset| apply_preset(subject, preset.name(), preset, volume)).collect();
    section.gallery(pictures(subject, studio, &edited));
    let summaries: Vec<PresetSummary> = edited.into_iter().map(|e| e.summary).collect();
    section.push(Block::Table(table(subject, &summaries)));
    (section, summaries)
}

/// Describes a preset, for any number of levels.
pub(crate) fn describe_preset(preset: &str) -> &'static str {
    match preset {
        "suppress" => "smooths and preserves limbs and volume: `1 − (1 − Φⁿ)²`",
        "suppress-paper" => "removes every band, as in the paper: smooth, but thin parts shrink",
        "enhance" => "amplifies every band, the fine ones most: crisp",
        "band1" => {
            "keeps the finest third of the bands and removes the others: fine texture on a smooth body"
        }
        _ => "removes the finest third of the bands and doubles the others: a caricature without texture",
    }
}

/// Computes `f + Σ_j (g_j − 1)·W_j`, which equals eq. 18 by the telescoping sum.
fn apply_preset(
    subject: &Subject<'_>,
    name: &'static str,
    preset: Preset,
    volume: Option<f64>,
) -> PresetResult {
    let (bands, n_channels) = (subject.bands, subject.bands.n_channels);
    let gains = preset.gains(bands.n_levels());
    let start = Instant::now();
    let mut values = subject.values.to_vec();
    for (gain, band) in gains.iter().zip(bands.wavelets()) {
        if *gain != 1.0 {
            let factor = gain - 1.0;
            values.par_iter_mut().zip(band).with_min_len(1 << 14).for_each(|(v, w)| *v += factor * w);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let change = |(after, before): (&[f64], &[f64])| -> f64 {
        after.iter().zip(before).map(|(a, b)| (a - b).powi(2)).sum()
    };
    let squares: Vec<f64> =
        values.chunks_exact(n_channels).zip(subject.values.chunks_exact(n_channels)).map(change).collect();
    let known = || squares.iter().enumerate().filter(|(_, s)| s.is_finite());
    let furthest = known().max_by(|a, b| a.1.total_cmp(b.1)).filter(|(_, square)| **square > 0.0);
    let mean = known().map(|(_, s)| s).sum::<f64>() / known().count().max(1) as f64;
    let summary = PresetSummary {
        name,
        gains,
        rms: mean.sqrt(),
        max: furthest.map_or(0.0, |(_, square)| square.sqrt()),
        vertex: furthest.map(|(vertex, _)| vertex),
        volume_ratio: volume_ratio(subject, &values, volume),
        seconds,
    };
    PresetResult { summary, values }
}

fn volume_ratio(subject: &Subject<'_>, values: &[f64], volume: Option<f64>) -> Option<f64> {
    if !(subject.is_geometry() && subject.shape.is_mesh()) {
        return None;
    }
    let before = volume.filter(|v| *v != 0.0)?;
    let geometry = subject.decomposer.geometry()?;
    let points = geometry.vertex_map().positions(values.as_chunks().0);
    Some(geometry.volume_of(&points) / before)
}

fn pictures(
    subject: &Subject<'_>,
    studio: &mut Studio<'_>,
    edited: &[PresetResult],
) -> Result<Vec<Figure>, String> {
    let signal = SignalPictures::new(subject);
    let mut specs = vec![signal.picture(
        subject.values,
        format!("The original, {}", subject.name),
        "The original.".to_owned(),
    )];
    for PresetResult { summary, values } in edited {
        let name = summary.name;
        let effect = match (name, subject.grid) {
            ("suppress", Some(_)) => "smooths: `1 − (1 − Φⁿ)²`",
            ("suppress-paper", Some(_)) => "removes every band: the rest S_J alone",
            _ => describe_preset(name),
        };
        specs.push(signal.picture(
            values,
            format!("{} after {name}", subject.name),
            format!("`{name}` {effect}. {}.", describe_change(subject, summary)),
        ));
    }
    studio.draw(&specs)
}

/// Describes the change by a preset, in a sentence.
fn describe_change(subject: &Subject<'_>, summary: &PresetSummary) -> String {
    let percent = subject.percent(summary.rms);
    if !subject.is_geometry() {
        format!("The signal changes by {} (rms)", digits(summary.rms))
    } else if percent.is_finite() {
        format!("Vertices move by {percent:.2} % of the diagonal (rms)")
    } else {
        format!("Vertices move by {} model units (rms)", digits(summary.rms))
    }
}

fn table(subject: &Subject<'_>, summaries: &[PresetSummary]) -> Table {
    let unit = subject.unit();
    let what = if subject.is_geometry() { "moved" } else { "changed" };
    let mut table = Table::new(
        "presets.csv",
        &format!(
            "Change by each preset, with equal weights for all {}{}.",
            subject.vertices(),
            if summaries.iter().any(|s| s.volume_ratio.is_some()) {
                ", and the remaining volume"
            } else {
                ""
            }
        ),
        &[
            "preset",
            "gains, fine to coarse",
            &format!("{what} (rms), {unit}"),
            &format!("{what} (largest), {unit}"),
            &format!("at {}", subject.vertex()),
            "volume, % of the original",
        ],
    );
    let numbers =
        |value: &dyn Fn(&PresetSummary) -> f64| column(&summaries.iter().map(value).collect::<Vec<_>>());
    let (rms, max) = (numbers(&|s| s.rms), numbers(&|s| s.max));
    for ((s, rms), max) in summaries.iter().zip(rms).zip(max) {
        let gains: Vec<String> = s.gains.iter().map(|g| format!("{}", (100.0 * g).round() / 100.0)).collect();
        table.push([
            s.name.to_owned(),
            gains.join(" "),
            rms,
            max,
            s.vertex.map_or_else(|| NONE.to_owned(), |v| subject.place(v)),
            s.volume_ratio.map_or_else(|| NONE.to_owned(), |r| format!("{:.2}", 100.0 * r)),
        ]);
    }
    table.drop_empty_columns()
}
