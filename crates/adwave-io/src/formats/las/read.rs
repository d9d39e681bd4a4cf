//! Reader for LAS 1.0 – 1.4 and its compressed form LAZ.
//!
//! The header and the point records are parsed here, because every field of a record is read in its own type,
//! including bit fields and extra bytes, and because numbers of the header are not trusted. The crate `laz`
//! decompresses records; sizes that it would trust are checked first.

use std::borrow::Cow;
use std::sync::Arc;

use adwave::Progress;

use crate::formats::las::crs::coordinate_system;
use crate::formats::las::extra::ExtraBytes;
use crate::formats::las::fields::{PointRecords, fields, record_bytes};
use crate::formats::las::write::{LasSource, provenance};
use crate::progress::collect;
use crate::{CoordinatePrecision, Format, ReadError, ReadLimits, ShapeFile};

/// Size of the shortest header in bytes; later versions extend it.
pub(crate) const LEAST_HEADER: usize = 227;
/// Size of the head of a variable-length record in bytes.
pub(crate) const RECORD_HEAD: usize = 54;

/// Header fields used for reading.
pub(crate) struct LasHeader {
    pub(crate) format: u8,
    pub(crate) record_bytes: usize,
    pub(crate) n_points: u64,
    pub(crate) bytes: usize,
    pub(crate) points_start: usize,
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
    pub(crate) is_compressed: bool,
}

/// Variable-length record of the header.
pub(crate) struct VariableRecord<'a> {
    /// Start of the record.
    pub(crate) start: usize,
    pub(crate) user: &'a [u8],
    pub(crate) id: u16,
    pub(crate) content: &'a [u8],
}

/// Number of the record that describes the compression.
pub(crate) const LASZIP: u16 = 22204;

impl VariableRecord<'_> {
    /// True if the record describes the compression of the points.
    pub(crate) fn is_compression(&self) -> bool {
        self.user.starts_with(b"laszip encoded") && self.id == LASZIP
    }
}

/// True if the record's user is COPC, whose records are valid only for one order of the points.
pub(crate) fn is_copc_record(user: &[u8]) -> bool {
    user.starts_with(b"copc\0")
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

pub(crate) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

pub(crate) fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

pub(crate) fn f64_at(bytes: &[u8], at: usize) -> Option<f64> {
    u64_at(bytes, at).map(f64::from_bits)
}

/// Reads a LAS or LAZ.
pub(crate) fn read_las(
    file: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let bytes = &file[..];
    let header = parse_header(bytes).ok_or_else(|| ReadError::Truncated {
        end: bytes.len() as u64,
        needed: LEAST_HEADER as u64,
        element: "header".into(),
        row: 0,
    })?;
    check_header(bytes.len() as u64, &header)?;
    limits.check_points(header.n_points)?;
    if header.is_compressed {
        limits.check_bytes(header.n_points.saturating_mul(header.record_bytes as u64))?;
    }
    let points = unpack_records(bytes, &header, progress)?;
    let records = records(bytes, &header);
    let extra = |r: &&VariableRecord<'_>| r.user.starts_with(b"LASF_Spec") && r.id == 4;
    let standard = record_bytes(header.format).unwrap_or(header.record_bytes);
    let extra = ExtraBytes::parse(records.iter().find(extra).map_or(&[], |r| r.content), standard);
    let n = header.n_points as usize;
    let n = n.min(points.len() / header.record_bytes);
    let row = |i: usize| &points[i * header.record_bytes..][..header.record_bytes];
    let coordinate = |row: &[u8], axis: usize| {
        let whole = u32_at(row, 4 * axis).map_or(0, u32::cast_signed);
        f64::from(whole) * header.scale[axis] + header.offset[axis]
    };
    let mut shape =
        ShapeFile::from_cloud(collect(n, progress, |i| [0, 1, 2].map(|axis| coordinate(row(i), axis)))?);
    shape.format = Some(if header.is_compressed { Format::LAZ } else { Format::LAS });
    shape.precision = CoordinatePrecision::F64;
    shape.vertex_fields = fields(
        header.format,
        &PointRecords { bytes: &points, record_bytes: header.record_bytes, n, progress },
        &extra,
    )?;
    shape.extras.push("the LAS header and its records".into());
    shape.provenance = provenance(&records).map(Arc::new);
    if let Some(system) = coordinate_system(bytes, &header, &records) {
        shape.unit.clone_from(&system.unit);
        shape.coordinate_system = Some(Arc::new(system));
    }
    // A shape without all points of the file could not be written again.
    if n as u64 == header.n_points {
        shape.set_source(LasSource { bytes: Arc::new(file), kept: None });
    }
    Ok(shape)
}

/// Returns the point records one after the other, decompressed if necessary.
pub(crate) fn unpack_records<'a>(
    bytes: &'a [u8],
    header: &LasHeader,
    progress: Progress<'_>,
) -> Result<Cow<'a, [u8]>, ReadError> {
    if !header.is_compressed {
        return Ok(Cow::Borrowed(&bytes[header.points_start..]));
    }
    let description = compression(&records(bytes, header))?;
    crate::formats::las::laz::unpack(bytes, header, description, progress).map(Cow::Owned)
}

/// Description of the compression in the file.
pub(crate) fn compression<'a>(records: &[VariableRecord<'a>]) -> Result<&'a [u8], ReadError> {
    let missing =
        || ReadError::Whole("the LAZ has no record of its compression; get an undamaged file".into());
    records.iter().find(|r| r.is_compression()).map(|r| r.content).ok_or_else(missing)
}

pub(crate) fn parse_header(bytes: &[u8]) -> Option<LasHeader> {
    let minor = *bytes.get(25)?;
    let format_byte = *bytes.get(104)?;
    let legacy = u64::from(u32_at(bytes, 107)?);
    // From version 1.4 on there is a 64-bit count; older programs omit it from their shorter header.
    let long = if minor >= 4 && u16_at(bytes, 94)? >= 255 { u64_at(bytes, 247)? } else { 0 };
    let triple = |at: usize| Some([f64_at(bytes, at)?, f64_at(bytes, at + 8)?, f64_at(bytes, at + 16)?]);
    bytes.get(LEAST_HEADER - 1)?;
    Some(LasHeader {
        format: format_byte & 0x3f,
        record_bytes: usize::from(u16_at(bytes, 105)?),
        n_points: if long > 0 { long } else { legacy },
        bytes: usize::from(u16_at(bytes, 94)?),
        points_start: u32_at(bytes, 96)? as usize,
        scale: triple(131)?,
        offset: triple(155)?,
        is_compressed: format_byte & 0x80 != 0,
    })
}

/// Checks the header of a file of that many bytes.
pub(crate) fn check_header(n_bytes: u64, header: &LasHeader) -> Result<(), ReadError> {
    let Some(least) = record_bytes(header.format) else {
        let message =
            format!("the point format must be in 0..=10, got {}; get an undamaged file", header.format);
        return Err(ReadError::byte_error(104, message));
    };
    if header.record_bytes < least {
        let message =
            format!("records of {} bytes are too short for format {}", header.record_bytes, header.format);
        return Err(ReadError::byte_error(105, message));
    }
    if header.bytes < LEAST_HEADER {
        let message = format!("a header of {} bytes is too short; get an undamaged file", header.bytes);
        return Err(ReadError::byte_error(94, message));
    }
    if header.points_start < header.bytes {
        let message = format!(
            "the points begin at byte {}, inside the header of {} bytes; get an undamaged file",
            header.points_start, header.bytes
        );
        return Err(ReadError::byte_error(96, message));
    }
    let remaining = n_bytes.saturating_sub(header.points_start as u64);
    let needed = header.n_points.saturating_mul(header.record_bytes as u64);
    if header.points_start as u64 > n_bytes || (!header.is_compressed && remaining < needed) {
        return Err(ReadError::Truncated {
            end: n_bytes,
            needed: (header.points_start as u64).saturating_add(needed),
            element: "point".into(),
            row: remaining / header.record_bytes as u64,
        });
    }
    Ok(())
}

/// Complete records between header and points.
pub(crate) fn records<'a>(bytes: &'a [u8], header: &LasHeader) -> Vec<VariableRecord<'a>> {
    let bytes = bytes.get(..header.points_start).unwrap_or(bytes);
    let mut records = Vec::new();
    let mut at = header.bytes;
    for _ in 0..u32_at(bytes, 100).unwrap_or(0) {
        let (Some(user), Some(id), Some(n)) =
            (bytes.get(at + 2..at + 18), u16_at(bytes, at + 18), u16_at(bytes, at + 20))
        else {
            break;
        };
        let start = at + RECORD_HEAD;
        let Some(content) = bytes.get(start..start + usize::from(n)) else { break };
        records.push(VariableRecord { start: at, user, id, content });
        at = start + usize::from(n);
    }
    records
}
