//! `adwave features`: where bands stand out in place and in scale.

mod args;

use crate::analysis::Analysis;
use crate::args::ResponseArg;
use crate::error::CliError;
use crate::field_file::no_fields_of;
use crate::global::Global;
use crate::output::{check_writable, number, percent_of, print, steps_json, table, write_error, write_shape};
use adwave::features::{Descriptor, FEATURE_EXTENT, Feature, describe, features, spheres};
use adwave_io::{Field, FieldValues, Format, ShapeFile, atomic_write};
use adwave_render::ColorMap;
use adwave_report::Table;
pub(crate) use args::FeaturesArgs;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// How many features are printed.
const MAX_PRINTED: usize = 40;

/// The features of one shape.
struct Found {
    analysis: Analysis,
    features: Vec<Feature>,
    descriptors: Vec<Descriptor>,
    seconds: f64,
}

pub(crate) fn run(args: &FeaturesArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.detect.params(&args.border).check().map_err(CliError::input)?;
    let kind = args.output.as_deref().map(output_kind).transpose()?;
    if let Some(path) = &args.output {
        check_writable(path)?;
    }
    let found = find(args, global)?;
    let json = report(args, &found);
    match (kind, &args.output) {
        (Some(OutputKind::Json), Some(path)) => write_text(path, &format!("{json:#}\n"))?,
        (Some(kind), Some(path)) => {
            let n_levels = found.analysis.schedule.n_levels();
            write_list(path, kind, &found.features, &found.descriptors, n_levels, global)?;
        }
        _ => {}
    }
    print(global, &text(args, &found), &json)
}

fn find(args: &FeaturesArgs, global: &Global<'_>) -> Result<Found, CliError> {
    let mut analysis = Analysis::new(&args.shape, &args.field, &args.levels, FEATURE_EXTENT, global)?;
    let params = args.detect.params(&args.border);
    // Spheres go into a new file, and the bytes of the old one would lie beside the bands.
    analysis.input.file.forget_original();
    let wavelets = analysis.wavelets(global, Some(params.response))?;
    let start = Instant::now();
    let features = features(&analysis.decomposer, &wavelets, &params, global.progress())
        .map_err(|e| CliError::classified(&e))?;
    let seconds = start.elapsed().as_secs_f64();
    let descriptors =
        if args.descriptors { describe(&analysis.decomposer, &wavelets, &features) } else { Vec::new() };
    Ok(Found { analysis, features, descriptors, seconds })
}

/// What a file of features is.
#[derive(Clone, Copy)]
pub(crate) enum OutputKind {
    Csv,
    Json,
    Spheres,
}

pub(crate) fn output_kind(path: &Path) -> Result<OutputKind, CliError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match (ending.as_deref(), Format::from_path(path)) {
        (Some("csv"), _) => Ok(OutputKind::Csv),
        (Some("json"), _) => Ok(OutputKind::Json),
        (_, Some(format)) if format.holds_fields() && format.holds_faces() => Ok(OutputKind::Spheres),
        _ => Err(no_fields_of(path, "features are", Format::holds_faces, &[".csv", ".json"])),
    }
}

/// Writes features of a shape's bands, which have `n_levels`.
pub(crate) fn write_features(
    path: &Path,
    kind: OutputKind,
    features: &[Feature],
    n_levels: usize,
    global: &Global<'_>,
) -> Result<(), CliError> {
    write_list(path, kind, features, &[], n_levels, global)
}

fn write_list(
    path: &Path,
    kind: OutputKind,
    features: &[Feature],
    descriptors: &[Descriptor],
    n_levels: usize,
    global: &Global<'_>,
) -> Result<(), CliError> {
    match kind {
        OutputKind::Json => {
            let features: Vec<Value> = features.iter().map(feature_json).collect();
            write_text(path, &format!("{:#}\n", json!({ "features": features })))
        }
        OutputKind::Csv => write_text(path, &csv(features, descriptors)),
        OutputKind::Spheres => write_spheres(path, features, n_levels, global),
    }
}

fn text(args: &FeaturesArgs, found: &Found) -> String {
    let analysis = &found.analysis;
    let mut text = analysis.headline(args.field.name());
    if found.features.is_empty() {
        let _ = writeln!(text, "no features: {}", what_to_try(args, analysis.signal.n_channels));
    } else {
        let n = found.features.len();
        let _ = writeln!(text, "{n} feature{}\n", if n == 1 { "" } else { "s" });
        text += &table(
            ["level", "sigma", "% of diagonal", "features"],
            by_level(&found.features).into_iter().map(|(level, count)| {
                let sigma = analysis.sigma()[level];
                [
                    level.to_string(),
                    number(sigma),
                    percent_of(sigma, analysis.decomposer.diagonal()),
                    count.to_string(),
                ]
            }),
        );
    }
    let _ = writeln!(text);
    if args.output.is_none() {
        text += &table(
            ["vertex", "x", "y", "z", "level", "sigma", "response", "sign"],
            found.features.iter().take(MAX_PRINTED).map(|f| {
                let [x, y, z] = f.position.map_or(["", "", ""].map(str::to_owned), |p| p.map(number));
                let (level, sign) = (f.level.to_string(), if f.sign() > 0 { "+" } else { "-" });
                [f.vertex.to_string(), x, y, z, level, number(f.sigma), number(f.response), sign.to_owned()]
            }),
        );
        if found.features.len() > MAX_PRINTED {
            let _ = writeln!(
                text,
                "  … {} more; write them with -o FILE.csv",
                found.features.len() - MAX_PRINTED
            );
        }
    }
    text += &analysis.timing("features", found.seconds);
    if let Some(path) = &args.output {
        text += &path.display().to_string();
    }
    text
}

/// What may give features where there are none.
fn what_to_try(args: &FeaturesArgs, n_channels: usize) -> &'static str {
    match args.detect.response {
        ResponseArg::Normalized if n_channels == 1 => {
            "take a lower --theta, more --levels, or --response literal where the signal is flat but for a few bumps"
        }
        ResponseArg::Literal if n_channels > 1 => "take a lower --theta, or --response normalized",
        _ => "take a lower --theta, or more --levels",
    }
}

/// How many features each level has.
fn by_level(features: &[Feature]) -> Vec<(usize, usize)> {
    features.chunk_by(|a, b| a.level == b.level).map(|same| (same[0].level, same.len())).collect()
}

fn report(args: &FeaturesArgs, found: &Found) -> Value {
    let Found { analysis, features, descriptors, seconds } = found;
    let feature = |(k, f): (usize, &Feature)| {
        let mut json = feature_json(f);
        if let Some(descriptor) = descriptors.get(k) {
            json["descriptor"] = json!(descriptor.as_slice());
        }
        json
    };
    json!({
        "shape": analysis.input.name,
        "field": args.field.name(),
        "theta": args.detect.theta,
        "vertices": analysis.decomposer.n_vertices(),
        "operator": analysis.decomposer.operator_kind().name(),
        "levels_reason": analysis.why,
        "steps": steps_json(&analysis.schedule.steps_from_zero()),
        "sigma": analysis.sigma(),
        "features": features.iter().enumerate().map(feature).collect::<Vec<_>>(),
        "seconds": {
            "read": analysis.seconds.read, "diffusion": analysis.seconds.diffusion,
            "bands": analysis.seconds.bands, "features": seconds,
        },
    })
}

fn feature_json(f: &Feature) -> Value {
    json!({
        "vertex": f.vertex, "position": f.position, "level": f.level, "sigma": f.sigma,
        "response": f.response, "strength": f.strength, "sign": f.sign(), "channel": f.channel,
    })
}

fn csv(features: &[Feature], descriptors: &[Descriptor]) -> String {
    let head = ["vertex", "x", "y", "z", "level", "sigma", "response", "strength", "sign", "channel"];
    let mut table = Table::new("features.csv", "", &head);
    let n_numbers = descriptors.first().map_or(0, |d| d.len());
    table.head.extend((0..n_numbers).map(|k| format!("d{k}")));
    for (k, f) in features.iter().enumerate() {
        let [x, y, z] = f.position.map_or(["", "", ""].map(str::to_owned), |p| p.map(|c| c.to_string()));
        let [sigma, response, strength] = [f.sigma, f.response, f.strength].map(|v| v.to_string());
        let (sign, channel) = (f.sign().to_string(), f.channel.map_or(String::new(), |c| c.to_string()));
        let mut row = vec![
            f.vertex.to_string(),
            x,
            y,
            z,
            f.level.to_string(),
            sigma,
            response,
            strength,
            sign,
            channel,
        ];
        row.extend(descriptors.get(k).into_iter().flatten().map(ToString::to_string));
        table.rows.push(row);
    }
    table.csv()
}

fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    atomic_write(path, |out| Ok(out.write_all(text.as_bytes())?)).map_err(write_error)
}

fn write_spheres(
    path: &Path,
    features: &[Feature],
    n_levels: usize,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let spheres = spheres(features);
    if spheres.points.is_empty() && !features.is_empty() {
        return Err(CliError::Input(
            "a graph's features have no position; write them as .csv or .json".to_owned(),
        ));
    }
    let mut file = ShapeFile::from_mesh(spheres.points, spheres.faces);
    let at = |value: &dyn Fn(&Feature) -> f64| -> Vec<f64> {
        spheres.feature_of.iter().map(|&k| value(&features[k as usize])).collect()
    };
    let last = n_levels as f64;
    let levels = at(&|f| f.level as f64);
    let color = ColorMap::from_name("turbo").expect("a name of the list").colors(&levels, 1.0, last);
    let numbers: [(&str, Vec<f64>); 5] = [
        ("vertex", at(&|f| f.vertex as f64)),
        ("level", levels),
        ("sigma", at(&|f| f.sigma)),
        ("response", at(&|f| f.response)),
        ("strength", at(&|f| f.strength)),
    ];
    for (name, values) in numbers {
        file.add_vertex_field(Field::new(name, 1, FieldValues::F64(values)))?;
    }
    file.add_vertex_field(Field::new("color", 3, FieldValues::U8(color)))?;
    write_shape(global, &file, path).map(|_| ())
}
