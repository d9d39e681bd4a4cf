//! `adwave evaluate`: repeatability of features, and agreement of maps with eye fixations.

mod args;

use super::analysis::{Analysis, AnalysisArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, print, table};
use crate::resolve::levels::{check_levels, rescale_levels};
use crate::resolve::operator::{build_operator, check_operator, operator_for_analysis};
use crate::resolve::shape::{Carrier, Input};
use crate::resolve::signal::load_signal;
use adwave::Progress;
use adwave::features::{Feature, Response, ShapeCoordinates, coordinate_features, features};
use adwave::measure::{
    Agreement, Change, ChangedShape, LevelRepeatability, RepeatabilityParams, agreement, center_distance,
    change, n_right, repeatability, share_by_chance,
};
use adwave::saliency::MapWeighting;
use adwave::shape::Shape;
use adwave_io::ShapeFile;
use adwave_simplify::resample_mesh;
pub(crate) use args::EvaluateArgs;
use serde_json::{Value, json};
use std::fmt::Write;

pub(crate) fn run(args: &EvaluateArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.detect.to_params(&args.border).check().map_err(CliError::input)?;
    args.map.to_params(&args.border).check().map_err(CliError::input)?;
    check_task(args, global)?;
    let extent = args.fixations.is_some().then(|| args.map.weighting.extent());
    let (levels, walk) = (&args.levels, None);
    let is_of_paper = args.fixations.is_some() && args.map.weighting != MapWeighting::Signed;
    let what = AnalysisArgs { shape: &args.shape, signal: &args.signal, levels, is_of_paper, extent, walk };
    let mut analysis = Analysis::new(what, global)?;
    match &args.fixations {
        Some(fixations) => evaluate_agreement(args, global, &mut analysis, fixations),
        None => evaluate_repeatability(args, global, &mut analysis),
    }
}

/// Refuses the options of the task that is not asked for, and values that no task has.
fn check_task(args: &EvaluateArgs, global: &Global<'_>) -> Result<(), CliError> {
    const REPEATABILITY: [&str; 9] = [
        "--percent",
        "--runs",
        "--within",
        "--theta",
        "--response",
        "--per-component",
        "--refine",
        "--edge-ratio",
        "--best",
    ];
    const AGREEMENT: [&str; 6] = ["--map", "--threshold", "--skip", "--weighting", "--unsigned", "--up"];
    if args.fixations.is_some() {
        global.given.refuse(&REPEATABILITY, "applies to features, and --fixations evaluates maps")?;
    } else {
        global.given.refuse(&AGREEMENT, "applies to maps, which --fixations evaluates")?;
    }
    if !args.threshold.is_finite() {
        return Err(CliError::Input(format!("--threshold must be finite, got {}", args.threshold)));
    }
    if !(args.within.is_finite() && args.within > 0.0) {
        return Err(CliError::Input(format!("--within must be finite and above 0, got {}", args.within)));
    }
    if !(1..=MOST_RUNS).contains(&args.runs) {
        return Err(CliError::Input(format!("--runs must be in 1..={MOST_RUNS}, got {}", args.runs)));
    }
    if let Some(percent) = args.percents.iter().find(|p| !(p.is_finite() && **p >= 0.0)) {
        return Err(CliError::Input(format!(
            "--percent must be a finite noise of at least 0 % of the mean edge, got {percent}"
        )));
    }
    Ok(())
}

/// Largest number of times that a random change is made.
const MOST_RUNS: u64 = 1000;

/// Agreement of maps with fixations.
fn evaluate_agreement(
    args: &EvaluateArgs,
    global: &Global<'_>,
    analysis: &mut Analysis,
    fixations: &str,
) -> Result<(), CliError> {
    let found = analysis.saliency(&args.map, &args.border, global)?;
    let one_channel = |name: &str| {
        let signal = load_signal(global, &analysis.input, name, None)?;
        if signal.n_channels != 1 {
            return Err(CliError::Input(format!("{name} must have one channel, got {}", signal.n_channels)));
        }
        Ok(signal.values.to_vec())
    };
    let fixations = one_channel(fixations)?;
    let sides = (found.sides(), found.sides_json());
    let saliency_map = found.saliency.map;
    let control = analysis.input.shape.points().map(center_distance);
    let mut maps = vec![(format!("saliency of {}", analysis.name.as_str()), saliency_map)];
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
    let mut text = analysis.headline();
    text += &format!("{}\n", sides.0);
    text += &format!("{} of {} vertices count as looked at\n\n", rows[0].1.n_positive, rows[0].1.n_vertices);
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

/// Repeatability of features under changes of the shape.
fn evaluate_repeatability(
    args: &EvaluateArgs,
    global: &Global<'_>,
    analysis: &mut Analysis,
) -> Result<(), CliError> {
    let reference = find(args, global, analysis)?;
    let geometry = analysis.decomposer.geometry_for("repeatability")?;
    let area = if geometry.faces().is_empty() {
        analysis.decomposer.areas().iter().sum()
    } else {
        geometry.area_of(geometry.points())
    };
    let mut rows: Vec<Repetition> = Vec::new();
    let percents = args.percents.iter().map(|p| (format!("noise {p} %"), Some(p / 100.0)));
    let kinds = percents.chain([("rotation".to_owned(), None)]);
    let mut changes: Vec<(String, Vec<Trial>)> = kinds
        .map(|(name, noise)| {
            let one = |seed: u64| match noise {
                Some(edges) => Trial::Change(Change::Noise { edges, seed }),
                None => Trial::Change(Change::Rotation { seed }),
            };
            (name, (1..=args.runs).map(one).collect())
        })
        .collect();
    changes.push(("scaling by 7.3".to_owned(), vec![Trial::Change(Change::Scaling { factor: 7.3 })]));
    let is_mesh = !geometry.triangles().is_empty();
    let resampling = if is_mesh { "4 × the faces" } else { "half the points" };
    changes.push((resampling.to_owned(), vec![Trial::Change(Change::Resampling { seed: 1 })]));
    if is_mesh {
        changes.push(("other vertices".to_owned(), (1..=args.runs).map(Trial::OtherVertices).collect()));
    }
    for (name, changes) in changes {
        let mut row = Repetition { name, levels: Vec::new(), n_right: 0, n_found: 0, by_chance: 0.0 };
        let n_runs = changes.len() as f64;
        for step in changes {
            global.progress().check().map_err(|_| CliError::Cancelled)?;
            let changed = step.apply(analysis, global)?;
            let found = find_again(args, global, analysis, &changed)?;
            let params = RepeatabilityParams::default().with_sigmas(args.within);
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
    let text = analysis.headline() + "\n" + &repeatability_table(&reference, &rows);
    let json = json!({
        "shape": analysis.input.name,
        "levels": analysis.schedule.n_levels(),
        "sigma": analysis.sigma(),
        "features": reference.len(),
        "runs": args.runs,
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
    /// As many other vertices on the same surface, with other triangles, drawn with this seed.
    OtherVertices(u64),
}

impl Trial {
    /// The changed shape.
    fn apply(&self, analysis: &Analysis, global: &Global<'_>) -> Result<ChangedShape, CliError> {
        let shape = &analysis.input.shape;
        match (self, shape) {
            (Self::Change(step), _) => change(shape, &analysis.decomposer, step).map_err(CliError::input),
            (Self::OtherVertices(seed), Shape::Mesh(mesh)) => {
                let mesh =
                    resample_mesh(mesh, *seed, global.progress()).map_err(|e| CliError::classify(&e))?;
                Ok(ChangedShape::resampled(Shape::Mesh(mesh)))
            }
            _ => Err(CliError::Input("only a mesh can get other vertices".to_owned())),
        }
    }
}

fn level_json(l: &LevelRepeatability) -> Value {
    json!({"level": l.level, "features": l.n_reference, "found": l.n_found, "share": l.share()})
}

/// Features under one kind of change, over all runs.
struct Repetition {
    name: String,
    levels: Vec<LevelRepeatability>,
    /// Features of the changed shapes that are one of the reference.
    n_right: usize,
    /// Features of the changed shapes.
    n_found: usize,
    by_chance: f64,
}

impl Repetition {
    /// The share of the features of the changed shapes that are features of the reference; `None` if there are none.
    fn precision(&self) -> Option<f64> {
        (self.n_found > 0).then(|| self.n_right as f64 / self.n_found as f64)
    }
}

/// A table with a row per change: a column per level, all levels, levels from 4 on, the share found by chance, and the
/// precision.
fn repeatability_table(reference: &[Feature], rows: &[Repetition]) -> String {
    let mut text = format!(
        "{}; columns: share found again by level, share found again by chance, share of the found ones that are right\n\n",
        count(reference.len(), "feature", "features")
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
        let Repetition { name, levels, .. } = row;
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
    let params = args.detect.to_params(&args.border);
    Ok(analysis.features(&params, global)?.features)
}

/// The features of a changed shape, on levels of the same widths.
fn find_again(
    args: &EvaluateArgs,
    global: &Global<'_>,
    analysis: &Analysis,
    changed: &ChangedShape,
) -> Result<Vec<Feature>, CliError> {
    let shape = &changed.shape;
    let operator = operator_for_analysis(&args.shape.operator, &args.levels, shape)?;
    check_operator(shape, &operator, global)?;
    let build = |progress: Progress<'_>| build_operator(shape, &operator, progress);
    let decomposer = with_progress(global, "preparing", build)?;
    let same_vertices = shape.n_vertices() == analysis.input.shape.n_vertices();
    let is_surface_signal =
        ["coords", "normals", "mean-curvature", "gaussian-curvature", "shape-index", "density"]
            .contains(&analysis.name.as_str());
    let (n_channels, values) = if is_surface_signal {
        let file = ShapeFile::from_cloud(shape.points().unwrap_or_default().to_vec());
        let input = Input {
            file,
            shape: shape.clone(),
            name: analysis.input.name.clone(),
            allows_degrees: analysis.input.allows_degrees,
            mesh_of_cells: None,
            carrier: Carrier::Shape,
        };
        let signal = load_signal(global, &input, analysis.name.as_str(), args.signal.texture.as_deref())?;
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
    let step_length = changed.length_before(decomposer.operator().step_length());
    let schedule = rescale_levels(&args.levels.to_spec(), &analysis.sigma()[1..], step_length)?;
    let bands = check_levels(&args.levels)?;
    let params = args.detect.to_params(&args.border);
    if analysis.is_geometry() && params.finds_significant(&decomposer) {
        let points = shape.points().unwrap_or_default();
        let coordinates = ShapeCoordinates { points, normals: None, schedule: &schedule, bands };
        let found = coordinate_features(&decomposer, &coordinates, &params, global.progress());
        return Ok(found.map_err(|e| CliError::classify(&e))?.features);
    }
    let request =
        decomposer.request(&values, n_channels, &schedule).params(&bands).progress(global.progress());
    let wavelets = if params.response == Response::Channels { request.wavelets() } else { request.norms() }?;
    features(&decomposer, &wavelets, &params, global.progress()).map_err(|e| CliError::classify(&e))
}
