//! Fields of a LAS point record.

use adwave::{Cancelled, Progress};

use crate::formats::las::extra::ExtraBytes;
use crate::model::field::ByteOrder;
use crate::model::grouping::{group, unique};
use crate::progress::{collect, report_row};
use crate::{Field, FieldValues, NOISE_CLASSES, ValueType, WITHHELD_FLAG};

/// Size of a record of the point format in bytes, without extra bytes.
pub(crate) fn record_bytes(format: u8) -> Option<usize> {
    const BYTES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    BYTES.get(usize::from(format)).copied()
}

/// Byte offset, type and number of channels of the field of that name; `None` for a bit field or a missing field.
pub(crate) fn whole_column(format: u8, name: &str) -> Option<(usize, ValueType, usize)> {
    let old = format < 6;
    let has_time = matches!(format, 1 | 3 | 4 | 5) || !old;
    let color = match format {
        2 => Some(20),
        3 | 5 => Some(28),
        7 | 8 | 10 => Some(30),
        _ => None,
    };
    match name {
        "intensity" => Some((12, ValueType::U16, 1)),
        "classification" if !old => Some((16, ValueType::U8, 1)),
        "scan_angle" => Some(if old { (16, ValueType::I8, 1) } else { (18, ValueType::I16, 1) }),
        "user_data" => Some((17, ValueType::U8, 1)),
        "point_source" => Some((if old { 18 } else { 20 }, ValueType::U16, 1)),
        "gps_time" if has_time => Some((if old { 20 } else { 22 }, ValueType::F64, 1)),
        "color" => color.map(|at| (at, ValueType::U16, 3)),
        "near_infrared" if matches!(format, 8 | 10) => Some((36, ValueType::U16, 1)),
        _ => None,
    }
}

/// Bit field: its name, byte offset, first bit and mask.
pub(crate) type BitField = (&'static str, usize, u8, u8);

/// Bit fields of the point format.
pub(crate) fn bit_columns(format: u8) -> &'static [BitField] {
    const OLD: &[BitField] = &[
        ("return_number", 14, 0, 7),
        ("number_of_returns", 14, 3, 7),
        ("scan_direction", 14, 6, 1),
        ("edge_of_flight_line", 14, 7, 1),
        ("classification", 15, 0, 31),
        ("classification_flags", 15, 5, 7),
    ];
    const NEW: &[BitField] = &[
        ("return_number", 14, 0, 15),
        ("number_of_returns", 14, 4, 15),
        ("classification_flags", 15, 0, 15),
        ("scanner_channel", 15, 4, 3),
        ("scan_direction", 15, 6, 1),
        ("edge_of_flight_line", 15, 7, 1),
    ];
    if format < 6 { OLD } else { NEW }
}

/// Returns true if a point record is flagged as withheld or classified as noise (7 or 18), so that its producer does
/// not mean it to be used. False for a record that is too short.
pub fn is_flagged_record(format: u8, record: &[u8]) -> bool {
    let (class, flags) = if format < 6 {
        let Some(&byte) = record.get(15) else { return false };
        (byte & 31, byte >> 5)
    } else {
        let (Some(&flags), Some(&class)) = (record.get(15), record.get(16)) else { return false };
        (class, flags)
    };
    NOISE_CLASSES.contains(&class) || flags & WITHHELD_FLAG != 0
}

/// Point records, one after the other.
pub(crate) struct PointRecords<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) record_bytes: usize,
    pub(crate) n: usize,
    pub(crate) progress: Progress<'a>,
}

impl PointRecords<'_> {
    fn record(&self, i: usize) -> &[u8] {
        &self.bytes[i * self.record_bytes..][..self.record_bytes]
    }

    /// Reads `n_channels` numbers of each record, the first at byte `at`.
    fn column(&self, t: ValueType, at: usize, n_channels: usize) -> Result<FieldValues, Cancelled> {
        let mut values = t.empty();
        for i in 0..self.n {
            report_row(self.progress, i as u64, self.n as u64)?;
            for c in 0..n_channels {
                values.push_bytes(&self.record(i)[at + c * t.n_bytes()..], ByteOrder::Little);
            }
        }
        Ok(values)
    }

    /// Reads a bit field of each record.
    fn bits(&self, at: usize, shift: u8, mask: u8) -> Result<FieldValues, Cancelled> {
        Ok(FieldValues::U8(collect(self.n, self.progress, |i| (self.record(i)[at] >> shift) & mask)?))
    }
}

/// Reads all attributes of the points, each in its own type.
pub(crate) fn fields(
    format: u8,
    records: &PointRecords<'_>,
    extra: &[ExtraBytes],
) -> Result<Vec<Field>, Cancelled> {
    let mut all = Vec::new();
    let whole = |name: &'static str, all: &mut Vec<Field>| -> Result<(), Cancelled> {
        if let Some((at, kind, n_channels)) = whole_column(format, name) {
            all.push(Field::new(name, n_channels, records.column(kind, at, n_channels)?));
        }
        Ok(())
    };
    whole("intensity", &mut all)?;
    for &(name, at, shift, mask) in bit_columns(format) {
        all.push(Field::new(name, 1, records.bits(at, shift, mask)?));
    }
    let others: &[&str] = if format < 6 {
        &["scan_angle", "user_data", "point_source", "gps_time", "color"]
    } else {
        &["classification", "user_data", "scan_angle", "point_source", "gps_time", "color", "near_infrared"]
    };
    others.iter().try_for_each(|name| whole(name, &mut all))?;
    let mut columns = Vec::new();
    for own in extra.iter().filter(|own| own.at + own.n_bytes() <= records.record_bytes) {
        let values = records.column(own.value_type, own.at, own.n_channels)?;
        let values = match own.scale {
            Some((scale, offset)) => {
                FieldValues::F64(collect(values.len(), records.progress, |i| values.get(i) * scale + offset)?)
            }
            None => values,
        };
        if own.n_channels == 1 {
            columns.push((own.name.clone(), values));
        } else {
            all.push(Field::new(unique(&all, own.name.clone()), own.n_channels, values));
        }
    }
    for field in group(columns, records.progress)?.0 {
        all.push(Field { name: unique(&all, field.name), ..field });
    }
    Ok(all)
}
