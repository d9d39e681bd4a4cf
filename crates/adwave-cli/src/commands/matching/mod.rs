//! `adwave match`: the motion between two shapes, and pairs of their features.

mod args;
mod picture;

use crate::args::ShapeArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{
    check_writable, count, has_extension, number, output_format, print, table, write_file, write_shape,
};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::shape::{Input, load_shape, move_points};
use crate::resolve::signal::file_normals;
use adwave::Decomposer;
use adwave::features::match_features;
use adwave::operator::OperatorTask;
use adwave_io::MovedNormals;
use adwave_register::{
    AlignInfo, AlignParams, Consensus, ConsensusParams, Motion, Pair, PairParams, ShapeFeatures, Surface,
    align, common_lengths, consensus, describe_shape, pairs_under,
};
use adwave_report::Table;
pub(crate) use args::MatchArgs;
use args::MotionArg;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Most pairs that are printed.
const MAX_PRINTED: usize = 20;

/// One of the two shapes.
struct Side {
    input: Input,
    decomposer: Decomposer,
    described: ShapeFeatures,
}

/// The motion between two shapes, and the pairs of their features.
struct Matching {
    /// None if there is no clear one.
    motion: Option<FittedMotion>,
    pairs: Vec<Pair>,
    sigma: Vec<f64>,
}

/// A motion from the first shape to the second.
struct FittedMotion {
    motion: Motion,
    /// Features that agree with it.
    consensus: Consensus,
    /// Quality of its fit.
    fit: AlignInfo,
}

pub(crate) fn run(args: &MatchArgs, global: &Global<'_>) -> Result<(), CliError> {
    check(args)?;
    let [mut first, mut second] = sides(args, global)?;
    let found = find(args, &first, &second, global)?;
    for side in [&mut first, &mut second] {
        for feature in &mut side.described.features {
            feature.vertex = side.input.file.file_row(feature.vertex);
        }
    }
    let mut text = describe(&first, &second, &found);
    if let Some(path) = &args.output {
        write_pairs(path, &first, &second, &found, global)?;
        let _ = writeln!(text, "{}", path.display());
    }
    if let Some(path) = &args.moved {
        let Some(FittedMotion { motion, .. }) = &found.motion else {
            return Err(CliError::Input("no motion was found that --moved could apply to SHAPE".to_owned()));
        };
        let mut file = first.input.file.clone();
        let points = file.points().iter().map(|p| motion.apply(p)).collect();
        move_points(&mut file, points, MovedNormals::Follow, global)?;
        write_shape(global, &file, path)?;
        let _ = writeln!(text, "{}", path.display());
    }
    if let Some(path) = &args.picture {
        let motion = found.motion.as_ref().map_or_else(Motion::default, |fitted| fitted.motion);
        with_spinner(global, "drawing", || {
            picture::write(path, args, [&first, &second], &motion, &found.pairs, global)
        })?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(global, &text, &report(&first, &second, &found))
}

/// Refuses what can be refused before anything is read.
fn check(args: &MatchArgs) -> Result<(), CliError> {
    if let Some(path) = args.output.as_deref().filter(|path| !has_extension(path, &["csv", "json"])) {
        return Err(CliError::Input(format!("{}: pairs are written as .csv or .json", path.display())));
    }
    if let Some(path) = args.picture.as_deref().filter(|path| !has_extension(path, &["png"])) {
        return Err(CliError::Input(format!("{}: a picture is written as .png", path.display())));
    }
    if let Some(path) = &args.moved {
        output_format(path)?;
    }
    for path in [&args.output, &args.picture, &args.moved].into_iter().flatten() {
        check_writable(path)?;
    }
    for (name, value) in [("--within", args.within), ("--theta", args.theta), ("--ratio", args.ratio)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(CliError::Input(format!("{name} must be a number above 0, got {value}")));
        }
    }
    Ok(())
}

fn sides(args: &MatchArgs, global: &Global<'_>) -> Result<[Side; 2], CliError> {
    let shapes = [args.shape.clone(), ShapeArgs { shape: args.other.clone(), ..args.shape.clone() }];
    let operator = operator_for_task(&args.shape.operator, OperatorTask::Comparison)?;
    let mut prepared = Vec::new();
    for shape in &shapes {
        let input = load_shape(shape, global)?;
        let decomposer = prepare(global, &input, &operator)?;
        prepared.push((input, decomposer));
    }
    let lengths_of =
        |k: usize| common_lengths(&prepared[k].1, &prepared[k].1).map_err(|e| CliError::classify(&e));
    let lengths = if args.motion == MotionArg::Rigid {
        let both = common_lengths(&prepared[0].1, &prepared[1].1).map_err(|e| CliError::classify(&e))?;
        [both.clone(), both]
    } else {
        [lengths_of(0)?, lengths_of(1)?]
    };
    let mut sides = Vec::new();
    for ((input, decomposer), lengths) in prepared.into_iter().zip(lengths) {
        let normals = file_normals(&input.file);
        let described = with_progress(global, "finding features", |progress| {
            describe_shape(&decomposer, normals.as_deref(), &lengths, args.theta, progress)
        })
        .map_err(|e| CliError::classify(&e))?;
        sides.push(Side { input, decomposer, described });
    }
    sides.try_into().map_err(|_| CliError::Input("two shapes are needed".to_owned()))
}

fn find(args: &MatchArgs, first: &Side, second: &Side, global: &Global<'_>) -> Result<Matching, CliError> {
    let (a, b) = (&first.described, &second.described);
    let sigma: Vec<f64> = a.features.iter().map(|f| f.sigma).collect();
    if args.motion == MotionArg::None {
        let pair = |m: adwave::features::Match| Pair {
            first: m.first,
            second: m.second,
            sigmas: f64::NAN,
            // Twice the distance between two descriptors that have nothing in common is 2·√2.
            confidence: (1.0 - m.distance / std::f64::consts::SQRT_2).clamp(0.0, 1.0),
        };
        let pairs =
            match_features(&a.descriptors, &b.descriptors, args.ratio).into_iter().map(pair).collect();
        return Ok(Matching { motion: None, pairs, sigma });
    }
    let params =
        ConsensusParams { scaled: args.motion == MotionArg::Similarity, ..ConsensusParams::default() };
    let found = with_progress(global, "matching", |progress| consensus(a, b, &params, progress))
        .map_err(|_| CliError::Cancelled)?;
    let clear = found.filter(Consensus::is_clear);
    let (Some(found), Some(surface)) = (clear, Surface::new(second.decomposer.geometry())) else {
        return Ok(Matching { motion: None, pairs: Vec::new(), sigma });
    };
    let points = first.decomposer.geometry().points();
    let (motion, info) = with_progress(global, "fitting", |progress| {
        align(
            points,
            &surface,
            found.motion,
            &AlignParams { scaled: params.scaled, ..AlignParams::default() },
            progress,
        )
    })
    .map_err(|_| CliError::Cancelled)?;
    let geometry = second.decomposer.geometry();
    let area = if geometry.faces().is_empty() {
        second.decomposer.areas().iter().sum()
    } else {
        geometry.area_of(geometry.points())
    };
    let pairs = pairs_under(&a.keys, &b.keys, &motion, area, &PairParams { sigmas: args.within });
    let fitted = FittedMotion { motion, consensus: found, fit: info };
    Ok(Matching { motion: Some(fitted), pairs, sigma })
}

fn describe(first: &Side, second: &Side, found: &Matching) -> String {
    let mut text = String::new();
    for side in [first, second] {
        let (n, n_features) = (side.decomposer.n_vertices(), side.described.features.len());
        let (n, n_features) = (count(n, "vertex", "vertices"), count(n_features, "feature", "features"));
        let _ = writeln!(text, "{}: {n}, {n_features}", side.input.name);
    }
    match &found.motion {
        Some(FittedMotion { motion, consensus, fit }) => {
            let scale = if motion.scale() == 1.0 {
                String::new()
            } else {
                format!(", scale {}", number(motion.scale()))
            };
            let _ = writeln!(
                text,
                "motion: rotation by {:.2}°, translation by ({}){scale}; {} agree with it, at most {} by chance",
                motion.degrees(),
                motion.translation().map(number).join(", "),
                count(consensus.n_agreeing, "feature", "features"),
                consensus.n_by_chance
            );
            let _ = writeln!(
                text,
                "fit: median distance {} ({} mean edges), {:.0} % overlap",
                number(fit.median),
                number(fit.median / second.decomposer.mean_length()),
                100.0 * fit.overlap
            );
        }
        None if found.pairs.is_empty() => {
            text += "no motion explains the features better than chance; try --theta 0.7 for more features, --motion similarity if the units \
                     differ, or --motion none for bent shapes\n";
        }
        None => {}
    }
    let _ = writeln!(text, "{}\n", count(found.pairs.len(), "pair", "pairs"));
    let mut by_confidence: Vec<&Pair> = found.pairs.iter().collect();
    by_confidence.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    if !by_confidence.is_empty() {
        text += &table(
            ["vertex", "other vertex", "sigma", "apart, σ", "confidence"],
            by_confidence.iter().take(MAX_PRINTED).map(|p| {
                let (a, b) = (&first.described.features[p.first], &second.described.features[p.second]);
                let apart = if p.sigmas.is_nan() { "–".to_owned() } else { format!("{:.2}", p.sigmas) };
                [
                    a.vertex.to_string(),
                    b.vertex.to_string(),
                    number(found.sigma[p.first]),
                    apart,
                    format!("{:.2}", p.confidence),
                ]
            }),
        );
    }
    if by_confidence.len() > MAX_PRINTED {
        let _ = writeln!(text, "  … {} more; write them with -o FILE.csv", by_confidence.len() - MAX_PRINTED);
    }
    text
}

/// A pair with its two features.
fn pair_json(first: &Side, second: &Side, pair: &Pair) -> Value {
    let feature = |side: &Side, k: usize| {
        let f = &side.described.features[k];
        json!({"vertex": f.vertex, "position": f.position, "sigma": f.sigma, "sign": f.sign()})
    };
    json!({
        "first": feature(first, pair.first), "second": feature(second, pair.second),
        "apart_sigmas": if pair.sigmas.is_nan() { None } else { Some(pair.sigmas) },
        "confidence": pair.confidence,
    })
}

fn report(first: &Side, second: &Side, found: &Matching) -> Value {
    let side = |side: &Side| {
        json!({
            "shape": side.input.name, "vertices": side.decomposer.n_vertices(), "features": side.described.features.len(),
            "signed": side.described.is_signed,
        })
    };
    json!({
        "first": side(first),
        "second": side(second),
        "motion": found.motion.as_ref().map(|FittedMotion { motion, consensus, fit }| json!({
            "matrix": motion.matrix(), "degrees": motion.degrees(), "scale": motion.scale(),
            "agreeing": consensus.n_agreeing, "by_chance": consensus.n_by_chance,
            "median_distance": fit.median, "overlap": fit.overlap,
        })),
        "pairs": found.pairs.iter().map(|p| pair_json(first, second, p)).collect::<Vec<_>>(),
    })
}

fn write_pairs(
    path: &Path,
    first: &Side,
    second: &Side,
    found: &Matching,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let text = if has_extension(path, &["json"]) {
        format!("{:#}\n", report(first, second, found))
    } else {
        let head = [
            "vertex",
            "x",
            "y",
            "z",
            "sigma",
            "other_vertex",
            "other_x",
            "other_y",
            "other_z",
            "other_sigma",
            "apart_sigmas",
            "confidence",
        ];
        let mut table = Table::new("pairs.csv", "", &head);
        for pair in &found.pairs {
            let mut row = Vec::new();
            for f in [&first.described.features[pair.first], &second.described.features[pair.second]] {
                row.push(f.vertex.to_string());
                row.extend(f.position.unwrap_or([f64::NAN; 3]).map(|c| c.to_string()));
                row.push(f.sigma.to_string());
            }
            row.push(if pair.sigmas.is_nan() { String::new() } else { pair.sigmas.to_string() });
            row.push(pair.confidence.to_string());
            table.rows.push(row);
        }
        table.csv()
    };
    write_file(global, path, text.as_bytes())
}
