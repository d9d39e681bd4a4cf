//! Records of a scan, and the columns they are stored in.

use e57::{PointCloud, RecordDataType, RecordName, RecordValue};

use crate::{Field, FieldValues, ReadError};

/// Positions of the coordinates and fields within a record.
pub(super) struct RecordLayout {
    /// Cartesian x, y, z, or range, azimuth, elevation.
    place: [usize; 3],
    is_spherical: bool,
    /// Component that tells whether the record has a position.
    state: Option<usize>,
    types: Vec<RecordDataType>,
    columns: Vec<ScanField>,
}

/// Field of a scan.
#[derive(Clone, PartialEq)]
struct ScanField {
    name: String,
    records: Vec<usize>,
    /// Component that marks a missing value if it is not 0.
    invalid: Option<usize>,
    kind: NumberKind,
}

/// Type of a column's numbers, wider ones last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum NumberKind {
    U8,
    U16,
    I32,
    I64,
    F32,
    F64,
}

fn kind(data_type: &RecordDataType) -> NumberKind {
    match data_type {
        RecordDataType::Single { .. } => NumberKind::F32,
        RecordDataType::Double { .. } | RecordDataType::ScaledInteger { .. } => NumberKind::F64,
        RecordDataType::Integer { min: 0.., max: ..=255 } => NumberKind::U8,
        RecordDataType::Integer { min: 0.., max: ..=65_535 } => NumberKind::U16,
        RecordDataType::Integer { min, max } => {
            let is_short = i32::try_from(*min).is_ok() && i32::try_from(*max).is_ok();
            if is_short { NumberKind::I32 } else { NumberKind::I64 }
        }
    }
}

/// Number of bits of a value, from the range given in the file.
fn bits(data_type: &RecordDataType) -> u64 {
    match data_type {
        RecordDataType::Single { .. } => 32,
        RecordDataType::Double { .. } => 64,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => {
            let range = i128::from(*max) - i128::from(*min);
            if range > 0 { u64::from(range.ilog2()) + 1 } else { 0 }
        }
    }
}

fn number(value: &RecordValue, data_type: &RecordDataType) -> f64 {
    match (value, data_type) {
        (RecordValue::Single(x), _) => f64::from(*x),
        (RecordValue::Double(x), _) => *x,
        (RecordValue::ScaledInteger(i), RecordDataType::ScaledInteger { scale, offset, .. }) => {
            *i as f64 * scale + offset
        }
        (RecordValue::ScaledInteger(i) | RecordValue::Integer(i), _) => *i as f64,
    }
}

impl RecordLayout {
    /// Layout of scan `k`, or the reason for which it cannot be read.
    pub(super) fn new(scan: &PointCloud, k: usize) -> Result<Self, ReadError> {
        let wrong = |what: &str| Err(ReadError::Whole(format!("scan {k} {what}; export the file again")));
        let types: Vec<RecordDataType> =
            scan.prototype.iter().map(|record| record.data_type.clone()).collect();
        let is_upside_down = |t: &RecordDataType| matches!(t, RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } if min > max);
        if types.iter().any(is_upside_down) {
            return wrong("has a number whose minimum is above its maximum");
        }
        if types.iter().all(|t| bits(t) == 0) {
            return wrong("has records of no bits, so their number is unknown");
        }
        let find = |name: RecordName| scan.prototype.iter().position(|record| record.name == name);
        let three = |names: [RecordName; 3]| {
            let [a, b, c] = names.map(find);
            Some([a?, b?, c?])
        };
        let cartesian = three([RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ]);
        let spherical =
            three([RecordName::SphericalRange, RecordName::SphericalAzimuth, RecordName::SphericalElevation]);
        let Some(place) = cartesian.or(spherical) else { return wrong("has no coordinates") };
        let is_spherical = cartesian.is_none();
        let state = find(if is_spherical {
            RecordName::SphericalInvalidState
        } else {
            RecordName::CartesianInvalidState
        });
        let mut columns = Vec::new();
        let mut add = |name: &str, records: Option<Vec<usize>>, invalid: Option<usize>| {
            if let Some(records) = records {
                let kind = records.iter().map(|&r| kind(&types[r])).max().unwrap_or(NumberKind::F64);
                columns.push(ScanField { name: name.into(), records, invalid, kind });
            }
        };
        let one = |name: RecordName| find(name).map(|r| vec![r]);
        add("intensity", one(RecordName::Intensity), find(RecordName::IsIntensityInvalid));
        let colors = three([RecordName::ColorRed, RecordName::ColorGreen, RecordName::ColorBlue]);
        add("color", colors.map(|c| c.to_vec()), find(RecordName::IsColorInvalid));
        add("row", one(RecordName::RowIndex), None);
        add("column", one(RecordName::ColumnIndex), None);
        add("return_count", one(RecordName::ReturnCount), None);
        add("return_index", one(RecordName::ReturnIndex), None);
        add("time", one(RecordName::TimeStamp), find(RecordName::IsTimeStampInvalid));
        for (r, record) in scan.prototype.iter().enumerate() {
            if let RecordName::Unknown { name, .. } = &record.name {
                add(name, Some(vec![r]), None);
            }
        }
        Ok(Self { place, is_spherical, state, types, columns })
    }

    pub(super) fn bits_of_a_point(&self) -> u64 {
        self.types.iter().map(bits).sum()
    }

    /// True if the coordinates are 32-bit floats.
    pub(super) fn is_single(&self, scan: &PointCloud) -> bool {
        let single = |r: &usize| matches!(scan.prototype[*r].data_type, RecordDataType::Single { .. });
        !self.is_spherical && self.place.iter().all(single)
    }

    fn value(&self, record: &[RecordValue], r: usize) -> f64 {
        record.get(r).map_or(f64::NAN, |value| number(value, &self.types[r]))
    }

    /// Position of a record; `None` if the scanner measured none.
    pub(super) fn point(&self, record: &[RecordValue]) -> Option<[f64; 3]> {
        if self.state.is_some_and(|r| self.value(record, r) != 0.0) {
            return None;
        }
        let [a, b, c] = self.place.map(|r| self.value(record, r));
        if !self.is_spherical {
            return Some([a, b, c]);
        }
        let (range, azimuth, elevation) = (a, b, c);
        let flat = range * elevation.cos();
        Some([flat * azimuth.cos(), flat * azimuth.sin(), range * elevation.sin()])
    }
}

/// Columns of all scans read so far.
#[derive(Default)]
pub(super) struct ScanColumns {
    columns: Vec<(ScanField, Vec<f64>)>,
    n_rows: usize,
}

impl ScanColumns {
    /// Finds the columns of a scan among these; a new column starts with missing values for the previous rows.
    pub(super) fn begin_scan(&mut self, layout: &RecordLayout) -> Vec<usize> {
        let n_rows = self.n_rows;
        let places = layout.columns.iter().map(|column| {
            let n_channels = column.records.len();
            let same =
                |(own, _): &(ScanField, Vec<f64>)| own.name == column.name && own.records.len() == n_channels;
            let k = self.columns.iter().position(same).unwrap_or_else(|| {
                self.columns.push((column.clone(), vec![f64::NAN; n_rows * n_channels]));
                self.columns.len() - 1
            });
            self.columns[k].0.kind = self.columns[k].0.kind.max(column.kind);
            k
        });
        places.collect()
    }

    /// Appends the values of a record of a scan whose columns are at `places`.
    pub(super) fn push(&mut self, layout: &RecordLayout, places: &[usize], record: &[RecordValue]) {
        for (column, &k) in layout.columns.iter().zip(places) {
            let is_invalid = column.invalid.is_some_and(|r| layout.value(record, r) != 0.0);
            let value = |&r: &usize| if is_invalid { f64::NAN } else { layout.value(record, r) };
            self.columns[k].1.extend(column.records.iter().map(value));
        }
        self.n_rows += 1;
    }

    /// Fills the columns that a scan does not have with missing values.
    pub(super) fn end_scan(&mut self, n_rows: usize) {
        for (column, values) in &mut self.columns {
            values.resize(n_rows * column.records.len(), f64::NAN);
        }
        self.n_rows = n_rows;
    }

    pub(super) fn bytes_of_a_row(&self) -> u64 {
        self.columns.iter().map(|(column, _)| 8 * column.records.len() as u64).sum()
    }

    /// Converts the columns to fields, in the types of the file; to floats if a value is missing.
    pub(super) fn into_fields(self, n_rows: usize) -> Vec<Field> {
        let mut fields: Vec<Field> = Vec::new();
        for (column, values) in self.columns {
            let n_channels = column.records.len();
            if values.len() != n_rows * n_channels || n_rows == 0 {
                continue;
            }
            let has_gaps = values.iter().any(|x| x.is_nan());
            let kind = if has_gaps && column.kind < NumberKind::I64 {
                column.kind.max(NumberKind::F32)
            } else {
                column.kind
            };
            let values = match kind {
                NumberKind::U8 => FieldValues::U8(values.iter().map(|&x| x as u8).collect()),
                NumberKind::U16 => FieldValues::U16(values.iter().map(|&x| x as u16).collect()),
                NumberKind::I32 => FieldValues::I32(values.iter().map(|&x| x as i32).collect()),
                NumberKind::I64 if !has_gaps => FieldValues::I64(values.iter().map(|&x| x as i64).collect()),
                NumberKind::F32 => FieldValues::F32(values.iter().map(|&x| x as f32).collect()),
                NumberKind::I64 | NumberKind::F64 => FieldValues::F64(values),
            };
            let mut name = column.name;
            while fields.iter().any(|field| field.name == name) {
                name.push('_');
            }
            fields.push(Field::new(name, n_channels, values));
        }
        fields
    }
}
