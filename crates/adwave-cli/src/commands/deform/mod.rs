//! `adwave deform`: a shape bent by handles.

mod args;
mod motion;

use super::moved_shape::MovedShape;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, count, note, number, output_format, percent_of};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::pose::{BentShape, bend};
use crate::resolve::region::{note_region, region_weights, union_of_regions};
use crate::resolve::shape::{GivenLength, Input, load_shape};
use adwave::operator::OperatorTask;
use adwave::region::Region;
use adwave::{Decomposer, Progress};
use adwave_deform::{DeformInfo, DeformParams, DeformRegions, Deformer, NewCrossings, blend_poses};
use adwave_io::{Pose, read_recipe};
pub(crate) use args::DeformArgs;
use motion::MotionText;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

pub(crate) fn run(args: &DeformArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.width.check()?;
    output_format(&args.output)?;
    check_writable(&args.output)?;
    let motions: Vec<&MotionText> =
        args.by.iter().chain(&args.to).chain(&args.turn).chain(&args.matrix).collect();
    if args.recipe.is_empty() && motions.len() != args.handles.len() {
        return Err(CliError::Input(format!(
            "each --move needs one motion (--by, --to, --turn or --matrix), got {} for {}",
            count(motions.len(), "motion", "motions"),
            count(args.handles.len(), "handle", "handles")
        )));
    }
    let pose = pose_of_recipes(args, global)?;
    let input = load_shape(&args.shape, global)?;
    let stiffness = args.stiffness.map(|length| GivenLength { option: "--stiffness", length });
    input.check_lengths(&[args.width.given_lengths(), stiffness.into_iter().collect()].concat())?;
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    if let Some(pose) = pose {
        let bent = with_progress(global, "bending", |progress| bend(&pose, &input, &decomposer, progress))?;
        return write_bent(input, &decomposer, &bent, args, global);
    }
    let schedule = args.width.resolve(&decomposer)?;
    let regions = with_progress(global, "measuring", |progress| {
        resolve_regions(args, &input, &decomposer, global, progress)
    })?;
    let params = DeformParams::default()
        .with_stiffness(args.stiffness.map(|length| length.to_model_units(decomposer.extent())))
        .with_keep_lengths(args.keep_lengths);
    let bind = |progress: Progress<'_>| Deformer::bind(&decomposer, &schedule, &regions, &params, progress);
    let mut deformer = with_progress(global, "binding", bind)?;
    let rest = input.shape.points().unwrap_or_default();
    for (k, (motion, handle)) in motions.iter().zip(&regions.handles).enumerate() {
        deformer.set(k + 1, motion.resolve(center(rest, handle))?)?;
    }
    let info = with_progress(global, "bending", |progress| deformer.solve(progress))?;
    write_bent(input, &decomposer, &BentShape { deformer, info }, args, global)
}

/// Prints notes and writes the bent shape.
fn write_bent(
    input: Input,
    decomposer: &Decomposer,
    BentShape { deformer, info }: &BentShape,
    args: &DeformArgs,
    global: &Global<'_>,
) -> Result<(), CliError> {
    note_parts(deformer, info, global);
    let (text, mut report) = describe(&input, decomposer, deformer, info);
    let points = deformer.points();
    let crossings =
        with_progress(global, "looking for crossings", |progress| deformer.new_crossings(progress))?;
    warn_of_crossings(&crossings, deformer.keep_lengths(), global);
    report["new_crossings"] = json!(crossings.n_pairs);
    MovedShape { input, decomposer, points, text, report }.write(&args.output, global)
}

/// The pose of a recipe, or the blend of several; `None` without a recipe.
fn pose_of_recipes(args: &DeformArgs, global: &Global<'_>) -> Result<Option<Pose>, CliError> {
    let poses: Vec<Pose> =
        args.recipe.iter().map(|path| pose_of_recipe(path, global)).collect::<Result<_, _>>()?;
    if poses.is_empty() && !args.shares.is_empty() {
        let text =
            "--shares applies to the poses of --recipe, and there is none; add --recipe FILE or leave it out";
        return Err(CliError::Input(text.to_owned()));
    }
    if poses.len() <= 1 && args.shares.is_empty() {
        return Ok(poses.into_iter().next());
    }
    Ok(Some(blend_poses(&poses, &args.shares)?))
}

/// The pose of a recipe; a note tells that its layers are not applied.
fn pose_of_recipe(path: &Path, global: &Global<'_>) -> Result<Pose, CliError> {
    global.inputs.add_file(path);
    let recipe = read_recipe(path).map_err(CliError::input)?;
    let n_layers = recipe.layers.len();
    let Some(pose) = recipe.pose.filter(|pose| !pose.handles.is_empty()) else {
        let name = path.display();
        return Err(CliError::Input(format!(
            "{name}: a pose must have a [[pose.handle]], got none; add one"
        )));
    };
    if n_layers > 0 {
        let layers = count(n_layers, "layer", "layers");
        note(global, &format!("{layers} of the recipe are not applied; adwave filter --recipe applies all"));
    }
    Ok(pose)
}

/// Mean position of some vertices.
fn center(points: &[[f64; 3]], vertices: &[u32]) -> [f64; 3] {
    let share = 1.0 / vertices.len().max(1) as f64;
    let sum = |c: usize| vertices.iter().map(|&v| share * points[v as usize][c]).sum();
    [sum(0), sum(1), sum(2)]
}

/// Vertices of the regions: those with a weight above 0.
fn resolve_regions(
    args: &DeformArgs,
    input: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
    progress: Progress<'_>,
) -> Result<DeformRegions, CliError> {
    let vertices = |region: &Region| -> Result<Vec<u32>, CliError> {
        let weights = region_weights(region, input, decomposer, progress)?;
        note_region(region, &input.file, decomposer, global)?;
        Ok((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
    };
    let fixed = if args.fix.is_empty() { Vec::new() } else { vertices(&union_of_regions(&args.fix))? };
    if fixed.is_empty() && !args.fix.is_empty() {
        return Err(CliError::Input("--fix holds no vertex; enlarge the region".to_owned()));
    }
    let handles = args.handles.iter().map(vertices).collect::<Result<_, _>>()?;
    Ok(DeformRegions { fixed, handles })
}

/// Prints notes on parts without a handle, on a free shape, and on a solve that did not end.
fn note_parts(deformer: &Deformer, info: &DeformInfo, global: &Global<'_>) {
    let bound = deformer.info();
    if bound.n_following_parts > 0 {
        let parts = count(bound.n_following_parts, "part has", "parts have");
        let vertices = count(bound.n_following_vertices, "vertex", "vertices");
        note(global, &format!("{parts} no handle ({vertices}); they follow the nearest part that has one"));
    }
    if bound.is_free {
        let text = if deformer.regions().handles.len() == 1 {
            "nothing is fixed, so the whole shape makes the motion of its handle (--fix REGION)"
        } else {
            "nothing is fixed; the handles alone say where the shape goes (--fix REGION)"
        };
        note(global, text);
    }
    if !info.is_converged {
        note(
            global,
            "the bend had not come to rest; give the handles a smaller motion, or a greater --stiffness",
        );
    }
}

/// Warns of triangles that cross and did not before, and names the largest place.
fn warn_of_crossings(crossings: &NewCrossings, keep_lengths: f64, global: &Global<'_>) {
    let Some(place) = crossings.places.first() else { return };
    let [x, y, z] = place.point.map(number);
    let pairs = count(crossings.n_pairs, "pair of triangles crosses", "pairs of triangles cross");
    let others = match crossings.places.len() - 1 {
        0 => String::new(),
        n => format!(" and at {}", count(n, "other place", "other places")),
    };
    let advice = if keep_lengths < 1.0 { ", or keep lengths (--keep-lengths 1)" } else { "" };
    note(
        global,
        &format!(
            "{pairs} that did not before, most near vertex {} ({x}, {y}, {z}){others}; give the handles a smaller motion \
             or other regions{advice}",
            place.vertex
        ),
    );
}

/// Lines and numbers about the bend.
fn describe(
    input: &Input,
    decomposer: &Decomposer,
    deformer: &Deformer,
    info: &DeformInfo,
) -> (String, serde_json::Value) {
    let (bound, regions) = (deformer.info(), deformer.regions());
    let moved: usize = regions.handles.iter().map(Vec::len).sum();
    let mut text = format!(
        "{}: {} fixed, {} in {}\n",
        input.name,
        count(regions.fixed.len(), "vertex", "vertices"),
        count(moved, "vertex", "vertices"),
        count(regions.handles.len(), "handle", "handles"),
    );
    let _ = writeln!(
        text,
        "base of σ {}, {} % of the diagonal, moved by {}; bending length {}; {}",
        number(bound.sigma),
        percent_of(bound.sigma, decomposer.extent()),
        count(bound.n_nodes, "node", "nodes"),
        number(bound.stiffness),
        count(info.n_steps, "step", "steps"),
    );
    if deformer.keep_lengths() > 0.0 {
        let steps = count(info.n_length_steps, "further step", "further steps");
        let _ = writeln!(text, "lengths kept at a share of {}; {steps}", number(deformer.keep_lengths()));
    }
    let report = json!({
        "sigma": bound.sigma,
        "nodes": bound.n_nodes,
        "stiffness": bound.stiffness,
        "fixed": regions.fixed.len(),
        "handles": regions.handles.iter().map(Vec::len).collect::<Vec<_>>(),
        "following_parts": bound.n_following_parts,
        "following_vertices": bound.n_following_vertices,
        "steps": info.n_steps,
        "keep_lengths": deformer.keep_lengths(),
        "length_steps": info.n_length_steps,
        "energy": info.energy_after,
        "converged": info.is_converged,
    });
    (text, report)
}
