//! `adwave filter`: change bands, and write the shape back.

mod args;

use crate::error::CliError;
use crate::field_file::{FieldFile, check_result, write_field, write_points};
use crate::global::Global;
use crate::movement::Movement;
use crate::output::{
    bands_params, levels_text, note, number, print, schedule, schedule_of, steps_json, write_error,
};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::region::joined;
use crate::shape_input::{load, refresh_normals};
use crate::signal::{self, COORDS};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::{Edit, FilterError, Gains, Layer, Preset};
use adwave::measure::rms;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::positions::{PositionParams, Volume, constrain_positions};
use adwave::region::Length;
use adwave_io::{Levels, Recipe, read_recipe, region_field, write_recipe};
pub(crate) use args::FilterArgs;
use args::KeepVolumeArg;
use serde_json::json;
use std::fmt::Write;

pub(crate) fn run(args: &FilterArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_result(&args.output)?;
    let params = bands_params(&args.levels)?;
    let recipe = match &args.recipe {
        Some(path) => {
            global.inputs.add_file(path);
            Some(read_recipe(path).map_err(CliError::input)?)
        }
        None => None,
    };
    let layers = layers(args, recipe.as_ref(), global)?;
    let positions = positions(args, recipe.as_ref());
    let in_recipe = recipe.as_ref().map_or(COORDS, |recipe| recipe.field.as_str());
    let field = args.field.asked().unwrap_or(in_recipe).to_owned();

    let mut input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let alone = FieldFile::for_result(&args.output, &field, &input.file);
    let signal = signal::load(global, &input, &field, args.field.texture.as_deref())?;
    let decomposer = prepare(global, &input.shape, &operator(args, recipe.as_ref())?)?;
    let decomposer = signal::mask(decomposer, &signal, &field, global)?;
    let schedule = chosen_schedule(args, recipe.as_ref(), &decomposer, global)?;
    let (schedule, layers) = keeping_volume(args.keep_volume, schedule, layers)?;
    let names = signal::field_names(&input.file);
    let lookup = |name: &str| region_field(&input.file, &decomposer, name);
    let edit = Edit::new(&layers).with_fields(&lookup, &names);
    // By the object that an interactive edit uses too, so that a recipe gives the same bits everywhere.
    let edited = with_progress(global, "filtering", |progress| {
        let request = decomposer.request(&signal.values, signal.n_channels, &schedule);
        let mut editor = request.params(&params).progress(progress).editor()?;
        editor.set_edit(&edit)?;
        Ok::<Vec<f64>, FilterError>(editor.into_edited())
    })?;

    let (n, levels) = (input.shape.n_vertices(), levels_text(schedule.n_levels()));
    let mut text = format!("{}: {n} vertices, {levels}\n", input.name);
    let mut report = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "field": field,
        "operator": decomposer.operator_kind().name(),
        "vertices": input.shape.n_vertices(),
        "steps": steps_json(&schedule.steps_from_zero()),
        "sigma": schedule.sigma(decomposer.diffusion().step_length()),
        "layers": layers,
    });
    if field == COORDS {
        let points = settled(positions, global, &decomposer, input.file.points(), &edited)?;
        let movement = Movement::new(decomposer.geometry(), &points);
        movement.check()?;
        movement.describe(&mut text);
        movement.add_to(&mut report);
        if let Some(sigma) = schedule.sigma(decomposer.diffusion().step_length()).last() {
            movement.warn(*sigma, global);
        }
        input.file.set_points(points)?;
        refresh_normals(args.update_normals, global, &mut input)?;
        with_spinner(global, "writing", || write_points(global, &args.output, alone, &input.file))?;
    } else if let Some(axis) = alone.is_none().then(|| signal::axis(&input.file, &field)).flatten() {
        let points = signal::with_axis(input.file.points(), axis, &edited);
        let movement = Movement::new(decomposer.geometry(), &points);
        movement.check()?;
        movement.describe(&mut text);
        movement.add_to(&mut report);
        input.file.set_points(points)?;
        refresh_normals(args.update_normals, global, &mut input)?;
        with_spinner(global, "writing", || write_points(global, &args.output, alone, &input.file))?;
    } else {
        let change = change(&signal.values, &edited);
        let _ = writeln!(
            text,
            "{field} changed by {} (rms over the vertices), {} at most",
            number(change.0),
            number(change.1)
        );
        report["changed"] = json!({"rms": change.0, "max": change.1});
        let new = signal::written(&input.file, &field, signal.n_channels, edited);
        with_spinner(global, "writing", || write_field(global, &args.output, alone, &mut input.file, new))?;
    }
    let _ = writeln!(text, "{}", args.output.display());
    if let Some(path) = &args.save_recipe {
        let operator = decomposer.operator_params();
        let recipe = Recipe {
            field,
            operator: Some(operator.kind),
            density_invariant: operator.density_invariant,
            keep_creases: operator.keep_creases,
            positions,
            levels: levels_to_save(args, recipe.as_ref(), &schedule, &decomposer),
            layers,
        };
        write_recipe(path, &recipe).map_err(write_error)?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(global, &text, &report)
}

/// The layers that the arguments or the recipe ask for.
fn layers(args: &FilterArgs, recipe: Option<&Recipe>, global: &Global<'_>) -> Result<Vec<Layer>, CliError> {
    if let Some(recipe) = recipe {
        if recipe.layers.is_empty() {
            note(global, "the recipe has no [[layer]]: nothing is changed");
        }
        return Ok(recipe.layers.clone());
    }
    let gains = match (args.preset, &args.gains) {
        (Some(preset), _) => Gains::Preset(Preset::from(preset)),
        (None, Some(gains)) => Gains::Gains(gains.clone()),
        (None, None) => {
            return Err(CliError::Input("say what to change: --preset, --gains or --recipe".to_owned()));
        }
    };
    Ok(vec![Layer { gains, region: joined(&args.region) }])
}

/// The schedule and the layers of a smoothing that keeps more of the volume: `1 − (1 − Φⁿ)^m` in the place of Φⁿ.
fn keeping_volume(
    how: Option<KeepVolumeArg>,
    schedule: Schedule,
    mut layers: Vec<Layer>,
) -> Result<(Schedule, Vec<Layer>), CliError> {
    let (factors, ends): (&[f64], &[f64]) = match how {
        None | Some(KeepVolumeArg::Offset) => return Ok((schedule, layers)),
        // 2Φⁿ − Φ²ⁿ = S(2n) + 2·(S(n) − S(2n)).
        Some(KeepVolumeArg::Twice) => (&[2.0], &[2.0]),
        // 3Φⁿ − 3Φ²ⁿ + Φ³ⁿ = S(3n) + 3·(S(n) − S(2n)).
        Some(KeepVolumeArg::Thrice) => (&[2.0, 3.0], &[3.0, 0.0]),
    };
    let n_levels = schedule.n_levels();
    for layer in &mut layers {
        let is_smoothing = match &layer.gains {
            Gains::Preset(preset) => matches!(preset, Preset::Suppress | Preset::SuppressPaper),
            Gains::Gains(gains) => gains.len() == n_levels && gains.iter().all(|g| *g == 0.0),
        };
        if !is_smoothing {
            return Err(CliError::Input(
                "--keep-volume twice and thrice are of a smoothing that drops every band; take --keep-volume offset".to_owned(),
            ));
        }
        layer.gains = Gains::Gains([&vec![0.0; n_levels][..], ends].concat());
    }
    let mut steps = schedule.steps().to_vec();
    let last = steps[n_levels - 1];
    steps.extend(factors.iter().map(|m| m * last));
    Ok((Schedule::real(steps)?, layers))
}

/// What is asked of new positions: by the arguments, else by the recipe.
fn positions(args: &FilterArgs, recipe: Option<&Recipe>) -> PositionParams {
    let in_recipe = recipe.map(|recipe| recipe.positions).unwrap_or_default();
    PositionParams {
        along: args.along.map(Into::into).or(in_recipe.along),
        borders: args.border.map_or(in_recipe.borders, Into::into),
        volume: match args.keep_volume {
            Some(KeepVolumeArg::Offset) => Volume::Keep,
            Some(_) => Volume::Free,
            None => in_recipe.volume,
        },
    }
}

/// New positions with what is asked of borders and volume.
fn settled(
    params: PositionParams,
    global: &Global<'_>,
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    edited: &[f64],
) -> Result<Vec<[f64; 3]>, CliError> {
    let points = edited.as_chunks().0.to_vec();
    if decomposer.geometry().points().is_empty() {
        return Ok(points);
    }
    with_progress(global, "settling", |progress| {
        constrain_positions(decomposer, before, points, &params, progress)
    })
    .map_err(|e| CliError::of(&e))
}

/// The operator: that of the arguments, else that of the recipe, else the surface's where levels are given by width.
fn operator(args: &FilterArgs, recipe: Option<&Recipe>) -> Result<OperatorParams, CliError> {
    let in_recipe = recipe.and_then(|recipe| recipe.operator);
    let by_width = recipe.is_some_and(|recipe| matches!(recipe.levels, Levels::Lengths(_)));
    let mut shape = args.shape.clone();
    shape.density_invariant |= recipe.is_some_and(|recipe| recipe.density_invariant);
    shape.keep_creases |= recipe.is_some_and(|recipe| recipe.keep_creases);
    match in_recipe {
        Some(kind) => shape.operator_or(kind),
        None if by_width && !args.levels.is_asked() => shape.operator_or(OperatorKind::Surface),
        None => shape.operator_for(&args.levels),
    }
}

/// The levels: those of the arguments, else those of the recipe, else as many as there are gains, else the default.
fn chosen_schedule(
    args: &FilterArgs,
    recipe: Option<&Recipe>,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Schedule, CliError> {
    let asked = &args.levels;
    if !asked.is_asked() {
        match recipe.map(|r| &r.levels) {
            Some(Levels::Dyadic(levels)) => return Ok(Schedule::dyadic(*levels)?),
            Some(Levels::Steps(steps)) => return Ok(Schedule::real(steps.clone())?),
            Some(Levels::Lengths(lengths)) => {
                let told = "are the recipe's widths those of a shape of another size? They can be given in % of the diagonal";
                return schedule_of(lengths, decomposer, global)
                    .map_err(|error| CliError::Input(format!("{error}; {told}")));
            }
            Some(Levels::Default) => {}
            None => {
                if let Some(gains) = &args.gains {
                    return Ok(Schedule::dyadic(gains.len())?);
                }
            }
        }
    }
    Ok(schedule(asked, decomposer, global)?.0)
}

/// What a recipe says of its levels: widths, which mean the same on other shapes, or steps.
fn levels_to_save(
    args: &FilterArgs,
    recipe: Option<&Recipe>,
    schedule: &Schedule,
    decomposer: &Decomposer,
) -> Levels {
    let step_length = decomposer.diffusion().step_length();
    if args.save_steps || step_length <= 0.0 {
        return Levels::Steps(schedule.steps().to_vec());
    }
    let in_recipe = match recipe.map(|recipe| &recipe.levels) {
        Some(Levels::Lengths(widths)) if !args.levels.is_asked() => Some(widths.clone()),
        _ => None,
    };
    let sigma = schedule.sigma(step_length);
    // As they were asked for, unless volume is kept by levels more.
    let asked = args.levels.widths().or(in_recipe).filter(|widths| widths.len() == schedule.n_levels());
    Levels::Lengths(asked.unwrap_or_else(|| sigma[1..].iter().map(|&sigma| Length::Units(sigma)).collect()))
}

/// Root mean square and largest change of a signal.
fn change(before: &[f64], after: &[f64]) -> (f64, f64) {
    let largest = before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (rms(before, after, 1), largest)
}
