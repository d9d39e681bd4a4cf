//! Columns of `.npy` files, a few at a time: arrays that are larger than memory.
//!
//! The rows of an array lie one after another, so each gives one piece to a block of columns. Pieces are read and
//! written at their positions, not through a map of the file, whose pages would count as memory of the process.

use super::read::{HEADER_BYTES, NpyHeader};
use super::write::header;
use crate::files::atomic::PendingFile;
use crate::files::positions::{read_at, write_at};
use crate::model::field::{Number, with_values};
use crate::{FieldValues, ReadError, WriteError};
use adwave::Progress;
use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Number of bytes that are read or written between two checks for cancellation.
const BYTES_AT_A_TIME: usize = 1 << 20;

/// A `.npy` file whose columns are read in blocks: n_rows × n_channels, where all dimensions but the first are
/// channels.
#[derive(Debug)]
pub struct NpyColumns {
    file: File,
    path: PathBuf,
    header: NpyHeader,
    n_rows: usize,
    n_channels: usize,
}

impl NpyColumns {
    /// Opens a file and reads its header; `None` if it is not a regular file that begins like an array, for instance
    /// because it is compressed.
    ///
    /// # Errors
    /// The file cannot be read, or its header is wrong or promises more numbers than the file has.
    pub fn open(path: &Path) -> Result<Option<Self>, ReadError> {
        Self::open_unnamed(path).map_err(|e| e.in_file(path))
    }

    fn open_unnamed(path: &Path) -> Result<Option<Self>, ReadError> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        let mut bytes = Vec::new();
        if metadata.is_file() {
            (&file).take(HEADER_BYTES as u64).read_to_end(&mut bytes)?;
        }
        if !bytes.starts_with(b"\x93NUMPY") {
            return Ok(None);
        }
        let header = NpyHeader::parse(&bytes, metadata.len())?;
        let n_rows = header.shape.first().copied().unwrap_or(1);
        let n_channels = header.n_values.checked_div(n_rows).unwrap_or(0);
        Ok(Some(Self { file, path: path.to_owned(), header, n_rows, n_channels }))
    }

    /// Number of rows: the length of the first dimension.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Number of channels: the product of the other lengths.
    pub fn n_channels(&self) -> usize {
        self.n_channels
    }

    /// Reads some channels, n_rows × channels, row-major.
    ///
    /// # Errors
    /// The file cannot be read, or the call is cancelled.
    ///
    /// # Panics
    /// If there are fewer channels.
    pub fn read(&self, channels: Range<usize>, progress: Progress<'_>) -> Result<Vec<f64>, ReadError> {
        assert!(channels.end <= self.n_channels, "channels of the array");
        self.read_unnamed(channels, progress).map_err(|e| e.in_file(&self.path))
    }

    fn read_unnamed(&self, channels: Range<usize>, progress: Progress<'_>) -> Result<Vec<f64>, ReadError> {
        let (n_rows, width) = (self.n_rows, channels.len());
        let mut values = Vec::with_capacity(n_rows * width);
        if width == 0 {
            return Ok(values);
        }
        if self.header.is_fortran {
            values.resize(n_rows * width, 0.0);
            let at_a_time = (BYTES_AT_A_TIME / self.header.value_type.n_bytes()).max(1);
            for (c, channel) in channels.enumerate() {
                // Further dimensions run the other way round too.
                let first = self.fortran_column(channel) * n_rows;
                for start in (0..n_rows).step_by(at_a_time) {
                    let end = n_rows.min(start + at_a_time);
                    let piece = first + start..first + end;
                    let column = self.read_values(std::slice::from_ref(&piece))?;
                    for (x, v) in (start..end).zip(column) {
                        values[x * width + c] = v;
                    }
                    progress.step((c * n_rows + end) as u64, (n_rows * width) as u64)?;
                }
            }
            return Ok(values);
        }
        let at_a_time = (BYTES_AT_A_TIME / (width * self.header.value_type.n_bytes())).max(1);
        for start in (0..n_rows).step_by(at_a_time) {
            let end = n_rows.min(start + at_a_time);
            let piece = |x: usize| x * self.n_channels + channels.start..x * self.n_channels + channels.end;
            let pieces: Vec<Range<usize>> = if width == self.n_channels {
                std::iter::once(start * width..end * width).collect()
            } else {
                (start..end).map(piece).collect()
            };
            values.extend(self.read_values(&pieces)?);
            progress.step(end as u64, n_rows as u64)?;
        }
        Ok(values)
    }

    /// Number of the column in the file of a channel whose last index runs fastest.
    fn fortran_column(&self, channel: usize) -> usize {
        let (mut rest, mut column) = (channel, 0);
        let mut stride = self.n_channels;
        for &n in self.header.shape[1..].iter().rev() {
            stride /= n;
            column += (rest % n) * stride;
            rest /= n;
        }
        column
    }

    /// Values at some ranges of positions.
    fn read_values(&self, ranges: &[Range<usize>]) -> io::Result<Vec<f64>> {
        let NpyHeader { start, value_type, order, .. } = self.header;
        let width = value_type.n_bytes();
        let mut bytes = vec![0; ranges.iter().map(Range::len).sum::<usize>() * width];
        let mut rest = &mut bytes[..];
        for range in ranges {
            let (piece, after) = rest.split_at_mut(range.len() * width);
            read_at(&self.file, (start + range.start * width) as u64, piece)?;
            rest = after;
        }
        let mut values: FieldValues = value_type.empty();
        with_values!(&mut values, v => {
            for bytes in bytes.chunks_exact(width) {
                v.push(Number::from_bytes(bytes, order));
            }
        });
        Ok(match values {
            FieldValues::F64(values) => values,
            other => other.to_f64(),
        })
    }
}

/// A `.npy` file of 64-bit floats whose columns are written in blocks. The file takes its place when it is finished;
/// dropped before, it leaves nothing.
pub struct NpyColumnsWriter {
    pending: PendingFile,
    path: PathBuf,
    /// Bytes before the numbers.
    start: usize,
    n_rows: usize,
    n_channels: usize,
}

impl NpyColumnsWriter {
    /// Creates a file of n_rows × n_channels zeros.
    ///
    /// # Errors
    /// The folder is missing, a system call fails, or the path is a pipe or a device.
    pub fn begin(path: &Path, n_rows: usize, n_channels: usize) -> Result<Self, WriteError> {
        let pending = PendingFile::begin(path).map_err(|e| e.in_file(path))?;
        let header = header("<f8", &[n_rows, n_channels]);
        let writer = Self { pending, path: path.to_owned(), start: header.len(), n_rows, n_channels };
        let file = writer.pending.out.get_ref();
        write_at(file, 0, &header)
            .and_then(|()| file.set_len(writer.position(n_rows * n_channels)))
            .map_err(|e| WriteError::from(e).in_file(path))?;
        Ok(writer)
    }

    /// Position in the file of a number.
    fn position(&self, i: usize) -> u64 {
        self.start as u64 + 8 * i as u64
    }

    /// Writes some channels from `first` on, n_rows × channels, row-major.
    ///
    /// # Errors
    /// The file cannot be written, or the call is cancelled.
    ///
    /// # Panics
    /// If `values` are not whole channels of the array.
    pub fn write(&mut self, first: usize, values: &[f64], progress: Progress<'_>) -> Result<(), WriteError> {
        let width = values.len().checked_div(self.n_rows).unwrap_or(0);
        assert!(width * self.n_rows == values.len() && first + width <= self.n_channels, "whole channels");
        self.write_unnamed(first, width, values, progress).map_err(|e| e.in_file(&self.path))
    }

    fn write_unnamed(
        &self,
        first: usize,
        width: usize,
        values: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        if width == 0 {
            return Ok(());
        }
        let file = self.pending.out.get_ref();
        let at_a_time = (BYTES_AT_A_TIME / (8 * width)).max(1);
        let mut bytes = Vec::with_capacity(8 * width * at_a_time.min(self.n_rows));
        for (chunk, rows) in values.chunks(at_a_time * width).enumerate() {
            let start = chunk * at_a_time;
            bytes.clear();
            bytes.extend(rows.iter().flat_map(|v| v.to_le_bytes()));
            if width == self.n_channels {
                write_at(file, self.position(start * width), &bytes)?;
            } else {
                for (x, piece) in (start..).zip(bytes.chunks_exact(8 * width)) {
                    write_at(file, self.position(x * self.n_channels + first), piece)?;
                }
            }
            progress.step((start + rows.len() / width) as u64, self.n_rows as u64)?;
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ArrayValues, ReadLimits, read_npy, write_npy};
    use std::sync::atomic::AtomicBool;

    #[test]
    fn blocks_of_columns_are_those_of_the_whole_array() {
        let folder = tempfile::tempdir().unwrap();
        let [whole, blocks] = ["whole.npy", "blocks.npy"].map(|name| folder.path().join(name));
        let (n, d) = (301, 23);
        let values: Vec<f64> = (0..n * d).map(|i| (i as f64).sin()).collect();
        write_npy(&whole, &[n, d], ArrayValues::F64(&values)).unwrap();
        let columns = NpyColumns::open(&whole).unwrap().unwrap();
        assert_eq!((columns.n_rows(), columns.n_channels()), (n, d));
        let mut writer = NpyColumnsWriter::begin(&blocks, n, d).unwrap();
        for range in [7..23, 0..1, 1..7, 5..5] {
            let block = columns.read(range.clone(), Progress::none()).unwrap();
            assert!(
                (0..n).all(|x| block[x * range.len()..][..range.len()] == values[x * d..][range.clone()])
            );
            writer.write(range.start, &block, Progress::none()).unwrap();
        }
        assert!(!blocks.exists());
        writer.finish(Progress::none()).unwrap();
        assert_eq!(std::fs::read(&whole).unwrap(), std::fs::read(&blocks).unwrap());
        assert_eq!(columns.read(0..d, Progress::none()).unwrap(), values);
    }

    #[test]
    fn every_type_and_order_is_read_as_the_whole_array_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        for descr in ["|u1", "<i2", ">i2", "<f4", ">f4", ">f8", "<i8"] {
            for fortran in ["False", "True"] {
                let width: usize = descr[2..].parse().unwrap();
                let text =
                    format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': (5, 2, 3), }}\n");
                let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
                bytes.extend((text.len() as u16).to_le_bytes());
                bytes.extend(text.as_bytes());
                bytes.extend((0..30 * width).map(|i| (i * 37 % 63) as u8));
                std::fs::write(&path, &bytes).unwrap();
                let whole = read_npy(&path, &ReadLimits::default()).unwrap().values.to_f64();
                let columns = NpyColumns::open(&path).unwrap().unwrap();
                for range in [0..6, 2..5, 5..6] {
                    let block = columns.read(range.clone(), Progress::none()).unwrap();
                    let expected: Vec<f64> =
                        whole.chunks(6).flat_map(|row| row[range.clone()].to_vec()).collect();
                    assert_eq!(block, expected, "{descr} {fortran} {range:?}");
                }
            }
        }
    }

    #[test]
    fn other_files_truncated_ones_and_a_stop_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        std::fs::write(&path, b"1,2,3").unwrap();
        assert!(NpyColumns::open(&path).unwrap().is_none());
        write_npy(&path, &[4, 20], ArrayValues::F64(&[0.5; 80])).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        let error = NpyColumns::open(&path).unwrap_err().to_string();
        assert!(error.contains("a.npy") && error.contains("array"), "{error}");
        std::fs::write(&path, &bytes).unwrap();
        let stop = AtomicBool::new(true);
        let columns = NpyColumns::open(&path).unwrap().unwrap();
        assert!(columns.read(0..20, Progress::none().with_cancel(&stop)).is_err());
        let mut writer = NpyColumnsWriter::begin(&path, 4, 20).unwrap();
        assert!(writer.write(0, &[1.0; 8], Progress::none().with_cancel(&stop)).is_err());
        drop(writer);
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        let empty = folder.path().join("empty.npy");
        write_npy(&empty, &[0, 20], ArrayValues::F64(&[])).unwrap();
        assert_eq!(NpyColumns::open(&empty).unwrap().unwrap().n_channels(), 0);
    }
}
