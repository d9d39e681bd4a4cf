//! `adwave evaluate`: whether features are found again, and whether a map agrees with fixations of the eye.

mod args;

use crate::analysis::Analysis;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{bands_params, print, table};
use crate::progress::prepare;
use crate::shape_input::Input;
use crate::signal;
use adwave::bands::Schedule;
use adwave::features::{FEATURE_EXTENT, Feature, Response, features};
use adwave::measure::{
    Agreement, Change, ChangedShape, LevelRepeatability, RepeatabilityParams, agreement, center_distance,
    change, n_right, repeatability, share_by_chance,
};
use adwave::shape::{Shape, surface_area};
use adwave_io::ShapeFile;
use adwave_simplify::resample_mesh;
pub(crate) use args::EvaluateArgs;
use serde_json::{Value, json};
use std::fmt::Write;

pub(crate) fn run(args: &EvaluateArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.detect.params(&args.border).check().map_err(CliError::input)?;
    args.map.params(&args.border).check().map_err(CliError::input)?;
    let share = if args.fixations.is_some() { args.map.extent() } else { FEATURE_EXTENT };
    let mut analysis = Analysis::new(&args.shape, &args.field, &args.levels, share, global)?;
    match &args.fixations {
        Some(fixations) => against(args, global, &mut analysis, fixations),
        None => again(args, global, &mut analysis),
    }
}

/// Agreement of maps with fixations.
fn against(
    args: &EvaluateArgs,
    global: &Global<'_>,
    analysis: &mut Analysis,
    fixations: &str,
) -> Result<(), CliError> {
    let found = analysis.saliency(&args.map, &args.border, global)?;
    let one_channel = |name: &str| {
        let signal = signal::load(global, &analysis.input, name, None)?;
        if signal.n_channels != 1 {
            return Err(CliError::Input(format!("{name} has {} channels, not one", signal.n_channels)));
        }
        Ok(signal.values.to_vec())
    };
    let fixations = one_channel(fixations)?;
    let sides = (found.sides(), found.sides_json());
    let own = found.saliency.map;
    let control = analysis.input.shape.points().map(center_distance);
    let mut maps = vec![(format!("saliency of {}", args.field.name()), own)];
    for name in &args.maps {
        maps.push((name.clone(), one_channel(name)?));
    }
    let compare = |map: &[f64], control: Option<&[f64]>| {
        agreement(map, &fixations, args.threshold, control).map_err(CliError::input)
    };
    let mut rows: Vec<(String, Agreement)> = Vec::new();
    for (name, map) in &maps {
        rows.push((name.clone(), compare(map, control.as_deref())?));
    }
    if let Some(control) = &control {
        rows.push(("distance from the center".to_owned(), compare(control, None)?));
    }
    let mut text = analysis.headline(args.field.name());
    text += &format!("{}\n", sides.0);
    text += &format!("{} of {} vertices were looked at\n\n", rows[0].1.n_positive, rows[0].1.n_vertices);
    text += &table(
        ["map", "AUC", "NSS", "correlation", "without center"],
        rows.iter().map(|(name, a)| {
            let [auc, nss, cc, partial] = [a.auc, a.nss, a.correlation, a.partial_correlation]
                .map(|v| if v.is_nan() { "-".to_owned() } else { format!("{v:.3}") });
            [name.clone(), auc, nss, cc, partial]
        }),
    );
    let json = json!({
        "shape": analysis.input.name,
        "levels": analysis.schedule.n_levels(),
        "sides": sides.1,
        "maps": rows.iter().map(|(name, a)| json!({
            "map": name, "vertices": a.n_vertices, "looked_at": a.n_positive, "auc": a.auc, "nss": a.nss,
            "correlation": a.correlation, "partial_correlation": a.partial_correlation,
        })).collect::<Vec<_>>(),
    });
    print(global, &text, &json)
}

/// Repeatability under changes.
fn again(args: &EvaluateArgs, global: &Global<'_>, analysis: &mut Analysis) -> Result<(), CliError> {
    let reference = find(args, global, analysis)?;
    let geometry = analysis.decomposer.geometry();
    let area = match geometry.triangles() {
        [] => analysis.decomposer.areas().iter().sum(),
        triangles => surface_area(geometry.points(), triangles),
    };
    let mut rows: Vec<Again> = Vec::new();
    let percents = args.percents.iter().map(|p| (format!("noise {p} %"), Some(p / 100.0)));
    let kinds = percents.chain([("rotation".to_owned(), None)]);
    let mut changes: Vec<(String, Vec<Trial>)> = kinds
        .map(|(name, noise)| {
            let one = |seed: u64| match noise {
                Some(edges) => Trial::Change(Change::Noise { edges, seed }),
                None => Trial::Change(Change::Rotation { seed }),
            };
            (name, (1..=args.runs.max(1)).map(one).collect())
        })
        .collect();
    changes.push(("scaling by 7.3".to_owned(), vec![Trial::Change(Change::Scaling { factor: 7.3 })]));
    let is_mesh = !analysis.decomposer.geometry().triangles().is_empty();
    let resampling = if is_mesh { "4 × the faces" } else { "half the points" };
    changes.push((resampling.to_owned(), vec![Trial::Change(Change::Resampling { seed: 1 })]));
    if is_mesh {
        changes
            .push(("other vertices".to_owned(), (1..=args.runs.max(1)).map(Trial::OtherVertices).collect()));
    }
    for (name, changes) in changes {
        let mut row = Again { name, levels: Vec::new(), n_right: 0, n_found: 0, by_chance: 0.0 };
        let n_runs = changes.len() as f64;
        for step in changes {
            global.progress().check().map_err(|_| CliError::Cancelled)?;
            let changed = step.of(analysis, global)?;
            let found = find_again(args, global, analysis, &changed)?;
            let params = RepeatabilityParams { sigmas: args.within, ..RepeatabilityParams::default() };
            let levels = repeatability(&reference, &found, &changed, &params);
            row.n_right += n_right(&reference, &found, &changed, &params);
            row.n_found += found.len();
            row.by_chance += share_by_chance(&reference, &found, &changed, &params, area) / n_runs;
            if row.levels.is_empty() {
                row.levels = levels;
            } else {
                for (sum, level) in row.levels.iter_mut().zip(levels) {
                    sum.n_reference += level.n_reference;
                    sum.n_found += level.n_found;
                }
            }
        }
        rows.push(row);
    }
    let text = analysis.headline(args.field.name()) + "\n" + &repeatability_table(&reference, &rows);
    let json = json!({
        "shape": analysis.input.name,
        "levels": analysis.schedule.n_levels(),
        "sigma": analysis.sigma(),
        "features": reference.len(),
        "runs": args.runs.max(1),
        "changes": rows.iter().map(|row| json!({
            "change": row.name,
            "levels": row.levels.iter().map(level_json).collect::<Vec<_>>(),
            "found_features": row.n_found,
            "right": row.n_right,
            "precision": row.precision(),
            "share_by_chance": if row.by_chance.is_finite() { Some(row.by_chance) } else { None },
        })).collect::<Vec<_>>(),
    });
    print(global, &text, &json)
}

/// One change of the shape.
enum Trial {
    Change(Change),
    /// As many other vertices on the same surface, and other triangles, by that seed.
    OtherVertices(u64),
}

impl Trial {
    fn of(&self, analysis: &Analysis, global: &Global<'_>) -> Result<ChangedShape, CliError> {
        let shape = &analysis.input.shape;
        match (self, shape) {
            (Self::Change(step), _) => change(shape, &analysis.decomposer, step).map_err(CliError::input),
            (Self::OtherVertices(seed), Shape::Mesh(mesh)) => {
                let mesh =
                    resample_mesh(mesh, *seed, global.progress()).map_err(|e| CliError::classified(&e))?;
                Ok(ChangedShape::resampled(Shape::Mesh(mesh)))
            }
            _ => Err(CliError::Input("only a mesh gets other vertices".to_owned())),
        }
    }
}

fn level_json(l: &LevelRepeatability) -> Value {
    json!({"level": l.level, "features": l.n_reference, "found": l.n_found, "share": l.share()})
}

/// What became of the features under one kind of change, over all runs.
struct Again {
    name: String,
    levels: Vec<LevelRepeatability>,
    /// Features of the changed shapes that are one of the reference.
    n_right: usize,
    /// Features of the changed shapes.
    n_found: usize,
    by_chance: f64,
}

impl Again {
    /// The share of the features of the changed shapes that are right; `None` without any.
    fn precision(&self) -> Option<f64> {
        (self.n_found > 0).then(|| self.n_right as f64 / self.n_found as f64)
    }
}

/// A row a change; a column a level, then all levels and those from 4 on, what chance gives, and the share that is right.
fn repeatability_table(reference: &[Feature], rows: &[Again]) -> String {
    let mut text = format!(
        "{} features; share of them that is found again, by level; what chance finds again; share of what is found that is right\n\n",
        reference.len()
    );
    let levels: Vec<usize> =
        rows.first().map(|row| row.levels.iter().map(|l| l.level).collect()).unwrap_or_default();
    let line = |name: &str, cells: &[String]| {
        let mut line = format!("  {name:<18}");
        for cell in cells {
            let _ = write!(line, "{cell:>9}");
        }
        line + "\n"
    };
    let heads = levels
        .iter()
        .map(|l| format!("level {l}"))
        .chain(["all", "4 up", "chance", "right"].map(str::to_owned));
    text += &line("", &heads.collect::<Vec<_>>());
    let two_digits = |v: f64| if v.is_nan() { "-".to_owned() } else { format!("{v:.2}") };
    for row in rows {
        let Again { name, levels, .. } = row;
        let beside = [row.by_chance, row.precision().unwrap_or(f64::NAN)].map(two_digits);
        let share = |from: usize| {
            let kept = levels.iter().filter(|l| l.level >= from);
            let (n, of) = kept.fold((0, 0), |(n, of), l| (n + l.n_found, of + l.n_reference));
            if of == 0 { "-".to_owned() } else { format!("{:.2}", n as f64 / of as f64) }
        };
        let cells =
            levels.iter().map(|l| format!("{:.2}", l.share())).chain([share(0), share(4)]).chain(beside);
        text += &line(name, &cells.collect::<Vec<_>>());
    }
    text
}

fn find(args: &EvaluateArgs, global: &Global<'_>, analysis: &mut Analysis) -> Result<Vec<Feature>, CliError> {
    let params = args.detect.params(&args.border);
    let wavelets = analysis.wavelets(global, Some(params.response))?;
    features(&analysis.decomposer, &wavelets, &params, global.progress())
        .map_err(|e| CliError::classified(&e))
}

/// The features of a changed shape, on levels of the same widths.
fn find_again(
    args: &EvaluateArgs,
    global: &Global<'_>,
    analysis: &Analysis,
    changed: &ChangedShape,
) -> Result<Vec<Feature>, CliError> {
    let shape = &changed.shape;
    let decomposer = prepare(global, shape, &args.shape.operator_for(&args.levels)?)?;
    let same_vertices = shape.n_vertices() == analysis.input.shape.n_vertices();
    let is_own = ["coords", "normals", "mean-curvature", "gaussian-curvature", "shape-index", "density"]
        .contains(&args.field.name());
    let (n_channels, values) = if is_own {
        let file = ShapeFile::from_cloud(shape.points().unwrap_or_default().to_vec());
        let input = Input { file, shape: shape.clone(), name: analysis.input.name.clone() };
        let signal = signal::load(global, &input, args.field.name(), args.field.texture.as_deref())?;
        (signal.n_channels, signal.values.to_vec())
    } else if same_vertices {
        (analysis.signal.n_channels, analysis.signal.values.to_vec())
    } else {
        // A field of the file is not known at other vertices.
        return Ok(Vec::new());
    };
    let decomposer = match adwave::mask::missing(&values, n_channels) {
        Some(flags) => decomposer.masked(&flags).map_err(CliError::input)?,
        None => decomposer,
    };
    let step = changed.length_before(decomposer.diffusion().step_length());
    let sigma = &analysis.sigma()[1..];
    let dyadic = args.levels.steps.is_none() && !args.levels.by_width() && args.levels.voices.is_none();
    let schedule = if dyadic {
        let octaves = 2.0 * (sigma[sigma.len() - 1] / step).log2();
        Schedule::dyadic((1.0 + octaves.round()).max(3.0) as usize)?
    } else {
        Schedule::lengths(sigma, step)?
    };
    let params = bands_params(&args.levels)?;
    let request =
        decomposer.request(&values, n_channels, &schedule).params(&params).progress(global.progress());
    let params = args.detect.params(&args.border);
    let wavelets = if params.response == Response::Channels { request.wavelets() } else { request.norms() }?;
    features(&decomposer, &wavelets, &params, global.progress()).map_err(|e| CliError::classified(&e))
}
