//! Volumes of a series, one at a time: NIfTI files that are larger than memory.
//!
//! The volumes lie one after another, so each is one piece, read and written at its position.

use super::header::{HeaderEditor, NiftiHeader, has_magic, is_cifti};
use super::read::read_nifti;
use crate::files::atomic::PendingFile;
use crate::files::positions::{read_at, write_at};
use crate::model::field::with_values;
use crate::model::grid_layout::GRID_VALUES;
use crate::model::grid_values::GridNumbers;
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType, WriteError};
use adwave::Progress;
use rayon::prelude::*;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes at the beginning of a file among which the header and its extensions end.
const HEAD_BYTES: usize = 1 << 16;

/// A NIfTI of several volumes, not compressed, that are read one at a time.
#[derive(Debug)]
pub struct VolumeSeries {
    file: File,
    path: PathBuf,
    /// Bytes before the numbers.
    head: Vec<u8>,
    /// Bytes after them.
    tail: Vec<u8>,
    header: NiftiHeader,
    /// Numbers of one volume.
    numbers: GridNumbers,
    n_volumes: usize,
}

/// A volume of a series.
#[derive(Debug)]
pub struct SeriesVolume {
    /// The values, one for each voxel in the order of the file.
    pub values: Vec<f64>,
    bytes: Vec<u8>,
}

impl VolumeSeries {
    /// Opens a file of two volumes or more with one number at each voxel; `None` if it is something else, is compressed,
    /// or has errors, which reading it as a whole reports.
    pub fn open(path: &Path, limits: &ReadLimits) -> Option<Self> {
        let file = File::open(path).ok()?;
        let metadata = file.metadata().ok().filter(std::fs::Metadata::is_file)?;
        let mut head = Vec::new();
        (&file).take(HEAD_BYTES as u64).read_to_end(&mut head).ok()?;
        if !has_magic(&head) || is_cifti(&head) {
            return None;
        }
        let header = NiftiHeader::parse(&head).ok()?;
        let (kind, 1) = header.value_type()? else { return None };
        if header.sizes.len() < 4 {
            return None;
        }
        let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size));
        let (n_places, n_volumes) = (product(&header.sizes[..3])?, product(&header.sizes[3..])?);
        let (slope, intercept) = header.scaling();
        let own = GridNumbers::new(kind, header.order, n_places, 1);
        let numbers = GridNumbers { slope, intercept, ..own };
        limits.check_places(n_places as u64).ok()?;
        limits.check_bytes(8 * n_places as u64).ok()?;
        let end = numbers.n_bytes()?.checked_mul(n_volumes)?.checked_add(header.start)? as u64;
        let n_after = metadata.len().checked_sub(end).filter(|n| *n <= HEAD_BYTES as u64)?;
        let mut tail = vec![0; n_after as usize];
        read_at(&file, end, &mut tail).ok()?;
        head.truncate(header.start);
        let path = path.to_owned();
        (n_volumes > 1).then_some(Self { file, path, head, tail, header, numbers, n_volumes })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of volumes.
    pub fn n_volumes(&self) -> usize {
        self.n_volumes
    }

    /// Number of voxels of a volume.
    pub fn n_places(&self) -> usize {
        self.numbers.n_places
    }

    /// Type of the numbers in the file.
    pub fn value_type(&self) -> ValueType {
        self.numbers.kind
    }

    /// The first volume as a file of its own, with the axes and notes of the whole.
    ///
    /// # Errors
    /// The file cannot be read, or the call is cancelled.
    pub fn first(&self, limits: &ReadLimits, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
        let mut bytes = self.head.clone();
        let (version, order) = (self.header.version, self.header.order);
        HeaderEditor { bytes: &mut bytes, version, order }.set_sizes(&self.header.sizes[..3]);
        bytes.extend(self.bytes(0)?);
        read_nifti(bytes, limits, progress).map_err(|e| e.in_file(&self.path))
    }

    /// True if all values of all volumes are finite numbers. Reads the file once.
    ///
    /// # Errors
    /// The file cannot be read, or the call is cancelled.
    pub fn is_finite(&self, progress: Progress<'_>) -> Result<bool, ReadError> {
        if self.numbers.kind.is_integer() {
            return Ok(true);
        }
        let flags = (0..self.n_volumes).into_par_iter().map(|volume| {
            progress.check()?;
            let mut values = self.numbers.kind.empty();
            with_values!(&mut values, v => *v = self.numbers.adjacent(&self.bytes(volume)?));
            Ok(match values {
                FieldValues::F32(values) => values.iter().all(|x| x.is_finite()),
                FieldValues::F64(values) => values.iter().all(|x| x.is_finite()),
                _ => true,
            })
        });
        let flags: Result<Vec<bool>, ReadError> = flags.collect();
        Ok(flags?.into_iter().all(|is_finite| is_finite))
    }

    /// The volume with this number, from 0.
    ///
    /// # Errors
    /// The file cannot be read, or the call is cancelled.
    ///
    /// # Panics
    /// If there are fewer volumes.
    pub fn read(&self, volume: usize, progress: Progress<'_>) -> Result<SeriesVolume, ReadError> {
        assert!(volume < self.n_volumes, "volumes of the series");
        let bytes = self.bytes(volume)?;
        progress.check().map_err(ReadError::from)?;
        Ok(SeriesVolume { values: self.numbers.values(&bytes), bytes })
    }

    fn bytes(&self, volume: usize) -> Result<Vec<u8>, ReadError> {
        let mut bytes = vec![0; self.numbers.n_bytes().unwrap_or(0)];
        let position = self.position(volume);
        read_at(&self.file, position, &mut bytes).map_err(|e| ReadError::from(e).in_file(&self.path))?;
        Ok(bytes)
    }

    fn position(&self, volume: usize) -> u64 {
        (self.head.len() + volume * self.numbers.n_bytes().unwrap_or(0)) as u64
    }
}

/// A series with the header and the type of numbers of another, whose volumes are written in any order. The file takes its
/// place when it is finished; dropped before, it leaves nothing.
pub struct VolumeSeriesWriter<'a> {
    series: &'a VolumeSeries,
    pending: PendingFile,
    path: PathBuf,
}

impl<'a> VolumeSeriesWriter<'a> {
    /// Creates a file of zeros.
    ///
    /// # Errors
    /// The folder is missing, a system call fails, or the path is a pipe or a device.
    pub fn begin(path: &Path, series: &'a VolumeSeries) -> Result<Self, WriteError> {
        let pending = PendingFile::begin(path).map_err(|e| e.in_file(path))?;
        let writer = Self { series, pending, path: path.to_owned() };
        let (file, end) = (writer.pending.out.get_ref(), series.position(series.n_volumes));
        write_at(file, 0, &series.head)
            .and_then(|()| file.set_len(end + series.tail.len() as u64))
            .and_then(|()| write_at(file, end, &series.tail))
            .map_err(|e| WriteError::from(e).in_file(path))?;
        Ok(writer)
    }

    /// Writes new values of a volume, whose number counts from 0. Where `before` has the same value, its bytes stay.
    ///
    /// # Errors
    /// The file cannot be written, a value does not fit the type of the numbers, or the call is cancelled.
    ///
    /// # Panics
    /// If there are more or fewer values than voxels.
    pub fn write(
        &self,
        volume: usize,
        before: &SeriesVolume,
        values: Vec<f64>,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let numbers = &self.series.numbers;
        assert_eq!(values.len(), numbers.n_places, "a value for each voxel");
        let is_single = numbers.kind == ValueType::F32 && !numbers.is_scaled();
        let values = if is_single {
            FieldValues::F32(values.iter().map(|v| *v as f32).collect())
        } else {
            FieldValues::F64(values)
        };
        let (field, mut bytes) = (Field::new(GRID_VALUES, 1, values), Vec::with_capacity(before.bytes.len()));
        let encoded = numbers.write(Some(&before.bytes), &field, Format::NIFTI, &mut bytes, progress);
        let written = encoded
            .map_err(|error| in_volume(error, volume))
            .and_then(|()| Ok(write_at(self.pending.out.get_ref(), self.series.position(volume), &bytes)?));
        written.map_err(|e| e.in_file(&self.path))
    }

    /// Flushes the file to the disk and puts it in its place.
    ///
    /// # Errors
    /// A system call fails, or the call is cancelled.
    pub fn finish(self, progress: Progress<'_>) -> Result<(), WriteError> {
        let Self { pending, path, .. } = self;
        pending.finish(progress).map_err(|e| e.in_file(&path))
    }
}

/// Names the volume, which is a channel of the whole, in an error about a place of it.
fn in_volume(error: WriteError, volume: usize) -> WriteError {
    match error {
        WriteError::Misfit { format, value, place, kind, low, high } => WriteError::Misfit {
            format,
            value,
            place: format!("{place}, channel {volume},"),
            kind,
            low,
            high,
        },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::grid_layout::GridLayout;
    use crate::{read_path, write_path};

    fn write_series(path: &Path, kind: ValueType, n_volumes: usize) -> ShapeFile {
        let mut file = ShapeFile::from_grid(GridLayout::new(&[3, 4, 5], &[2.0, 1.0, 1.0])).unwrap();
        let values = (0..60 * n_volumes).map(|i| ((i * 37) % 101) as f64 - 20.0).collect();
        file.add_vertex_field(Field::new(GRID_VALUES, n_volumes, FieldValues::F64(values))).unwrap();
        file.set_value_type(Some(kind));
        write_path(&file, path, None).unwrap();
        file
    }

    #[test]
    fn volumes_are_those_of_the_whole_file_in_every_type() {
        let folder = tempfile::tempdir().unwrap();
        let [path, copy] = ["a.nii", "b.nii"].map(|name| folder.path().join(name));
        for kind in [ValueType::I16, ValueType::F32, ValueType::F64, ValueType::I8] {
            write_series(&path, kind, 7);
            let whole = read_path(&path, &ReadLimits::default()).unwrap();
            let field = whole.field(GRID_VALUES).unwrap();
            let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
            assert_eq!((series.n_volumes(), series.n_places(), series.value_type()), (7, 60, kind));
            assert!(series.is_finite(Progress::none()).unwrap());
            let first = series.first(&ReadLimits::default(), Progress::none()).unwrap();
            assert_eq!(first.grid().unwrap().sizes, whole.grid().unwrap().sizes);
            assert_eq!(first.grid().unwrap().steps, whole.grid().unwrap().steps);
            let writer = VolumeSeriesWriter::begin(&copy, &series).unwrap();
            for volume in [3, 0, 6, 1, 2, 5, 4] {
                let read = series.read(volume, Progress::none()).unwrap();
                assert!((0..60).all(|place| read.values[place] == field.get(place, volume)));
                let same = read.values.clone();
                writer.write(volume, &read, same, Progress::none()).unwrap();
            }
            writer.finish(Progress::none()).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&copy).unwrap());
        }
    }

    #[test]
    fn files_with_errors_and_unknown_values_are_left_to_the_reader_of_the_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.nii");
        write_series(&path, ValueType::F32, 1);
        assert!(VolumeSeries::open(&path, &ReadLimits::default()).is_none());
        write_series(&path, ValueType::F32, 3);
        let mut bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        assert!(VolumeSeries::open(&path, &ReadLimits::default()).is_none());
        let end = bytes.len();
        bytes[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
        std::fs::write(&path, &bytes).unwrap();
        let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
        assert!(!series.is_finite(Progress::none()).unwrap());
        let few = ReadLimits { max_bytes: 479, ..ReadLimits::default() };
        assert!(VolumeSeries::open(&path, &few).is_none());
    }

    #[test]
    fn a_value_beyond_the_type_is_named_with_its_volume_and_nothing_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let [path, out] = ["a.nii", "b.nii"].map(|name| folder.path().join(name));
        write_series(&path, ValueType::I8, 3);
        let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
        let writer = VolumeSeriesWriter::begin(&out, &series).unwrap();
        let read = series.read(2, Progress::none()).unwrap();
        let mut values = read.values.clone();
        values[5] = 128.0;
        let error = writer.write(2, &read, values, Progress::none()).unwrap_err().to_string();
        assert!(error.contains("128") && error.contains("5, channel 2,"), "{error}");
        drop(writer);
        assert!(!out.exists());
    }
}
