//! Selected points as a LAS in memory.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use adwave::Progress;

use crate::formats::las::counts::Counts;
use crate::formats::las::part::selection::position;
use crate::formats::las::read::{
    Header, RECORD_HEAD, is_copc_record, parse_header, read_las, records, u32_at, u64_at,
};
use crate::formats::las::write::{COMPRESSED, LONG_HEADER, put, variable_record};
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Size of the head of an extended record in bytes.
const EXTENDED_HEAD: usize = 60;
/// Largest number of extended records of a file.
const MOST_EXTENDED: u32 = 1 << 16;
/// Header offset of the position of wave packets.
const WAVES: usize = 227;
/// Header offset of the position of extended records; their number follows.
const EXTENDED: usize = 235;

/// Writer of a LAS in memory.
pub(super) struct Image<'a> {
    header: Vec<u8>,
    parsed: Header,
    records: Vec<Vec<u8>>,
    extended: Vec<Vec<u8>>,
    /// Index of the extended record with the wave packets.
    waves: Option<usize>,
    points: Vec<u8>,
    counts: Counts,
    low: [f64; 3],
    high: [f64; 3],
    /// Size of all content except the points, in bytes.
    n_others: u64,
    limits: &'a ReadLimits,
}

impl<'a> Image<'a> {
    /// Creates a LAS without points, with the records of a file that begins with `head`.
    pub(super) fn new(
        head: &[u8],
        file: &mut File,
        limits: &'a ReadLimits,
        progress: Progress<'_>,
    ) -> Result<Self, ReadError> {
        let short = || ReadError::Whole("the header is truncated; get an undamaged file".into());
        let parsed = parse_header(head).ok_or_else(short)?;
        let header = head.get(..parsed.bytes).ok_or_else(short)?.to_vec();
        let kept = |record: &crate::formats::las::read::Record<'_>| {
            let end = record.start + RECORD_HEAD + record.content.len();
            (!record.is_compression() && !is_copc_record(record.user))
                .then(|| head[record.start..end].to_vec())
        };
        let records: Vec<_> = records(head, &parsed).iter().filter_map(kept).collect();
        let mut this = Self {
            n_others: (header.len() + records.iter().map(Vec::len).sum::<usize>()) as u64,
            header,
            parsed,
            records,
            extended: Vec::new(),
            waves: None,
            points: Vec::new(),
            counts: Counts::default(),
            low: [f64::INFINITY; 3],
            high: [f64::NEG_INFINITY; 3],
            limits,
        };
        this.read_extended(file, progress)?;
        Ok(this)
    }

    /// Copies the complete extended records of the file, except the hierarchy of a COPC.
    fn read_extended(&mut self, file: &mut File, progress: Progress<'_>) -> Result<(), ReadError> {
        if self.header[25] < 4 || self.header.len() < LONG_HEADER {
            return Ok(());
        }
        let n_bytes = file.metadata()?.len();
        let waves = u64_at(&self.header, WAVES);
        let mut at = u64_at(&self.header, EXTENDED).unwrap_or(0);
        for _ in 0..u32_at(&self.header, EXTENDED + 8).unwrap_or(0).min(MOST_EXTENDED) {
            progress.check()?;
            let mut record = Vec::new();
            file.seek(SeekFrom::Start(at))?;
            file.take(EXTENDED_HEAD as u64).read_to_end(&mut record)?;
            let length = if record.len() < EXTENDED_HEAD { None } else { u64_at(&record, 20) };
            let end = length.and_then(|n| at.checked_add(EXTENDED_HEAD as u64)?.checked_add(n));
            let (Some(length), Some(end)) = (length, end.filter(|&end| end <= n_bytes)) else { break };
            if !is_copc_record(&record[2..18]) {
                self.n_others = self.n_others.saturating_add(EXTENDED_HEAD as u64 + length);
                self.limits.check_bytes(self.n_others)?;
                file.take(length).read_to_end(&mut record)?;
                self.waves = self.waves.or((waves == Some(at)).then_some(self.extended.len()));
                self.extended.push(record);
            }
            at = end;
        }
        Ok(())
    }

    /// Stores the coordinate system as text, unless a record already does.
    pub(super) fn add_coordinate_system(&mut self, text: &str) {
        let is_said = |record: &Vec<u8>| record[2..].starts_with(b"LASF_Projection\0");
        let length = u16::try_from(text.len() + 1);
        if length.is_err() || text.is_empty() || self.records.iter().chain(&self.extended).any(is_said) {
            return;
        }
        let record = variable_record(b"LASF_Projection", 2112, &[text.as_bytes(), &[0]].concat());
        self.n_others += record.len() as u64;
        self.records.push(record);
        // Flag for a coordinate system as text.
        self.header[6] |= 16;
    }

    pub(super) fn header(&self) -> &Header {
        &self.parsed
    }

    /// Appends complete records.
    pub(super) fn add(&mut self, rows: &[u8]) -> Result<(), ReadError> {
        let size = self.parsed.record_bytes;
        self.limits.check_points(self.counts.n + (rows.len() / size) as u64)?;
        self.limits.check_bytes(self.n_others + (self.points.len() + rows.len()) as u64)?;
        for row in rows.chunks_exact(size) {
            self.counts.add(row, self.parsed.format);
            let point = position(row, &self.parsed);
            for (axis, &x) in point.iter().enumerate() {
                self.low[axis] = self.low[axis].min(x);
                self.high[axis] = self.high[axis].max(x);
            }
        }
        self.points.extend_from_slice(rows);
        Ok(())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Converts to a shape; `format` is that of the source files.
    pub(super) fn into_shape(
        mut self,
        format: Format,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<ShapeFile, ReadError> {
        self.finish_header();
        let mut bytes = self.header;
        bytes.extend(self.records.iter().flatten());
        bytes.append(&mut self.points);
        let mut position = bytes.len() as u64;
        if !self.extended.is_empty() {
            put(&mut bytes, EXTENDED, position.to_le_bytes());
        }
        for (k, mut record) in self.extended.into_iter().enumerate() {
            if self.waves == Some(k) {
                put(&mut bytes, WAVES, position.to_le_bytes());
            }
            position += record.len() as u64;
            bytes.append(&mut record);
        }
        let mut shape = read_las(bytes, limits, progress)?;
        shape.format = Some(format);
        Ok(shape)
    }

    /// Stores the counts, positions and bounds of the content.
    fn finish_header(&mut self) {
        let start = self.header.len() + self.records.iter().map(Vec::len).sum::<usize>();
        put(&mut self.header, 96, (start as u32).to_le_bytes());
        put(&mut self.header, 100, (self.records.len() as u32).to_le_bytes());
        self.header[104] &= !COMPRESSED;
        for axis in 0..3 {
            put(&mut self.header, 179 + 16 * axis, self.high[axis].to_le_bytes());
            put(&mut self.header, 187 + 16 * axis, self.low[axis].to_le_bytes());
        }
        self.counts.put_into(&mut self.header);
        let minor = self.header[25];
        if minor >= 3 && self.header.len() >= EXTENDED {
            put(&mut self.header, WAVES, 0_u64.to_le_bytes());
        }
        if minor >= 4 && self.header.len() >= LONG_HEADER {
            put(&mut self.header, EXTENDED, 0_u64.to_le_bytes());
            put(&mut self.header, EXTENDED + 8, (self.extended.len() as u32).to_le_bytes());
        } else if minor >= 4 && self.header.len() >= 255 {
            // Such headers are longer than in any version, and their 64-bit count is read.
            put(&mut self.header, 247, self.counts.n.to_le_bytes());
        } else if u32_at(&self.header, 107) == Some(0) {
            put(&mut self.header, 107, u32::try_from(self.counts.n).unwrap_or(0).to_le_bytes());
        }
    }
}
