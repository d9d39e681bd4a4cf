//! `adwave report`: a page about a shape.

mod args;

use super::analysis::{Analysis, AnalysisArgs};
use super::flat_grid::{FlatGrid, subject_grid};
use crate::error::CliError;
use crate::global::Global;
use crate::output::health::health_json;
use crate::output::progress::with_progress;
use crate::output::stopwatch::Stopwatch;
use crate::output::{
    bytes_text, check_writable, command_line, count, has_extension, print, steps_json, write_file,
};
use crate::resolve::levels::check_levels;
use crate::resolve::shape::load_shape;
use crate::resolve::signal::{default_signal, field_names, file_normals};
use crate::resolve::up::UpAxis;
use crate::resolve::walk::with_given_walk;
use adwave::bands::{Bands, FWHM};
use adwave_render::Up;
use adwave_report::shape_report::{ShapeReport, Subject, Viewpoint, shape_report};
pub(crate) use args::ReportArgs;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

pub(crate) fn run(args: &ReportArgs, global: &Global<'_>) -> Result<(), CliError> {
    let start = Instant::now();
    check(args)?;
    let mut watch = Stopwatch::start();
    let input = with_given_walk(load_shape(&args.shape, global)?, &args.walk, global)?;
    let signal = args.signal.with_default(default_signal(&input.file));
    let field = signal.name_on(&input.file).to_owned();
    if input.file.grid().is_some() {
        let applies = format!("applies to shapes, and {} is drawn flat", input.name);
        global.given.refuse(&["--view", "--up"], &applies)?;
    }
    let up = input.file.grid().is_none().then(|| UpAxis::choose(args.up, &input));
    let (levels, extent) = (&args.levels, None);
    let what = AnalysisArgs {
        shape: &args.shape,
        signal: &signal,
        levels,
        is_of_paper: false,
        extent,
        walk: Some(&args.walk),
    };
    let mut analysis = Analysis::from_input(input, watch.lap(), what, global)?;
    analysis.mask_outsiders()?;
    let bands = analysis.bands(global)?;
    let viewpoint = Viewpoint { view: Some(args.view), up: up.map_or_else(Up::default, |up| up.up) };
    let report = report(viewpoint, global, &analysis, &bands, &field)?;
    let html = report.page.html();
    write_file(global, &args.output, html.as_bytes())?;
    let seconds = start.elapsed().as_secs_f64();
    let text = analysis.headline()
        + &up.map_or_else(String::new, UpAxis::line)
        + &summary(&report, html.len(), seconds, &args.output);
    let mut json = describe(args, &analysis, &field, &report, html.len(), seconds);
    json["up"] = up.map_or(Value::Null, UpAxis::to_json);
    print(global, &text, &json)
}

/// Refuses arguments that are invalid for all shapes, before anything is read.
fn check(args: &ReportArgs) -> Result<(), CliError> {
    if !has_extension(&args.output, &["html", "htm"]) {
        return Err(CliError::Input(format!("{}: a report is written as .html", args.output.display())));
    }
    check_writable(&args.output)?;
    check_levels(&args.levels).map(|_| ())
}

fn report(
    viewpoint: Viewpoint,
    global: &Global<'_>,
    analysis: &Analysis,
    bands: &Bands,
    field: &str,
) -> Result<ShapeReport, CliError> {
    let input = &analysis.input;
    let format = input.file.format();
    let seconds = &analysis.seconds;
    let normals = file_normals(&input.file);
    let sheet = FlatGrid::new_for_page(input, global)?;
    let subject = Subject {
        name: file_name(&input.name),
        format: &format.map_or_else(|| "built-in".to_owned(), |f| f.to_string()),
        fields: &field_names(&input.file),
        shape: &input.shape,
        grid: subject_grid(input, sheet.as_ref()),
        decomposer: &analysis.decomposer,
        signal: if input.file.field(field).is_some() { field } else { signal_name(field) },
        values: &analysis.signal.values,
        normals: normals.as_deref(),
        bands,
        levels_reason: &analysis.levels_reason,
        command: &command_line(global.arguments.iter().skip(1)),
        seconds: &[("reading", seconds.read), ("diffusion", seconds.diffusion), ("bands", seconds.bands)],
    };
    with_progress(global, "measuring and drawing", |progress| shape_report(&subject, viewpoint, progress))
        .map_err(|_| CliError::Cancelled)
}

/// The file name of a path that is given as text.
fn file_name(name: &str) -> &str {
    Path::new(name).file_name().and_then(|part| part.to_str()).unwrap_or(name)
}

/// The name of a signal that may come from another file: the column, or the file without folders and endings.
fn signal_name(field: &str) -> &str {
    let name = file_name(field);
    if let Some((file, column)) = name.rsplit_once(':')
        && !file.is_empty()
        && !column.is_empty()
    {
        return column;
    }
    let plain = name.strip_suffix(".gz").unwrap_or(name);
    let stem = [".gii", ".npy", ".csv", ".tsv"].into_iter().find_map(|ending| plain.strip_suffix(ending));
    stem.filter(|stem| !stem.is_empty()).unwrap_or(name)
}

fn summary(report: &ShapeReport, bytes: usize, seconds: f64, output: &Path) -> String {
    let features = report.features.as_ref().map_or(0, |f| f.features.len());
    format!(
        "{}, {}, {} in {}; {seconds:.2} s\n{}",
        count(report.bands.len(), "band", "bands"),
        count(features, "feature", "features"),
        count(report.n_pictures, "picture", "pictures"),
        bytes_text(bytes as f64),
        output.display(),
    )
}

fn describe(
    args: &ReportArgs,
    analysis: &Analysis,
    field: &str,
    report: &ShapeReport,
    bytes: usize,
    seconds: f64,
) -> Value {
    let parts: serde_json::Map<String, Value> =
        report.seconds.iter().map(|(what, seconds)| (what.clone(), json!(seconds))).collect();
    json!({
        "shape": analysis.input.name,
        "kind": analysis.input.kind_name(),
        "output": args.output.display().to_string(),
        "bytes": bytes,
        "pictures": report.n_pictures,
        "field": field,
        "levels_reason": analysis.levels_reason,
        "health": report.health.as_ref().map(health_json),
        "bands": report.bands.iter().map(|b| json!({
            "level": b.level, "steps": steps_json(&[b.steps])[0], "sigma": b.sigma, "percent": analysis.percent(b.sigma),
            "fwhm": analysis.percent(b.sigma).map(|_| FWHM * b.sigma),
            "rms": b.rms, "max": b.max, "energy_share": b.energy_share,
            "detail_share": b.detail_share, "greatest_loss": b.greatest_loss, "rms_loss": b.rms_loss,
        })).collect::<Vec<_>>(),
        "saliency": report.saliency.as_ref().map(|s| json!({
            "largest_vertex": s.vertex, "largest": s.largest, "patches": s.n_patches, "top_share": s.top_share,
        })),
        "features": report.features.as_ref().map(|f| f.features.iter().map(|f| json!({
            "vertex": f.vertex, "position": f.position, "level": f.level, "sigma": f.sigma,
            "response": f.response, "strength": f.strength,
        })).collect::<Vec<_>>()),
        "presets": report.presets.iter().map(|p| json!({
            "name": p.name, "gains": p.gains, "rms": p.rms, "max": p.max, "vertex": p.vertex,
            "volume_ratio": p.volume_ratio,
        })).collect::<Vec<_>>(),
        "seconds": {"parts": parts, "all": seconds},
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_are_called_by_what_tells_them_apart() {
        for (field, name) in [
            ("coords", "coords"),
            ("a/b/sulc_left.gii.gz", "sulc_left"),
            ("a/heat.csv", "heat"),
            ("a/heat.csv:inner", "inner"),
            ("rdf:", "rdf:"),
            (".npy", ".npy"),
        ] {
            assert_eq!(signal_name(field), name);
        }
    }
}
