//! Fields of a shape in LAS records: in standard dimensions, in existing extra bytes, or in added extra bytes.

use adwave::Progress;

use crate::formats::las::extra::{
    DESCRIPTION, ExtraBytes, description, fields_of, holds, names, undescribed,
};
use crate::formats::las::fields::{bit_columns, record_bytes, whole_column};
use crate::formats::las::read::RECORD_HEAD;
use crate::formats::las::write::{Parts, put, variable_record};
use crate::model::field::{ByteOrder, Number as _, with_values};
use crate::progress::at_row;
use crate::{Field, FieldValues, ShapeFile, ValueType, WriteError, WriteReport};

/// User of the record that describes extra bytes.
const SPECIFICATION: &[u8] = b"LASF_Spec";
const EXTRA_BYTES: u16 = 4;

/// Factor that converts one-byte colors to two bytes.
fn factor(field: &Field) -> f64 {
    if field.name == "color" && matches!(field.values, FieldValues::U8(_)) { 257.0 } else { 1.0 }
}

/// True if the type can store all values of the field exactly.
pub(crate) fn fits(field: &Field, kind: ValueType) -> bool {
    let range = match kind {
        ValueType::U8 => 0.0..=255.0,
        ValueType::I8 => -128.0..=127.0,
        ValueType::I16 => -32768.0..=32767.0,
        ValueType::F64 => return true,
        _ => 0.0..=65535.0,
    };
    let factor = factor(field);
    // Colors given as numbers from 0 to 1 are not LAS colors.
    let is_color = field.name != "color" || matches!(field.values, FieldValues::U8(_) | FieldValues::U16(_));
    let holds = |k: usize| {
        let value = factor * field.values.get(k);
        value.fract() == 0.0 && range.contains(&value)
    };
    is_color && (0..field.values.len()).all(holds)
}

/// Location of a field in the standard record.
pub(crate) enum Place {
    /// Byte offset, first bit and mask.
    Bits(usize, u8, u8),
    /// First byte and type of each channel.
    Whole(usize, ValueType),
}

impl Place {
    /// Finds the dimension of the point format that can store all values of a field exactly.
    pub(crate) fn of(format: u8, field: &Field) -> Option<Self> {
        let is_mine = |bits: &&(&str, usize, u8, u8)| bits.0 == field.name && field.n_channels == 1;
        if let Some(&(_, at, shift, mask)) = bit_columns(format).iter().find(is_mine) {
            let holds = |k: usize| {
                let value = field.values.get(k);
                value.fract() == 0.0 && (0.0..=f64::from(mask)).contains(&value)
            };
            return (0..field.values.len()).all(holds).then_some(Self::Bits(at, shift, mask));
        }
        let (at, kind, n_channels) = whole_column(format, &field.name)?;
        (n_channels == field.n_channels && fits(field, kind)).then_some(Self::Whole(at, kind))
    }
}

/// Field names of the standard dimensions.
fn standard_names(format: u8) -> Vec<String> {
    let whole = [
        "intensity",
        "classification",
        "scan_angle",
        "user_data",
        "point_source",
        "gps_time",
        "color",
        "near_infrared",
    ];
    let whole = whole.into_iter().filter(|name| whole_column(format, name).is_some());
    let bits = bit_columns(format).iter().map(|bits| bits.0);
    let colors: &[&str] =
        if whole_column(format, "color").is_some() { &["red", "green", "blue"] } else { &[] };
    // Names of the standard dimensions in other programs.
    let others = ["x", "y", "z", "point_source_id"].iter().chain(colors).copied();
    whole.chain(bits).chain(others).map(str::to_owned).collect()
}

impl Parts {
    /// Stores the changed fields, or all fields in a new file; fields without a standard dimension become extra
    /// bytes.
    pub(crate) fn set_fields(
        &mut self,
        shape: &ShapeFile,
        has_original: bool,
        report: &mut WriteReport,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let described = ExtraBytes::parse(self.descriptions(), self.standard_bytes());
        let fields = fields_of(&described);
        let mut added = Vec::new();
        for field in &shape.vertex_fields {
            if has_original && !shape.edited.contains(&field.name) {
                continue;
            }
            if let Some(place) = Place::of(self.parsed.format, field) {
                self.set_standard(field, &place, progress)?;
                continue;
            }
            let own = fields.iter().find(|(name, _)| *name == field.name);
            let members: Vec<&ExtraBytes> =
                own.map_or(Vec::new(), |(_, members)| members.iter().map(|&e| &described[e]).collect());
            let has_room = members.iter().all(|e| e.at + e.n_bytes() <= self.parsed.record_bytes);
            let n_channels: usize = members.iter().map(|e| e.n_channels).sum();
            if members.is_empty() {
                added.push(field);
            } else if has_room
                && n_channels == field.n_channels
                && members.iter().all(|e| holds(e, &field.values))
            {
                let places =
                    members.iter().flat_map(|e| (0..e.n_channels).map(|c| e.at + c * e.value_type.n_bytes()));
                self.set_extra(field, &places.collect::<Vec<_>>(), progress)?;
            } else {
                report.leave_out(format!("vertex field `{}`", field.name));
            }
        }
        self.add_fields(&added, &described, report, progress)
    }

    /// Size of a record without extra bytes.
    fn standard_bytes(&self) -> usize {
        record_bytes(self.parsed.format).unwrap_or(self.parsed.record_bytes)
    }

    /// Descriptions of the extra bytes.
    fn descriptions(&self) -> &[u8] {
        self.records.iter().find(|record| is_list(record)).map_or(&[], |record| &record[RECORD_HEAD..])
    }

    fn set_standard(
        &mut self,
        field: &Field,
        place: &Place,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let (size, factor, n) = (self.parsed.record_bytes, factor(field), field.len());
        for i in 0..n {
            at_row(progress, i as u64, n as u64)?;
            let row = &mut self.points[i * size..][..size];
            match *place {
                Place::Bits(at, shift, mask) => {
                    let bits = (field.get(i, 0) as u8 & mask) << shift;
                    row[at] = row[at] & !(mask << shift) | bits;
                }
                Place::Whole(at, kind) => {
                    for c in 0..field.n_channels {
                        let (at, value) = (at + c * kind.n_bytes(), factor * field.get(i, c));
                        match kind {
                            ValueType::U8 => put(row, at, (value as u8).to_le_bytes()),
                            ValueType::I8 => put(row, at, (value as i8).to_le_bytes()),
                            ValueType::I16 => put(row, at, (value as i16).to_le_bytes()),
                            ValueType::F64 => put(row, at, value.to_le_bytes()),
                            _ => put(row, at, (value as u16).to_le_bytes()),
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Stores the channels of a field at these bytes of the records.
    fn set_extra(
        &mut self,
        field: &Field,
        places: &[usize],
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let (size, n, width) = (self.parsed.record_bytes, field.len(), field.values.value_type().n_bytes());
        let mut bytes = Vec::with_capacity(width * places.len());
        with_values!(&field.values, values => for (i, row) in values.chunks_exact(places.len()).enumerate() {
            at_row(progress, i as u64, n as u64)?;
            bytes.clear();
            for x in row {
                x.write_bytes(ByteOrder::Little, &mut bytes);
            }
            for (own, at) in bytes.chunks_exact(width).zip(places) {
                self.points[i * size + at..][..width].copy_from_slice(own);
            }
        });
        Ok(())
    }

    /// Extends the records by fields without a dimension.
    fn add_fields(
        &mut self,
        fields: &[&Field],
        described: &[ExtraBytes],
        report: &mut WriteReport,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let old = self.parsed.record_bytes;
        let mut list = ExtraList::of(self.descriptions(), described, self.parsed.format, old);
        let mut placed: Vec<(&Field, Vec<usize>)> = Vec::new();
        for &field in fields {
            let Some((name, places)) = list.add(&field.name, field.n_channels, field.values.value_type())
            else {
                report.leave_out(format!("vertex field `{}`", field.name));
                continue;
            };
            if name != field.name {
                report.leave_out(format!("the name of `{}` (stored as `{name}`)", field.name));
            }
            placed.push((field, places));
        }
        if placed.is_empty() {
            return Ok(());
        }
        let size = list.record_bytes;
        let mut points = vec![0; self.points.len() / old * size];
        for (to, from) in points.chunks_exact_mut(size).zip(self.points.chunks_exact(old)) {
            to[..old].copy_from_slice(from);
        }
        self.points = points;
        self.parsed.record_bytes = size;
        put(&mut self.header, 105, (size as u16).to_le_bytes());
        list.put_into(&mut self.records);
        placed.iter().try_for_each(|(field, places)| self.set_extra(field, places, progress))
    }
}

/// Descriptions of the extra bytes of a file whose records grow.
pub(crate) struct ExtraList {
    descriptions: Vec<u8>,
    /// Names in use.
    taken: Vec<String>,
    /// Size of a record with all additions, in bytes.
    pub(crate) record_bytes: usize,
    is_understood: bool,
}

impl ExtraList {
    /// Reads the descriptions in these records.
    pub(crate) fn read(records: &[Vec<u8>], format: u8, size: usize) -> Self {
        let content = records.iter().find(|record| is_list(record)).map_or(&[][..], |r| &r[RECORD_HEAD..]);
        Self::of(content, &ExtraBytes::parse(content, record_bytes(format).unwrap_or(size)), format, size)
    }

    fn of(content: &[u8], described: &[ExtraBytes], format: u8, size: usize) -> Self {
        let standard = record_bytes(format).unwrap_or(size);
        let end = described.last().map_or(standard, |last| last.at + last.n_bytes());
        // Content after an unknown description, or beyond the end of short records, cannot be located.
        let is_understood = content.len() == described.len() * DESCRIPTION && end <= size;
        let mut descriptions = content.to_vec();
        if is_understood {
            descriptions.extend(undescribed(size - end));
        }
        let mut taken = standard_names(format);
        taken.extend(described.iter().map(|extra| extra.name.clone()));
        Self { descriptions, taken, record_bytes: size, is_understood }
    }

    /// Adds a field and returns its name and the location of each channel; `None` if there is no room.
    pub(crate) fn add(
        &mut self,
        name: &str,
        n_channels: usize,
        kind: ValueType,
    ) -> Option<(String, Vec<usize>)> {
        const MOST: usize = u16::MAX as usize;
        let (name, columns) = names(name, n_channels, &self.taken);
        let n_bytes = columns.len() * kind.n_bytes();
        let has_room = self.record_bytes + n_bytes <= MOST
            && self.descriptions.len() + columns.len() * DESCRIPTION <= MOST;
        if !self.is_understood || !has_room {
            return None;
        }
        let mut places = Vec::with_capacity(columns.len());
        for column in columns {
            self.descriptions.extend(description(&column, kind));
            places.push(self.record_bytes);
            self.record_bytes += kind.n_bytes();
            self.taken.push(column);
        }
        Some((name, places))
    }

    /// Replaces the descriptions in the records.
    pub(crate) fn put_into(&self, records: &mut Vec<Vec<u8>>) {
        let record = variable_record(SPECIFICATION, EXTRA_BYTES, &self.descriptions);
        match records.iter_mut().find(|record| is_list(record)) {
            Some(own) => *own = record,
            None => records.push(record),
        }
    }
}

fn is_list(record: &[u8]) -> bool {
    record[2..].starts_with(SPECIFICATION) && record[18..20] == EXTRA_BYTES.to_le_bytes()
}
