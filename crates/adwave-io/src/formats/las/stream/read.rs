//! Reading of LAS and LAZ points in blocks.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::ReadError;
use crate::formats::las::read::{Header, LEAST_HEADER, check_header, compression, parse_header, records};
use crate::formats::las::stream::LasLayout;
use crate::formats::las::stream::unpack::Unpacker;

/// Largest size of the content before the points in bytes; records of a coordinate system have some kilobytes.
const MOST_HEAD: u64 = 1 << 26;
/// Bytes read at a time.
const STEP: usize = 1 << 20;

/// Reader of the point records of a LAS or LAZ, in blocks in the order of the file.
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
    /// Bytes before the points.
    head: Vec<u8>,
    header: Header,
    /// Size of the file in bytes.
    n_bytes: u64,
    points: Points,
}

enum Points {
    /// Uncompressed points, and the number of them read.
    Plain(BufReader<File>, u64),
    Packed(Box<Unpacker>),
    /// State after an error; nothing more is read.
    Broken,
}

impl LasReader {
    /// Opens a file and reads the content before its points: at most 64 MiB for any size of the file.
    ///
    /// # Errors
    /// The file cannot be read, is not a LAS or LAZ, its header or the description of its compression is damaged, or
    /// it ends before the last point stated in the header; in a LAZ the latter is detected only by
    /// [`read`](Self::read). The message is one line that begins with the file's name.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::open_file(path).map_err(|e| e.in_file(path))
    }

    fn open_file(path: &Path) -> Result<Self, ReadError> {
        let mut file = File::open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(ReadError::Whole("the file must be a regular LAS or LAZ file".into()));
        }
        let n_bytes = metadata.len();
        if n_bytes == 0 {
            return Err(ReadError::Empty);
        }
        let mut head = Vec::new();
        (&file).take(LEAST_HEADER as u64 + 28).read_to_end(&mut head)?;
        if !head.starts_with(b"LASF") {
            return Err(ReadError::Whole("a LAS or LAZ must begin with `LASF`".into()));
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

    /// Storage of the points, and their number according to the header.
    pub fn layout(&self) -> &LasLayout {
        &self.layout
    }

    /// Appends the next `most` records, decompressed, or all remaining ones. Returns their number, which is 0 only at
    /// the end.
    ///
    /// # Errors
    /// The file ends early or is damaged; the message is one line with the file's name and the point, counted from 0.
    /// `records` then contains some of the points before it, and nothing more can be read.
    pub fn read(&mut self, most: usize, records: &mut Vec<u8>) -> Result<usize, ReadError> {
        let result = match &mut self.points {
            Points::Plain(file, n_read) => {
                read_plain(file, n_read, &self.layout, self.n_bytes, most, records)
            }
            Points::Packed(unpacker) => unpacker.read(most, records),
            Points::Broken => {
                Err(ReadError::Whole("reading cannot continue after the previous error".into()))
            }
        };
        if result.is_err() {
            self.points = Points::Broken;
        }
        result.map_err(|e| e.in_file(&self.path))
    }

    /// Skips the next `most` records, or all remaining ones, and returns their number. In a LAS, and in a LAZ with a
    /// chunk table, the skipped records are not read, except for the beginning of one chunk.
    ///
    /// # Errors
    /// The errors of [`read`](Self::read).
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
                // Below 2⁶³, because the stated size cannot exceed that of the file.
                let bytes = n as i64 * self.layout.record_bytes as i64;
                *n_read += n;
                file.seek_relative(bytes).map(|()| n).map_err(ReadError::from)
            }
            Points::Packed(unpacker) => unpacker.skip(most),
            Points::Broken => {
                Err(ReadError::Whole("reading cannot continue after the previous error".into()))
            }
        };
        if result.is_err() {
            self.points = Points::Broken;
        }
        result.map_err(|e| e.in_file(&self.path))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes before the points, and the parsed header.
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
    // Step by step, because the file may have become shorter.
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

/// Converts an error of the system; a file that ends within a point gives a truncation error.
pub(super) fn cut_or(error: std::io::Error, n_bytes: u64, point: u64) -> ReadError {
    if error.kind() == ErrorKind::UnexpectedEof {
        ReadError::Truncated { end: n_bytes, needed: n_bytes + 1, element: "point".into(), row: point }
    } else {
        error.into()
    }
}
