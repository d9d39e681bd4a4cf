//! Reading the points of a LAS or LAZ in portions.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::ReadError;
use crate::formats::las::read::{Header, LEAST_HEADER, check_header, compression, parse_header, records};
use crate::formats::las::stream::LasLayout;
use crate::formats::las::stream::unpack::Unpacker;

/// Most bytes before the points: records of a coordinate system are some kilobytes.
const MOST_HEAD: u64 = 1 << 26;
/// Bytes that are read at once.
const STEP: usize = 1 << 20;

/// The point records of a LAS or LAZ, read in portions in the order of the file.
///
/// ```
/// use adwave_io::{LasReader, ShapeFile, write_path};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.laz");
/// write_path(&ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0]; 5]), &path, None).unwrap();
/// let mut reader = LasReader::open(&path).unwrap();
/// let mut records = Vec::new();
/// assert_eq!(reader.read(3, &mut records).unwrap(), 3);
/// assert_eq!(reader.read(3, &mut records).unwrap(), 2);
/// assert_eq!(reader.read(3, &mut records).unwrap(), 0);
/// assert_eq!(records.len(), 5 * reader.layout().record_bytes);
/// ```
pub struct LasReader {
    path: PathBuf,
    layout: LasLayout,
    /// The bytes before the points.
    head: Vec<u8>,
    header: Header,
    /// Bytes of the file.
    n_bytes: u64,
    points: Points,
}

enum Points {
    /// As they are, and how many have been read.
    Plain(BufReader<File>, u64),
    Packed(Box<Unpacker>),
    /// After an error nothing more is read.
    Broken,
}

impl LasReader {
    /// Opens a file and reads what stands before its points: at most 64 MiB, whatever its size.
    ///
    /// # Errors
    /// One line that begins with the file's name: it cannot be read, is no LAS or LAZ, its header or what describes the compression
    /// is broken, or it ends before the last point that the header promises. In a LAZ the last shows only in
    /// [`read`](Self::read).
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::open_file(path).map_err(|e| e.in_file(path))
    }

    fn open_file(path: &Path) -> Result<Self, ReadError> {
        let mut file = File::open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(ReadError::Whole("is no regular file; give a LAS or LAZ".into()));
        }
        let n_bytes = metadata.len();
        if n_bytes == 0 {
            return Err(ReadError::Empty);
        }
        let mut head = Vec::new();
        (&file).take(LEAST_HEADER as u64 + 28).read_to_end(&mut head)?;
        if !head.starts_with(b"LASF") {
            return Err(ReadError::Whole("is no LAS or LAZ: it does not begin with `LASF`; give one".into()));
        }
        let header = parse_header(&head).ok_or_else(|| ReadError::Truncated {
            end: n_bytes,
            needed: LEAST_HEADER as u64,
            element: "header".into(),
            row: 0,
        })?;
        check_header(n_bytes, &header)?;
        let start = header.points_start as u64;
        if start > MOST_HEAD {
            return Err(ReadError::Limit { what: "bytes before the points", found: start, limit: MOST_HEAD });
        }
        file.seek(SeekFrom::Start(0))?;
        head.clear();
        (&file).take(start).read_to_end(&mut head)?;
        if head.len() as u64 != start {
            return Err(cut_or(ErrorKind::UnexpectedEof.into(), n_bytes, 0));
        }
        let points = if header.is_compressed && header.n_points > 0 {
            let records = records(&head, &header);
            Points::Packed(Box::new(Unpacker::new(file, n_bytes, &header, compression(&records)?)?))
        } else {
            file.seek(SeekFrom::Start(start))?;
            Points::Plain(BufReader::with_capacity(STEP, file), 0)
        };
        let layout = LasLayout::of(&head, &header);
        Ok(Self { path: path.to_path_buf(), layout, head, header, n_bytes, points })
    }

    /// How the points are stored, and how many the header promises.
    pub fn layout(&self) -> &LasLayout {
        &self.layout
    }

    /// Appends the next records, unpacked, `most` of them or all that are left; how many, which is 0 only at the end.
    ///
    /// # Errors
    /// One line that begins with the file's name and names the point, counted from 0, at which the file ends early or is broken.
    /// `records` then holds some of the points before that one, and nothing more can be read.
    pub fn read(&mut self, most: usize, records: &mut Vec<u8>) -> Result<usize, ReadError> {
        let result = match &mut self.points {
            Points::Plain(file, n_read) => {
                read_plain(file, n_read, &self.layout, self.n_bytes, most, records)
            }
            Points::Packed(unpacker) => unpacker.read(most, records),
            Points::Broken => Err(ReadError::Whole("cannot be read on after the error before".into())),
        };
        if result.is_err() {
            self.points = Points::Broken;
        }
        result.map_err(|e| e.in_file(&self.path))
    }

    /// Goes behind the next records, `most` of them or all that are left; how many. What a LAS or a LAZ with a table of its chunks
    /// holds there is not read, but for the beginning of one chunk.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    ///
    /// ```
    /// use adwave_io::{LasReader, ShapeFile, write_path};
    /// let folder = tempfile::tempdir().unwrap();
    /// let path = folder.path().join("a.laz");
    /// write_path(&ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0]; 5]), &path, None).unwrap();
    /// let mut reader = LasReader::open(&path).unwrap();
    /// assert_eq!(reader.skip(3).unwrap(), 3);
    /// assert_eq!(reader.read(9, &mut Vec::new()).unwrap(), 2);
    /// assert_eq!(reader.skip(3).unwrap(), 0);
    /// ```
    pub fn skip(&mut self, most: u64) -> Result<u64, ReadError> {
        let result = match &mut self.points {
            Points::Plain(file, n_read) => {
                let n = most.min(self.layout.n_points - *n_read);
                // Below 2⁶³: the header promises no more bytes than the file has.
                let bytes = n as i64 * self.layout.record_bytes as i64;
                *n_read += n;
                file.seek_relative(bytes).map(|()| n).map_err(ReadError::from)
            }
            Points::Packed(unpacker) => unpacker.skip(most),
            Points::Broken => Err(ReadError::Whole("cannot be read on after the error before".into())),
        };
        if result.is_err() {
            self.points = Points::Broken;
        }
        result.map_err(|e| e.in_file(&self.path))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes before the points, and what was found in them.
    pub(in crate::formats::las) fn head(&self) -> (&[u8], &Header) {
        (&self.head, &self.header)
    }

    pub(in crate::formats::las) fn n_bytes(&self) -> u64 {
        self.n_bytes
    }
}

fn read_plain(
    file: &mut BufReader<File>,
    n_read: &mut u64,
    layout: &LasLayout,
    n_bytes: u64,
    most: usize,
    records: &mut Vec<u8>,
) -> Result<usize, ReadError> {
    let n = (layout.n_points - *n_read).min(most as u64) as usize;
    let (size, mut left) = (layout.record_bytes, n);
    let per_step = (STEP / size).max(1);
    // Step by step, since the file may be shorter by now.
    while left > 0 {
        let rows = left.min(per_step);
        let start = records.len();
        records.resize(start + rows * size, 0);
        if let Err(error) = file.read_exact(&mut records[start..]) {
            records.truncate(start);
            return Err(cut_or(error, n_bytes, *n_read));
        }
        *n_read += rows as u64;
        left -= rows;
    }
    Ok(n)
}

/// The error of a file that ends within a point, or another one of the system.
pub(super) fn cut_or(error: std::io::Error, n_bytes: u64, point: u64) -> ReadError {
    if error.kind() == ErrorKind::UnexpectedEof {
        ReadError::Truncated { end: n_bytes, needed: n_bytes + 1, element: "point".into(), row: point }
    } else {
        error.into()
    }
}
