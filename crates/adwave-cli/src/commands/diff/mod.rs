//! `adwave diff`: the difference between two versions of a shape, an image or a volume, scale by scale.

mod args;
mod distances;
mod grids;
mod reach;

use crate::args::ShapeArgs;
use crate::commands::flat_grid::{FlatGrid, subject_grid};
use crate::commands::transform::{band_fields, write_npz};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::{ValuesFile, unsuitable_format};
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
use adwave::mask::missing;
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
use grids::{GridValues, add_place, place_text};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

pub(crate) fn run(args: &DiffArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(path) = args.output.as_deref().filter(|path| !is_for_values(path)) {
        output_kind(path)?;
    }
    if let Some(path) = &args.output {
        check_writable(path)?;
    }
    let params = check_levels(&args.levels)?;
    if let Some(Length::Units(limit) | Length::PercentOfDiagonal(limit)) = args.limit
        && !(limit.is_finite() && limit > 0.0)
    {
        return Err(CliError::Input(format!("--limit must be finite and above 0, got {limit}")));
    }
    let is_page = args.output.as_deref().is_some_and(|path| has_extension(path, &["html", "htm"]));
    if !is_page {
        global.given.refuse(&["--view", "--up"], "applies to the pictures of a page (-o FILE.html)")?;
    }
    let first = load_one_of_two(&args.shape, global)?;
    let other = ShapeArgs { shape: args.other.clone(), ..args.shape.clone() };
    let mut second = load_one_of_two(&other, global)?;
    check_shape_options(&[&first, &second], global)?;
    let is_grid = [&first, &second].iter().any(|input| input.file.grid().is_some());
    let output = if is_grid {
        grids::check(args, &first, global)?;
        Some(OutputKind::Values)
    } else {
        args.output.as_deref().map(output_kind).transpose()?
    };
    let limit = args.limit.map(|length| GivenLength { option: "--limit", length });
    let lengths: Vec<GivenLength> = args.levels.given_lengths().into_iter().chain(limit).collect();
    first.check_lengths(&lengths)?;
    let operator = operator_for_task(&args.shape.operator, OperatorTask::Comparison)?;
    let decomposer = prepare(global, &first, &operator)?;
    let (found, both) = if is_grid {
        let (found, both) = grids::difference(&first, &second)?;
        (found, Some(both))
    } else {
        (difference(args, &first, &mut second, &decomposer, global)?, None)
    };
    let signal = Signal::new(found.n_channels, SignalValues::Other(found.values.clone()));
    let decomposer = match missing(&signal.values, signal.n_channels).filter(|_| is_grid) {
        // The text tells how many places are compared.
        Some(flags) => decomposer.masked(&flags).map_err(CliError::input)?,
        None => mask_missing(decomposer, &signal, DIFFERENCE, global)?,
    };
    let levels = resolve_spec(&args.levels.to_spec(), SALIENCY_EXTENT, &decomposer, global)?;
    let bands = with_progress(global, "splitting", |progress| {
        let request: BandsRequest<'_> =
            decomposer.request(&signal.values, signal.n_channels, &levels.schedule);
        request.params(&params).progress(progress).bands()
    })?;
    let sheet = if is_page { FlatGrid::new_for_page(&first, global)? } else { None };
    let comparison = VersionComparison {
        args,
        both,
        sheet,
        first: &first,
        second: &second,
        decomposer: &decomposer,
        found: &found,
        parts: bands
            .as_slice()
            .chunks_exact(found.values.len())
            .map(|band| Summary::new(band, found.n_channels, &decomposer.areas()))
            .collect(),
        bands: &bands,
        levels_reason: &levels.reason,
    };
    let summaries = band_summaries(&comparison.subject(""));
    match (output, &args.output) {
        (_, Some(path)) if is_page => comparison.write_page(path, global)?,
        (Some(OutputKind::Values), Some(path)) => comparison.write_values(path, global)?,
        (Some(OutputKind::Fields), Some(path)) => comparison.write_fields(path, global)?,
        _ => {}
    }
    print(global, &comparison.text(&summaries), &comparison.json(&summaries))
}

#[derive(Clone, Copy)]
enum OutputKind {
    Page,
    Fields,
    /// The values of an image or a volume.
    Values,
}

/// True if a file of that name holds arrays, images or volumes.
fn is_for_values(path: &Path) -> bool {
    has_extension(path, &["npy", "npz"]) || Format::grid_from_path(path).is_some()
}

fn output_kind(path: &Path) -> Result<OutputKind, CliError> {
    match Format::from_path(path) {
        _ if has_extension(path, &["html", "htm"]) => Ok(OutputKind::Page),
        Some(format) if format.holds_fields() => Ok(OutputKind::Fields),
        _ => Err(unsuitable_format(path, "a difference is", &[".html"])),
    }
}

/// Two versions of a shape, an image or a volume, their difference, and its bands.
struct VersionComparison<'a> {
    args: &'a DiffArgs,
    /// Values of two images or volumes.
    both: Option<GridValues>,
    /// Mesh that shows an image or a volume on a page.
    sheet: Option<FlatGrid>,
    first: &'a Input,
    second: &'a Input,
    decomposer: &'a Decomposer,
    found: &'a Difference,
    /// Statistics of W1 … WJ and SJ.
    parts: Vec<Summary>,
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
            grid: subject_grid(self.first, self.sheet.as_ref()),
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
        let sum = Summary::new(&self.found.values, self.found.n_channels, &self.decomposer.areas());
        if self.both.is_none() || sum.greatest > 0.0 {
            text += &self.level_table(summaries, &sum);
        }
        if let Some(path) = &self.args.output {
            let _ = writeln!(text, "{}", path.display());
        }
        text
    }

    /// The bands, the rest and their sum, with the places where each is largest.
    fn level_table(&self, summaries: &[BandSummary], sum: &Summary) -> String {
        let diagonal = self.decomposer.extent();
        let unit = if self.both.is_some() { "units of the values" } else { "by area, model units" };
        let none = || "–".to_owned();
        let levels = summaries.iter().zip(&self.parts).map(|(b, part)| {
            let share = Some(b.detail_share).filter(|share| share.is_finite());
            [
                b.level.to_string(),
                number(b.sigma),
                fwhm_text(b.sigma, diagonal),
                percent_of(b.sigma, diagonal),
                number(part.rms),
                number(part.greatest),
                self.place(part.vertex),
                share.map_or_else(none, |share| format!("{:.1}", 100.0 * share)),
            ]
        });
        let last = [("rest", self.rest()), ("sum", sum)].map(|(name, part)| {
            let [rms, greatest] = [part.rms, part.greatest].map(number);
            [name.to_owned(), none(), none(), none(), rms, greatest, self.place(part.vertex), none()]
        });
        let table = table(
            [
                "level",
                "sigma",
                "FWHM",
                "% of diagonal",
                "rms",
                "largest",
                self.place_word(),
                "% of the bands",
            ],
            levels.chain(last),
        );
        format!("\n{} (rms {unit})\n\n{table}", self.levels_reason)
    }

    /// The rest S_J.
    fn rest(&self) -> &Summary {
        self.parts.last().expect("bands and a rest")
    }

    /// Head of a column of places.
    fn place_word(&self) -> &'static str {
        if self.both.is_some() { "at" } else { "at vertex" }
    }

    /// Number of a vertex in the file, or index and coordinates of a place.
    fn place(&self, vertex: usize) -> String {
        match self.first.file.grid() {
            Some(layout) => place_text(layout, vertex),
            None => self.first.file.file_row(vertex).to_string(),
        }
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
            "levels": summaries.iter().zip(&self.parts).map(|(b, part)| {
                let mut level = json!({
                    "level": b.level, "steps": steps_json(&[b.steps])[0], "sigma": b.sigma,
                    "rms": b.rms, "max": b.max,
                    "share": if b.detail_share.is_finite() { Some(b.detail_share) } else { None },
                });
                match self.first.file.grid() {
                    Some(layout) => add_place(&mut level, layout, part.vertex),
                    None => level["vertex"] = json!(self.first.file.file_row(part.vertex)),
                }
                level
            }).collect::<Vec<_>>(),
            "fwhm": fwhm_json(&sigma, self.decomposer.extent()),
            "rest_rms": self.rest().rms,
        })
    }

    /// Writes the difference and its bands as frames, or the arrays of `transform`.
    fn write_values(&self, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
        let kind = ValuesFile::choose(path, &self.first.file).filter(|_| !has_extension(path, &["npz"]));
        let Some(kind) = kind else {
            return write_npz(global, path, self.first, &self.found.values, self.bands);
        };
        kind.write(global, path, &self.fields(), &self.first.file)
    }

    /// The fields difference, W1 … WJ and SJ.
    fn fields(&self) -> Vec<Field> {
        let values = FieldValues::F64(self.found.values.clone());
        let mut fields = vec![Field::new(DIFFERENCE, self.found.n_channels, values)];
        fields.extend(band_fields(self.bands));
        fields
    }

    /// Writes SHAPE with the difference and its bands as fields.
    fn write_fields(&self, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
        let mut file = clone_for_output(&self.first.file, path);
        for field in self.fields() {
            file.add_vertex_field(field)?;
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
            values: self.both.as_ref().map(|both| [&both.first[..], &both.second]),
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
