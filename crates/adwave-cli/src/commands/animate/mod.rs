//! `adwave animate`: frames of one connectivity, a shape that moves. [`frames`] reads and writes them, [`motion`] is what is
//! done to the motion.

mod args;
mod frames;
mod motion;

use crate::commands::denoise::describe_series;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::{holds_fields, unsuitable_format};
use crate::output::{check_writable, count, has_extension, note, number, print, steps_json, write_shape};
use crate::resolve::levels::{check_levels, resolve_spec};
use crate::resolve::time::{StepSource, TimeBands};
use adwave::bands::{BandsError, DEFAULT_EXTENT, Schedule};
use adwave::denoise::{DenoiseParams, denoise_series};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::time::TimeAxis;
use adwave::{Decomposer, LevelSpec, Progress};
use adwave_io::{Field, FieldValues, Format, MovedNormals};
pub(crate) use args::AnimateArgs;
use frames::{FrameSource, Frames};
use serde_json::json;
use std::fmt::Write;

/// Seconds from frame to frame if nothing says it.
const STEP: f64 = 1.0;

/// Options that need bands in space.
const LEVEL_OPTIONS: [&str; 6] = ["--levels", "--voices", "--steps", "--lengths", "--fwhm", "--accuracy"];

pub(crate) fn run(args: &AnimateArgs, global: &Global<'_>) -> Result<(), CliError> {
    check(args, global)?;
    let given_step = args.time.axis.time_step;
    let source = FrameSource {
        frames: &args.frames,
        positions: args.positions.as_deref(),
        animation: args.animation.as_deref(),
        step: given_step,
    };
    let mut frames = Frames::read(&source, global)?;
    frames.check_output(&args.output)?;
    let (n_frames, n) = (frames.length, frames.shape.n_vertices());
    let stated = frames.step;
    let step = given_step.or(stated).unwrap_or(STEP);
    let is_glb = Format::from_path(&args.output) == Some(Format::GLB);
    let needs_step = args.time.widths().is_some() || is_glb;
    if given_step.is_none() && stated.is_none() && needs_step {
        note(
            global,
            "the frames are taken as 1 s apart; --time-step says how far they are, such as --time-step 40ms",
        );
    }
    let axis = TimeAxis::new(n_frames, step)
        .and_then(|axis| axis.with_ends(args.time.axis.time_ends.unwrap_or_default()))
        .map_err(|e| CliError::Input(format!("{}: {e}", args.frames)))?;
    let mut text = format!(
        "{}: {} of {}, one every {} s\n",
        args.frames,
        count(n_frames, "frame", "frames"),
        count(n, "vertex", "vertices"),
        number(step)
    );
    let mut report = json!({"frames": n_frames, "vertices_per_frame": n, "step": step, "output": args.output.display().to_string()});
    let unknown = motion::unknown(&frames);
    note_unknown(unknown.as_deref(), global);
    if args.still {
        with_progress(global, "moving", |progress| {
            take_motion_out(args, &mut frames, unknown.as_deref(), &mut text, &mut report, progress)
        })?;
    }
    let needs_domain = args.denoise || args.gains.is_some() || args.motion.is_some();
    let decomposer = needs_domain.then(|| prepare(&frames, unknown.as_deref(), global)).transpose()?;
    let before = frames.positions.clone();
    if let Some(decomposer) = decomposer.as_ref().filter(|_| args.denoise) {
        let params = DenoiseParams::default().with_strength(args.strength.unwrap_or(1.0));
        let denoised = with_progress(global, "denoising", |progress| {
            denoise_series(decomposer, &axis, before.as_flattened(), 3, &params, progress)
        })
        .map_err(|e| CliError::classify(&e))?;
        frames.positions = restored(unknown.as_deref(), &before, &denoised.values);
        describe_series(&mut text, &axis, &denoised.info);
        report["denoise"] = json!(denoised.info);
    }
    let source = match (given_step, stated) {
        (Some(_), _) => StepSource::Option,
        (None, Some(_)) => StepSource::File,
        (None, None) => StepSource::Assumed,
    };
    if let Some(time) = TimeBands::resolve_on_axis(&args.time, axis, source)? {
        let gains = args.time_gains.clone().unwrap_or_else(|| vec![0.0; time.widths.len()]);
        time.check_gains(&gains)?;
        with_progress(global, "filtering", |progress| {
            time.filter_components(frames.positions.as_flattened_mut(), 3, &gains, progress)
        })?;
        time.describe(&mut text, Some(&gains));
        report["time"] = time.to_json(Some(&gains));
    }
    if let Some(decomposer) = &decomposer {
        edit_in_space(args, decomposer, &mut frames, global, &mut text, &mut report)?;
    }
    let change = motion::rms_change(&before, &frames.positions);
    drop(before);
    let _ = writeln!(text, "positions changed by {} (rms over vertices and frames)", number(change));
    report["changed"] = json!(change);
    let written = frames.write(&args.output, step, global)?;
    let _ = writeln!(text, "{written}");
    print(global, &text, &report)
}

/// Says how many vertices have no position in some frames.
fn note_unknown(unknown: Option<&[bool]>, global: &Global<'_>) {
    let Some(unknown) = unknown else { return };
    let n_unknown = unknown.iter().filter(|flag| **flag).count();
    let vertices = count(n_unknown, "vertex has", "vertices have");
    note(global, &format!("{vertices} no position in some frames; these stay as they are in all"));
}

/// Turns and moves the frames onto their mean, and says how far.
fn take_motion_out(
    args: &AnimateArgs,
    frames: &mut Frames,
    unknown: Option<&[bool]>,
    text: &mut String,
    report: &mut serde_json::Value,
    progress: Progress<'_>,
) -> Result<(), CliError> {
    let found = motion::take_motion_out(frames, unknown, progress).map_err(|_| CliError::Cancelled)?;
    let Some([turn, way]) = found else {
        return Err(CliError::Input(format!(
            "--still needs points that are not on a line, and those of {} are",
            args.frames
        )));
    };
    let (degrees, distance) = (number(turn), number(way));
    let _ =
        writeln!(text, "motion of the whole taken out: turns of up to {degrees}°, ways of up to {distance}");
    report["still"] = json!({"degrees": turn, "way": way});
    Ok(())
}

/// Refuses options that apply to nothing, and results that cannot be written.
fn check(args: &AnimateArgs, global: &Global<'_>) -> Result<(), CliError> {
    if args.time.widths().is_none() {
        let applies = "applies to bands along time (--time-fwhm or --time-lengths)";
        global.given.refuse(&["--time-gains"], applies)?;
        if !args.denoise {
            global.given.refuse(&["--time-ends"], "applies to bands along time and to --denoise")?;
        }
    }
    if args.gains.is_none() && args.motion.is_none() {
        global
            .given
            .refuse(&LEVEL_OPTIONS, "applies to bands in space; give --gains for them, or --motion")?;
    }
    if let Some(path) = &args.motion {
        check_writable(path)?;
        if !holds_fields(path) {
            return Err(unsuitable_format(path, "maps of the motion are", &[]));
        }
    }
    if has_extension(&args.output, &["npy"]) || Format::from_path(&args.output) == Some(Format::GLB) {
        check_writable(&args.output)?;
    }
    Ok(())
}

/// The first frame with heat on it, without the vertices that are unknown.
fn prepare(frames: &Frames, unknown: Option<&[bool]>, global: &Global<'_>) -> Result<Decomposer, CliError> {
    let shape = frames.shape.to_shape()?;
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let whole =
        with_progress(global, "preparing", |progress| Decomposer::with_params(&shape, &params, progress))
            .map_err(|_| CliError::Cancelled)?;
    match unknown {
        Some(unknown) => whole.masked(unknown).map_err(|e| CliError::classify(&e)),
        None => Ok(whole),
    }
}

/// New positions, but for the vertices that are unknown, which keep those `before`.
fn restored(unknown: Option<&[bool]>, before: &[[f64; 3]], values: &[f64]) -> Vec<[f64; 3]> {
    let mut positions = values.as_chunks().0.to_vec();
    let Some(unknown) = unknown else { return positions };
    let n_frames = before.len() / unknown.len();
    for (x, _) in unknown.iter().enumerate().filter(|(_, is_unknown)| **is_unknown) {
        let own = x * n_frames..(x + 1) * n_frames;
        positions[own.clone()].copy_from_slice(&before[own]);
    }
    positions
}

/// Scales the bands in space of the motion, and writes its map.
fn edit_in_space(
    args: &AnimateArgs,
    decomposer: &Decomposer,
    frames: &mut Frames,
    global: &Global<'_>,
    text: &mut String,
    report: &mut serde_json::Value,
) -> Result<(), CliError> {
    if args.gains.is_none() && args.motion.is_none() {
        return Ok(());
    }
    let schedule = schedule(args, decomposer, global)?;
    let sigma = schedule.sigma(decomposer.operator().step_length());
    let widths: Vec<String> = sigma[1..].iter().map(|sigma| number(*sigma)).collect();
    let _ = writeln!(
        text,
        "bands of the motion in space, by heat on the first frame: widths σ {}",
        widths.join(", ")
    );
    report["steps"] = json!(steps_json(&schedule.steps_from_zero()));
    report["sigma"] = json!(sigma);
    let failed = |error: BandsError| match error {
        BandsError::Cancelled(_) => CliError::Cancelled,
        other => CliError::classify(&other),
    };
    if let Some(gains) = &args.gains {
        let n_levels = schedule.n_levels();
        if gains.len() != n_levels && gains.len() != n_levels + 1 {
            return Err(CliError::Input(format!(
                "--gains must have a number for each band, {n_levels}, and may have one more for the rest, got {}",
                gains.len()
            )));
        }
        if gains.len() == n_levels && args.levels.to_spec() == LevelSpec::Default {
            let text = format!(
                "larger motion than σ = {} stays; name the sizes by --fwhm or --lengths, and the last gain may be that of the rest",
                number(sigma[n_levels])
            );
            note(global, &text);
        }
        with_progress(global, "filtering", |progress| {
            motion::scale_bands(decomposer, frames, &schedule, gains, progress)
        })
        .map_err(failed)?;
        report["gains"] = json!(gains);
    }
    let Some(path) = &args.motion else { return Ok(()) };
    let maps = with_progress(global, "measuring", |progress| {
        motion::motion_maps(decomposer, frames, &schedule, progress)
    })
    .map_err(failed)?;
    let mut file = frames.shape.clone();
    file.move_points(frames.mean(), MovedNormals::Follow, global.progress())?;
    let mut means = Vec::with_capacity(maps.len());
    for (k, map) in maps.into_iter().enumerate() {
        let is_rest = k == schedule.n_levels();
        let name = if is_rest { "motion_rest".to_owned() } else { format!("motion_{}", k + 1) };
        let known = map.iter().filter(|v| v.is_finite());
        let square: f64 = known.clone().map(|v| v * v).sum::<f64>() / known.count().max(1) as f64;
        means.push(square.sqrt());
        file.add_vertex_field(Field::new(name, 1, FieldValues::F64(map)))?;
    }
    let listed: Vec<String> = means.iter().map(|mean| number(*mean)).collect();
    let _ = writeln!(text, "motion by band, fine to coarse, and the rest (rms): {}", listed.join(", "));
    report["motion"] = json!(means);
    write_shape(global, &file, path)?;
    let _ = writeln!(text, "{}", path.display());
    Ok(())
}

/// The levels that are asked for, else one for each gain, else the default.
fn schedule(args: &AnimateArgs, decomposer: &Decomposer, global: &Global<'_>) -> Result<Schedule, CliError> {
    check_levels(&args.levels)?;
    let spec = match (args.levels.to_spec(), &args.gains) {
        (LevelSpec::Default, Some(gains)) => LevelSpec::Dyadic(gains.len()),
        (spec, _) => spec,
    };
    Ok(resolve_spec(&spec, DEFAULT_EXTENT, decomposer, global)?.schedule)
}
