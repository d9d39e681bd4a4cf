//! `adwave features`: places where bands stand out from their surroundings and from neighboring levels.

mod args;

use super::analysis::{Analysis, FoundFeatures};
use crate::error::CliError;
use crate::global::Global;
use crate::output::features_file::{FeatureList, FeaturesFile, feature_json};
use crate::output::{
    check_writable, coordinate_text, count, number, percent_of, print, steps_json, table, write_file,
};
use crate::resolve::shape::row_words;
use adwave::features::{Descriptor, Feature, Response, describe};
pub(crate) use args::FeaturesArgs;
use serde_json::{Value, json};
use std::fmt::Write;

/// Most features that are printed.
const MAX_PRINTED: usize = 40;

/// The features of one shape.
struct Detection {
    analysis: Analysis,
    features: Vec<Feature>,
    descriptors: Vec<Descriptor>,
    seconds: f64,
}

pub(crate) fn run(args: &FeaturesArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.detect.to_params(&args.border).check().map_err(CliError::input)?;
    let kind = args.output.as_deref().map(FeaturesFile::from_path).transpose()?;
    if let Some(path) = &args.output {
        check_writable(path)?;
    }
    if !matches!(kind, Some(FeaturesFile::Csv | FeaturesFile::Json)) && !global.json {
        global.given.refuse(&["--descriptors"], "applies to .csv and .json files and to --json")?;
    }
    let detection = detect(args, global)?;
    let json = report(args, &detection);
    match (kind, &args.output) {
        (Some(FeaturesFile::Json), Some(path)) => write_file(global, path, format!("{json:#}\n").as_bytes())?,
        (Some(kind), Some(path)) => {
            let n_levels = detection.analysis.schedule.n_levels();
            let Detection { features, descriptors, .. } = &detection;
            FeatureList { features, descriptors, n_levels }.write(path, kind, global)?;
        }
        _ => {}
    }
    print(global, &text(args, &detection), &json)
}

fn detect(args: &FeaturesArgs, global: &Global<'_>) -> Result<Detection, CliError> {
    let mut analysis = Analysis::new(args.analysis(), global)?;
    let mut params = args.detect.to_params(&args.border);
    let is_significant = analysis.finds_significant(&params);
    if analysis.is_grid() && !is_significant && !global.given.has("--response") {
        // The mean of a level, by which the usual response divides, is that of the background of an image.
        params = params.with_response(Response::Literal);
    }
    // Spheres go into a new file: the bytes of the old one need not be kept while the bands are computed.
    analysis.input.file.forget_original();
    let FoundFeatures { mut features, wavelets, seconds } = analysis.features(&params, global)?;
    let descriptors =
        if args.descriptors { describe(&analysis.decomposer, &wavelets, &features) } else { Vec::new() };
    for feature in &mut features {
        feature.vertex = analysis.input.file.file_row(feature.vertex);
    }
    Ok(Detection { analysis, features, descriptors, seconds })
}

fn text(args: &FeaturesArgs, detection: &Detection) -> String {
    let Detection { analysis, features, .. } = detection;
    let mut text = analysis.headline();
    if analysis.finds_significant(&args.detect.to_params(&args.border)) {
        text += match (analysis.input.shape.is_mesh(), analysis.is_grid()) {
            (true, _) => {
                "features stand out from what the triangles and noise can cause; strength is in standard deviations\n"
            }
            (_, true) => {
                "features stand out from what noise can cause; strength is in standard deviations of noise that is taken as \
                 independent of place to place\n"
            }
            _ => "",
        };
    }
    if features.is_empty() {
        let _ = writeln!(text, "no features: {}", suggestion(args, analysis));
    } else {
        let _ = writeln!(text, "{}\n", count(features.len(), "feature", "features"));
        text += &table(
            ["level", "sigma", "% of diagonal", "features"],
            count_by_level(features).into_iter().map(|(level, n)| {
                let sigma = analysis.sigma()[level];
                let percent = percent_of(sigma, analysis.decomposer.extent());
                [level.to_string(), number(sigma), percent, n.to_string()]
            }),
        );
    }
    let _ = writeln!(text);
    if args.output.is_none() {
        text += &list(features, analysis);
    }
    text += &analysis.timing("features", detection.seconds);
    if let Some(path) = &args.output {
        text += &path.display().to_string();
    }
    text
}

/// A table of the first features, with positions in the digits that the size of the shape needs.
fn list(features: &[Feature], analysis: &Analysis) -> String {
    let (extent, [one, _]) = (analysis.decomposer.extent(), analysis.input.row_words());
    let mut text = table(
        [one, "x", "y", "z", "level", "sigma", "response", "strength", "sign"],
        features.iter().take(MAX_PRINTED).map(|f| {
            let [x, y, z] =
                f.position.map_or(["", "", ""].map(str::to_owned), |p| p.map(|c| coordinate_text(c, extent)));
            let (level, sign) = (f.level.to_string(), if f.sign() > 0 { "+" } else { "-" });
            let [sigma, response, strength] = [f.sigma, f.response, f.strength].map(number);
            [f.vertex.to_string(), x, y, z, level, sigma, response, strength, sign.to_owned()]
        }),
    );
    if features.len() > MAX_PRINTED {
        let n_more = features.len() - MAX_PRINTED;
        let _ = writeln!(text, "  … {n_more} more; write them with -o FILE.csv");
    }
    text
}

/// Advice if there are no features.
fn suggestion(args: &FeaturesArgs, analysis: &Analysis) -> &'static str {
    let n_channels = analysis.signal.n_channels;
    if analysis.finds_significant(&args.detect.to_params(&args.border)) {
        return "nothing stands out from what the sampling and noise can cause; try more --levels, or --theta 2.4 for the \
                rule of the paper";
    }
    match args.detect.response {
        Response::Normalized if n_channels == 1 => {
            "try a lower --theta, more --levels, or --response literal if the signal is flat except for a few bumps"
        }
        Response::Literal if n_channels > 1 => "try a lower --theta, or --response normalized",
        _ => "try a lower --theta, or more --levels",
    }
}

/// The number of features of each level that has some.
fn count_by_level(features: &[Feature]) -> Vec<(usize, usize)> {
    features.chunk_by(|a, b| a.level == b.level).map(|same| (same[0].level, same.len())).collect()
}

fn report(args: &FeaturesArgs, detection: &Detection) -> Value {
    let Detection { analysis, features, descriptors, seconds } = detection;
    let params = args.detect.to_params(&args.border);
    let is_significant = analysis.finds_significant(&params);
    let feature = |(k, f): (usize, &Feature)| {
        let mut json = feature_json(f);
        if let Some(descriptor) = descriptors.get(k) {
            json["descriptor"] = json!(descriptor.as_slice());
        }
        json
    };
    json!({
        "shape": analysis.input.name,
        "output": args.output.as_ref().map(|path| path.display().to_string()),
        "field": analysis.name,
        "rule": if is_significant { "significance" } else { "theta" },
        "theta": (!is_significant || analysis.input.shape.is_cloud()).then(|| params.theta()),
        row_words(&analysis.input.file)[1]: analysis.decomposer.n_vertices(),
        "operator": analysis.decomposer.operator_kind().name(),
        "levels_reason": analysis.levels_reason,
        "steps": steps_json(&analysis.schedule.steps_from_zero()),
        "sigma": analysis.sigma(),
        "features": features.iter().enumerate().map(feature).collect::<Vec<_>>(),
        "seconds": {
            "read": analysis.seconds.read, "diffusion": analysis.seconds.diffusion,
            "bands": analysis.seconds.bands, "features": seconds,
        },
    })
}
