//! The filtered signal of many channels, a group of channels at a time: of an array that is read and written by columns, of
//! a series of volumes that are read and written one by one, or of an image or a volume whose numbers would take twice the
//! memory in 64 bits.

use super::compute::{
    BandsAccuracy, EditedGroup, Filtered, LevelsAndLayers, SignalChange, edited_parts, levels_and_layers,
    schedule,
};
use super::resolve::FilterJob;
use crate::commands::result_file::{EditedSignal, note_rounding};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::resolve::operator::{SignalParts, build_decomposer, note_outsiders};
use crate::resolve::region::note_region;
use crate::resolve::signal::{KEEP_SENTINELS, Signal, SignalValues, note_unknown};
use adwave::pages::zeros;
use adwave::{Decomposer, Progress};
use adwave_io::{
    Field, FieldValues, GRID_VALUES, NpyColumns, NpyColumnsWriter, SeriesVolume, ShapeFile, ValueType,
    VolumeSeries, VolumeSeriesWriter, WriteError, mark_unknown,
};
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// Bytes of the values of a group; the result takes as many.
const GROUP_BYTES: usize = 256 << 20;

/// Divisor of the number of channels of a group, so that no block of the products is narrow.
const GROUP_OF: usize = 64;

/// Source of the channels of a signal that is filtered in groups.
pub(super) enum Columns {
    /// An array in a file, which goes into another file of its kind.
    Array(NpyColumns),
    /// The values of the image or volume itself.
    OfGrid,
    /// Volumes in a file, which go into another one a volume at a time.
    Volumes(Box<VolumeSeries>),
}

impl Columns {
    /// Number of channels.
    pub(super) fn n_channels(&self, file: &ShapeFile) -> usize {
        match self {
            Self::Array(columns) => columns.n_channels(),
            Self::OfGrid => file.field(GRID_VALUES).map_or(0, |field| field.n_channels),
            Self::Volumes(series) => series.n_volumes(),
        }
    }

    /// Values of some channels, one row for each place.
    fn read(
        &self,
        file: &ShapeFile,
        channels: Range<usize>,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, CliError> {
        match self {
            Self::Array(columns) => Ok(columns.read(channels, progress)?),
            Self::Volumes(_) => unreachable!("volumes are filtered one by one"),
            Self::OfGrid => {
                let field = file.field(GRID_VALUES).expect("an image or a volume has values");
                let mut values = zeros(field.len() * channels.len());
                values.par_chunks_exact_mut(channels.len()).enumerate().for_each(|(i, row)| {
                    row.iter_mut().zip(channels.clone()).for_each(|(value, c)| *value = field.get(i, c));
                });
                Ok(values)
            }
        }
    }
}

/// Filters the signal of a job, group after group.
pub(super) fn compute_by_columns(
    job: &FilterJob<'_>,
    columns: &Columns,
    global: &Global<'_>,
) -> Result<Filtered, CliError> {
    with_progress(global, "filtering", |progress| {
        let decomposer = build_decomposer(&job.input, &job.operator, progress)?;
        note_outsiders(decomposer.geometry(), &job.input, global);
        let (n_rows, n_channels) = (job.input.shape.n_vertices(), columns.n_channels(&job.input.file));
        if let Columns::Volumes(series) = columns {
            return global.files.write_with(job.result.path(), |path| {
                filter_volumes(job, series, &decomposer, path, global, progress)
            });
        }
        let Columns::Array(_) = columns else {
            let mut values = Values::new(job, n_rows * n_channels);
            let mut filtered = visit_groups(job, columns, &decomposer, global, progress, |at, group| {
                values.place(at, group, n_channels);
                Ok(())
            })?;
            let field = Field::new(GRID_VALUES, n_channels, values.into_field());
            filtered.edited = EditedSignal::Field { field, channel_names: Vec::new() };
            return Ok(filtered);
        };
        global.files.write_with(job.result.path(), |path: &Path| {
            // Errors name the file that the staged one will replace.
            let failed = |error: WriteError| CliError::from(error.about_file(job.result.path()));
            let mut writer = NpyColumnsWriter::begin(path, n_rows, n_channels).map_err(failed)?;
            let filtered = visit_groups(job, columns, &decomposer, global, progress, |at, group| {
                writer.write(at, group, progress.quiet()).map_err(failed)
            })?;
            writer.finish(progress.quiet()).map_err(failed)?;
            Ok(filtered)
        })
    })
}

/// New values of an image or a volume, in 32 bits if its file has these.
enum Values {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Values {
    fn new(job: &FilterJob<'_>, n: usize) -> Self {
        match job.input.file.field(GRID_VALUES).map(|field| field.values.value_type()) {
            Some(ValueType::F32) if job.input.file.value_type() != Some(ValueType::F64) => {
                Self::Single(zeros(n))
            }
            _ => Self::Double(zeros(n)),
        }
    }

    /// Puts the channels of a group from channel `at` on into their places.
    fn place(&mut self, at: usize, group: &[f64], n_channels: usize) {
        let n_rows = match self {
            Self::Single(values) => values.len() / n_channels,
            Self::Double(values) => values.len() / n_channels,
        };
        let width = group.len() / n_rows;
        let rows = group.par_chunks_exact(width);
        match self {
            Self::Single(all) => rows.zip(all.par_chunks_exact_mut(n_channels)).for_each(|(values, row)| {
                row[at..at + width].iter_mut().zip(values).for_each(|(a, v)| *a = *v as f32);
            }),
            Self::Double(all) => rows
                .zip(all.par_chunks_exact_mut(n_channels))
                .for_each(|(values, row)| row[at..at + width].copy_from_slice(values)),
        }
    }

    fn into_field(self) -> FieldValues {
        match self {
            Self::Single(values) => FieldValues::F32(values),
            Self::Double(values) => FieldValues::F64(values),
        }
    }
}

/// Change of a volume, and the accuracy of its bands if they were computed.
type ChangeAndAccuracy = (SignalChange, Option<BandsAccuracy>);

/// Filters the volumes of a series, a few at the same time, into a file of the same kind at `path`.
fn filter_volumes(
    job: &FilterJob<'_>,
    series: &VolumeSeries,
    decomposer: &Decomposer,
    path: &Path,
    global: &Global<'_>,
    progress: Progress<'_>,
) -> Result<Filtered, CliError> {
    // Errors name the file that the staged one will replace.
    let failed = |error: WriteError| CliError::from(error.about_file(job.result.path()));
    let (schedule, layers) = levels_and_layers(job, schedule(job, decomposer, global)?)?;
    let (n, chosen) = (series.n_volumes(), LevelsAndLayers { schedule: &schedule, layers: &layers });
    let writer = VolumeSeriesWriter::begin(path, series).map_err(failed)?;
    let filter = |(volume, mut before): (usize, SeriesVolume)| -> Result<ChangeAndAccuracy, CliError> {
        let mut values = std::mem::take(&mut before.values);
        let unknown = mark_unknown(&mut values, 1);
        let signal = Signal { unknown, ..Signal::new(1, SignalValues::Other(values)) };
        let name = format!("{}, channel {}", job.signal_name, volume + 1);
        note_unknown(&name, &signal.unknown, global);
        let parts = SignalParts::new(decomposer, &signal, &name, global)?;
        let EditedGroup { mut values, accuracy } =
            edited_parts(job, &parts, &signal.values, Some(chosen), global, progress.quiet())?;
        let change = SignalChange::new(&signal.values, &values);
        signal.restore_unknown(&mut values);
        writer.write(volume, Some(&before), &values, progress.quiet()).map_err(failed)?;
        Ok((change, accuracy))
    };
    // Volumes at the same time, which take several vectors each.
    let together = (GROUP_BYTES / (8 * series.n_places()).max(1)).clamp(1, 2 * rayon::current_num_threads());
    let (mut change, mut accuracy) = (SignalChange::default(), None);
    for first in (0..n).step_by(together) {
        progress.step(first as u64, n as u64).map_err(|_| CliError::Cancelled)?;
        let numbers = first..(first + together).min(n);
        let volumes: Vec<_> = numbers.clone().zip(series.read(numbers, progress.quiet())?).collect();
        let results: Vec<_> = if together == 1 {
            volumes.into_iter().map(filter).collect()
        } else {
            volumes.into_par_iter().map(filter).collect()
        };
        for result in results {
            let (own, bands) = result?;
            change = change.plus(own);
            if let Some(BandsAccuracy { precision, error_bound }) = bands {
                accuracy = Some(BandsAccuracy::with(accuracy, precision, error_bound));
            }
        }
    }
    note_rounding(&job.input, &job.signal_name, global);
    writer.finish(progress.quiet()).map_err(failed)?;
    progress.step(n as u64, n as u64).map_err(|_| CliError::Cancelled)?;
    let (decomposer, edited) = (decomposer.clone(), EditedSignal::Written);
    Ok(Filtered { decomposer, schedule, layers, edited, change, accuracy, quantity: None })
}

/// Filters group after group, and calls `write` with the first channel and the new values of each.
fn visit_groups(
    job: &FilterJob<'_>,
    columns: &Columns,
    decomposer: &Decomposer,
    global: &Global<'_>,
    progress: Progress<'_>,
    mut write: impl FnMut(usize, &[f64]) -> Result<(), CliError>,
) -> Result<Filtered, CliError> {
    let (n_rows, n_channels) = (job.input.shape.n_vertices(), columns.n_channels(&job.input.file));
    let together =
        (GROUP_BYTES / (8 * n_rows.max(1)) / GROUP_OF * GROUP_OF).clamp(GROUP_OF, n_channels.max(GROUP_OF));
    let mut filtered: Option<Filtered> = None;
    for at in (0..n_channels).step_by(together) {
        progress.step(at as u64, n_channels as u64).map_err(|_| CliError::Cancelled)?;
        let channels = at..(at + together).min(n_channels);
        let mut values = columns.read(&job.input.file, channels.clone(), progress.quiet())?;
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
        write(at, &values)?;
    }
    progress.step(n_channels as u64, n_channels as u64).map_err(|_| CliError::Cancelled)?;
    Ok(filtered.expect("an array of many channels has a group"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_channels_lie_beside_each_other() {
        // Value 10·row + channel of 4 rows and 5 channels, in groups of 2, 2 and 1 channels.
        let value = |row: usize, channel: usize| (10 * row + channel) as f64;
        for single in [true, false] {
            let mut values =
                if single { Values::Single(vec![-1.0; 20]) } else { Values::Double(vec![-1.0; 20]) };
            for (at, width) in [(0, 2), (2, 2), (4, 1)] {
                let group: Vec<f64> = (0..4 * width).map(|k| value(k / width, at + k % width)).collect();
                values.place(at, &group, 5);
            }
            let expected: Vec<f64> = (0..20).map(|k| value(k / 5, k % 5)).collect();
            assert_eq!(values.into_field().to_f64(), expected);
        }
    }

    #[test]
    fn channels_of_a_grid_are_read_by_rows() {
        let mut file = ShapeFile::from_grid(adwave_io::GridLayout::new(&[2, 2], &[1.0; 2])).unwrap();
        let values = (0..12_u16).collect();
        file.add_vertex_field(Field::new(GRID_VALUES, 3, FieldValues::U16(values))).unwrap();
        assert_eq!(Columns::OfGrid.n_channels(&file), 3);
        let read = Columns::OfGrid.read(&file, 1..3, Progress::none()).unwrap();
        assert_eq!(read, [1.0, 2.0, 4.0, 5.0, 7.0, 8.0, 10.0, 11.0]);
    }
}
