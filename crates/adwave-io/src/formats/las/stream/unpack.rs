//! Parallel decompression of the chunks of a LAZ.
//!
//! The table at the end of the file has the length of each chunk. If it is missing, layered chunks (formats 6 to 10)
//! are located by the sizes at their beginning, and other chunks are decompressed point by point. Allocations are
//! checked against the size of the file, and a panic of the library becomes an error.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::laszip::ChunkTable;
use rayon::prelude::*;

use crate::ReadError;
use crate::formats::las::laz::{VARIABLE, i64_at, u16_at, u32_at};
use crate::formats::las::read::Header;
use crate::formats::las::stream::coding::{Coding, Decompressor, layer_sizes, unpack_rows};
use crate::formats::las::stream::read::cut_or;

/// Size of the points that are decompressed in advance, in bytes; a larger chunk is decompressed on demand. Tests
/// have few points.
const MOST_WAITING: u64 = if cfg!(test) { 1 << 16 } else { 1 << 26 };
/// Chunks per thread in one batch, so that all threads end at about the same time.
const CHUNKS_PER_THREAD: usize = 4;
/// Largest number of chunks of a file; each takes 16 bytes of memory.
const MOST_CHUNKS: u64 = 1 << 24;
/// Growth of the result in bytes when points are decompressed one by one.
const STEP: usize = 1 << 20;

/// Separately compressed block of points.
struct Chunk {
    start: u64,
    /// Compressed size in bytes, if known.
    n_bytes: Option<u64>,
    n_points: u64,
}

/// Sequential decompressor of the points of a LAZ.
pub(super) struct Unpacker {
    file: File,
    n_bytes: u64,
    coding: Coding,
    n_points: u64,
    /// Number of points of each chunk but the last, if all are equal.
    chunk_points: Option<u64>,
    table: Option<ChunkTable>,
    /// Index of the next chunk, its start and its first point.
    next_chunk: usize,
    at: u64,
    point: u64,
    /// Decompressed points, and the number of bytes already returned.
    waiting: Vec<u8>,
    fetched: usize,
    packed: Vec<u8>,
    serial: Option<Serial>,
    /// Reader at the end of a chunk of unknown length.
    source: Option<BufReader<File>>,
}

/// Chunk that is decompressed point by point.
struct Serial {
    decompressor: Decompressor<'static, BufReader<File>>,
    start: u64,
    left: u64,
    is_length_known: bool,
}

impl Unpacker {
    pub(super) fn new(
        file: File,
        n_bytes: u64,
        header: &Header,
        description: &[u8],
    ) -> Result<Self, ReadError> {
        let start = header.points_start as u64;
        let wrong = |what: &str| broken(start, 0, what);
        let coding = Coding::of(description, header.record_bytes).map_err(|what| wrong(&what))?;
        let is_chunked = match u16_at(description, 0) {
            0 => return Err(wrong("its points are not compressed")),
            1 => false,
            _ => true,
        };
        let fixed = |n: u64| (n > 0 && n != VARIABLE).then_some(n);
        let chunk_points =
            if is_chunked { u32_at(description, 12).and_then(fixed) } else { Some(header.n_points) };
        let is_sequential = coding.n_layers.is_none();
        let mut this = Self {
            file,
            n_bytes,
            coding,
            n_points: header.n_points,
            chunk_points,
            table: None,
            next_chunk: 0,
            at: if is_chunked { start + 8 } else { start },
            point: 0,
            waiting: Vec::new(),
            fetched: 0,
            packed: Vec::new(),
            serial: None,
            source: None,
        };
        if is_chunked {
            let position = this.table_position(start)?;
            this.table = position.and_then(|position| this.read_table(position));
            if this.table.is_none() && chunk_points.is_none() && is_sequential {
                return Err(wrong("the table of its chunks of different sizes is missing"));
            }
        }
        Ok(this)
    }

    /// Start of the chunk table, if stated.
    fn table_position(&mut self, start: u64) -> Result<Option<u64>, ReadError> {
        for at in [Some(start), self.n_bytes.checked_sub(8)].into_iter().flatten() {
            let mut own = Vec::new();
            self.file.seek(SeekFrom::Start(at))?;
            (&self.file).take(8).read_to_end(&mut own)?;
            let position = i64_at(&own, 0).and_then(|position| u64::try_from(position).ok());
            if let Some(position) = position.filter(|&p| p > start) {
                return Ok(Some(position));
            }
        }
        Ok(None)
    }

    /// Reads the chunk table; `None` if it is truncated or invalid.
    fn read_table(&mut self, position: u64) -> Option<ChunkTable> {
        self.file.seek(SeekFrom::Start(position)).ok()?;
        let mut head = Vec::new();
        (&self.file).take(8).read_to_end(&mut head).ok()?;
        let room = position.checked_sub(self.at)?;
        // Each chunk begins with an uncompressed point.
        if u32_at(&head, 4)? > MOST_CHUNKS.min(room / self.coding.record_bytes as u64) {
            return None;
        }
        self.file.seek(SeekFrom::Start(position)).ok()?;
        let mut source = BufReader::new(&self.file);
        let is_variable = self.chunk_points.is_none();
        let read = catch_unwind(AssertUnwindSafe(|| ChunkTable::read(&mut source, is_variable)));
        let table = read.ok()?.ok()?;
        // The library converts the sizes to signed numbers.
        let bytes = table.as_ref().iter().try_fold(0, |sum: u64, entry| sum.checked_add(entry.byte_count))?;
        let counts = table.as_ref().iter().all(|entry| u32::try_from(entry.point_count).is_ok());
        (bytes <= room && counts).then_some(table)
    }

    /// Appends at most `most` records and returns their number, which is 0 only at the end.
    pub(super) fn read(&mut self, most: usize, records: &mut Vec<u8>) -> Result<usize, ReadError> {
        let size = self.coding.record_bytes;
        let mut n = 0;
        while n < most {
            if self.fetched < self.waiting.len() {
                let rows = (most - n).min((self.waiting.len() - self.fetched) / size);
                records.extend_from_slice(&self.waiting[self.fetched..][..rows * size]);
                self.fetched += rows * size;
                n += rows;
            } else if let Some(serial) = self.serial.take() {
                n += self.read_on(serial, most - n, records)?;
            } else if self.point < self.n_points {
                self.unpack_next()?;
            } else {
                break;
            }
        }
        Ok(n)
    }

    /// Skips at most `most` records and returns their number, which is smaller only at the end of the file. Chunks of
    /// known length are not decompressed.
    pub(super) fn skip(&mut self, most: u64) -> Result<u64, ReadError> {
        let size = self.coding.record_bytes;
        let mut left = most;
        let mut passed = Vec::new();
        while left > 0 {
            if self.fetched == self.waiting.len() && self.serial.is_none() && self.point < self.n_points {
                let before = (self.next_chunk, self.at, self.point);
                let chunk = self.next_chunk()?;
                if chunk.n_bytes.is_some() && chunk.n_points <= left {
                    left -= chunk.n_points;
                    continue;
                }
                (self.next_chunk, self.at, self.point) = before;
            }
            passed.clear();
            let n = self.read(left.min((STEP / size).max(1) as u64) as usize, &mut passed)?;
            if n == 0 {
                break;
            }
            left -= n as u64;
        }
        Ok(most - left)
    }

    /// Locates the next chunk and moves past it.
    fn next_chunk(&mut self) -> Result<Chunk, ReadError> {
        let (start, left) = (self.at, self.n_points - self.point);
        let n_points = self.chunk_points.map(|n| n.min(left));
        let chunk = if let Some(table) = &self.table {
            let Some(entry) = table.as_ref().get(self.next_chunk) else {
                return Err(self.ends(start, "its chunks contain fewer points than the header states"));
            };
            let n_points = n_points.unwrap_or(entry.point_count.min(left));
            Chunk { start, n_bytes: Some(entry.byte_count), n_points }
        } else if let Some(n_layers) = self.coding.n_layers {
            let (n_bytes, stated) = self.layered_head(start, n_layers)?;
            Chunk { start, n_bytes: Some(n_bytes), n_points: n_points.unwrap_or(stated.min(left)) }
        } else {
            Chunk { start, n_bytes: None, n_points: n_points.unwrap_or(left) }
        };
        if chunk.n_points == 0 && self.table.is_none() {
            return Err(self.ends(start, "a chunk is empty"));
        }
        let end = start.saturating_add(chunk.n_bytes.unwrap_or(0));
        if end > self.n_bytes {
            return Err(self.cut(end));
        }
        self.next_chunk += 1;
        self.at = end;
        self.point += chunk.n_points;
        Ok(chunk)
    }

    /// Reads the length of a layered chunk and the number of points it states.
    fn layered_head(&mut self, start: u64, n_layers: usize) -> Result<(u64, u64), ReadError> {
        let size = self.coding.record_bytes + 4 + 4 * n_layers;
        let mut head = Vec::new();
        self.file.seek(SeekFrom::Start(start))?;
        (&self.file).take(size as u64).read_to_end(&mut head)?;
        let sizes = layer_sizes(&head, self.coding.record_bytes, n_layers);
        let (n_points, n_bytes) = sizes.ok_or_else(|| self.cut(start + size as u64))?;
        Ok((size as u64 + n_bytes, n_points))
    }

    fn cut(&self, needed: u64) -> ReadError {
        ReadError::Truncated { end: self.n_bytes, needed, element: "point".into(), row: self.point }
    }

    fn ends(&self, at: u64, what: &str) -> ReadError {
        broken(at, self.point, what)
    }

    /// Decompresses the next chunks, or begins a chunk that is too long for that.
    fn unpack_next(&mut self) -> Result<(), ReadError> {
        let size = self.coding.record_bytes as u64;
        let first_point = self.point;
        let (mut chunks, mut unpacked, mut packed) = (Vec::new(), 0, 0);
        let most_chunks = CHUNKS_PER_THREAD * rayon::current_num_threads().max(1);
        while self.point < self.n_points && chunks.len() < most_chunks {
            let before = (self.next_chunk, self.at, self.point);
            let chunk = match self.next_chunk() {
                Ok(chunk) => chunk,
                // Earlier content first.
                Err(_) if !chunks.is_empty() => break,
                Err(error) => return Err(error),
            };
            let n_unpacked = chunk.n_points.saturating_mul(size);
            let n_packed = chunk.n_bytes.filter(|&n| n <= MOST_WAITING && n_unpacked <= MOST_WAITING);
            match n_packed {
                Some(n) if unpacked + n_unpacked <= MOST_WAITING && packed + n <= MOST_WAITING => {
                    unpacked += n_unpacked;
                    packed += n;
                    chunks.push(chunk);
                }
                None if chunks.is_empty() => return self.begin(&chunk, first_point),
                _ => {
                    (self.next_chunk, self.at, self.point) = before;
                    break;
                }
            }
        }
        let Some(first) = chunks.first() else { return Ok(()) };
        self.packed.resize(packed as usize, 0);
        self.file.seek(SeekFrom::Start(first.start))?;
        self.file.read_exact(&mut self.packed).map_err(|e| cut_or(e, self.n_bytes, first_point))?;
        self.fetched = 0;
        self.waiting.resize(unpacked as usize, 0);
        let (mut from, mut to) = (&self.packed[..], &mut self.waiting[..]);
        let mut parts = Vec::with_capacity(chunks.len());
        for chunk in &chunks {
            let (own, rest) = from.split_at(chunk.n_bytes.unwrap_or(0) as usize);
            let (rows, others) = to.split_at_mut((chunk.n_points * size) as usize);
            parts.push((own, rows));
            (from, to) = (rest, others);
        }
        let coding = &self.coding;
        let unpacked: Vec<_> = parts.into_par_iter().map(|(own, rows)| coding.unpack(own, rows)).collect();
        let mut point = first_point;
        for (chunk, outcome) in chunks.iter().zip(unpacked) {
            if let Err(failure) = outcome {
                self.waiting.clear();
                return Err(broken(chunk.start, point + failure.done as u64, &failure.what()));
            }
            point += chunk.n_points;
        }
        Ok(())
    }

    /// Begins to decompress a chunk point by point.
    fn begin(&mut self, chunk: &Chunk, first_point: u64) -> Result<(), ReadError> {
        if let Some(n_layers) = self.coding.n_layers {
            let (n_bytes, _) = self.layered_head(chunk.start, n_layers)?;
            if n_bytes > self.n_bytes - chunk.start {
                return Err(broken(chunk.start, first_point, "a layer is larger than the file"));
            }
        }
        let source = if let Some(source) = self.source.take() {
            source
        } else {
            let mut source = BufReader::with_capacity(STEP, self.file.try_clone()?);
            source.seek(SeekFrom::Start(chunk.start))?;
            source
        };
        let decompressor = self
            .coding
            .decompressor(source)
            .map_err(|e| broken(chunk.start, first_point, &crate::text::one_line(&e)))?;
        let is_length_known = chunk.n_bytes.is_some();
        self.serial =
            Some(Serial { decompressor, start: chunk.start, left: chunk.n_points, is_length_known });
        Ok(())
    }

    /// Decompresses the next points of a chunk in progress.
    fn read_on(
        &mut self,
        mut serial: Serial,
        most: usize,
        records: &mut Vec<u8>,
    ) -> Result<usize, ReadError> {
        let size = self.coding.record_bytes;
        let n = serial.left.min(most as u64).min((STEP / size).max(1) as u64) as usize;
        let start = records.len();
        records.resize(start + n * size, 0);
        if let Err(failure) = unpack_rows(&mut serial.decompressor, &mut records[start..], size) {
            records.truncate(start + failure.done * size);
            let point = self.point - serial.left + failure.done as u64;
            return Err(match failure.error {
                Some(error) if !serial.is_length_known => cut_or(error, self.n_bytes, point),
                _ => broken(serial.start, point, &failure.what()),
            });
        }
        serial.left -= n as u64;
        if serial.left > 0 {
            self.serial = Some(serial);
        } else if !serial.is_length_known {
            self.source = Some(serial.decompressor.box_into_inner());
        }
        Ok(n)
    }
}

fn broken(byte: u64, point: u64, what: &str) -> ReadError {
    let message = format!("the LAZ compression is damaged at point {point} ({what}); get an undamaged file");
    ReadError::Byte { byte, message }
}
