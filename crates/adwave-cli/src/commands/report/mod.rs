//! `adwave report`: one page about one shape.

mod args;

use crate::analysis::Analysis;
use crate::commands::info::{health_json, kind};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{
    bands_params, check_levels, check_writable, command_line, print, steps_json, write_error,
};
use crate::progress::{with_progress, with_spinner};
use crate::shape_input::load;
use crate::signal::{default_signal, field_names, file_normals};
use crate::stopwatch::Stopwatch;
use crate::up::Upward;
use adwave::bands::Bands;
use adwave::features::FEATURE_EXTENT;
use adwave_io::atomic_write;
use adwave_report::shape_report::{ShapeReport, Subject, Viewpoint, shape_report};
pub(crate) use args::ReportArgs;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

pub(crate) fn run(args: &ReportArgs, global: &Global<'_>) -> Result<(), CliError> {
    let start = Instant::now();
    check(args)?;
    let mut watch = Stopwatch::start();
    let input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let signal = args.field.or(default_signal(&input.file));
    let field = signal.name().to_owned();
    let upward = Upward::of(args.up, &input);
    let mut analysis =
        Analysis::of(input, watch.lap(), &args.shape, &signal, &args.levels, FEATURE_EXTENT, global)?;
    let bands = analysis.bands(global)?;
    let viewpoint = Viewpoint { view: Some(args.view), up: upward.up };
    let report = report(viewpoint, global, &analysis, &bands, &field)?;
    let html = report.page.html();
    atomic_write(&args.output, |out| Ok(out.write_all(html.as_bytes())?)).map_err(write_error)?;
    let seconds = start.elapsed().as_secs_f64();
    let text =
        analysis.headline(&field) + &upward.line() + &summary(&report, html.len(), seconds, &args.output);
    let mut json = describe(args, &analysis, &field, &report, html.len(), seconds);
    json["up"] = upward.json();
    print(global, &text, &json)
}

/// What can be refused before anything is read.
fn check(args: &ReportArgs) -> Result<(), CliError> {
    let named = |ending: &str| args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if !named("html") && !named("htm") {
        return Err(CliError::Input(format!("{}: a report is written as .html", args.output.display())));
    }
    check_writable(&args.output)?;
    bands_params(&args.levels)?;
    check_levels(&args.levels)
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
    let subject = Subject {
        name: last_part(&input.name),
        format: &format.map_or_else(|| "built-in".to_owned(), |f| f.to_string()),
        fields: &field_names(&input.file),
        shape: &input.shape,
        decomposer: &analysis.decomposer,
        signal: if input.file.field(field).is_some() { field } else { signal_name(field) },
        values: &analysis.signal.values,
        normals: normals.as_deref(),
        bands,
        levels_reason: &analysis.why,
        command: &command_line(global.arguments.iter().skip(1)),
        seconds: &[("reading", seconds.read), ("diffusion", seconds.diffusion), ("bands", seconds.bands)],
    };
    with_progress(global, "measuring and drawing", |progress| shape_report(&subject, viewpoint, progress))
        .map_err(|_| CliError::Cancelled)
}

/// A name without the folders before it.
fn last_part(name: &str) -> &str {
    Path::new(name).file_name().and_then(|part| part.to_str()).unwrap_or(name)
}

/// The name of a signal that may come from another file: the column, or the file without folders and endings.
fn signal_name(field: &str) -> &str {
    let name = last_part(field);
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
    let count = |n: usize, what: &str| if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") };
    let features = report.features.as_ref().map_or(0, |f| f.features.len());
    format!(
        "{}, {}, {} in {:.1} MB; {seconds:.2} s\n{}",
        count(report.bands.len(), "band"),
        count(features, "feature"),
        count(report.n_pictures, "picture"),
        bytes as f64 / 1e6,
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
        "kind": kind(&analysis.input.shape),
        "output": args.output.display().to_string(),
        "bytes": bytes,
        "pictures": report.n_pictures,
        "field": field,
        "levels_reason": analysis.why,
        "health": health_json(&report.health),
        "bands": report.bands.iter().map(|b| json!({
            "level": b.level, "steps": steps_json(&[b.steps])[0], "sigma": b.sigma, "percent": analysis.percent(b.sigma),
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
