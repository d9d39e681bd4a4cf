//! The filtered signal.

use super::resolve::FilterJob;
use crate::commands::result_file::EditedSignal;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::resolve::levels::resolve_spec;
use crate::resolve::operator::{SignalParts, build_operator, note_close_sheets, note_outsiders};
use crate::resolve::region::{note_far_points, region_in_shape};
use crate::resolve::signal::{COORDS, field_names};
use adwave::bands::{DEFAULT_EXTENT, Schedule};
use adwave::filter::{Edit, Layer};
use adwave::local_fit::LocalFit;
use adwave::measure::rms;
use adwave::positions::{MoveDirection, constrain_positions};
use adwave::{BandsRequest, Decomposer, Progress};
use adwave_io::{region_field, with_axis};

/// A filtered signal, and the levels and layers that it was filtered by.
pub(super) struct Filtered {
    pub(super) decomposer: Decomposer,
    pub(super) schedule: Schedule,
    pub(super) layers: Vec<Layer>,
    pub(super) edited: EditedSignal,
    /// Difference to the signal before.
    pub(super) change: SignalChange,
}

/// Difference between two signals.
#[derive(Clone, Copy)]
pub(super) struct SignalChange {
    /// Root mean square over the values that are known; 0 if there are none.
    pub(super) rms: f64,
    /// Largest difference of a value.
    pub(super) max: f64,
    /// Number of values that differ.
    pub(super) n_changed: usize,
}

/// Filters the signal of a job.
pub(super) fn compute(job: &FilterJob<'_>, global: &Global<'_>) -> Result<Filtered, CliError> {
    with_progress(global, "filtering", |progress| {
        let decomposer = build_operator(&job.input.shape, &job.operator, progress)?;
        note_outsiders(decomposer.geometry(), &job.input, global);
        if job.signal_name == COORDS {
            let sheets = decomposer.close_sheets(progress.quiet()).map_err(|_| CliError::Cancelled)?;
            note_close_sheets(sheets, global);
        }
        let parts = SignalParts::new(&decomposer, &job.signal, &job.signal_name, global)?;
        let decomposer = parts.first().decomposer.clone();
        let (schedule, layers) = levels_and_layers(job, schedule(job, &decomposer, global)?)?;
        for layer in &job.layers {
            note_far_points(&layer.region, &decomposer, global)?;
        }
        let values = parts.map(&job.signal.values, |part, values, n_channels| {
            let signal = PartOfSignal { decomposer: &part.decomposer, values, n_channels };
            if part.channels().first() == Some(&0) {
                return edited_values(job, signal, &schedule, &layers, progress);
            }
            // Widths are other numbers of steps where other vertices are masked.
            let own = job.levels.spec.resolve(&part.decomposer, DEFAULT_EXTENT)?.schedule;
            let (own, layers) = levels_and_layers(job, own)?;
            edited_values(job, signal, &own, &layers, progress)
        })?;
        let change = SignalChange::new(&job.signal.values, &values);
        let edited = if job.signal_name == COORDS {
            EditedSignal::Points(constrained_points(job, &decomposer, &values, progress)?)
        } else {
            job.result.place_values(&job.input.file, &job.signal_name, &job.signal, values)
        };
        Ok(Filtered { decomposer, schedule, layers, edited, change })
    })
}

/// Levels and layers with those that keep the volume.
fn levels_and_layers(job: &FilterJob<'_>, schedule: Schedule) -> Result<(Schedule, Vec<Layer>), CliError> {
    match job.keep_volume {
        Some(how) => how.extend_levels(schedule, job.layers.clone()).map_err(with_offset_flag),
        None => Ok((schedule, job.layers.clone())),
    }
}

/// Channels of the signal with the decomposer that masks where they are NaN.
#[derive(Clone, Copy)]
struct PartOfSignal<'a> {
    decomposer: &'a Decomposer,
    /// Values by rows of `n_channels`.
    values: &'a [f64],
    n_channels: usize,
}

/// The schedule of the job's levels on its shape.
fn schedule(job: &FilterJob<'_>, decomposer: &Decomposer, global: &Global<'_>) -> Result<Schedule, CliError> {
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

/// The signal after the edit. A signal of few channels is computed by the object that interactive edits use, so that a recipe
/// gives the same bits everywhere; many channels agree with it to the accuracy of the bands.
fn edited_values(
    job: &FilterJob<'_>,
    signal: PartOfSignal<'_>,
    schedule: &Schedule,
    layers: &[Layer],
    progress: Progress<'_>,
) -> Result<Vec<f64>, CliError> {
    let PartOfSignal { decomposer, values, n_channels } = signal;
    let names = field_names(&job.input.file);
    let lookup = |name: &str| region_field(&job.input.file, decomposer, name);
    let layers = &layers
        .iter()
        .map(|layer| Ok(Layer { region: region_in_shape(&layer.region, &job.input)?, ..layer.clone() }))
        .collect::<Result<Vec<Layer>, CliError>>()?;
    if let Some(labels) = &job.labels {
        let edit = Edit::new(layers).with_fields(&lookup, &names);
        let layers = edit.resolve(schedule.n_levels(), decomposer.metric(), progress)?;
        let request = decomposer.request(values, 1, schedule).params(&job.bands);
        return Ok(request.progress(progress).filter_labels(labels, &layers)?);
    }
    let axis = job.positions.along.and_then(MoveDirection::axis).filter(|_| job.signal_name == COORDS);
    let edited = |values: &[f64], n_channels: usize| -> Result<Vec<f64>, CliError> {
        let edit = Edit::new(layers).with_fields(&lookup, &names);
        if n_channels >= MANY_CHANNELS {
            let layers = edit.resolve(schedule.n_levels(), decomposer.metric(), progress)?;
            return edited_in_groups(values, n_channels, progress, |values, n_channels| {
                let signal = PartOfSignal { decomposer, values, n_channels };
                Ok(request(job, signal, schedule, progress.quiet()).filter_layers(&layers)?)
            });
        }
        let mut editor =
            request(job, PartOfSignal { decomposer, values, n_channels }, schedule, progress).editor()?;
        editor.set_edit(&edit)?;
        Ok(editor.into_edited())
    };
    match axis {
        Some(axis) => {
            let points = values.as_chunks().0;
            let heights: Vec<f64> = points.iter().map(|p: &[f64; 3]| p[axis]).collect();
            Ok(with_axis(points, axis, &edited(&heights, 1)?).into_flattened())
        }
        None => edited(values, n_channels),
    }
}

/// Number of channels from which a signal is filtered in groups without an editor, whose bands would take several times
/// the memory of the signal.
const MANY_CHANNELS: usize = 16;

/// Largest number of channels of a group.
const CHANNELS_TOGETHER: usize = 32;

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

/// Result of `edit(values, n_channels)` for groups of channels of nearly equal size.
fn edited_in_groups(
    values: &[f64],
    n_channels: usize,
    progress: Progress<'_>,
    edit: impl Fn(&[f64], usize) -> Result<Vec<f64>, CliError>,
) -> Result<Vec<f64>, CliError> {
    let most = n_channels.div_ceil(n_channels.div_ceil(CHANNELS_TOGETHER));
    let mut edited = vec![0.0; values.len()];
    for at in (0..n_channels).step_by(most) {
        progress.step(at as u64, n_channels as u64).map_err(|_| CliError::Cancelled)?;
        let width = most.min(n_channels - at);
        let group: Vec<f64> =
            values.chunks_exact(n_channels).flat_map(|row| &row[at..at + width]).copied().collect();
        let group = edit(&group, width)?;
        for (row, group) in edited.chunks_exact_mut(n_channels).zip(group.chunks_exact(width)) {
            row[at..at + width].copy_from_slice(group);
        }
    }
    Ok(edited)
}

/// New positions under the constraints on directions, borders and volume.
fn constrained_points(
    job: &FilterJob<'_>,
    decomposer: &Decomposer,
    edited: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, CliError> {
    let points = edited.as_chunks().0.to_vec();
    if decomposer.geometry().points().is_empty() {
        return Ok(points);
    }
    Ok(constrain_positions(decomposer, job.input.file.points(), points, &job.positions, progress)?)
}

impl SignalChange {
    fn new(before: &[f64], after: &[f64]) -> Self {
        let known = || before.iter().zip(after).filter(|(a, b)| !(a.is_nan() || b.is_nan()));
        let max = known().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let n_changed = known().filter(|(a, b)| a != b).count();
        let n_known = known().count();
        let rms = match n_known {
            0 => 0.0,
            n if n == before.len() => rms(before, after, 1),
            _ => {
                let (before, after): (Vec<f64>, Vec<f64>) = known().unzip();
                rms(&before, &after, 1)
            }
        };
        Self { rms, max, n_changed }
    }
}
