//! The fields of a LAS point record.

use adwave::{Cancelled, Progress};

use crate::field::ByteOrder;
use crate::progress::{at_row, collect};
use crate::{Field, FieldValues, ValueType};

/// The bytes of a record of the point format, without extra bytes.
pub(crate) fn record_bytes(format: u8) -> Option<usize> {
    const BYTES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    BYTES.get(usize::from(format)).copied()
}

/// Where a record has the field of that name, its type and its channels; `None` of a field that is a few bits of a byte, or is not
/// there.
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
        "classification" => Some(if old { (15, ValueType::U8, 1) } else { (16, ValueType::U8, 1) }),
        "scan_angle" => Some(if old { (16, ValueType::I8, 1) } else { (18, ValueType::I16, 1) }),
        "user_data" => Some((17, ValueType::U8, 1)),
        "point_source" => Some((if old { 18 } else { 20 }, ValueType::U16, 1)),
        "gps_time" if has_time => Some((if old { 20 } else { 22 }, ValueType::F64, 1)),
        "color" => color.map(|at| (at, ValueType::U16, 3)),
        "near_infrared" if matches!(format, 8 | 10) => Some((36, ValueType::U16, 1)),
        _ => None,
    }
}

/// An attribute that a program has added after the standard ones.
pub(crate) struct ExtraBytes {
    name: String,
    value_type: ValueType,
    n_channels: usize,
    scale: Option<(f64, f64)>,
}

impl ExtraBytes {
    /// Parses the descriptions, 192 bytes each; stops at one whose size is not known.
    pub(crate) fn parse(content: &[u8]) -> Vec<Self> {
        const TYPES: [ValueType; 10] = [
            ValueType::U8,
            ValueType::I8,
            ValueType::U16,
            ValueType::I16,
            ValueType::U32,
            ValueType::I32,
            ValueType::U64,
            ValueType::I64,
            ValueType::F32,
            ValueType::F64,
        ];
        let mut all = Vec::new();
        for entry in content.chunks_exact(192) {
            let code = usize::from(entry[2]);
            // Type 0 is `options` bytes without a meaning; 11 to 30 are pairs and triples of the first ten.
            let (value_type, n_channels) = match code {
                0 => (ValueType::U8, usize::from(entry[3]).max(1)),
                1..=30 => (TYPES[(code - 1) % 10], 1 + (code - 1) / 10),
                _ => break,
            };
            let text = entry[4..36].split(|&b| b == 0).next().unwrap_or(b"");
            let number = |at: usize| {
                let mut own = [0; 8];
                own.copy_from_slice(&entry[at..at + 8]);
                f64::from_le_bytes(own)
            };
            let (has_scale, has_offset) = (entry[3] & 8 != 0, entry[3] & 16 != 0);
            let scale = (code > 0 && (has_scale || has_offset)).then(|| {
                (if has_scale { number(112) } else { 1.0 }, if has_offset { number(136) } else { 0.0 })
            });
            all.push(Self {
                name: String::from_utf8_lossy(text).into_owned(),
                value_type,
                n_channels,
                scale,
            });
        }
        all
    }
}

/// The point records, one after the other.
pub(crate) struct Records<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) record_bytes: usize,
    pub(crate) n: usize,
    pub(crate) progress: Progress<'a>,
}

impl Records<'_> {
    fn record(&self, i: usize) -> &[u8] {
        &self.bytes[i * self.record_bytes..][..self.record_bytes]
    }

    /// `n_channels` numbers of each record, the first at byte `at`.
    fn column(&self, t: ValueType, at: usize, n_channels: usize) -> Result<FieldValues, Cancelled> {
        let mut values = t.empty();
        for i in 0..self.n {
            at_row(self.progress, i as u64, self.n as u64)?;
            for c in 0..n_channels {
                values.push_bytes(&self.record(i)[at + c * t.n_bytes()..], ByteOrder::Little);
            }
        }
        Ok(values)
    }

    /// Some bits of one byte of each record.
    fn bits(&self, at: usize, shift: u8, mask: u8) -> Result<FieldValues, Cancelled> {
        Ok(FieldValues::U8(collect(self.n, self.progress, |i| (self.record(i)[at] >> shift) & mask)?))
    }
}

/// All attributes of the points, each in its own type.
pub(crate) fn fields(
    format: u8,
    records: &Records<'_>,
    extra: &[ExtraBytes],
) -> Result<Vec<Field>, Cancelled> {
    let column = |t: ValueType, at: usize, n: usize| records.column(t, at, n);
    let bits = |at: usize, shift: u8, mask: u8| records.bits(at, shift, mask);
    let mut all = Vec::new();
    let mut add = |name: &str, n: usize, values: FieldValues| all.push(Field::new(name, n, values));
    add("intensity", 1, column(ValueType::U16, 12, 1)?);
    let (time, color, nir) = if format < 6 {
        add("return_number", 1, bits(14, 0, 7)?);
        add("number_of_returns", 1, bits(14, 3, 7)?);
        add("scan_direction", 1, bits(14, 6, 1)?);
        add("edge_of_flight_line", 1, bits(14, 7, 1)?);
        add("classification", 1, bits(15, 0, 31)?);
        add("classification_flags", 1, bits(15, 5, 7)?);
        add("scan_angle", 1, column(ValueType::I8, 16, 1)?);
        add("user_data", 1, column(ValueType::U8, 17, 1)?);
        add("point_source", 1, column(ValueType::U16, 18, 1)?);
        let has_time = matches!(format, 1 | 3 | 4 | 5);
        let color = matches!(format, 2 | 3 | 5).then_some(if has_time { 28 } else { 20 });
        (has_time.then_some(20), color, None)
    } else {
        add("return_number", 1, bits(14, 0, 15)?);
        add("number_of_returns", 1, bits(14, 4, 15)?);
        add("classification_flags", 1, bits(15, 0, 15)?);
        add("scanner_channel", 1, bits(15, 4, 3)?);
        add("scan_direction", 1, bits(15, 6, 1)?);
        add("edge_of_flight_line", 1, bits(15, 7, 1)?);
        add("classification", 1, column(ValueType::U8, 16, 1)?);
        add("user_data", 1, column(ValueType::U8, 17, 1)?);
        add("scan_angle", 1, column(ValueType::I16, 18, 1)?);
        add("point_source", 1, column(ValueType::U16, 20, 1)?);
        (Some(22), matches!(format, 7 | 8 | 10).then_some(30), matches!(format, 8 | 10).then_some(36))
    };
    if let Some(at) = time {
        add("gps_time", 1, column(ValueType::F64, at, 1)?);
    }
    if let Some(at) = color {
        add("color", 3, column(ValueType::U16, at, 3)?);
    }
    if let Some(at) = nir {
        add("near_infrared", 1, column(ValueType::U16, at, 1)?);
    }
    let mut at = record_bytes(format).unwrap_or(0);
    for own in extra {
        let n_bytes = own.value_type.n_bytes() * own.n_channels;
        if records.record_bytes < at + n_bytes {
            break;
        }
        let values = column(own.value_type, at, own.n_channels)?;
        let values = match own.scale {
            Some((scale, offset)) => {
                FieldValues::F64(collect(values.len(), records.progress, |i| values.get(i) * scale + offset)?)
            }
            None => values,
        };
        add(&own.name, own.n_channels, values);
        at += n_bytes;
    }
    Ok(all)
}
