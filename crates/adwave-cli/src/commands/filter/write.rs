//! The result of a filter as a file, as a recipe, and as a report.

use super::compute::{BandsAccuracy, Filtered, SignalChange};
use super::resolve::{FilterJob, SavedLevels};
use crate::commands::result_file::EditedSignal;
use crate::error::CliError;
use crate::global::Global;
use crate::output::denoising::describe_local_fit;
use crate::output::movement::Movement;
use crate::output::{count, number, print, steps_json, write_file_with};
use crate::resolve::pose::ReshapedBy;
use crate::resolve::shape::Input;
use crate::resolve::signal::COORDS;
use crate::resolve::turned::turn_parts;
use adwave::bands::Precision;
use adwave::filter::Layer;
use adwave::region::Length;
use adwave::shape::surface_parts;
use adwave::{Decomposer, LevelSpec, Progress};
use adwave_io::{Recipe, write_recipe};
use serde_json::json;
use std::fmt::Write;

/// Writes the result of a job and reports it.
pub(super) fn write(mut job: FilterJob<'_>, filtered: Filtered, global: &Global<'_>) -> Result<(), CliError> {
    let saved_levels = job.save_recipe.map(|saved| levels_to_save(&job, &filtered, saved.levels));
    let is_in_time_alone = job.is_in_time_alone();
    let Filtered { decomposer, schedule, layers, edited, change, accuracy, quantity } = filtered;
    let (signal, output) = (std::mem::take(&mut job.signal_name), job.result.path().display().to_string());
    let n_vertices = job.input.shape.n_vertices();
    let sigma = schedule.sigma(decomposer.operator().step_length());
    let levels = if is_in_time_alone {
        String::new()
    } else {
        format!(", {}", count(schedule.n_levels(), "level", "levels"))
    };
    let mut text = format!("{}: {}{levels}\n", job.input.name, job.input.count_rows());
    let mut report = json!({
        "shape": job.input.name,
        "output": output,
        "field": signal,
        "operator": decomposer.operator_kind().name(),
        job.input.row_words()[1]: n_vertices,
        "steps": steps_json(&schedule.steps_from_zero()),
        "sigma": sigma,
        "layers": layers,
    });
    if let Some(fit) = job.local_fit.filter(|_| !is_in_time_alone) {
        let fit = decomposer.applied_local_fit(fit);
        describe_local_fit(&mut text, fit);
        report["local_fit"] = json!(fit);
    }
    if let Some(quantity) = quantity {
        quantity.describe(&mut text);
        quantity.add_to(&mut report);
    }
    if let Some((time, gains)) = &job.time {
        time.describe(&mut text, Some(gains));
        report["time"] = time.to_json(Some(gains));
        if let Some(rows) = &job.gains_by_time {
            describe_gains_by_time(rows, &mut text, &mut report);
        }
    }
    if let EditedSignal::Points(points) = &edited {
        let geometry = decomposer.geometry_for("a report of the movement")?;
        let movement = Movement::measure(geometry, points)?.in_file_rows(&job.input.file);
        movement.describe(&mut text);
        movement.add_to(&mut report);
        if let Some(widest) = sigma.last().filter(|_| signal == COORDS) {
            movement.note_unusual(*widest, global);
        }
    } else {
        describe_change(&job.input, job.labels.as_deref(), &signal, &change, &mut text, &mut report);
    }
    if let Some(by) = &job.reshaped_by {
        describe_reshape(by, &mut text, &mut report);
    }
    if let Some(BandsAccuracy { precision, error_bound }) = accuracy {
        if precision == Precision::Single {
            let _ = writeln!(text, "single precision: bands are off by at most {}", number(error_bound));
        }
        report["bands"] = json!({"precision": precision.name(), "error_bound": error_bound});
    }
    if !job.turned.is_empty() {
        turn_faces(&mut job, &decomposer, &mut text, &mut report)?;
    }
    job.result.write(&mut job.input, &signal, edited, job.normals, global)?;
    let _ = writeln!(text, "{output}");
    if let (Some(saved), Some(levels)) = (job.save_recipe, saved_levels) {
        let recipe = recipe_to_save(&job, signal, levels, layers);
        write_file_with(global, saved.path, |path| write_recipe(path, &recipe))?;
        let _ = writeln!(text, "{}", saved.path.display());
    }
    print(global, &text, &report)
}

/// Turns over the faces of the parts that the recipe names, and adds their number.
fn turn_faces(
    job: &mut FilterJob<'_>,
    decomposer: &Decomposer,
    text: &mut String,
    report: &mut serde_json::Value,
) -> Result<(), CliError> {
    let parts = surface_parts(decomposer.geometry_for("parts of a surface")?, Progress::none())?;
    let turned = turn_parts(&mut job.input, &parts, &job.turned)?;
    turned.describe(text);
    turned.add_to(report);
    Ok(())
}

/// The recipe of a job.
fn recipe_to_save(job: &FilterJob<'_>, field: String, levels: LevelSpec, layers: Vec<Layer>) -> Recipe {
    Recipe {
        field,
        operator: Some(job.operator.kind),
        density_invariant: job.operator.density_invariant,
        keep_creases: job.operator.keep_creases,
        local_fit: job.local_fit,
        positions: job.positions,
        levels,
        layers,
        clones: job.reshaped_by.as_ref().map_or_else(Vec::new, |by| by.clones.clone()),
        pose: job.reshaped_by.as_ref().and_then(|by| by.pose.clone()),
        turned: job.turned.clone(),
    }
}

/// Adds the gains in space for each band along time.
fn describe_gains_by_time(rows: &[Vec<f64>], text: &mut String, report: &mut serde_json::Value) {
    let row = |row: &Vec<f64>| row.iter().map(|gain| number(*gain)).collect::<Vec<_>>().join(", ");
    let listed = rows.iter().map(row).collect::<Vec<_>>().join("; ");
    let _ = writeln!(text, "gains in space for each band along time, and for the rest: {listed}");
    report["time"]["gains_by_time"] = json!(rows);
    report["layers"] = json!([]);
}

/// Adds the change of a field: how many labels are others, or by how much numbers differ.
fn describe_change(
    input: &Input,
    labels: Option<&[f64]>,
    signal: &str,
    change: &SignalChange,
    text: &mut String,
    report: &mut serde_json::Value,
) {
    if let Some(labels) = labels {
        let (n_labels, n_changed) = (labels.len(), change.n_changed);
        let different = count(n_labels, "label", "labels");
        let _ = writeln!(text, "{signal}: {different}, changed at {n_changed} of {}", input.count_rows());
        report["labels"] = json!({"different": n_labels, "changed": n_changed});
    } else {
        let (rms, max, rows) = (number(change.rms), number(change.max), input.row_words()[1]);
        let _ = writeln!(text, "{signal} changed by {rms} (rms over the {rows}), {max} at most");
        report["changed"] = json!({"rms": change.rms, "max": change.max});
    }
}

/// Adds the clones and handles of the recipe.
fn describe_reshape(by: &ReshapedBy, text: &mut String, report: &mut serde_json::Value) {
    let n_clones: usize = by.clones.iter().map(|clone| clone.targets.len()).sum();
    let n_handles = by.pose.as_ref().map_or(0, |pose| pose.handles.len());
    let (clones, handles) = (count(n_clones, "clone", "clones"), count(n_handles, "handle", "handles"));
    let _ = writeln!(text, "then {clones} of detail, and a bend by {handles}");
    report["clones"] = json!(n_clones);
    report["handles"] = json!(n_handles);
}

/// The levels of the recipe that is saved: widths as they were asked for, unless keeping the volume added levels; or
/// steps.
fn levels_to_save(job: &FilterJob<'_>, filtered: &Filtered, form: SavedLevels) -> LevelSpec {
    let schedule = &filtered.schedule;
    let step_length = filtered.decomposer.operator().step_length();
    if form == SavedLevels::Steps || step_length <= 0.0 {
        return LevelSpec::Steps(schedule.steps().to_vec());
    }
    match &job.levels.spec {
        LevelSpec::Widths(widths) if widths.len() == schedule.n_levels() => job.levels.spec.clone(),
        _ => {
            let sigma = schedule.sigma(step_length);
            LevelSpec::Widths(sigma[1..].iter().map(|&sigma| Length::Units(sigma)).collect())
        }
    }
}
