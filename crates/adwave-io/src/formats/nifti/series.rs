//! Volumes one at a time: NIfTI files that are larger than memory, plain or compressed by gzip.
//!
//! The volumes lie one after another. In a plain file each is read and written at its position, in any order; a compressed
//! one is read and written from the beginning to the end.

use super::header::{HeaderEditor, NiftiHeader, has_magic, is_cifti};
use super::read::read_nifti;
use super::write::NiftiFrame;
use crate::files::atomic::PendingFile;
use crate::files::positions::{read_at, write_at};
use crate::model::field::{ByteOrder, Number, with_values};
use crate::model::grid_layout::GRID_VALUES;
use crate::model::grid_values::GridNumbers;
use crate::{
    Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType, WriteError, WriteReport,
};
use adwave::Progress;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Bytes at the beginning of a file among which the header and its extensions end, and most bytes after the numbers.
const HEAD_BYTES: usize = 1 << 16;
/// Bytes that are compressed between two checks for cancellation.
const COMPRESSED_PER_STEP: usize = 1 << 18;

/// Values that a thread writes at a time.
const VALUES_PER_PIECE: usize = 1 << 18;

/// Values that are checked at a time.
const VALUES_PER_BLOCK: usize = 1 << 12;

/// A NIfTI of several volumes that are read one at a time.
#[derive(Debug)]
pub struct VolumeSeries {
    source: SeriesSource,
    path: PathBuf,
    /// Bytes before the numbers.
    head: Vec<u8>,
    header: NiftiHeader,
    /// Numbers of one volume.
    numbers: GridNumbers,
    n_volumes: usize,
}

#[derive(Debug)]
enum SeriesSource {
    Plain { file: File, n_after: usize },
    Gzip(Box<Mutex<GzipVolumes>>),
}

/// Volumes of a compressed file.
#[derive(Debug)]
struct GzipVolumes {
    reader: MultiGzDecoder<BufReader<File>>,
    /// Number of the volume that comes next.
    next: usize,
}

/// A volume of a series.
#[derive(Debug)]
pub struct SeriesVolume {
    /// The values, one for each voxel in the order of the file.
    pub values: Vec<f64>,
    bytes: Vec<u8>,
}

impl VolumeSeries {
    /// Opens a file of two volumes or more with one number at each voxel; `None` if it is something else, or if its
    /// header has errors or a plain file ends early, which reading it as a whole reports.
    pub fn open(path: &Path, limits: &ReadLimits) -> Option<Self> {
        let file = File::open(path).ok()?;
        let metadata = file.metadata().ok().filter(std::fs::Metadata::is_file)?;
        let mut head = Vec::new();
        (&file).take(HEAD_BYTES as u64).read_to_end(&mut head).ok()?;
        let is_gzip = head.starts_with(&[0x1f, 0x8b]);
        if is_gzip {
            head.clear();
            gzip_reader(path).ok()?.take(HEAD_BYTES as u64).read_to_end(&mut head).ok()?;
        }
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
        head.truncate(header.start);
        let source = if is_gzip {
            SeriesSource::Gzip(Box::new(Mutex::new(GzipVolumes::open(path, head.len()).ok()?)))
        } else {
            let n_after = metadata.len().checked_sub(end).filter(|n| *n <= HEAD_BYTES as u64)?;
            SeriesSource::Plain { file, n_after: n_after as usize }
        };
        let path = path.to_owned();
        (n_volumes > 1).then_some(Self { source, path, head, header, numbers, n_volumes })
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
        bytes.extend(self.bytes(0, progress)?);
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
        let is_finite = |volume: usize| {
            progress.check()?;
            let mut values = self.numbers.kind.empty();
            with_values!(&mut values, v => *v = self.numbers.adjacent(&self.bytes(volume, progress)?));
            Ok(match values {
                FieldValues::F32(values) => all(&values, |x| x.is_finite()),
                FieldValues::F64(values) => all(&values, |x| x.is_finite()),
                _ => true,
            })
        };
        let flags: Result<Vec<bool>, ReadError> = match self.source {
            SeriesSource::Plain { .. } => (0..self.n_volumes).into_par_iter().map(is_finite).collect(),
            SeriesSource::Gzip(_) => (0..self.n_volumes).map(is_finite).collect(),
        };
        Ok(flags?.into_iter().all(|is_finite| is_finite))
    }

    /// The volumes with these numbers, from 0. Those of a compressed file are found fastest from the first to the last.
    ///
    /// # Errors
    /// The file cannot be read, or the call is cancelled.
    ///
    /// # Panics
    /// If there are fewer volumes.
    pub fn read(
        &self,
        volumes: Range<usize>,
        progress: Progress<'_>,
    ) -> Result<Vec<SeriesVolume>, ReadError> {
        assert!(volumes.end <= self.n_volumes, "volumes of the series");
        let decode = |bytes: Vec<u8>| SeriesVolume { values: self.numbers.values(&bytes), bytes };
        if matches!(self.source, SeriesSource::Plain { .. }) {
            return volumes.into_par_iter().map(|volume| Ok(decode(self.bytes(volume, progress)?))).collect();
        }
        let bytes = volumes.map(|volume| self.bytes(volume, progress)).collect::<Result<Vec<_>, _>>()?;
        Ok(bytes.into_par_iter().map(decode).collect())
    }

    fn bytes(&self, volume: usize, progress: Progress<'_>) -> Result<Vec<u8>, ReadError> {
        progress.check()?;
        let mut bytes = vec![0; self.numbers.n_bytes().unwrap_or(0)];
        let read = match &self.source {
            SeriesSource::Plain { file, .. } => {
                let position = position(&self.head, &self.numbers, volume);
                read_at(file, position, &mut bytes).map_err(ReadError::from)
            }
            SeriesSource::Gzip(volumes) => {
                let damaged = |e: io::Error| {
                    let of = self.n_volumes;
                    ReadError::Whole(format!(
                        "the gzip stream is damaged or ends before volume {} of {of} does ({e}); get the complete file",
                        volume + 1
                    ))
                };
                self.locate(lock(volumes), volume, &mut bytes)
                    .and_then(|mut volumes| {
                        volumes.next += 1;
                        volumes.reader.read_exact(&mut bytes)
                    })
                    .map_err(damaged)
            }
        };
        read.map_err(|e| e.in_file(&self.path))?;
        Ok(bytes)
    }

    /// Reads on, or again from the beginning, until `volume` comes next; `skipped` holds the bytes of a volume.
    fn locate<'a>(
        &self,
        mut volumes: MutexGuard<'a, GzipVolumes>,
        volume: usize,
        skipped: &mut [u8],
    ) -> io::Result<MutexGuard<'a, GzipVolumes>> {
        if volume < volumes.next {
            *volumes = GzipVolumes::open(&self.path, self.head.len())?;
        }
        while volumes.next < volume {
            volumes.reader.read_exact(skipped)?;
            volumes.next += 1;
        }
        Ok(volumes)
    }

    /// Bytes after the numbers.
    fn tail(&self) -> io::Result<Vec<u8>> {
        match &self.source {
            SeriesSource::Plain { file, n_after } => {
                let mut tail = vec![0; *n_after];
                read_at(file, position(&self.head, &self.numbers, self.n_volumes), &mut tail)?;
                Ok(tail)
            }
            SeriesSource::Gzip(volumes) => {
                let mut skipped = vec![0; self.numbers.n_bytes().unwrap_or(0)];
                let mut volumes = self.locate(lock(volumes), self.n_volumes, &mut skipped)?;
                let mut tail = Vec::new();
                (&mut volumes.reader).take(HEAD_BYTES as u64 + 1).read_to_end(&mut tail)?;
                if tail.len() > HEAD_BYTES {
                    let message =
                        "more bytes follow the volumes than the header tells of; get an intact file";
                    return Err(io::Error::other(message));
                }
                Ok(tail)
            }
        }
    }
}

impl GzipVolumes {
    /// The volumes that follow a header of so many bytes.
    fn open(path: &Path, n_before: usize) -> io::Result<Self> {
        let mut reader = gzip_reader(path)?;
        reader.read_exact(&mut vec![0; n_before])?;
        Ok(Self { reader, next: 0 })
    }
}

fn gzip_reader(path: &Path) -> io::Result<MultiGzDecoder<BufReader<File>>> {
    Ok(MultiGzDecoder::new(BufReader::with_capacity(1 << 18, File::open(path)?)))
}

/// True if `is_good` holds for all values. It ends early only between blocks; within one, it would compare value by value.
fn all<T>(values: &[T], is_good: impl Fn(&T) -> bool) -> bool {
    values.chunks(VALUES_PER_BLOCK).all(|block| block.iter().fold(true, |all, value| all & is_good(value)))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// First byte of a volume in a plain file.
fn position(head: &[u8], numbers: &GridNumbers, volume: usize) -> u64 {
    (head.len() + volume * numbers.n_bytes().unwrap_or(0)) as u64
}

/// A NIfTI whose volumes are written one at a time, in any order; a compressed file keeps those that come early until
/// their turn. The file takes its place when it is finished; dropped before, it leaves nothing.
pub struct VolumeSeriesWriter<'a> {
    /// Bytes before the numbers, and after them if they belong to no series.
    head: Vec<u8>,
    tail: Vec<u8>,
    series: Option<&'a VolumeSeries>,
    /// Numbers of one volume.
    numbers: GridNumbers,
    n_volumes: usize,
    output: SeriesOutput,
    path: PathBuf,
}

/// File that the volumes go to.
struct SeriesOutput {
    pending: PendingFile,
    /// The stream of a compressed file.
    gzip: Option<Mutex<GzipOutput>>,
}

struct GzipOutput {
    encoder: GzEncoder<BufWriter<File>>,
    /// Number of the volume that comes next.
    next: usize,
    /// Bytes of volumes that came early.
    early: BTreeMap<usize, Vec<u8>>,
}

impl<'a> VolumeSeriesWriter<'a> {
    /// Creates a file with the header and the type of numbers of a series, compressed if its name ends in `.gz`.
    ///
    /// # Errors
    /// The folder is missing, a system call fails, or the path is a pipe or a device.
    pub fn begin(path: &Path, series: &'a VolumeSeries) -> Result<Self, WriteError> {
        let (head, numbers) = (series.head.clone(), series.numbers.clone());
        let output = SeriesOutput::begin(path, &head).map_err(|e| e.in_file(path))?;
        let (n_volumes, path) = (series.n_volumes, path.to_owned());
        Ok(Self { head, tail: Vec::new(), series: Some(series), numbers, n_volumes, output, path })
    }

    /// Creates a file for `n_channels` values of a type at each place of a volume: the one that it was read from, else a
    /// new one. The report names fields that it cannot hold.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin), and if the shape is no volume.
    pub fn begin_channels(
        path: &Path,
        shape: &ShapeFile,
        kind: ValueType,
        n_channels: usize,
    ) -> Result<(Self, WriteReport), WriteError> {
        let begin = || {
            let mut report = WriteReport::default();
            report.report_vertex_fields(shape, &[GRID_VALUES]);
            let frame = NiftiFrame::new(shape, kind, n_channels, &mut report)?;
            Ok((SeriesOutput::begin(path, &frame.head)?, frame, report))
        };
        let (output, frame, report) = begin().map_err(|e: WriteError| e.in_file(path))?;
        let NiftiFrame { head, tail, numbers } = frame;
        let numbers = GridNumbers { n_planes: 1, ..numbers };
        let (n_volumes, path) = (n_channels, path.to_owned());
        Ok((Self { head, tail, series: None, numbers, n_volumes, output, path }, report))
    }

    /// Writes the values of a volume, whose number counts from 0. Where `before` has the same value, its bytes stay.
    /// Volume 0 of a compressed file begins it again.
    ///
    /// # Errors
    /// The file cannot be written, a value does not fit the type of the numbers, or the call is cancelled.
    ///
    /// # Panics
    /// If there are more or fewer values than voxels.
    pub fn write(
        &self,
        volume: usize,
        before: Option<&SeriesVolume>,
        values: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        assert_eq!(values.len(), self.numbers.n_places, "a value for each voxel");
        // A value beyond the range of 32 bits goes the way that refuses it.
        let fits = |value: &f64| (*value as f32).is_finite() | !value.is_finite();
        let is_single = self.numbers.kind == ValueType::F32
            && !self.numbers.is_scaled()
            && values.par_chunks(VALUES_PER_PIECE).all(|values| all(values, fits));
        if is_single && self.output.gzip.is_none() {
            let before = before.map(|before| &before.bytes[..]);
            let written = self.write_singles(volume, before, values, progress);
            return written.map_err(|e| e.in_file(&self.path));
        }
        let values = if is_single {
            FieldValues::F32(values.par_iter().map(|v| *v as f32).collect())
        } else {
            FieldValues::F64(values.to_vec())
        };
        let field = Field::new(GRID_VALUES, 1, values);
        let encode = |out: &mut dyn Write| {
            let before = before.map(|before| &before.bytes[..]);
            let encoded = self.numbers.write(before, &field, Format::NIFTI, out, progress);
            encoded.map_err(|error| in_volume(error, volume))
        };
        let file = self.output.pending.out.get_ref();
        let written = match &self.output.gzip {
            None => {
                let position = position(&self.head, &self.numbers, volume);
                encode(&mut WriterAt { file, position })
            }
            Some(output) => {
                let mut bytes = Vec::with_capacity(self.numbers.n_bytes().unwrap_or(0));
                encode(&mut bytes).and_then(|()| {
                    let mut output = lock(output);
                    if volume == 0 && output.next > 0 {
                        output.begin_again(file, &self.head)?;
                    }
                    output.early.insert(volume, bytes);
                    output.compress(progress)
                })
            }
        };
        written.map_err(|e| e.in_file(&self.path))
    }

    /// Writes the values of a volume as floats of 32 bits, each thread its own pieces. Where the bytes `before` are those of
    /// the same value, they stay.
    fn write_singles(
        &self,
        volume: usize,
        before: Option<&[u8]>,
        values: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let (file, start) = (self.output.pending.out.get_ref(), position(&self.head, &self.numbers, volume));
        let order = self.numbers.order;
        values.par_chunks(VALUES_PER_PIECE).enumerate().try_for_each(|(k, values)| {
            progress.check()?;
            let first = k * VALUES_PER_PIECE * size_of::<f32>();
            let to_bytes = |number: f32| match order {
                ByteOrder::Little => number.to_le_bytes(),
                ByteOrder::Big => number.to_be_bytes(),
            };
            let mut bytes = vec![0; size_of_val(values) / 2];
            let numbers = bytes.as_chunks_mut().0.iter_mut().zip(values);
            if let Some(before) = before {
                let before = before[first..].as_chunks::<{ size_of::<f32>() }>().0;
                for ((number, value), before) in numbers.zip(before) {
                    let (new, old) = (*value as f32, f32::from_bytes(before, order));
                    // Zeros of either sign are equal, and NaN has many patterns.
                    let is_same = (new == old) | (new.is_nan() & !old.is_finite());
                    *number = if is_same { *before } else { to_bytes(new) };
                }
            } else {
                numbers.for_each(|(number, value)| *number = to_bytes(*value as f32));
            }
            Ok(write_at(file, start + first as u64, &bytes)?)
        })
    }

    /// Flushes the file to the disk and puts it in its place.
    ///
    /// # Errors
    /// A system call fails, a compressed series has another end than its header tells of, or the call is cancelled.
    pub fn finish(self, progress: Progress<'_>) -> Result<(), WriteError> {
        let Self { head, tail, series, numbers, n_volumes, output, path } = self;
        let end = || -> Result<(), WriteError> {
            let tail = series.map_or(Ok(tail), VolumeSeries::tail)?;
            let SeriesOutput { pending, gzip } = output;
            if let Some(gzip) = gzip {
                let GzipOutput { mut encoder, .. } =
                    gzip.into_inner().unwrap_or_else(PoisonError::into_inner);
                encoder.write_all(&tail)?;
                encoder.finish()?.flush()?;
            } else {
                write_at(pending.out.get_ref(), position(&head, &numbers, n_volumes), &tail)?;
            }
            pending.finish(progress)
        };
        end().map_err(|e| e.in_file(&path))
    }
}

impl SeriesOutput {
    fn begin(path: &Path, head: &[u8]) -> Result<Self, WriteError> {
        let pending = PendingFile::begin(path)?;
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
            let mut encoder = gzip_encoder(pending.out.get_ref())?;
            encoder.write_all(head)?;
            let output = GzipOutput { encoder, next: 0, early: BTreeMap::new() };
            return Ok(Self { pending, gzip: Some(Mutex::new(output)) });
        }
        write_at(pending.out.get_ref(), 0, head)?;
        Ok(Self { pending, gzip: None })
    }
}

/// Encoder into a file from its position on.
fn gzip_encoder(file: &File) -> io::Result<GzEncoder<BufWriter<File>>> {
    let file = BufWriter::with_capacity(1 << 18, file.try_clone()?);
    Ok(GzEncoder::new(file, flate2::Compression::default()))
}

impl GzipOutput {
    /// Empties the file and writes the header.
    fn begin_again(&mut self, mut file: &File, head: &[u8]) -> io::Result<()> {
        // The old encoder ends its stream when it is dropped.
        self.encoder = gzip_encoder(file)?;
        file.rewind()?;
        file.set_len(0)?;
        self.next = 0;
        self.early.clear();
        self.encoder.write_all(head)
    }

    /// Compresses the volumes whose turn has come.
    fn compress(&mut self, progress: Progress<'_>) -> Result<(), WriteError> {
        while let Some(bytes) = self.early.remove(&self.next) {
            for part in bytes.chunks(COMPRESSED_PER_STEP) {
                progress.check()?;
                self.encoder.write_all(part)?;
            }
            self.next += 1;
        }
        Ok(())
    }
}

/// Writer that begins at a byte of a file.
struct WriterAt<'a> {
    file: &'a File,
    position: u64,
}

impl Write for WriterAt<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_at(self.file, self.position, bytes)?;
        self.position += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
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
                let read = &series.read(volume..volume + 1, Progress::none()).unwrap()[0];
                assert!((0..60).all(|place| read.values[place] == field.get(place, volume)));
                writer.write(volume, Some(read), &read.values, Progress::none()).unwrap();
            }
            writer.finish(Progress::none()).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&copy).unwrap());
        }
    }

    #[test]
    fn channels_of_many_pieces_are_written_and_values_beyond_the_type_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let sizes = [64, 64, 65];
        let (n, file) = (64 * 64 * 65, ShapeFile::from_grid(GridLayout::new(&sizes, &[1.0; 3])).unwrap());
        assert!(n > VALUES_PER_PIECE);
        for path in ["a.nii", "a.nii.gz"].map(|name| folder.path().join(name)) {
            let (writer, _) = VolumeSeriesWriter::begin_channels(&path, &file, ValueType::F32, 2).unwrap();
            let channel = |c: usize| (0..n).map(|i| (i * 2 + c) as f64).collect::<Vec<_>>();
            (0..2).for_each(|c| writer.write(c, None, &channel(c), Progress::none()).unwrap());
            let mut large = channel(0);
            large[n - 1] = 1e39;
            let refused = writer.write(1, None, &large, Progress::none()).unwrap_err().to_string();
            assert!(
                refused.contains("value 1e39 at") && refused.ends_with("such as f64, or bands as .npz"),
                "{refused}"
            );
            writer.finish(Progress::none()).unwrap();
            let read = read_path(&path, &ReadLimits::default()).unwrap();
            let field = read.field(GRID_VALUES).unwrap();
            assert!((0..n).all(|i| [0, 1].map(|c| field.get(i, c)) == [0, 1].map(|c| (i * 2 + c) as f64)));
        }
    }

    #[test]
    fn floats_that_stay_keep_their_bytes_in_every_piece() {
        let folder = tempfile::tempdir().unwrap();
        let [path, copy] = ["a.nii", "b.nii"].map(|name| folder.path().join(name));
        let n = 64 * 64 * 65;
        let mut file = ShapeFile::from_grid(GridLayout::new(&[64, 64, 65], &[1.0; 3])).unwrap();
        let values = FieldValues::F32((0..2 * n).map(|i| i as f32 + 0.1).collect());
        file.add_vertex_field(Field::new(GRID_VALUES, 2, values)).unwrap();
        write_path(&file, &path, None).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let start = bytes.len() - 4 * n; // of the second volume
        let odd_nan = f32::from_bits(0x7fc0_0abc);
        for (place, number) in [(7, -0.0_f32), (n - 2, -0.0), (n - 1, odd_nan)] {
            bytes[start + 4 * place..][..4].copy_from_slice(&number.to_le_bytes());
        }
        std::fs::write(&path, &bytes).unwrap();
        let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
        let writer = VolumeSeriesWriter::begin(&copy, &series).unwrap();
        let read = series.read(0..2, Progress::none()).unwrap();
        writer.write(0, Some(&read[0]), &read[0].values, Progress::none()).unwrap();
        let mut changed = read[1].values.clone();
        changed[7] = 0.0;
        changed[n - 1] = f64::NAN;
        changed[n - 3] = 1.0 / 3.0;
        writer.write(1, Some(&read[1]), &changed, Progress::none()).unwrap();
        writer.finish(Progress::none()).unwrap();
        bytes[start + 4 * (n - 3)..][..4].copy_from_slice(&(1.0_f32 / 3.0).to_le_bytes());
        assert!(bytes == std::fs::read(&copy).unwrap());
    }

    #[test]
    fn compressed_volumes_are_those_of_the_plain_file() {
        let folder = tempfile::tempdir().unwrap();
        let [path, plain, packed] = ["a.nii.gz", "b.nii", "c.nii.gz"].map(|name| folder.path().join(name));
        write_series(&path, ValueType::I16, 5);
        let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
        let whole = read_path(&path, &ReadLimits::default()).unwrap();
        for range in [0..2, 3..5, 1..4] {
            for (volume, read) in range.clone().zip(series.read(range, Progress::none()).unwrap()) {
                assert!(
                    (0..60).all(|at| read.values[at] == whole.field(GRID_VALUES).unwrap().get(at, volume))
                );
            }
        }
        for out in [&plain, &packed] {
            let writer = VolumeSeriesWriter::begin(out, &series).unwrap();
            // The second round begins the compressed file again.
            for volume in [0, 1, 2, 0, 4, 2, 1, 3] {
                let read = &series.read(volume..volume + 1, Progress::none()).unwrap()[0];
                writer.write(volume, Some(read), &read.values, Progress::none()).unwrap();
            }
            writer.finish(Progress::none()).unwrap();
        }
        let unpack = |path: &Path| {
            let mut bytes = Vec::new();
            gzip_reader(path).unwrap().read_to_end(&mut bytes).unwrap();
            bytes
        };
        assert!(unpack(&path) == unpack(&packed) && unpack(&path) == std::fs::read(&plain).unwrap());
        // A file that was cut off is named when it is read; near its head, it is left to the reader of the whole.
        write_series(&path, ValueType::I16, 2000);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 20]).unwrap();
        let series = VolumeSeries::open(&path, &ReadLimits::default()).unwrap();
        let error = series.read(0..2000, Progress::none()).unwrap_err().to_string();
        assert!(error.contains("a.nii.gz") && error.contains("complete file"), "{error}");
        std::fs::write(&path, &bytes[..200]).unwrap();
        assert!(VolumeSeries::open(&path, &ReadLimits::default()).is_none());
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
        let read = &series.read(2..3, Progress::none()).unwrap()[0];
        let mut values = read.values.clone();
        values[5] = 128.0;
        let error = writer.write(2, Some(read), &values, Progress::none()).unwrap_err().to_string();
        assert!(error.contains("128") && error.contains("5, channel 2,"), "{error}");
        drop(writer);
        assert!(!out.exists());
    }
}
