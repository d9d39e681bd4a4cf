//! The bands: how wide, how strong, and what they look like.

use super::Subject;
use super::drawing::{FieldLook, Frame, Scale, Studio};
use crate::detail::detail_loss;
use crate::page::{Block, Figure, Image, Section};
use crate::table::{NONE, Table, column, digits};
use adwave_render::plot::{Axis, Chart, Mark, Series};

/// At how many levels the shape is shown.
const MAX_SHOWN: usize = 4;
/// Sides of a chart, pixels: its letters can still be read where a phone shows it at five sixths of that.
const CHART: (u32, u32) = (420, 300);

/// One level in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct BandSummary {
    /// j, from 1.
    pub level: usize,
    /// n_j.
    pub steps: f64,
    /// σ_j in model units; hops on a graph.
    pub sigma: f64,
    /// Root of the mean square of W_j by area, in units of the signal.
    pub rms: f64,
    /// Largest ‖W_j‖ of a vertex, in units of the signal.
    pub max: f64,
    /// The mean square of W_j by that of the signal about its mean; NaN for a constant signal.
    pub energy_share: f64,
    /// The mean square of W_j by the sum of those of all bands; NaN for a constant signal.
    pub detail_share: f64,
    /// What is lost where the bands 1 … j are dropped: the greatest ‖f − S_j‖ of a vertex, in units of the signal.
    pub greatest_loss: f64,
    /// Root of the mean square of ‖f − S_j‖ by area, in units of the signal.
    pub rms_loss: f64,
}

pub(crate) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> (Section, Vec<BandSummary>) {
    let mut section = Section::new("bands", "Bands");
    section.say(format!("There are {}.", subject.levels_reason));
    let spread = Spread::new(subject);
    let bands = summaries(subject, &spread);
    section.push(Block::Table(table(subject, &bands, &spread)));
    section.push(Block::Table(losses(subject, &bands)));
    if !spread.total.is_finite() || spread.total <= 0.0 {
        section.note(
            "The signal is the same everywhere: every band is 0, and there are no shares of its energy.",
        );
    }
    match chart(subject, &bands).and_then(|shares| Ok([shares, decay(subject)?])) {
        Ok(charts) => section.gallery(Ok(charts.into_iter().flatten().collect())),
        Err(why) => section.note(format!("No chart: {why}.")),
    }
    if studio.can_draw() {
        section.say(if subject.is_geometry() {
            "The shape smoothed: the positions S_j, all in one scale.".to_owned()
        } else {
            format!("The signal smoothed: S_j of {}, all with the same colors.", subject.scalar_name())
        });
        section.gallery(smoothed(subject, studio));
        section.say("What the bands hold: W_j on the shape as it is, each with colors of its own range.");
        section.gallery(magnitudes(subject, studio));
    }
    (section, bands)
}

/// The levels that are shown, spread evenly from the first to the last.
fn shown(n_levels: usize) -> Vec<usize> {
    let n = n_levels.min(MAX_SHOWN);
    (0..n).map(|k| 1 + (2 * k * (n_levels - 1) + n - 1) / (2 * (n - 1)).max(1)).collect()
}

/// Mean squares under the areas of the vertices, which are 0 where the signal has no value.
struct Spread {
    /// Of the signal about its mean.
    total: f64,
    /// Of the rest S_J about its mean.
    rest: f64,
    bands: Vec<f64>,
}

impl Spread {
    fn new(subject: &Subject<'_>) -> Self {
        let (bands, areas) = (subject.bands, subject.decomposer.areas());
        let about_mean = |signal: &[f64]| about_mean(signal, bands.n_channels, &areas);
        Self {
            total: about_mean(subject.values),
            rest: about_mean(bands.coarsest()),
            bands: bands.energy(&areas).expect("one area per vertex"),
        }
    }
}

/// `Σ μ(x)‖f(x) − f̄‖² / Σ μ(x)`; every vertex counts alike where no area is above 0.
fn about_mean(signal: &[f64], n_channels: usize, areas: &[f64]) -> f64 {
    let all_alike = areas.iter().sum::<f64>() <= 0.0;
    let weight = |x: usize| if all_alike { 1.0 } else { areas[x] };
    let rows = || signal.chunks_exact(n_channels).enumerate().filter(|&(x, _)| weight(x) > 0.0);
    let total: f64 = rows().map(|(x, _)| weight(x)).sum();
    let mut mean = vec![0.0; n_channels];
    for (x, row) in rows() {
        mean.iter_mut().zip(row).for_each(|(m, v)| *m += weight(x) / total * v);
    }
    rows()
        .map(|(x, row)| weight(x) / total * row.iter().zip(&mean).map(|(v, m)| (v - m).powi(2)).sum::<f64>())
        .sum()
}

/// The bands in numbers, fine to coarse. O(vertices × levels).
pub fn band_summaries(subject: &Subject<'_>) -> Vec<BandSummary> {
    summaries(subject, &Spread::new(subject))
}

fn summaries(subject: &Subject<'_>, spread: &Spread) -> Vec<BandSummary> {
    let bands = subject.bands;
    // Rounding alone leaves a constant signal a spread of about 1e-32 of its square.
    let size = subject.values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    let constant = spread.total <= (1e-13 * size).powi(2);
    let all: f64 = spread.bands.iter().sum();
    let share = |energy: f64, of: f64| if constant { f64::NAN } else { energy / of };
    let losses = detail_loss(bands, &subject.decomposer.areas());
    (1..=bands.n_levels())
        .map(|level| {
            let max = bands
                .wavelet(level)
                .chunks_exact(bands.n_channels)
                .map(|row| row.iter().map(|w| w * w).sum::<f64>())
                .filter(|square| square.is_finite())
                .fold(0.0, f64::max);
            let energy = spread.bands[level - 1];
            BandSummary {
                level,
                steps: bands.steps[level],
                sigma: bands.sigma[level],
                rms: energy.sqrt(),
                max: max.sqrt(),
                energy_share: share(energy, spread.total),
                detail_share: share(energy, all),
                greatest_loss: losses[level - 1].greatest,
                rms_loss: losses[level - 1].rms,
            }
        })
        .collect()
}

fn table(subject: &Subject<'_>, bands: &[BandSummary], spread: &Spread) -> Table {
    let (width, unit) = (subject.width_unit(), subject.unit());
    let mut table = Table::new(
        "bands.csv",
        "The bands, fine to coarse. The signal's energy is its mean square about its mean; that of a band is the mean square \
         of W_j. Neighboring bands overlap, so the shares of the signal's energy do not add up to 100 %.",
        &[
            "level j",
            "steps n_j",
            &format!("σ_j, {width}"),
            "σ_j, % of the diagonal",
            &format!("rms of W_j, {unit}"),
            &format!("largest |W_j|, {unit}"),
            "% of the signal's energy",
            "% of all bands' energy",
        ],
    );
    let numbers = |value: &dyn Fn(&BandSummary) -> f64| column(&bands.iter().map(value).collect::<Vec<_>>());
    let columns = [
        numbers(&|b| b.sigma),
        numbers(&|b| subject.percent(b.sigma)),
        numbers(&|b| b.rms),
        numbers(&|b| b.max),
        numbers(&|b| 100.0 * b.energy_share),
        numbers(&|b| 100.0 * b.detail_share),
    ];
    for (k, band) in bands.iter().enumerate() {
        let [sigma, percent, rms, max, energy, detail] = columns.each_ref().map(|cells| cells[k].clone());
        table.push([band.level.to_string(), count(band.steps), sigma, percent, rms, max, energy, detail]);
    }
    let constant = bands.iter().all(|b| b.energy_share.is_nan());
    let rest = if constant { NONE.to_owned() } else { digits(100.0 * spread.rest / spread.total) };
    let none = || NONE.to_owned();
    let name = format!("rest S_{}", bands.len());
    table.push([name, none(), none(), none(), digits(spread.rest.sqrt()), none(), rest, none()]);
    table.without_empty_columns()
}

/// What each level leaves out.
fn losses(subject: &Subject<'_>, bands: &[BandSummary]) -> Table {
    let (width, unit) = (subject.width_unit(), subject.unit());
    let mut table = Table::new(
        "detail.csv",
        "What is lost when everything finer than level j is dropped, which is what `adwave filter --gains` does with j zeros and \
         then ones: the distance of the signal f from S_j over the vertices, rms by area.",
        &[
            "bands dropped",
            &format!("σ_j, {width}"),
            &format!("greatest |f − S_j|, {unit}"),
            "greatest, % of the diagonal",
            &format!("rms |f − S_j|, {unit}"),
            "rms, % of the diagonal",
        ],
    );
    let numbers = |value: &dyn Fn(&BandSummary) -> f64| column(&bands.iter().map(value).collect::<Vec<_>>());
    // Of another signal than the shape a percentage of the diagonal means nothing.
    let percent = |loss: f64| if subject.is_geometry() { subject.percent(loss) } else { f64::NAN };
    let columns = [
        numbers(&|b| b.sigma),
        numbers(&|b| b.greatest_loss),
        numbers(&|b| percent(b.greatest_loss)),
        numbers(&|b| b.rms_loss),
        numbers(&|b| percent(b.rms_loss)),
    ];
    for (k, band) in bands.iter().enumerate() {
        let [sigma, greatest, greatest_percent, rms, rms_percent] =
            columns.each_ref().map(|cells| cells[k].clone());
        let dropped = if band.level == 1 { "1".to_owned() } else { format!("1 to {}", band.level) };
        table.push([dropped, sigma, greatest, greatest_percent, rms, rms_percent]);
    }
    table.without_empty_columns()
}

/// Energy by level; nothing without two levels that have some.
fn chart(subject: &Subject<'_>, bands: &[BandSummary]) -> Result<Option<Figure>, String> {
    let strong = bands.iter().filter(|b| b.detail_share > 0.0);
    let Some(most) = strong.clone().max_by(|a, b| a.detail_share.total_cmp(&b.detail_share)) else {
        return Ok(None);
    };
    if strong.count() < 2 {
        return Ok(None);
    }
    let caption = format!(
        "Where the details are: the share of each band in the energy of all bands. The strongest is band {}, of {}, with \
         {:.0} %.",
        most.level,
        width(subject, most.sigma),
        100.0 * most.detail_share,
    );
    let alt = bands
        .iter()
        .map(|b| format!("level {}: {:.1} %", b.level, 100.0 * b.detail_share))
        .collect::<Vec<_>>()
        .join(", ");
    let points = bands.iter().enumerate().map(|(k, b)| [k as f64, 100.0 * b.detail_share]);
    let chart = Chart {
        title: "Energy of the bands".to_owned(),
        x: Axis {
            label: "level, fine to coarse".to_owned(),
            names: bands.iter().map(|b| b.level.to_string()).collect(),
            ..Axis::default()
        },
        y: Axis { label: "share, %".to_owned(), ..Axis::default() },
        series: vec![Series { label: String::new(), mark: Mark::Bars, points: points.collect() }],
    };
    plotted(&chart, &format!("A bar for the energy of each band: {alt}."), caption).map(Some)
}

/// How much is left of a signal after each level; for the shape itself it is nearly all.
fn decay(subject: &Subject<'_>) -> Result<Option<Figure>, String> {
    let (bands, areas) = (subject.bands, subject.decomposer.areas());
    let rms = |signal: &[f64]| about_mean(signal, bands.n_channels, &areas).sqrt();
    let left: Vec<f64> = bands.all_scaling().chunks_exact(subject.values.len()).map(rms).collect();
    let (first, last) = (left[0], left[bands.n_levels()]);
    if subject.is_geometry() || !(first > 0.0 && left.iter().all(|v| v.is_finite())) {
        return Ok(None);
    }
    let caption = format!(
        "How {} evens out: the standard deviation of S_j, from S_0, the signal itself, to S_{}. Of {} at first, {} is left.",
        subject.signal,
        bands.n_levels(),
        digits(first),
        digits(last),
    );
    let chart = Chart {
        title: "What is left of the signal".to_owned(),
        x: Axis {
            label: "level, fine to coarse".to_owned(),
            names: (0..left.len()).map(|j| j.to_string()).collect(),
            ..Axis::default()
        },
        y: Axis { label: "standard deviation".to_owned(), ..Axis::default() },
        series: vec![Series {
            label: String::new(),
            mark: Mark::Stems,
            points: left.iter().enumerate().map(|(j, v)| [j as f64, *v]).collect(),
        }],
    };
    let alt =
        format!("The standard deviation of the smoothed signal by level: {}.", column(&left).join(", "));
    plotted(&chart, &alt, caption).map(Some)
}

/// A chart as a figure of the page.
fn plotted(chart: &Chart, alt: &str, caption: String) -> Result<Figure, String> {
    let svg = chart.svg(CHART.0, CHART.1).map_err(|e| e.to_string())?;
    Ok(Figure {
        image: Image::svg(svg, CHART.0, CHART.1),
        alt: alt.to_owned(),
        caption,
        legend: None,
        link: None,
    })
}

fn smoothed(subject: &Subject<'_>, studio: &mut Studio<'_>) -> Result<Vec<Figure>, String> {
    let bands = subject.bands;
    let scale = Scale::of(&subject.scalar(subject.values));
    let scaling = bands.all_scaling();
    let frames: Vec<Frame<'_>> = shown(bands.n_levels())
        .into_iter()
        .map(|j| {
            let caption =
                format!("S_{j}, after {}: {}.", steps(bands.steps[j]), width(subject, bands.sigma[j]));
            let frame = Frame::plain(format!("{} smoothed to level {j}", subject.signal), caption);
            if subject.is_geometry() {
                frame.at(scaling[(j * subject.values.len())..][..subject.values.len()].as_chunks().0)
            } else {
                let values = subject.scalar(&bands.scaling(j));
                frame.field(FieldLook::new(values, subject.scalar_name(), scale))
            }
        })
        .collect();
    studio.draw(&frames)
}

fn magnitudes(subject: &Subject<'_>, studio: &mut Studio<'_>) -> Result<Vec<Figure>, String> {
    let bands = subject.bands;
    let frames: Vec<Frame<'_>> = shown(bands.n_levels())
        .into_iter()
        .map(|j| {
            let values = subject.scalar(bands.wavelet(j));
            let signed = bands.n_channels == 1;
            let scale = if signed { Scale::of(&values) } else { Scale::from_zero(&values, 0.99) };
            let name = if signed { format!("W_{j}") } else { format!("|W_{j}|") };
            let caption = format!("{name}, of {}.", width(subject, bands.sigma[j]));
            Frame::plain(format!("Band {j} of {}", subject.signal), caption).field(FieldLook::new(
                values,
                if subject.is_geometry() { format!("{name}, model units") } else { name },
                scale,
            ))
        })
        .collect();
    studio.draw(&frames)
}

fn steps(n: f64) -> String {
    if n == 1.0 { "1 step".to_owned() } else { format!("{} steps", count(n)) }
}

/// A whole number of steps as it is, others with four digits.
fn count(n: f64) -> String {
    if n.fract() == 0.0 { n.to_string() } else { digits(n) }
}

/// `width σ = 0.05 model units, 2 % of the diagonal`.
fn width(subject: &Subject<'_>, sigma: f64) -> String {
    let percent = subject.percent(sigma);
    let of_diagonal =
        if percent.is_finite() { format!(", {percent:.2} % of the diagonal") } else { String::new() };
    format!("width σ = {} {}{of_diagonal}", digits(sigma), subject.width_unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_that_are_shown_are_spread_from_the_first_to_the_last() {
        assert_eq!(shown(1), [1]);
        assert_eq!(shown(3), [1, 2, 3]);
        assert_eq!(shown(8), [1, 3, 6, 8]);
        assert_eq!(shown(6), [1, 3, 4, 6]);
    }

    #[test]
    fn mean_squares_are_those_known_by_hand() {
        // Values 0 and 4 with weights 3 and 1: the mean is 1, and (3·1 + 1·9)/4 = 3.
        assert_eq!(about_mean(&[0.0, 4.0], 1, &[3.0, 1.0]), 3.0);
        assert_eq!(about_mean(&[0.0, 4.0, f64::NAN], 1, &[3.0, 1.0, 0.0]), 3.0);
        assert_eq!(about_mean(&[0.0, 0.0, 4.0, 2.0], 2, &[0.0, 0.0]), 5.0);
    }
}
