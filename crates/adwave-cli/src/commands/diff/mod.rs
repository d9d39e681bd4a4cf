//! `adwave diff`: the difference between two versions of a shape, scale by scale.

mod args;
mod distances;
mod reach;

use crate::args::ShapeArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::unsuitable_format;
use crate::output::{
    check_writable, clone_for_output, command_line, fwhm_json, fwhm_text, has_extension, number, percent_of,
    print, steps_json, table, write_file, write_shape,
};
use crate::resolve::applicable::check_shape_options;
use crate::resolve::levels::{check_levels, resolve_spec};
use crate::resolve::operator::{mask_missing, operator_for_task, prepare};
use crate::resolve::shape::{GivenLength, Input, load_one_of_two};
use crate::resolve::signal::{Signal, SignalValues, file_normals};
use crate::resolve::up::UpAxis;
use adwave::bands::Bands;
use adwave::operator::OperatorTask;
use adwave::region::Length;
use adwave::saliency::SALIENCY_EXTENT;
use adwave::{BandsRequest, Decomposer};
use adwave_io::{Field, FieldValues, Format};
use adwave_register::Summary;
use adwave_report::difference_report::{Versions, difference_report};
use adwave_report::page::Fact;
use adwave_report::shape_report::{BandSummary, DIFFERENCE, Subject, Viewpoint, band_summaries};
pub(crate) use args::DiffArgs;
use distances::{Difference, difference};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

pub(crate) fn run(args: &DiffArgs, global: &Global<'_>) -> Result<(), CliError> {
    let output = args.output.as_deref().map(output_kind).transpose()?;
    if let Some(path) = &args.output {
        check_writable(path)?;
    }
    let params = check_levels(&args.levels)?;
    if let Some(Length::Units(limit) | Length::PercentOfDiagonal(limit)) = args.limit
        && !(limit.is_finite() && limit > 0.0)
    {
        return Err(CliError::Input(format!("--limit must be finite and above 0, got {limit}")));
    }
    if !matches!(output, Some(OutputKind::Page)) {
        global.given.refuse(&["--view", "--up"], "applies to the pictures of a page (-o FILE.html)")?;
    }
    let first = load_one_of_two(&args.shape, global)?;
    let other = ShapeArgs { shape: args.other.clone(), ..args.shape.clone() };
    let mut second = load_one_of_two(&other, global)?;
    check_shape_options(&[&first, &second], global)?;
    let limit = args.limit.map(|length| GivenLength { option: "--limit", length });
    let lengths: Vec<GivenLength> = args.levels.given_lengths().into_iter().chain(limit).collect();
    first.check_lengths(&lengths)?;
    let operator = operator_for_task(&args.shape.operator, OperatorTask::Comparison)?;
    let decomposer = prepare(global, &first, &operator)?;
    let found = difference(args, &first, &mut second, &decomposer, global)?;
    let values = SignalValues::Other(found.values.clone());
    let signal =
        Signal { n_channels: found.n_channels, values, channel_names: Vec::new(), unknown: Vec::new() };
    let decomposer = mask_missing(decomposer, &signal, DIFFERENCE, global)?;
    let levels = resolve_spec(&args.levels.to_spec(), SALIENCY_EXTENT, &decomposer, global)?;
    let bands = with_progress(global, "splitting", |progress| {
        let request: BandsRequest<'_> =
            decomposer.request(&signal.values, signal.n_channels, &levels.schedule);
        request.params(&params).progress(progress).bands()
    })?;
    let comparison = VersionComparison {
        args,
        first: &first,
        second: &second,
        decomposer: &decomposer,
        found: &found,
        bands: &bands,
        levels_reason: &levels.reason,
    };
    let summaries = band_summaries(&comparison.subject(""));
    match (output, &args.output) {
        (Some(OutputKind::Page), Some(path)) => comparison.write_page(path, global)?,
        (Some(OutputKind::Fields), Some(path)) => comparison.write_fields(path, global)?,
        _ => {}
    }
    print(global, &comparison.text(&summaries), &comparison.json(&summaries))
}

#[derive(Clone, Copy)]
enum OutputKind {
    Page,
    Fields,
}

fn output_kind(path: &Path) -> Result<OutputKind, CliError> {
    match Format::from_path(path) {
        _ if has_extension(path, &["html", "htm"]) => Ok(OutputKind::Page),
        Some(format) if format.holds_fields() => Ok(OutputKind::Fields),
        _ => Err(unsuitable_format(path, "a difference is", &[".html"])),
    }
}

/// Two versions of a shape, their difference, and its bands.
struct VersionComparison<'a> {
    args: &'a DiffArgs,
    first: &'a Input,
    second: &'a Input,
    decomposer: &'a Decomposer,
    found: &'a Difference,
    bands: &'a Bands,
    levels_reason: &'a str,
}

impl VersionComparison<'_> {
    fn subject<'s>(&'s self, command: &'s str) -> Subject<'s> {
        Subject {
            name: &self.first.name,
            format: "",
            fields: &[],
            shape: &self.first.shape,
            decomposer: self.decomposer,
            signal: DIFFERENCE,
            values: &self.found.values,
            normals: None,
            bands: self.bands,
            levels_reason: self.levels_reason,
            command,
            seconds: &[],
        }
    }

    fn text(&self, summaries: &[BandSummary]) -> String {
        let mut text = format!("{} against {}\n", self.second.name, self.first.name);
        for sentence in &self.found.how {
            let _ = writeln!(text, "{sentence}");
        }
        for fact in &self.found.facts {
            let _ = writeln!(text, "  {:<12} {}{}", fact.name, fact.value, meaning(fact));
        }
        let diagonal = self.decomposer.extent();
        let _ = writeln!(text, "\n{} (rms by area, model units)\n", self.levels_reason);
        text += &table(
            ["level", "sigma", "FWHM", "% of diagonal", "rms of W", "largest |W|", "% of the bands"],
            summaries.iter().map(|b| {
                [
                    b.level.to_string(),
                    number(b.sigma),
                    fwhm_text(b.sigma, diagonal),
                    percent_of(b.sigma, diagonal),
                    number(b.rms),
                    number(b.max),
                    if b.detail_share.is_finite() {
                        format!("{:.1}", 100.0 * b.detail_share)
                    } else {
                        "–".to_owned()
                    },
                ]
            }),
        );
        let _ = writeln!(
            text,
            "  the rest, wider than the last level (S_J), has an rms of {}",
            number(self.rest())
        );
        if let Some(path) = &self.args.output {
            let _ = writeln!(text, "{}", path.display());
        }
        text
    }

    /// Root mean square of S_J by area.
    fn rest(&self) -> f64 {
        Summary::new(self.bands.coarsest(), self.found.n_channels, &self.decomposer.areas()).rms
    }

    fn json(&self, summaries: &[BandSummary]) -> Value {
        let sigma: Vec<f64> = summaries.iter().map(|b| b.sigma).collect();
        json!({
            "output": self.args.output.as_ref().map(|path| path.display().to_string()),
            "first": self.first.name,
            "second": self.second.name,
            "by": if self.found.n_channels == 3 { "vertex" } else { "closest" },
            "difference": self.found.json,
            "motion": self.found.motion.as_ref().map(|motion| json!({
                "matrix": motion.matrix(), "degrees": motion.degrees(),
            })),
            "levels": summaries.iter().map(|b| json!({
                "level": b.level, "steps": steps_json(&[b.steps])[0], "sigma": b.sigma,
                "rms": b.rms, "max": b.max,
                "share": if b.detail_share.is_finite() { Some(b.detail_share) } else { None },
            })).collect::<Vec<_>>(),
            "fwhm": fwhm_json(&sigma, self.decomposer.extent()),
            "rest_rms": self.rest(),
        })
    }

    /// Writes SHAPE with the difference and its bands as fields.
    fn write_fields(&self, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
        let mut file = clone_for_output(&self.first.file, path);
        let n_levels = self.bands.n_levels();
        let levels = self.bands.wavelets().enumerate().map(|(j, level)| (format!("W{}", j + 1), level));
        let rest = (format!("S{n_levels}"), self.bands.coarsest());
        for (name, values) in
            std::iter::once((DIFFERENCE.to_owned(), &self.found.values[..])).chain(levels).chain([rest])
        {
            file.add_vertex_field(Field::new(
                name,
                self.found.n_channels,
                FieldValues::F64(values.to_vec()),
            ))?;
        }
        write_shape(global, &file, path).map(|_| ())
    }

    fn write_page(&self, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
        let normals = file_normals(&self.first.file);
        let command = command_line(global.arguments.iter().skip(1));
        let subject = Subject { normals: normals.as_deref(), ..self.subject(&command) };
        let versions = Versions {
            other: &self.second.name,
            shape: &self.second.shape,
            facts: self.found.facts.clone(),
            how: self.found.how.clone(),
        };
        let viewpoint =
            Viewpoint { view: Some(self.args.view), up: UpAxis::choose(self.args.up, self.first).up };
        let report = with_progress(global, "drawing", |progress| {
            difference_report(&subject, &versions, viewpoint, progress)
        })
        .map_err(|_| CliError::Cancelled)?;
        let html = report.page.html();
        write_file(global, path, html.as_bytes())
    }
}

fn meaning(fact: &Fact) -> String {
    if fact.meaning.is_empty() { String::new() } else { format!("   {}", fact.meaning) }
}
