//! LAS and LAZ writer: rewrites the records that were read, so that their other content stays, or writes a new file
//! of version 1.2.

use crate::model::source_document::SourceDocument;
use std::io::{Cursor, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use adwave::Progress;

use crate::formats::las::counts::PointCounts;
use crate::formats::las::fields::record_bytes;
use crate::formats::las::places::{DimensionSlot, fits};
use crate::formats::las::read::{
    LASZIP, LEAST_HEADER, LasHeader, RECORD_HEAD, VariableRecord, is_copc_record, parse_header, records,
    unpack_records,
};
use crate::formats::las::steps::CoordinateSteps;
use crate::progress::report_row;
use crate::provenance::{NAME, Provenance};
use crate::{Format, ShapeFile, ValueType, WriteError, WriteReport};

/// Bytes of a LAS or LAZ, and the indices of the shape's points in it; all points if there is no list.
#[derive(Debug)]
pub(crate) struct LasSource {
    pub(crate) bytes: Arc<Vec<u8>>,
    pub(crate) kept: Option<Vec<u32>>,
}

impl SourceDocument for LasSource {
    /// The records of a LAS stay in a LAZ, and the other way round.
    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::LAS || format == Format::LAZ
    }

    fn subset(&self, vertices: &[u32]) -> Option<Arc<dyn SourceDocument>> {
        let kept = match &self.kept {
            Some(kept) => vertices.iter().map(|&v| kept[v as usize]).collect(),
            None => vertices.to_vec(),
        };
        Some(Arc::new(Self { bytes: Arc::clone(&self.bytes), kept: Some(kept) }))
    }
}

/// Number of points per compressed chunk.
pub(crate) const CHUNK: u32 = 50_000;
/// Bit of the point format that marks compressed points.
pub(crate) const COMPRESSED: u8 = 0x80;
/// Size of the header of version 1.4 in bytes.
pub(crate) const LONG_HEADER: usize = 375;

/// Uncompressed file in parts.
pub(crate) struct LasParts {
    pub(crate) header: Vec<u8>,
    /// Complete variable-length records, without that of the compression.
    pub(crate) records: Vec<Vec<u8>>,
    /// Unused bytes between these records and the points.
    gap: Vec<u8>,
    pub(crate) points: Vec<u8>,
    /// Content after the points, and its original start.
    tail: Vec<u8>,
    tail_start: usize,
    pub(crate) parsed: LasHeader,
}

/// Writes the shape's points.
pub(crate) fn write_las(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if !shape.faces.is_empty() {
        report.report_dropped("faces");
    }
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    report.report_face_fields(shape, &[]);
    let original = shape.source::<LasSource>();
    let mut parts = if let Some(original) = original {
        LasParts::read(original, progress).ok_or_else(|| cannot(format, "points of a damaged file"))?
    } else {
        let steps = CoordinateSteps::choose(shape);
        steps.report(shape, report);
        LasParts::new(shape, format, &steps)?
    };
    if shape.moved || original.is_none() {
        parts.set_points(shape, format, progress)?;
    }
    parts.set_fields(shape, original.is_some(), report, progress)?;
    // An unchanged scan keeps its bytes.
    let is_same = original.is_some() && !shape.moved && shape.edited.is_empty();
    if !is_same {
        parts.records.retain(|record| !is_provenance(record));
        parts.records.extend(shape.valid_provenance().and_then(provenance_record));
    }
    if original.is_none_or(|original| original.kept.is_some()) {
        parts.count();
    }
    let bytes = parts.assembled(format == Format::LAZ, format, progress)?;
    out.write_all(&bytes)?;
    Ok(())
}

fn cannot(format: Format, what: impl Into<String>) -> WriteError {
    WriteError::CannotHold { format, what: what.into() }
}

pub(crate) fn put<const N: usize>(bytes: &mut [u8], at: usize, value: [u8; N]) {
    bytes[at..at + N].copy_from_slice(&value);
}

impl LasParts {
    /// Parses the file that was read before; `None` if that fails, which only a changed library could cause.
    fn read(original: &LasSource, progress: Progress<'_>) -> Option<Self> {
        let bytes = &original.bytes[..];
        let parsed = parse_header(bytes)?;
        let all = unpack_records(bytes, &parsed, progress).ok()?;
        let size = parsed.record_bytes;
        let points = match &original.kept {
            Some(kept) => kept.iter().flat_map(|&i| &all[i as usize * size..][..size]).copied().collect(),
            None => all[..parsed.n_points as usize * size].to_vec(),
        };
        let mut this = Self {
            header: bytes[..parsed.bytes].to_vec(),
            records: Vec::new(),
            gap: Vec::new(),
            points,
            tail: Vec::new(),
            tail_start: bytes.len(),
            parsed,
        };
        let mut records_end = this.header.len();
        for record in records(bytes, &this.parsed) {
            records_end = record.start + RECORD_HEAD + record.content.len();
            if !record.is_compression() && !is_copc_record(record.user) {
                this.records
                    .push(bytes[record.start..record.start + RECORD_HEAD + record.content.len()].to_vec());
            }
        }
        this.gap = bytes.get(records_end..this.parsed.points_start).unwrap_or_default().to_vec();
        this.tail_start = this.where_tail_starts(bytes.len());
        this.tail = bytes[this.tail_start..].to_vec();
        Some(this)
    }

    /// Start of the tail: the extended records and wave packets state theirs; without compression, everything after
    /// the points is kept.
    fn where_tail_starts(&self, end: usize) -> usize {
        let stated = self.positions().into_iter().filter_map(|at| usize::try_from(self.u64_at(at)).ok());
        let points_end = self.parsed.points_start + self.parsed.n_points as usize * self.parsed.record_bytes;
        let (least, otherwise) = if self.parsed.is_compressed {
            (self.parsed.points_start + 1, end)
        } else {
            (points_end, points_end)
        };
        stated.filter(|start| (least..end).contains(start)).min().unwrap_or(otherwise).min(end)
    }

    /// Header offsets of positions after the points.
    fn positions(&self) -> Vec<usize> {
        let (minor, length) = (self.header[25], self.header.len());
        let mut found = Vec::new();
        if minor >= 3 && length >= 235 {
            found.push(227);
        }
        if minor >= 4 && length >= 375 {
            found.push(235);
        }
        found
    }

    fn u64_at(&self, at: usize) -> u64 {
        let mut own = [0; 8];
        own.copy_from_slice(&self.header[at..at + 8]);
        u64::from_le_bytes(own)
    }

    /// Creates a file without fields: version 1.2 if its records can store all fields of the shape, else 1.4, the
    /// first version with extra bytes.
    fn new(shape: &ShapeFile, format: Format, steps: &CoordinateSteps) -> Result<Self, WriteError> {
        if shape.points.is_empty() {
            return Err(cannot(format, "a shape without points"));
        }
        let has_color = shape.field("color").is_some_and(|f| f.n_channels == 3 && fits(f, ValueType::U16));
        let old = if has_color { 2 } else { 0 };
        let is_old = shape.vertex_fields.iter().all(|field| DimensionSlot::find(old, field).is_some());
        let id = if is_old { old } else { 6 + u8::from(has_color) };
        let size = record_bytes(id).unwrap_or(20);
        let mut header = new_header(if is_old { 2 } else { 4 }, id, size as u16, steps.scale, steps.offset);
        if is_old {
            put(&mut header, 107, 1_u32.to_le_bytes());
        }
        // Return 1 of 1.
        let mut record = vec![0; size];
        record[14] = if is_old { 0b1001 } else { 0b1_0001 };
        let Some(parsed) = parse_header(&header) else { return Err(cannot(format, "these points")) };
        Ok(Self {
            header,
            records: Vec::new(),
            gap: Vec::new(),
            points: record.repeat(shape.points.len()),
            tail: Vec::new(),
            tail_start: 0,
            parsed,
        })
    }

    /// Stores the coordinates in steps of the header, and the bounds. Unchanged coordinates keep their number.
    fn set_points(
        &mut self,
        shape: &ShapeFile,
        format: Format,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let (size, n) = (self.parsed.record_bytes, shape.points.len() as u64);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (i, point) in shape.points.iter().enumerate() {
            report_row(progress, i as u64, n)?;
            let row = &mut self.points[i * size..][..size];
            for axis in 0..3 {
                let (scale, offset) = (self.parsed.scale[axis], self.parsed.offset[axis]);
                let steps = ((point[axis] - offset) / scale).round();
                if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&steps) {
                    let what =
                        format!("the coordinate {} in steps of {scale:?} from {offset:?}", point[axis]);
                    return Err(cannot(format, what));
                }
                put(row, 4 * axis, (steps as i32).to_le_bytes());
                let value = steps * scale + offset;
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        for axis in 0..3 {
            put(&mut self.header, 179 + 16 * axis, high[axis].to_le_bytes());
            put(&mut self.header, 187 + 16 * axis, low[axis].to_le_bytes());
        }
        Ok(())
    }

    /// Stores the number of points, in total and per return, in the header.
    fn count(&mut self) {
        let mut counts = PointCounts::default();
        for row in self.points.chunks_exact(self.parsed.record_bytes) {
            counts.add(row, self.parsed.format);
        }
        counts.put_into(&mut self.header);
    }

    /// Assembles the whole file.
    fn assembled(
        mut self,
        compressed: bool,
        format: Format,
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, WriteError> {
        let compression = if compressed {
            Some(
                compression(self.parsed.format, self.parsed.record_bytes, CHUNK)
                    .map_err(|what| cannot(format, what))?,
            )
        } else {
            None
        };
        if let Some(description) = &compression {
            self.records.push(compression_record(description));
        }
        let start = self.header.len() + self.records.iter().map(Vec::len).sum::<usize>() + self.gap.len();
        let too_large = || cannot(format, "records before the points of more than 4 GiB");
        put(&mut self.header, 96, u32::try_from(start).map_err(|_| too_large())?.to_le_bytes());
        put(&mut self.header, 100, (self.records.len() as u32).to_le_bytes());
        self.header[104] = self.parsed.format | if compressed { COMPRESSED } else { 0 };
        let mut bytes = self.header.clone();
        bytes.extend(self.records.iter().flatten());
        bytes.extend(&self.gap);
        match &compression {
            Some(description) if !self.points.is_empty() => {
                let points = std::mem::take(&mut self.points);
                let size = self.parsed.record_bytes;
                // No object of the library survives, so a state left inconsistent by a panic is never used.
                let compressed =
                    catch_unwind(AssertUnwindSafe(|| compress(bytes, description, &points, size, progress)));
                bytes = compressed
                    .unwrap_or_else(|_| Err(PackError::Refused("these points; write a LAS instead".into())))
                    .map_err(|stop| stop.into_error(format))?;
            }
            _ => bytes.append(&mut self.points),
        }
        // The content after the points has moved.
        for at in self.positions() {
            let old = self.u64_at(at);
            if old >= self.tail_start as u64 && old > 0 && !self.tail.is_empty() {
                let new = old - self.tail_start as u64 + bytes.len() as u64;
                put(&mut bytes, at, new.to_le_bytes());
            }
        }
        bytes.append(&mut self.tail);
        Ok(bytes)
    }
}

/// Creates the header of a new file without points, of version 1.2 or 1.4 (`minor`).
pub(crate) fn new_header(minor: u8, format: u8, size: u16, scale: [f64; 3], offset: [f64; 3]) -> Vec<u8> {
    let n_bytes = if minor >= 4 { LONG_HEADER } else { LEAST_HEADER };
    let mut header = vec![0; n_bytes];
    header[..4].copy_from_slice(b"LASF");
    header[24..26].copy_from_slice(&[1, minor]);
    if format >= 6 {
        // Coordinate systems of these formats are stored as text.
        header[6] = 16;
    }
    header[26..31].copy_from_slice(b"OTHER");
    let program = concat!("adwave ", env!("CARGO_PKG_VERSION")).as_bytes();
    header[58..58 + program.len()].copy_from_slice(program);
    put(&mut header, 94, (n_bytes as u16).to_le_bytes());
    header[104] = format;
    put(&mut header, 105, size.to_le_bytes());
    for axis in 0..3 {
        put(&mut header, 131 + 8 * axis, scale[axis].to_le_bytes());
        put(&mut header, 155 + 8 * axis, offset[axis].to_le_bytes());
    }
    header
}

/// Compression for points of this format and size; the error has the reason if there is none.
pub(crate) fn compression(format: u8, size: usize, chunk: u32) -> Result<laz::LazVlr, String> {
    let extra = size.saturating_sub(record_bytes(format).unwrap_or(size));
    let builder = laz::LazVlrBuilder::default().with_point_format(format, extra as u16);
    Ok(builder
        .map_err(|e| format!("point format {format}: {}", crate::text::one_line(&e)))?
        .with_fixed_chunk_size(chunk)
        .build())
}

/// Creates the variable-length record of the compression.
pub(crate) fn compression_record(description: &laz::LazVlr) -> Vec<u8> {
    let mut content = Vec::new();
    // Writing to a vector cannot fail.
    let _ = description.write_to(&mut content);
    variable_record(b"laszip encoded", LASZIP, &content)
}

/// Number of the record with the provenance.
const PROVENANCE: u16 = 1;

/// Creates the record with the provenance; `None` if it does not fit in one record.
pub(crate) fn provenance_record(provenance: &Provenance) -> Option<Vec<u8>> {
    let json = provenance.to_json();
    u16::try_from(json.len()).ok()?;
    Some(variable_record(NAME.as_bytes(), PROVENANCE, json.as_bytes()))
}

/// True if the record contains the provenance.
pub(crate) fn is_provenance(record: &[u8]) -> bool {
    record[2..].starts_with(NAME.as_bytes())
        && record[2 + NAME.len()] == 0
        && record[18..20] == PROVENANCE.to_le_bytes()
}

/// Provenance of the points, if a record has it.
pub(crate) fn provenance(records: &[VariableRecord<'_>]) -> Option<Provenance> {
    let is_own = |r: &&VariableRecord<'_>| {
        r.id == PROVENANCE && r.user.split(|&b| b == 0).next() == Some(NAME.as_bytes())
    };
    Provenance::from_json(std::str::from_utf8(records.iter().find(is_own)?.content).ok()?)
}

/// Creates a variable-length record of at most 65,535 bytes.
pub(crate) fn variable_record(user: &[u8], id: u16, content: &[u8]) -> Vec<u8> {
    let mut record = vec![0; RECORD_HEAD];
    record[2..2 + user.len()].copy_from_slice(user);
    put(&mut record, 18, id.to_le_bytes());
    put(&mut record, 20, (content.len() as u16).to_le_bytes());
    record.extend(content);
    record
}

/// Points compressed between two checks for cancellation.
const STEP: usize = 1 << 15;

enum PackError {
    Cancelled(adwave::Cancelled),
    Refused(String),
}

impl PackError {
    fn into_error(self, format: Format) -> WriteError {
        match self {
            Self::Cancelled(cancelled) => cancelled.into(),
            Self::Refused(what) => cannot(format, what),
        }
    }
}

/// Appends the compressed points; the positions stored in them count from the start of the file.
///
/// The library subtracts times as integers and panics in a debug build if that overflows; the caller catches the
/// panic.
fn compress(
    before: Vec<u8>,
    description: &laz::LazVlr,
    points: &[u8],
    record_bytes: usize,
    progress: Progress<'_>,
) -> Result<Vec<u8>, PackError> {
    let refused =
        |e: &dyn std::fmt::Display| PackError::Refused(format!("these points: {}", crate::text::one_line(e)));
    let mut target = Cursor::new(before);
    target.set_position(target.get_ref().len() as u64);
    let mut compressor =
        laz::LasZipCompressor::new(&mut target, description.clone()).map_err(|e| refused(&e))?;
    let n = points.len() / record_bytes;
    for (k, chunk) in points.chunks(STEP * record_bytes).enumerate() {
        progress.step((k * STEP) as u64, n as u64).map_err(PackError::Cancelled)?;
        compressor.compress_many(chunk).map_err(|e| refused(&e))?;
    }
    compressor.done().map_err(|e| refused(&e))?;
    drop(compressor);
    Ok(target.into_inner())
}
