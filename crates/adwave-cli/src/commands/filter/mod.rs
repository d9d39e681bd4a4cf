//! `adwave filter`: change bands, and write the shape back.

mod args;

use crate::error::CliError;
use crate::global::Global;
use crate::output::{
    bands_params, check_writable, format_of, note, number, print, schedule, steps_json, write_error,
    write_shape,
};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::shape_input::{Input, load};
use crate::signal::{self, COORDS};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::{Displacement, Edit, FilterError, Gains, Layer, Preset, displacement};
use adwave::measure::rms;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::region::Region;
use adwave::shape::{Shape, enclosed_volume, triangulate, vertex_normals};
use adwave_io::{Levels, Recipe, read_recipe, write_recipe};
pub(crate) use args::FilterArgs;
use serde_json::json;
use std::fmt::Write;

pub(crate) fn run(args: &FilterArgs, global: &Global<'_>) -> Result<(), CliError> {
    format_of(&args.output)?;
    check_writable(&args.output)?;
    let params = bands_params(&args.levels)?;
    let recipe = match &args.recipe {
        Some(path) => Some(read_recipe(path).map_err(CliError::input)?),
        None => None,
    };
    let layers = layers(args, recipe.as_ref())?;
    let field = match (&args.field, &recipe) {
        (Some(field), _) => field.clone(),
        (None, Some(recipe)) => recipe.field.clone(),
        (None, None) => COORDS.to_owned(),
    };

    let mut input = with_spinner(global, "reading", || load(&args.shape))?;
    let signal = signal::load(&input, &field)?;
    if field != COORDS && input.file.field(&field).is_none() {
        return Err(CliError::Input(format!(
            "{field} is not a field of {}, so it cannot be written back",
            input.name
        )));
    }
    let decomposer = prepare(global, &input.shape, &operator(args, recipe.as_ref())?)?;
    let decomposer = signal::mask(decomposer, &signal, &field, global)?;
    let schedule = chosen_schedule(args, recipe.as_ref(), &decomposer)?;
    let names = signal::field_names(&input.file);
    let lookup = |name: &str| signal::field(&input.file, name);
    let edit = Edit::new(&layers).with_fields(&lookup, &names);
    // By the object that an interactive edit uses too, so that a recipe gives the same bits everywhere.
    let edited = with_progress(global, "filtering", |progress| {
        let request = decomposer.request(&signal.values, signal.n_channels, &schedule);
        let mut editor = request.params(&params).progress(progress).editor()?;
        editor.set_edit(&edit)?;
        Ok::<Vec<f64>, FilterError>(editor.into_edited())
    })?;

    let mut text =
        format!("{}: {} vertices, {} levels\n", input.name, input.shape.n_vertices(), schedule.n_levels());
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
        let points = edited.as_chunks().0.to_vec();
        let moved = displacement(input.file.points(), &points);
        let volumes = volumes(&decomposer, &points);
        describe_move(&mut text, moved, decomposer.diagonal(), volumes);
        report["moved"] = json!({
            "rms": moved.rms, "max": moved.max, "furthest_vertex": moved.furthest,
            "rms_percent": 100.0 * moved.rms / decomposer.diagonal().max(f64::MIN_POSITIVE),
            "max_percent": 100.0 * moved.max / decomposer.diagonal().max(f64::MIN_POSITIVE),
        });
        report["volume"] = json!(volumes.map(|(before, after)| json!({"before": before, "after": after})));
        input.file.set_points(points)?;
        refresh_normals(args, global, &mut input)?;
    } else {
        let change = change(&signal.values, &edited);
        let _ = writeln!(text, "{field} changed by {} (rms), {} at most", number(change.0), number(change.1));
        report["changed"] = json!({"rms": change.0, "max": change.1});
        let old = input.file.field(&field).expect("the field that was filtered");
        input.file.add_vertex_field(old.with_values_rounded(&edited))?;
    }
    with_spinner(global, "writing", || write_shape(global, &input.file, &args.output))?;
    let _ = writeln!(text, "{}", args.output.display());
    if let Some(path) = &args.save_recipe {
        let operator = Some(decomposer.operator_kind());
        let levels = Levels::Steps(schedule.steps().to_vec());
        let recipe = Recipe { field, operator, levels, layers };
        write_recipe(path, &recipe).map_err(write_error)?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(global, &text, &report)
}

/// The layers that the arguments or the recipe ask for.
fn layers(args: &FilterArgs, recipe: Option<&Recipe>) -> Result<Vec<Layer>, CliError> {
    if let Some(recipe) = recipe {
        return Ok(recipe.layers.clone());
    }
    let gains = match (args.preset, &args.gains) {
        (Some(preset), _) => Gains::Preset(Preset::from(preset)),
        (None, Some(gains)) => Gains::Gains(gains.clone()),
        (None, None) => {
            return Err(CliError::Input("say what to change: --preset, --gains or --recipe".to_owned()));
        }
    };
    let region = match args.region.as_slice() {
        [] => Region::Everywhere {},
        [one] => one.clone(),
        several => Region::Any(several.to_vec()),
    };
    Ok(vec![Layer { gains, region }])
}

/// The operator: that of the arguments, else that of the recipe, else the surface's where levels are given by width.
fn operator(args: &FilterArgs, recipe: Option<&Recipe>) -> Result<OperatorParams, CliError> {
    let in_recipe = recipe.and_then(|recipe| recipe.operator);
    let by_width = recipe.is_some_and(|recipe| matches!(recipe.levels, Levels::Lengths(_)));
    match in_recipe {
        Some(kind) => args.shape.operator_or(kind),
        None if by_width && !args.levels.is_asked() => args.shape.operator_or(OperatorKind::Surface),
        None => args.shape.operator_for(&args.levels),
    }
}

/// The levels: those of the arguments, else those of the recipe, else as many as there are gains, else the default.
fn chosen_schedule(
    args: &FilterArgs,
    recipe: Option<&Recipe>,
    decomposer: &Decomposer,
) -> Result<Schedule, CliError> {
    let asked = &args.levels;
    if !asked.is_asked() {
        match recipe.map(|r| &r.levels) {
            Some(Levels::Dyadic(levels)) => return Ok(Schedule::dyadic(*levels)?),
            Some(Levels::Steps(steps)) => return Ok(Schedule::real(steps.clone())?),
            Some(Levels::Lengths(lengths)) => {
                return Ok(Schedule::lengths(lengths, decomposer.diffusion().step_length())?);
            }
            Some(Levels::Default) => {}
            None => {
                if let Some(gains) = &args.gains {
                    return Ok(Schedule::dyadic(gains.len())?);
                }
            }
        }
    }
    Ok(schedule(asked, decomposer)?.0)
}

/// Volume before and after, where the surface encloses one.
fn volumes(decomposer: &Decomposer, after: &[[f64; 3]]) -> Option<(f64, f64)> {
    let before = decomposer.health().volume?;
    let geometry = decomposer.geometry();
    Some((before, enclosed_volume(&geometry.vertex_map().positions(after), geometry.triangles())))
}

fn describe_move(text: &mut String, moved: Displacement, diagonal: f64, volumes: Option<(f64, f64)>) {
    let percent = |length: f64| number(if diagonal > 0.0 { 100.0 * length / diagonal } else { 0.0 });
    let _ = writeln!(
        text,
        "vertices moved by {} (rms, {} % of the diagonal), vertex {} furthest: {} ({} %)",
        number(moved.rms),
        percent(moved.rms),
        moved.furthest,
        number(moved.max),
        percent(moved.max),
    );
    if let Some((before, after)) = volumes {
        let _ = writeln!(
            text,
            "volume {} → {} ({:+.3} %)",
            number(before),
            number(after),
            100.0 * (after - before) / before
        );
    }
}

/// Root mean square and largest change of a signal.
fn change(before: &[f64], after: &[f64]) -> (f64, f64) {
    let largest = before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (rms(before, after, 1), largest)
}

/// Computes the file's normals anew where that is asked for, or says that they are the old ones.
fn refresh_normals(args: &FilterArgs, global: &Global<'_>, input: &mut Input) -> Result<(), CliError> {
    let (Some(field), Shape::Mesh(mesh)) = (input.file.field("normal"), &input.shape) else { return Ok(()) };
    if args.update_normals {
        let triangles = triangulate(input.file.points(), mesh.faces());
        let normals = vertex_normals(input.file.points(), &triangles);
        let field = field.with_values_rounded(normals.as_flattened());
        input.file.add_vertex_field(field)?;
    } else {
        note(global, "the normals are those of the input; --update-normals computes them anew");
    }
    Ok(())
}
