//! Bands section: widths, energies and pictures of the bands.

use super::Subject;
use super::drawing::{FieldLook, PictureSpec, Scale, SignalPictures, Studio};
use crate::detail::detail_loss;
use crate::page::{Block, Figure, Image, Section};
use crate::table::{NONE, Table, column, digits};
use adwave::bands::FWHM;
use adwave_render::plot::{Chart, ChartAxis, Mark, Series};

/// Largest number of levels that are drawn.
const MAX_DRAWN: usize = 4;
/// Size of a chart in pixels. Its text is still legible if a narrow screen scales it to five sixths.
const CHART: (u32, u32) = (420, 300);

/// Statistics of a band.
#[derive(Clone, Debug, PartialEq)]
pub struct BandSummary {
    /// Level j, from 1.
    pub level: usize,
    /// Number of steps n_j.
    pub steps: f64,
    /// Width σ_j in model units, or in hops on a graph.
    pub sigma: f64,
    /// Root mean square of W_j, weighted by area, in units of the signal.
    pub rms: f64,
    /// Largest ‖W_j‖ at a vertex, in units of the signal.
    pub max: f64,
    /// Mean square of W_j divided by the variance of the signal; NaN for a constant signal.
    pub energy_share: f64,
    /// Share of W_j in the variance of the signal ([`Bands::shares`](adwave::bands::Bands::shares)). These shares and
    /// that of the rest sum to 1; NaN for a constant signal.
    pub variance_share: f64,
    /// Mean square of W_j divided by the sum over all bands; NaN for a constant signal.
    pub detail_share: f64,
    /// Loss when the bands 1 … j are dropped: the largest ‖f − S_j‖ at a vertex, in units of the signal.
    pub greatest_loss: f64,
    /// Root mean square of ‖f − S_j‖, weighted by area, in units of the signal.
    pub rms_loss: f64,
}

pub(crate) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> (Section, Vec<BandSummary>) {
    let mut section = Section::new("bands", "Bands");
    section.say(format!("There are {}.", subject.levels_reason));
    let energies = BandEnergies::new(subject);
    let bands = summaries(subject, &energies);
    section.push(Block::Table(table(subject, &bands, &energies)));
    section.push(Block::Table(losses(subject, &bands)));
    if !energies.total.is_finite() || energies.total <= 0.0 {
        section.note("The signal is constant: every band is 0, and shares of its energy are undefined.");
    }
    match energy_chart(subject, &bands).and_then(|shares| Ok([shares, decay_chart(subject)?])) {
        Ok(charts) => section.gallery(Ok(charts.into_iter().flatten().collect())),
        Err(why) => section.note(format!("No chart: {why}.")),
    }
    if studio.can_draw() {
        section.say(if subject.is_geometry() {
            "The smoothed shape: the positions S_j, at the same scale.".to_owned()
        } else {
            format!("The smoothed signal: S_j of {}, in the same range of colors.", subject.scalar_name())
        });
        section.gallery(smoothed(subject, studio));
        section.say(match subject.grid {
            Some(_) => "The bands W_j, each in its own range of colors.",
            None => "The bands: W_j on the original shape, each in its own range of colors.",
        });
        section.gallery(magnitudes(subject, studio));
    }
    (section, bands)
}

/// Levels that are drawn, evenly spaced from the first to the last.
fn select_levels(n_levels: usize) -> Vec<usize> {
    let n = n_levels.min(MAX_DRAWN);
    (0..n).map(|k| 1 + (2 * k * (n_levels - 1) + n - 1) / (2 * (n - 1)).max(1)).collect()
}

/// Variances and mean squares, weighted by the areas of the vertices, which are 0 where the signal has no value.
struct BandEnergies {
    /// Variance of the signal.
    total: f64,
    /// Variance of the rest S_J.
    rest: f64,
    /// Mean square of each band.
    bands: Vec<f64>,
    /// Shares of the bands and of the rest in the variance of the signal.
    shares: Vec<f64>,
}

impl BandEnergies {
    fn new(subject: &Subject<'_>) -> Self {
        let (bands, areas) = (subject.bands, subject.decomposer.areas());
        let variance = |signal: &[f64]| weighted_variance(signal, bands.n_channels, &areas);
        Self {
            total: variance(subject.values),
            rest: variance(bands.coarsest()),
            bands: bands.energy(&areas).expect("one area per vertex"),
            shares: bands.shares(&subject.decomposer.stationary()).expect("one weight per vertex"),
        }
    }
}

/// Variance `Σ μ(x)‖f(x) − f̄‖² / Σ μ(x)`; the weights are equal if no area is positive.
fn weighted_variance(signal: &[f64], n_channels: usize, areas: &[f64]) -> f64 {
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

/// Statistics of all bands, fine to coarse. O(vertices × levels).
pub fn band_summaries(subject: &Subject<'_>) -> Vec<BandSummary> {
    summaries(subject, &BandEnergies::new(subject))
}

fn summaries(subject: &Subject<'_>, energies: &BandEnergies) -> Vec<BandSummary> {
    let bands = subject.bands;
    // By rounding, a constant signal has a variance of about 1e-32 of its square.
    let size = subject.values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    let constant = energies.total <= (1e-13 * size).powi(2);
    let all: f64 = energies.bands.iter().sum();
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
            let energy = energies.bands[level - 1];
            BandSummary {
                level,
                steps: bands.steps[level],
                sigma: bands.sigma[level],
                rms: energy.sqrt(),
                max: max.sqrt(),
                energy_share: share(energy, energies.total),
                variance_share: if constant { f64::NAN } else { energies.shares[level - 1] },
                detail_share: share(energy, all),
                greatest_loss: losses[level - 1].greatest,
                rms_loss: losses[level - 1].rms,
            }
        })
        .collect()
}

fn table(subject: &Subject<'_>, bands: &[BandSummary], energies: &BandEnergies) -> Table {
    let (width, unit) = (subject.width_unit(), subject.unit());
    let mut table = Table::new(
        "bands.csv",
        "The bands, fine to coarse. The energy of the signal is its variance; the energy of a band is the mean square of W_j. \
         Neighboring bands overlap, so that the shares of the signal's energy do not add up to 100 %. The shares of its variance \
         do: what ‖S_j‖² loses from level to level, by the stationary distribution of the operator.",
        &[
            "level j",
            "steps n_j",
            &format!("σ_j, {width}"),
            &format!("FWHM, {width}"),
            "σ_j, % of the diagonal",
            &format!("rms of W_j, {unit}"),
            &format!("largest |W_j|, {unit}"),
            "% of the signal's energy",
            "% of the signal's variance",
            "% of all bands' energy",
        ],
    );
    let numbers = |value: &dyn Fn(&BandSummary) -> f64| column(&bands.iter().map(value).collect::<Vec<_>>());
    let columns = [
        numbers(&|b| b.sigma),
        numbers(&|b| if subject.percent(b.sigma).is_nan() { f64::NAN } else { FWHM * b.sigma }),
        numbers(&|b| subject.percent(b.sigma)),
        numbers(&|b| b.rms),
        numbers(&|b| b.max),
        numbers(&|b| 100.0 * b.energy_share),
        numbers(&|b| 100.0 * b.variance_share),
        numbers(&|b| 100.0 * b.detail_share),
    ];
    for (k, band) in bands.iter().enumerate() {
        let [sigma, fwhm, percent, rms, max, energy, variance, detail] =
            columns.each_ref().map(|cells| cells[k].clone());
        table.push([
            band.level.to_string(),
            format_steps(band.steps),
            sigma,
            fwhm,
            percent,
            rms,
            max,
            energy,
            variance,
            detail,
        ]);
    }
    let constant = bands.iter().all(|b| b.energy_share.is_nan());
    let rest = if constant { NONE.to_owned() } else { digits(100.0 * energies.rest / energies.total) };
    let rest_share = energies.shares.last().filter(|_| !constant);
    let variance = rest_share.map_or(NONE.to_owned(), |share| digits(100.0 * share));
    let none = || NONE.to_owned();
    let name = format!("rest S_{}", bands.len());
    table.push([
        name,
        none(),
        none(),
        none(),
        none(),
        digits(energies.rest.sqrt()),
        none(),
        rest,
        variance,
        none(),
    ]);
    table.drop_empty_columns()
}

/// Table of the loss when bands are dropped.
fn losses(subject: &Subject<'_>, bands: &[BandSummary]) -> Table {
    let (width, unit) = (subject.width_unit(), subject.unit());
    let mut table = Table::new(
        "detail.csv",
        &format!(
            "The loss when the bands up to level j are dropped, as `adwave filter --gains` does with j zeros followed by ones: \
             the distance of the signal f from S_j over the {}; the rms is weighted by area.",
            subject.vertices()
        ),
        &[
            "bands dropped",
            &format!("σ_j, {width}"),
            &format!("largest |f − S_j|, {unit}"),
            "largest, % of the diagonal",
            &format!("rms |f − S_j|, {unit}"),
            "rms, % of the diagonal",
        ],
    );
    let numbers = |value: &dyn Fn(&BandSummary) -> f64| column(&bands.iter().map(value).collect::<Vec<_>>());
    // A percentage of the diagonal has a meaning only if the signal is the shape.
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
    table.drop_empty_columns()
}

/// Chart of the energy of each level; `None` if fewer than two levels have energy.
fn energy_chart(subject: &Subject<'_>, bands: &[BandSummary]) -> Result<Option<Figure>, String> {
    let strong = bands.iter().filter(|b| b.detail_share > 0.0);
    let Some(most) = strong.clone().max_by(|a, b| a.detail_share.total_cmp(&b.detail_share)) else {
        return Ok(None);
    };
    if strong.count() < 2 {
        return Ok(None);
    }
    let caption = format!(
        "Share of each band in the energy of all bands. The strongest is band {}, of {}, with {:.0} %.",
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
        x: ChartAxis {
            label: "level, fine to coarse".to_owned(),
            names: bands.iter().map(|b| b.level.to_string()).collect(),
            ..ChartAxis::default()
        },
        y: ChartAxis { label: "share, %".to_owned(), ..ChartAxis::default() },
        series: vec![Series { label: String::new(), mark: Mark::Bars, points: points.collect() }],
    };
    chart_figure(&chart, &format!("A bar chart of the energy of each band: {alt}."), caption).map(Some)
}

/// Chart of the standard deviation after each level; `None` for coordinates, of which nearly everything remains.
fn decay_chart(subject: &Subject<'_>) -> Result<Option<Figure>, String> {
    let (bands, areas) = (subject.bands, subject.decomposer.areas());
    let rms = |signal: &[f64]| weighted_variance(signal, bands.n_channels, &areas).sqrt();
    let left: Vec<f64> = bands.all_scaling().chunks_exact(subject.values.len()).map(rms).collect();
    let (first, last) = (left[0], left[bands.n_levels()]);
    if subject.is_geometry() || !(first > 0.0 && left.iter().all(|v| v.is_finite())) {
        return Ok(None);
    }
    let caption = format!(
        "How {} evens out: the standard deviation of S_j, from S_0, the signal itself, to S_{}. It decreases from {} to {}.",
        subject.signal,
        bands.n_levels(),
        digits(first),
        digits(last),
    );
    let chart = Chart {
        title: "Standard deviation of the smoothed signal".to_owned(),
        x: ChartAxis {
            label: "level, fine to coarse".to_owned(),
            names: (0..left.len()).map(|j| j.to_string()).collect(),
            ..ChartAxis::default()
        },
        y: ChartAxis { label: "standard deviation".to_owned(), ..ChartAxis::default() },
        series: vec![Series {
            label: String::new(),
            mark: Mark::Stems,
            points: left.iter().enumerate().map(|(j, v)| [j as f64, *v]).collect(),
        }],
    };
    let alt =
        format!("The standard deviation of the smoothed signal by level: {}.", column(&left).join(", "));
    chart_figure(&chart, &alt, caption).map(Some)
}

/// Converts a chart to a figure of the page.
fn chart_figure(chart: &Chart, alt: &str, caption: String) -> Result<Figure, String> {
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
    let (scaling, signal) = (bands.all_scaling(), SignalPictures::new(subject));
    let specs: Vec<PictureSpec<'_>> = select_levels(bands.n_levels())
        .into_iter()
        .map(|j| {
            let caption =
                format!("S_{j}, after {}: {}.", steps(bands.steps[j]), width(subject, bands.sigma[j]));
            let values = &scaling[(j * subject.values.len())..][..subject.values.len()];
            signal.picture(values, format!("{} smoothed to level {j}", subject.signal), caption)
        })
        .collect();
    studio.draw(&specs)
}

fn magnitudes(subject: &Subject<'_>, studio: &mut Studio<'_>) -> Result<Vec<Figure>, String> {
    let bands = subject.bands;
    let specs: Vec<PictureSpec<'_>> = select_levels(bands.n_levels())
        .into_iter()
        .map(|j| {
            let values = subject.scalar(bands.wavelet(j));
            let signed = bands.n_channels == 1;
            let scale =
                if signed { Scale::about_zero(&values, 0.99) } else { Scale::from_zero(&values, 0.99) };
            let name = if signed { format!("W_{j}") } else { format!("|W_{j}|") };
            let caption = format!("{name}, of {}.", width(subject, bands.sigma[j]));
            PictureSpec::plain(format!("Band {j} of {}", subject.signal), caption).field(FieldLook::new(
                values,
                if subject.is_geometry() { format!("{name}, model units") } else { name },
                scale,
            ))
        })
        .collect();
    studio.draw(&specs)
}

fn steps(n: f64) -> String {
    if n == 1.0 { "1 step".to_owned() } else { format!("{} steps", format_steps(n)) }
}

/// Formats a number of steps: an integer exactly, other numbers with four digits.
fn format_steps(n: f64) -> String {
    if n.fract() == 0.0 { n.to_string() } else { digits(n) }
}

/// Describes a width, such as `width σ = 0.05 model units, 2 % of the diagonal`.
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
    fn drawn_levels_are_evenly_spaced_from_the_first_to_the_last() {
        assert_eq!(select_levels(1), [1]);
        assert_eq!(select_levels(3), [1, 2, 3]);
        assert_eq!(select_levels(8), [1, 3, 6, 8]);
        assert_eq!(select_levels(6), [1, 3, 4, 6]);
    }

    #[test]
    fn variances_equal_values_computed_by_hand() {
        // Values 0 and 4 with weights 3 and 1: the mean is 1, and (3·1 + 1·9)/4 = 3.
        assert_eq!(weighted_variance(&[0.0, 4.0], 1, &[3.0, 1.0]), 3.0);
        assert_eq!(weighted_variance(&[0.0, 4.0, f64::NAN], 1, &[3.0, 1.0, 0.0]), 3.0);
        assert_eq!(weighted_variance(&[0.0, 0.0, 4.0, 2.0], 2, &[0.0, 0.0]), 5.0);
    }
}
