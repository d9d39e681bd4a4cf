//! `adwave denoise`: noise taken off, no knob needed.

mod args;

use crate::error::CliError;
use crate::field_file::{FieldFile, check_result, write_field, write_points};
use crate::global::Global;
use crate::movement::Movement;
use crate::output::{number, print};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::shape_input::{Input, load, refresh_normals};
use crate::signal::{self, COORDS};
use adwave::denoise::{DenoiseInfo, denoise, denoise_signal};
use adwave::shape::{PreparedGeometry, Shape};
pub(crate) use args::{CreasesArg, DenoiseArgs};
use serde_json::json;
use std::fmt::Write;

pub(crate) fn run(args: &DenoiseArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_result(&args.output)?;
    let mut input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let alone = FieldFile::for_result(&args.output, args.field.name(), &input.file);
    if args.field.name() != COORDS {
        return denoise_field(args.field.name(), input, alone, args, global);
    }
    let weld = args.shape.operator()?.weld;
    let geometry =
        with_progress(global, "preparing", |progress| PreparedGeometry::new(&input.shape, weld, progress))
            .map_err(|e| CliError::of(&e))?;
    let denoised =
        with_progress(global, "denoising", |progress| denoise(&geometry, &args.params(), progress))
            .map_err(|e| CliError::of(&e))?;
    let movement = Movement::new(&geometry, &denoised.points);
    input.file.set_points(denoised.points)?;
    refresh_normals(args.update_normals, global, &mut input)?;
    with_spinner(global, "writing", || write_points(global, &args.output, alone, &input.file))?;

    let mut text = format!("{}: {} vertices\n", input.name, input.shape.n_vertices());
    describe(&mut text, &denoised.info, matches!(input.shape, Shape::Mesh(_)));
    movement.describe(&mut text);
    let _ = writeln!(text, "{}", args.output.display());
    let mut report = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "vertices": input.shape.n_vertices(),
        "denoise": denoised.info,
    });
    movement.add_to(&mut report);
    print(global, &text, &report)
}

/// A field in the place of the shape.
fn denoise_field(
    name: &str,
    mut input: Input,
    alone: Option<FieldFile>,
    args: &DenoiseArgs,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let signal = signal::load(global, &input, name, args.field.texture.as_deref())?;
    let decomposer = prepare(global, &input.shape, &args.shape.operator()?)?;
    let decomposer = signal::mask(decomposer, &signal, name, global)?;
    let denoised = with_progress(global, "denoising", |progress| {
        denoise_signal(&decomposer, &signal.values, signal.n_channels, &args.params(), progress)
    })
    .map_err(|e| CliError::of(&e))?;
    if let Some(axis) = alone.is_none().then(|| signal::axis(&input.file, name)).flatten() {
        let points = signal::with_axis(input.file.points(), axis, &denoised.values);
        input.file.set_points(points)?;
        refresh_normals(args.update_normals, global, &mut input)?;
        with_spinner(global, "writing", || write_points(global, &args.output, alone, &input.file))?;
    } else {
        let new = signal::written(&input.file, name, signal.n_channels, denoised.values);
        with_spinner(global, "writing", || write_field(global, &args.output, alone, &mut input.file, new))?;
    }
    let mut text = format!("{}: {} vertices, {name}\n", input.name, input.shape.n_vertices());
    for info in &denoised.info {
        let share = |weights: &[f64]| 100.0 * weights.iter().sum::<f64>();
        let _ = writeln!(
            text,
            "noise {}: {:.0} % as it was, {:.0} % smoothed, {:.0} % smoothed with steps kept; expected error {} → {} (rms)",
            number(info.noise),
            100.0 * info.kept,
            share(&info.plain_weights),
            share(&info.step_weights),
            number(info.risk[0].sqrt()),
            number(info.risk[1].sqrt()),
        );
    }
    let _ = writeln!(text, "{}", args.output.display());
    let report = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "field": name,
        "vertices": input.shape.n_vertices(),
        "denoise": denoised.info,
    });
    print(global, &text, &report)
}

/// What was assumed, and how much was smoothed by what.
pub(crate) fn describe(text: &mut String, info: &DenoiseInfo, is_mesh: bool) {
    let unit = if is_mesh { "mean edges" } else { "mean distances of neighbors" };
    let _ = writeln!(
        text,
        "noise along the normals: {} model units, {} {unit}",
        number(info.noise),
        number(info.noise_in_edges)
    );
    let share = |weights: &[f64]| 100.0 * weights.iter().sum::<f64>();
    let steps = |weights: &[f64]| {
        let mean: f64 = weights.iter().enumerate().map(|(j, w)| w * f64::from(1_u32 << j)).sum();
        mean / weights.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let _ = writeln!(text, "normals: {:.0} % as they were", 100.0 * info.kept);
    for (name, weights) in
        [("creases kept", &info.crease_weights), ("creases smoothed", &info.smooth_weights)]
    {
        if share(weights) > 0.0 {
            let _ = writeln!(
                text,
                "         {:.0} % with {name}, by {:.0} steps on average",
                share(weights),
                steps(weights)
            );
        }
    }
    if info.n_far > 0 {
        let vertices = if info.n_far == 1 { "vertex" } else { "vertices" };
        let _ = writeln!(text, "{} {vertices} moved farther than 3 times the noise", info.n_far);
    }
}
