//! `adwave denoise`: removal of noise without tuning.

mod args;

use super::result_file::{EditedSignal, ResultFile, set_value_type};
use crate::args::OPERATOR_OPTIONS;
use crate::error::CliError;
use crate::global::Global;
use crate::output::denoising::{SamplingUnit, describe_denoising, describe_local_fit};
use crate::output::movement::Movement;
use crate::output::progress::with_progress;
use crate::output::values_file::{holds_fields, unsuitable_format};
use crate::output::{count, note, number, print, table};
use crate::resolve::operator::{
    SignalParts, check_operator, note_moved_sheets, note_outsiders, operator_for_task, operator_with_default,
    prepare,
};
use crate::resolve::quantity::{Carried, CarriedSignal};
use crate::resolve::region::{note_region, region_in_shape, region_weights, union_of_regions};
use crate::resolve::shape::{GivenLength, Input, load_shape};
use crate::resolve::signal::{COORDS, load_signal, refuse_labels, smooth_labels_hint};
use crate::resolve::time::{resolve_frames, restore_held};
use crate::resolve::walk::with_given_walk;
use adwave::bands::FWHM;
use adwave::denoise::{
    NoiseModel, Outliers, SeriesNoise, SharedNoise, SignalNoise, denoise, denoise_series, denoise_signal,
};
use adwave::operator::{OperatorKind, OperatorParams, OperatorTask};
use adwave::positions::{PositionParams, blend_by_weights, constrain_positions};
use adwave::region::Length;
use adwave::shape::{PreparedGeometry, Shape, WeldMode};
use adwave::signal::{find_close_sheets, normals_facing};
use adwave::time::TimeAxis;
use adwave::{Decomposer, Progress};
use adwave_io::{Field, FieldValues};
pub(crate) use args::DenoiseArgs;
use serde_json::json;
use std::fmt::Write;

/// Field with the noise at each vertex.
const NOISE_FIELD: &str = "noise";

pub(crate) fn run(args: &DenoiseArgs, global: &Global<'_>) -> Result<(), CliError> {
    let result = ResultFile::new(&args.output)?;
    let input = load_shape(&args.shape, global)?;
    let name = args.signal.name_on(&input.file).to_owned();
    let input = input.resolve_cells(&name, global)?;
    let mut input = with_given_walk(input, &args.walk, global)?;
    result.check_places(&input)?;
    set_value_type(&mut input, &args.output, args.value_type, global)?;
    // A region that the shape cannot have is refused before any work.
    region_in_shape(&union_of_regions(&args.region), &input)?;
    if args.in_time {
        let applies = "applies to frames one by one; noise in space and time together is gaussian";
        global.given.refuse(&["--noise-model"], applies)?;
    } else {
        global.given.refuse(&["--time-step", "--time-ends"], "applies to a series of frames (--in-time)")?;
    }
    args.quantity.check_signal(&name)?;
    if !args.quantity.are_numbers() {
        let applies = "applies to numbers, and the signal holds directions or tensors";
        global.given.refuse(&["--in-time", "--noise-model", "--local-fit", "--as-numbers"], applies)?;
    }
    if name == COORDS {
        global.given.refuse(
            &["--in-time"],
            "applies to a field whose channels are frames (--signal), and the signal is coords",
        )?;
        global.given.refuse(&["--texture"], "applies to signals of a texture, and the signal is coords")?;
        global.given.refuse(&["--as-numbers"], "applies to fields of labels, and the signal is coords")?;
        global.given.refuse(&["--noise-model"], "applies to a field (--signal), and the signal is coords")?;
        global.given.refuse(&["--walk"], "applies to a field (--signal), and the signal is coords")?;
        let shared = match args.shared_noise {
            SharedNoise::Deviation(deviation) => Some(("--shared-noise", deviation)),
            _ => None,
        };
        let given = args.noise_sigma.map(|noise| ("--noise-sigma", noise)).into_iter().chain(shared);
        let lengths: Vec<GivenLength> =
            given.map(|(option, units)| GivenLength { option, length: Length::Units(units) }).collect();
        input.check_lengths(&lengths)?;
        denoise_positions(input, result, args, global)
    } else {
        global.given.refuse(&["--creases"], "applies to positions; steps of a field are kept anyway")?;
        global
            .given
            .refuse(&["--outliers", "--shared-noise"], "applies to positions, and the signal is a field")?;
        global.given.refuse(&["--noise-map"], "applies to positions; the noise of a field is printed")?;
        denoise_field(input, result, args, global)
    }
}

fn denoise_positions(
    mut input: Input,
    result: ResultFile<'_>,
    args: &DenoiseArgs,
    global: &Global<'_>,
) -> Result<(), CliError> {
    if args.fit.local_fit.is_some() {
        return Err(CliError::Input("--local-fit is for a field (--signal); leave it out".to_owned()));
    }
    if args.outliers != Outliers::Keep && !input.shape.is_cloud() {
        return Err(CliError::Input(format!(
            "--outliers applies to clouds, and {} has faces or edges; leave it out",
            input.name
        )));
    }
    if args.noise_map && !holds_fields(result.path()) {
        return Err(unsuitable_format(result.path(), "positions and their noise are", &[]));
    }
    if !input.shape.is_mesh() {
        global.given.refuse(&["--shared-noise"], "applies to meshes")?;
    }
    if input.shape.is_graph() {
        global.given.refuse(&["--creases"], "applies to meshes and clouds; corners of a curve stay sharp")?;
    }
    let operator = operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?;
    check_operator(&input.shape, &operator, global)?;
    // Positions are denoised by their normals; the operator has a part in borders and regions alone.
    if args.border.is_none() && args.region.is_empty() {
        global
            .given
            .refuse(&OPERATOR_OPTIONS, "applies to a field (--signal), to --border and to --region")?;
    }
    let weld = operator.weld;
    let (geometry, is_by_viewpoints) = prepare_geometry(&input, weld, global)?;
    let sheets = find_close_sheets(&geometry, None, global.progress()).map_err(|_| CliError::Cancelled)?;
    let denoised =
        with_progress(global, "denoising", |progress| denoise(&geometry, &args.to_params(), progress))
            .map_err(|e| CliError::classify(&e))?;
    let moved = limit_positions(&input, denoised.points, args, global)?;
    if let Some(before) = sheets {
        let after =
            find_close_sheets(&geometry, Some(&moved), global.progress()).map_err(|_| CliError::Cancelled)?;
        note_moved_sheets(before, after, global);
    }
    let movement = Movement::measure(&geometry, &moved)?.in_file_rows(&input.file);
    let n_vertices = input.shape.n_vertices();
    if args.noise_map {
        input.file.add_vertex_field(Field::new(NOISE_FIELD, 1, FieldValues::F64(denoised.noise)))?;
    }
    if args.outliers == Outliers::Drop && !denoised.outliers.is_empty() {
        let is_kept = |x: &u32| denoised.outliers.binary_search(x).is_err();
        let kept: Vec<u32> = (0..n_vertices as u32).filter(is_kept).collect();
        result.write_part(&mut input, moved, &kept, args.normals.to_rule(), global)?;
    } else {
        let points = EditedSignal::Points(moved);
        result.write(&mut input, COORDS, points, args.normals.to_rule(), global)?;
    }

    let mut text = format!("{}: {}\n", input.name, count(n_vertices, "vertex", "vertices"));
    let unit = match input.shape {
        Shape::Mesh(_) => SamplingUnit::MeanEdges,
        Shape::Graph(_) => SamplingUnit::CurveEdges,
        Shape::Cloud(_) => SamplingUnit::NeighborDistances,
    };
    describe_denoising(&mut text, &denoised.info, unit);
    movement.describe(&mut text);
    let _ = writeln!(text, "{}", args.output.display());
    let mut report = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "vertices": n_vertices,
        "denoise": denoised.info,
        "sides_by_viewpoints": is_by_viewpoints,
    });
    movement.add_to(&mut report);
    print(global, &text, &report)
}

/// The geometry of a shape, and whether the places from which a cloud was scanned tell its sides apart.
fn prepare_geometry(
    input: &Input,
    weld: WeldMode,
    global: &Global<'_>,
) -> Result<(PreparedGeometry, bool), CliError> {
    let (with_sides, geometry) = with_progress(global, "preparing", |progress| {
        let with_sides = facing_viewpoints(input, progress)?;
        let shape = with_sides.as_ref().unwrap_or(&input.shape);
        let geometry = PreparedGeometry::new(shape, weld, progress).map_err(|e| CliError::classify(&e))?;
        Ok::<_, CliError>((with_sides, geometry))
    })?;
    note_outsiders(Some(&geometry), input, global);
    let is_by_viewpoints = with_sides.is_some() && geometry.has_separate_sheets();
    if is_by_viewpoints {
        note(global, "points that were scanned from opposite sides belong to different surfaces");
    }
    Ok((geometry, is_by_viewpoints))
}

/// The cloud with normals on the sides from which its points were seen, if its file tells these and has no normals.
fn facing_viewpoints(input: &Input, progress: Progress<'_>) -> Result<Option<Shape>, CliError> {
    let (Shape::Cloud(cloud), Some(viewpoints)) = (&input.shape, input.file.viewpoints()) else {
        return Ok(None);
    };
    if cloud.normals().is_some() {
        return Ok(None);
    }
    let normals = normals_facing(cloud.points(), &viewpoints, progress).map_err(|_| CliError::Cancelled)?;
    Ok(Some(Shape::Cloud(cloud.clone().with_sides(normals))))
}

/// New positions under the constraints on borders and regions that are asked for.
fn limit_positions(
    input: &Input,
    points: Vec<[f64; 3]>,
    args: &DenoiseArgs,
    global: &Global<'_>,
) -> Result<Vec<[f64; 3]>, CliError> {
    if args.border.is_none() && args.region.is_empty() {
        return Ok(points);
    }
    let operator = operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?;
    let decomposer = prepare(global, input, &operator)?;
    note_region(&union_of_regions(&args.region), &input.file, &decomposer, global)?;
    let before = input.file.points();
    with_progress(global, "limiting", |progress| {
        let points = match args.border {
            Some(borders) => {
                let params = PositionParams::default().with_borders(borders);
                constrain_positions(&decomposer, before, points, &params, progress)?
            }
            None => points,
        };
        let weights = region_weights(&union_of_regions(&args.region), input, &decomposer, progress)?;
        let after = blend_by_weights(before.as_flattened(), points.as_flattened(), &weights);
        Ok(after.as_chunks().0.to_vec())
    })
}

/// A signal without noise, and what was assumed.
struct DenoisedSignal {
    values: Vec<f64>,
    /// Noise of each group of channels; empty for a series.
    infos: Vec<SignalNoise>,
    series: Option<SeriesNoise>,
    /// The domain of the first channel.
    decomposer: Decomposer,
}

/// Removes noise from one of the signals of a quantity, in space alone or along an axis of time as well.
fn denoise_carried(
    own: &CarriedSignal<'_>,
    axis: Option<&TimeAxis>,
    args: &DenoiseArgs,
    name: &str,
    global: &Global<'_>,
) -> Result<DenoisedSignal, CliError> {
    let parts = SignalParts::new(&own.decomposer, &own.signal, name, global)?;
    let (mut infos, mut series) = (Vec::new(), None);
    let values = parts.map(&own.signal.values, |part, values, n_channels| {
        if let Some(axis) = axis {
            // All channels are NaN at the same vertices.
            let denoised = with_progress(global, "denoising", |progress| {
                denoise_series(&part.decomposer, axis, values, 1, &args.to_params(), progress)
            })
            .map_err(|e| CliError::classify(&e))?;
            series.get_or_insert(denoised.info);
            return Ok(denoised.values);
        }
        let denoised = with_progress(global, "denoising", |progress| {
            denoise_signal(&part.decomposer, values, n_channels, &args.to_params(), progress)
        })
        .map_err(|e| CliError::classify(&e))?;
        for mut info in denoised.info {
            info.channels = info.channels.iter().map(|&channel| part.channels()[channel]).collect();
            infos.push(info);
        }
        Ok(denoised.values)
    })?;
    infos.sort_by_key(|info| info.channels.first().copied());
    Ok(DenoisedSignal { values, infos, series, decomposer: parts.first().decomposer.clone() })
}

/// The operator of fields: the walk, or for directions and tensors heat, unless another is asked for.
fn field_operator(args: &DenoiseArgs) -> Result<OperatorParams, CliError> {
    if args.quantity.are_numbers() {
        operator_for_task(&args.shape.operator, OperatorTask::StepLevels)
    } else {
        operator_with_default(&args.shape.operator, OperatorKind::Surface)
    }
}

fn denoise_field(
    mut input: Input,
    result: ResultFile<'_>,
    args: &DenoiseArgs,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let name = &args.signal.name_on(&input.file).to_owned();
    if args.border.is_some() {
        return Err(CliError::Input(format!(
            "--border applies to coordinates, and --signal is {name}; leave it out"
        )));
    }
    global.given.refuse(&["--keep-normals"], &format!("applies to coordinates, and the signal is {name}"))?;
    let mut signal = load_signal(global, &input, name, args.signal.texture.as_deref())?;
    refuse_labels(name, &signal, args.labels, &smooth_labels_hint(name))?;
    let series = args.in_time.then(|| resolve_frames(&args.time, name, &mut signal, global)).transpose()?;
    let prepared = prepare(global, &input, &field_operator(args)?)?;
    let carried = Carried::new(args.quantity, &prepared, &signal, name, global, global.progress())?;
    let axis = series.as_ref().map(|(axis, _)| axis);
    let mut parts = carried.signals.iter().map(|own| denoise_carried(own, axis, args, name, global));
    let DenoisedSignal { values, mut infos, series: series_info, decomposer } =
        parts.next().expect("a quantity has a signal")?;
    let mut edited = vec![values];
    for other in parts {
        let other = other?;
        edited.push(other.values);
        infos.extend(other.infos);
    }
    if let Some((_, held)) = &series {
        restore_held(held, &mut edited[0]);
    }
    if !args.region.is_empty() {
        let region = union_of_regions(&args.region);
        note_region(&region, &input.file, &decomposer, global)?;
        let weights = with_progress(global, "measuring", |progress| {
            region_weights(&region, &input, &decomposer, progress)
        })?;
        for (own, values) in carried.signals.iter().zip(&mut edited) {
            *values = blend_by_weights(&own.signal.values, values, &weights);
        }
    }
    let (values, quantity) = carried.join(edited, global.progress())?;
    let edited = result.place_values(&input.file, name, &signal, values);
    result.write(&mut input, name, edited, args.normals.to_rule(), global)?;

    let mut text = format!("{}: {}, {name}\n", input.name, input.count_rows());
    let fit = decomposer.applied_local_fit(args.to_params().local_fit);
    if let Some(quantity) = &quantity {
        quantity.describe(&mut text);
    } else {
        describe_local_fit(&mut text, fit);
    }
    for info in &infos {
        describe_channel(&mut text, info);
    }
    if let (Some(axis), Some(info)) = (axis, &series_info) {
        describe_series(&mut text, axis, info);
    }
    let _ = writeln!(text, "{}", args.output.display());
    let mut report = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "field": name,
        input.row_words()[1]: input.shape.n_vertices(),
        "local_fit": fit,
        "denoise": infos,
    });
    if let Some(quantity) = quantity {
        quantity.add_to(&mut report);
    }
    if let (Some(axis), Some(info)) = (axis, &series_info) {
        report["denoise"] = json!(info);
        report["time"] = json!({"frames": axis.n_frames(), "step": axis.step(), "ends": axis.ends().name()});
    }
    print(global, &text, &report)
}

/// Adds the noise of a series and a table of what became of its bands along time.
pub(crate) fn describe_series(text: &mut String, axis: &TimeAxis, info: &SeriesNoise) {
    let [before, after] = info.risk.map(f64::sqrt);
    let _ = writeln!(
        text,
        "time: {}, one every {} s; ends: {}\nnoise {}; expected error {} → {} (rms)",
        count(axis.n_frames(), "frame", "frames"),
        number(axis.step()),
        axis.ends(),
        number(info.noise),
        number(before),
        number(after),
    );
    let band = |i: usize| match (i.checked_sub(1).and_then(|k| info.widths.get(k)), info.widths.get(i)) {
        (_, Some(width)) => format!("up to {} s", number(FWHM * width)),
        (Some(width), None) => format!("slower than {} s", number(FWHM * width)),
        (None, None) if i == 0 => "all that changes".to_owned(),
        (None, None) => "steady".to_owned(),
    };
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let rows = info.weights.iter().enumerate().map(|(i, weights)| {
        let (unchanged, dropped) = (weights[0], weights[weights.len() - 1]);
        [band(i), percent(unchanged), percent(1.0 - unchanged - dropped), percent(dropped)]
    });
    *text += &table(["along time (FWHM)", "unchanged", "smoothed in space", "dropped"], rows);
}

/// Adds a line on the noise of a channel and on how it was smoothed.
fn describe_channel(text: &mut String, info: &SignalNoise) {
    let percent = |weights: &[f64]| 100.0 * weights.iter().fold(0.0, |sum, w| sum + w);
    let noise = match info.model {
        NoiseModel::Poisson => format!("variance {} × value", number(info.noise * info.noise)),
        NoiseModel::Multiplicative => format!("{} % of the value", number(100.0 * info.noise)),
        _ => number(info.noise),
    };
    let [before, after] = info.risk.map(f64::sqrt);
    let error = match info.model {
        NoiseModel::Gaussian => format!("expected error {} → {} (rms)", number(before), number(after)),
        _ if before > 0.0 => {
            format!("expected error {} % of the noise (rms)", number(100.0 * after / before))
        }
        _ => "no noise".to_owned(),
    };
    let _ = writeln!(
        text,
        "noise {noise}: {:.0} % unchanged, {:.0} % smoothed, {:.0} % smoothed with steps kept; {error}",
        100.0 * info.kept,
        percent(&info.plain_weights),
        percent(&info.step_weights),
    );
    if info.repeated > 0 {
        let places = count(info.repeated, "place has", "places have");
        let _ = writeln!(
            text,
            "{places} several rows that differ by noise ({} a row): all get the same value (--no-weld treats rows apart)",
            number(info.noise_of_rows)
        );
    }
    if info.jumps > 0 {
        let places = count(info.jumps, "place has", "places have");
        let _ = writeln!(
            text,
            "{places} rows that differ by more than 4 times the noise: their jump stays (a larger --noise removes it)"
        );
    }
}
