//! The filtered signal of an array of many channels, which is read and written a group of columns at a time.

use super::compute::{
    EditedGroup, Filtered, LevelsAndLayers, SignalChange, edited_parts, levels_and_layers, schedule,
};
use super::resolve::FilterJob;
use crate::commands::result_file::EditedSignal;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::resolve::operator::{SignalParts, build_decomposer, note_outsiders};
use crate::resolve::region::note_region;
use crate::resolve::signal::{KEEP_SENTINELS, Signal, SignalValues, note_unknown};
use adwave::{Decomposer, Progress};
use adwave_io::{NpyColumns, NpyColumnsWriter, WriteError, mark_unknown};
use std::path::Path;

/// Bytes of the values of a group; the result takes as many.
const GROUP_BYTES: usize = 256 << 20;

/// Divisor of the number of channels of a group, so that no block of the products is narrow.
const GROUP_OF: usize = 64;

/// Filters the signal of a job from one file into another.
pub(super) fn compute_by_columns(
    job: &FilterJob<'_>,
    columns: &NpyColumns,
    global: &Global<'_>,
) -> Result<Filtered, CliError> {
    with_progress(global, "filtering", |progress| {
        let decomposer = build_decomposer(&job.input, &job.operator, progress)?;
        note_outsiders(decomposer.geometry(), &job.input, global);
        let write = |path: &Path| write_groups(job, columns, &decomposer, path, global, progress);
        global.files.write_with(job.result.path(), write)
    })
}

/// Filters group after group into the file at `path`.
fn write_groups(
    job: &FilterJob<'_>,
    columns: &NpyColumns,
    decomposer: &Decomposer,
    path: &Path,
    global: &Global<'_>,
    progress: Progress<'_>,
) -> Result<Filtered, CliError> {
    let (n_rows, n_channels) = (columns.n_rows(), columns.n_channels());
    let together =
        (GROUP_BYTES / (8 * n_rows.max(1)) / GROUP_OF * GROUP_OF).clamp(GROUP_OF, n_channels.max(GROUP_OF));
    // Errors name the file that the staged one will replace.
    let failed = |error: WriteError| CliError::from(error.about_file(job.result.path()));
    let mut writer = NpyColumnsWriter::begin(path, n_rows, n_channels).map_err(failed)?;
    let mut filtered: Option<Filtered> = None;
    for at in (0..n_channels).step_by(together) {
        progress.step(at as u64, n_channels as u64).map_err(|_| CliError::Cancelled)?;
        let channels = at..(at + together).min(n_channels);
        let mut values = columns.read(channels.clone(), progress.quiet())?;
        let unknown = if global.given.has(KEEP_SENTINELS) {
            Vec::new()
        } else {
            mark_unknown(&mut values, channels.len())
        };
        let signal = Signal { unknown, ..Signal::new(channels.len(), SignalValues::Other(values)) };
        let name = if channels.len() < n_channels {
            format!("{}, channels {} to {}", job.signal_name, at + 1, channels.end)
        } else {
            job.signal_name.clone()
        };
        note_unknown(&name, &signal.unknown, global);
        let parts = SignalParts::new(decomposer, &signal, &name, global)?;
        let group = if filtered.is_some() {
            edited_parts(job, &parts, &signal.values, None, global, progress.quiet())?
        } else {
            let decomposer = parts.first().decomposer.clone();
            let (schedule, layers) = levels_and_layers(job, schedule(job, &decomposer, global)?)?;
            for layer in &job.layers {
                note_region(&layer.region, &job.input.file, &decomposer, global)?;
            }
            let chosen = Some(LevelsAndLayers { schedule: &schedule, layers: &layers });
            let group = edited_parts(job, &parts, &signal.values, chosen, global, progress.quiet())?;
            let (edited, change) = (EditedSignal::Written, SignalChange::default());
            filtered = Some(Filtered {
                decomposer,
                schedule,
                layers,
                edited,
                change,
                accuracy: None,
                quantity: None,
            });
            group
        };
        let EditedGroup { mut values, accuracy } = group;
        if let Some(filtered) = &mut filtered {
            filtered.change = filtered.change.plus(SignalChange::new(&signal.values, &values));
            filtered.add_accuracy(accuracy);
        }
        signal.restore_unknown(&mut values);
        writer.write(at, &values, progress.quiet()).map_err(failed)?;
    }
    progress.step(n_channels as u64, n_channels as u64).map_err(|_| CliError::Cancelled)?;
    writer.finish(progress.quiet()).map_err(failed)?;
    Ok(filtered.expect("an array of many channels has a group"))
}
