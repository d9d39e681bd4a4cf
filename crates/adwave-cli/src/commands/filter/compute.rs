//! The filtered signal.

use super::resolve::FilterJob;
use crate::commands::result_file::EditedSignal;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::resolve::levels::resolve_spec;
use crate::resolve::operator::{SignalParts, build_decomposer, note_close_sheets, note_outsiders};
use crate::resolve::pose::reshaped_points;
use crate::resolve::quantity::{Carried, QuantityReport};
use crate::resolve::region::{note_region, region_in_shape};
use crate::resolve::signal::{COORDS, field_names};
use adwave::bands::{BandsInfo, DEFAULT_EXTENT, Precision, Schedule};
use adwave::filter::{Edit, Gains, Layer};
use adwave::local_fit::LocalFit;
use adwave::positions::{MoveDirection, constrain_positions};
use adwave::{BandsRequest, Decomposer, EditBits, MANY_CHANNELS, Progress};
use adwave_io::{region_field, with_axis};
use rayon::prelude::*;

/// Values that a thread compares at a time.
const VALUES_AT_A_TIME: usize = 1 << 16;

/// Sums of differences side by side.
const TOGETHER: usize = 8;

/// A filtered signal, and the levels and layers that it was filtered by.
pub(super) struct Filtered {
    pub(super) decomposer: Decomposer,
    pub(super) schedule: Schedule,
    pub(super) layers: Vec<Layer>,
    pub(super) edited: EditedSignal,
    /// Difference to the signal before.
    pub(super) change: SignalChange,
    /// Number format and error of the bands, of a signal of many channels.
    pub(super) accuracy: Option<BandsAccuracy>,
    /// Facts about directions or tensors.
    pub(super) quantity: Option<QuantityReport>,
}

impl Filtered {
    /// Takes the bands of a further group of channels into account.
    pub(super) fn add_accuracy(&mut self, group: Option<BandsAccuracy>) {
        if let Some(BandsAccuracy { precision, error_bound }) = group {
            self.accuracy = Some(BandsAccuracy::with(self.accuracy, precision, error_bound));
        }
    }
}

/// Number format and error of the bands of all groups of channels.
#[derive(Clone, Copy)]
pub(super) struct BandsAccuracy {
    pub(super) precision: Precision,
    /// Largest bound of an error relative to a band.
    pub(super) error_bound: f64,
}

impl BandsAccuracy {
    /// Both together: single precision if either has it.
    pub(super) fn with(this: Option<Self>, precision: Precision, error_bound: f64) -> Self {
        let other = Self { precision, error_bound };
        let Some(this) = this else { return other };
        let single = [this, other].into_iter().find(|a| a.precision == Precision::Single);
        Self { error_bound: this.error_bound.max(error_bound), ..single.unwrap_or(other) }
    }
}

/// Difference between two signals.
#[derive(Clone, Copy, Default)]
pub(super) struct SignalChange {
    /// Root mean square over the values that are known; 0 if there are none.
    pub(super) rms: f64,
    /// Largest difference of a value.
    pub(super) max: f64,
    /// Number of values that differ.
    pub(super) n_changed: usize,
    n_known: usize,
}

/// Filters the signal of a job.
pub(super) fn compute(job: &FilterJob<'_>, global: &Global<'_>) -> Result<Filtered, CliError> {
    with_progress(global, "filtering", |progress| {
        let decomposer = build_decomposer(&job.input, &job.operator, progress)?;
        note_outsiders(decomposer.geometry(), &job.input, global);
        if job.signal_name == COORDS {
            let sheets = decomposer.close_sheets(progress.quiet()).map_err(|_| CliError::Cancelled)?;
            note_close_sheets(sheets, global);
        }
        let quantity = job.quantity;
        let carried =
            Carried::new(quantity, &decomposer, &job.signal, &job.signal_name, global, progress.quiet())?;
        let parts = (carried.signals.iter())
            .map(|own| SignalParts::new(&own.decomposer, &own.signal, &job.signal_name, global))
            .collect::<Result<Vec<_>, _>>()?;
        let decomposer = parts[0].first().decomposer.clone();
        let (schedule, layers) = levels_and_layers(job, schedule(job, &decomposer, global)?)?;
        for layer in &job.layers {
            note_region(&layer.region, &job.input.file, &decomposer, global)?;
        }
        let chosen = LevelsAndLayers { schedule: &schedule, layers: &layers };
        let (mut edited, mut accuracy) = (Vec::new(), None);
        for (own, parts) in carried.signals.iter().zip(&parts) {
            if job.is_in_time_alone() {
                edited.push(own.signal.values.to_vec());
                continue;
            }
            let group = match &job.gains_by_time {
                Some(_) => edited_by_time(job, parts, &own.signal.values, chosen, global, progress)?,
                None => edited_parts(job, parts, &own.signal.values, Some(chosen), global, progress)?,
            };
            edited.push(group.values);
            if let Some(own) = group.accuracy {
                accuracy = Some(BandsAccuracy::with(accuracy, own.precision, own.error_bound));
            }
        }
        let (mut values, quantity) = carried.join(edited, progress.quiet())?;
        match &job.time {
            Some((time, _)) if job.gains_by_time.is_some() => time.restore_held(&mut values),
            Some((time, gains)) => time.filter(&mut values, gains, progress.quiet())?,
            None => {}
        }
        let is_shape = job.signal_name == COORDS;
        // For positions, the movement is reported instead.
        let change =
            if is_shape { SignalChange::default() } else { SignalChange::new(&job.signal.values, &values) };
        let edited = if is_shape {
            let points = constrained_points(job, &decomposer, values, progress)?;
            EditedSignal::Points(match &job.reshaped_by {
                Some(by) => reshaped_points(by, &job.input, points, progress)?,
                None => points,
            })
        } else {
            job.result.place_values(&job.input.file, &job.signal_name, &job.signal, values)
        };
        Ok(Filtered { decomposer, schedule, layers, edited, change, accuracy, quantity })
    })
}

/// Levels and layers of the part of a signal with its first channel.
#[derive(Clone, Copy)]
pub(super) struct LevelsAndLayers<'a> {
    pub(super) schedule: &'a Schedule,
    pub(super) layers: &'a [Layer],
}

/// New values of some channels.
pub(super) struct EditedGroup {
    pub(super) values: Vec<f64>,
    pub(super) accuracy: Option<BandsAccuracy>,
}

/// The signal after the edit, part by part; `chosen` are the levels of the part with channel 0.
pub(super) fn edited_parts(
    job: &FilterJob<'_>,
    parts: &SignalParts,
    values: &[f64],
    chosen: Option<LevelsAndLayers<'_>>,
    global: &Global<'_>,
    progress: Progress<'_>,
) -> Result<EditedGroup, CliError> {
    let mut accuracy = None;
    let values = parts.map(values, |part, values, n_channels| {
        let signal = PartOfSignal { decomposer: &part.decomposer, values, n_channels };
        check_precision(job, signal, global)?;
        let is_first = part.channels().first() == Some(&0);
        let edited = if let Some(chosen) = chosen.filter(|_| is_first) {
            edited_values(job, signal, chosen, progress)?
        } else {
            // Widths are other numbers of steps where other vertices are masked.
            let own = job.levels.spec.resolve(&part.decomposer, DEFAULT_EXTENT)?.schedule;
            let (schedule, layers) = levels_and_layers(job, own)?;
            let own = LevelsAndLayers { schedule: &schedule, layers: &layers };
            edited_values(job, signal, own, progress)?
        };
        if let Some(own) = edited.accuracy {
            accuracy = Some(BandsAccuracy::with(accuracy, own.precision, own.error_bound));
        }
        Ok(edited.values)
    })?;
    Ok(EditedGroup { values, accuracy })
}

/// The signal after an edit with other gains for each band along time; `chosen` are the levels, and the layer whose gains
/// are replaced.
fn edited_by_time(
    job: &FilterJob<'_>,
    parts: &SignalParts,
    values: &[f64],
    chosen: LevelsAndLayers<'_>,
    global: &Global<'_>,
    progress: Progress<'_>,
) -> Result<EditedGroup, CliError> {
    let (time, time_gains) = job.time.as_ref().expect("rows of gains need bands along time");
    let rows = job.gains_by_time.iter().flatten().zip(time_gains.iter().chain([&1.0]));
    let mut all = EditedGroup { values: vec![0.0; values.len()], accuracy: None };
    for (band, (gains, of_band)) in time.bands(values, progress.quiet())?.iter().zip(rows) {
        let with_gains = |layer: &Layer| Layer { gains: Gains::Gains(gains.clone()), ..layer.clone() };
        let layers: Vec<Layer> = chosen.layers.iter().map(with_gains).collect();
        let chosen = LevelsAndLayers { layers: &layers, ..chosen };
        let group = edited_parts(job, parts, band, Some(chosen), global, progress)?;
        all.values.iter_mut().zip(&group.values).for_each(|(sum, value)| *sum += of_band * value);
        if let Some(own) = group.accuracy {
            all.accuracy = Some(BandsAccuracy::with(all.accuracy, own.precision, own.error_bound));
        }
    }
    Ok(all)
}

/// Refuses a number format that a linear fit, which takes one channel after another, would not use.
fn check_precision(
    job: &FilterJob<'_>,
    signal: PartOfSignal<'_>,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let fit = signal.decomposer.applied_local_fit(job.local_fit.unwrap_or(LocalFit::Constant));
    if fit == LocalFit::Linear {
        let applies = "applies to bands about a constant; add --local-fit constant, or leave it out";
        return match global.given.refuse(&["--precision"], "") {
            Err(_) => Err(CliError::Input(format!("--precision {applies}"))),
            Ok(()) => Ok(()),
        };
    }
    Ok(())
}

/// Levels and layers, including those that keep the volume.
pub(super) fn levels_and_layers(
    job: &FilterJob<'_>,
    schedule: Schedule,
) -> Result<(Schedule, Vec<Layer>), CliError> {
    match job.keep_volume {
        Some(how) => how.extend_levels(schedule, job.layers.clone()).map_err(with_offset_flag),
        None => Ok((schedule, job.layers.clone())),
    }
}

/// Channels of the signal with the decomposer that masks the vertices where they are NaN.
#[derive(Clone, Copy)]
struct PartOfSignal<'a> {
    decomposer: &'a Decomposer,
    /// Values by rows of `n_channels`.
    values: &'a [f64],
    n_channels: usize,
}

/// The schedule of the job's levels on its shape.
pub(super) fn schedule(
    job: &FilterJob<'_>,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Schedule, CliError> {
    let resolved = resolve_spec(&job.levels.spec, DEFAULT_EXTENT, decomposer, global);
    match resolved {
        Ok(levels) => Ok(levels.schedule),
        Err(error) if job.levels.is_from_recipe && job.levels.spec.is_by_width() => {
            Err(CliError::Input(format!(
                "{error}; the recipe may be for a shape of another size; widths in % of the diagonal fit every size"
            )))
        }
        Err(error) => Err(error),
    }
}

fn with_offset_flag(error: adwave::filter::KeepVolumeError) -> CliError {
    match error {
        adwave::filter::KeepVolumeError::NotSmoothing { .. } => {
            CliError::Input(format!("{error} (--keep-volume offset)"))
        }
        other => other.into(),
    }
}

/// The signal after the edit. Recipes and regions on few channels are computed by the object that interactive edits
/// use, so that a recipe gives the same bits everywhere; gains alone, and many channels, agree with it to the accuracy
/// of the bands.
fn edited_values(
    job: &FilterJob<'_>,
    signal: PartOfSignal<'_>,
    levels: LevelsAndLayers<'_>,
    progress: Progress<'_>,
) -> Result<EditedGroup, CliError> {
    let LevelsAndLayers { schedule, layers } = levels;
    let PartOfSignal { decomposer, values, n_channels } = signal;
    let names = field_names(&job.input.file);
    let lookup = |name: &str| region_field(&job.input.file, decomposer, name);
    let layers = &layers
        .iter()
        .map(|layer| Ok(Layer { region: region_in_shape(&layer.region, &job.input)?, ..layer.clone() }))
        .collect::<Result<Vec<Layer>, CliError>>()?;
    let edit = Edit::new(layers).with_fields(&lookup, &names);
    let layers = edit.resolve(schedule.n_levels(), decomposer.metric(), progress)?;
    if let Some(labels) = &job.labels {
        let request = decomposer.request(values, 1, schedule).params(&job.bands);
        let values = request.progress(progress).filter_labels(labels, &layers)?;
        return Ok(EditedGroup { values, accuracy: None });
    }
    let axis = job.positions.along.and_then(MoveDirection::axis).filter(|_| job.signal_name == COORDS);
    let bits = if job.has_recipe { EditBits::Editor } else { EditBits::Accuracy };
    let edited = move |values: &[f64], n_channels: usize| -> Result<(Vec<f64>, BandsInfo), CliError> {
        let request = request(job, PartOfSignal { decomposer, values, n_channels }, schedule, progress);
        Ok(request.edit(layers, bits)?)
    };
    let (values, info) = match axis {
        Some(axis) => {
            let points = values.as_chunks().0;
            let heights: Vec<f64> = points.iter().map(|p: &[f64; 3]| p[axis]).collect();
            let (heights, info) = edited(&heights, 1)?;
            (with_axis(points, axis, &heights).into_flattened(), info)
        }
        None => edited(values, n_channels)?,
    };
    // For few channels, the accuracy is reported only if single precision was used.
    let accuracy = (info.precision == Precision::Single || n_channels >= MANY_CHANNELS)
        .then_some(BandsAccuracy { precision: info.precision, error_bound: info.error_bound });
    Ok(EditedGroup { values, accuracy })
}

/// Request for the bands of a signal with the options of the job.
fn request<'a>(
    job: &FilterJob<'_>,
    signal: PartOfSignal<'a>,
    schedule: &'a Schedule,
    progress: Progress<'a>,
) -> BandsRequest<'a> {
    let request = signal.decomposer.request(signal.values, signal.n_channels, schedule).params(&job.bands);
    request.local_fit(job.local_fit.unwrap_or(LocalFit::Constant)).progress(progress)
}

/// New positions under the constraints on directions, borders and volume.
fn constrained_points(
    job: &FilterJob<'_>,
    decomposer: &Decomposer,
    edited: Vec<f64>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, CliError> {
    let points = edited.as_chunks().0.to_vec();
    drop(edited);
    if decomposer.positions().is_empty() {
        return Ok(points);
    }
    Ok(constrain_positions(decomposer, job.input.file.points(), points, &job.positions, progress)?)
}

impl SignalChange {
    /// Change of two parts of a signal together.
    pub(super) fn plus(self, other: Self) -> Self {
        let n_known = self.n_known + other.n_known;
        let square = |part: Self| part.rms * part.rms * part.n_known as f64;
        let rms = match n_known {
            0 => 0.0,
            n => ((square(self) + square(other)) / n as f64).sqrt(),
        };
        let n_changed = self.n_changed + other.n_changed;
        Self { rms, max: self.max.max(other.max), n_changed, n_known }
    }

    pub(super) fn new(before: &[f64], after: &[f64]) -> Self {
        let parts = before.par_chunks(VALUES_AT_A_TIME).zip(after.par_chunks(VALUES_AT_A_TIME));
        let parts: Vec<Self> = parts.map(|(before, after)| Self::measure(before, after)).collect();
        parts.into_iter().reduce(Self::plus).unwrap_or_default()
    }

    fn measure(before: &[f64], after: &[f64]) -> Self {
        // Several sums side by side, so that the processor adds them at once.
        let (mut max, mut squares) = ([0.0_f64; TOGETHER], [0.0; TOGETHER]);
        let (mut n_changed, mut n_known) = ([0_u64; TOGETHER], [0_u64; TOGETHER]);
        let mut add = |lane: usize, a: f64, b: f64| {
            let is_known = !(a.is_nan() | b.is_nan());
            let difference = if is_known { (a - b).abs() } else { 0.0 };
            max[lane] = if difference > max[lane] { difference } else { max[lane] };
            squares[lane] += difference * difference;
            n_changed[lane] += u64::from(is_known && a != b);
            n_known[lane] += u64::from(is_known);
        };
        let ((befores, last_before), (afters, last_after)) = (before.as_chunks(), after.as_chunks());
        for (before, after) in befores.iter().zip(afters) {
            let (before, after): (&[f64; TOGETHER], &[f64; TOGETHER]) = (before, after);
            (0..TOGETHER).for_each(|lane| add(lane, before[lane], after[lane]));
        }
        last_before.iter().zip(last_after).for_each(|(a, b)| add(0, *a, *b));
        let n_known = n_known.iter().sum::<u64>() as usize;
        let rms = (squares.iter().sum::<f64>() / n_known.max(1) as f64).sqrt();
        let n_changed = n_changed.iter().sum::<u64>() as usize;
        Self { rms, max: max.into_iter().fold(0.0, f64::max), n_changed, n_known }
    }
}
