//! MRC writer.

use super::header::{self, MrcHeader, mode_of};
use super::read::angstrom;
use crate::model::context::WriteContext;
use crate::model::field::{ByteOrder, Number};
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::{Field, Format, ShapeFile, ValueType, WriteError};

/// Version of the format: that of 2014.
const VERSION: i32 = 20140;

/// A map that was read.
#[derive(Debug)]
pub(super) struct MrcDocument {
    pub(super) bytes: Vec<u8>,
    pub(super) header: MrcHeader,
    pub(super) numbers: GridNumbers,
}

/// Replaces a number of the header.
fn put<T: Number>(bytes: &mut [u8], at: usize, number: T, order: ByteOrder) {
    let mut own = Vec::with_capacity(4);
    number.write_bytes(order, &mut own);
    bytes[at..at + own.len()].copy_from_slice(&own);
}

/// Sets least, greatest and mean density, and their deviation.
fn put_statistics(head: &mut [u8], field: &Field, order: ByteOrder) {
    let (mut least, mut greatest, mut sum, mut square, mut n) =
        (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0, 0.0);
    for i in 0..field.values.len() {
        let x = field.values.get(i);
        if x.is_finite() {
            (least, greatest) = (least.min(x), greatest.max(x));
            (sum, n) = (sum + x, n + 1.0);
        }
    }
    let mean = if n > 0.0 { sum / n } else { 0.0 };
    for i in 0..field.values.len() {
        let x = field.values.get(i) - mean;
        square += if x.is_finite() { x * x } else { 0.0 };
    }
    if n > 0.0 {
        for (k, x) in [least, greatest, mean].into_iter().enumerate() {
            put(head, header::STATISTICS + 4 * k, x as f32, order);
        }
        put(head, header::DEVIATION, (square / n).sqrt() as f32, order);
    }
}

/// Type of the numbers of a map.
fn map_kind(
    kind: ValueType,
    is_asked: bool,
    c: &mut WriteContext<'_>,
) -> Result<(ValueType, i32), WriteError> {
    match mode_of(kind) {
        Some(mode) => Ok((kind, mode)),
        None if is_asked => {
            let what = format!("{} numbers: it has i8, i16, u16 and f32", kind.name());
            Err(WriteError::CannotHold { format: c.format, what })
        }
        None => {
            c.report.add_note(format!("{} numbers are written as 32-bit floats", kind.name()));
            Ok((ValueType::F32, 2))
        }
    }
}

fn check_channels(field: &Field, format: Format) -> Result<(), WriteError> {
    if field.n_channels == 1 {
        return Ok(());
    }
    let what = format!("{} channels: it stores one number at a place", field.n_channels);
    Err(WriteError::CannotHold { format, what })
}

impl SourceDocument for MrcDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let Self { bytes, header, numbers } = self;
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) && shape.value_type.is_none() {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        check_channels(field, c.format)?;
        let (kind, mode) = map_kind(shape.value_type.unwrap_or(numbers.kind), true, c)?;
        let end = header.start + numbers.n_bytes().unwrap_or(0);
        let old = &bytes[header.start..end];
        let mut new = Vec::new();
        let own = GridNumbers { kind, ..numbers.clone() };
        own.write((kind == numbers.kind).then_some(old), field, c.format, &mut new, c.progress)?;
        if new == old {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        let mut head = bytes[..header.start].to_vec();
        put(&mut head, header::MODE, mode, header.order);
        put_statistics(&mut head, field, header.order);
        c.out.write_all(&head)?;
        c.out.write_all(&new)?;
        c.out.write_all(&bytes[end..])?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::MRC
    }
}

/// Writes a new map.
pub(super) fn write_mrc(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    check_channels(field, c.format)?;
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: c.format, what: "a shape".into() });
    };
    let asked = shape.value_type;
    let (kind, mode) = map_kind(asked.unwrap_or(field.values.value_type()), asked.is_some(), c)?;
    let order = ByteOrder::Little;
    let n = layout.sizes.len();
    let scale =
        layout.unit.as_ref().zip(angstrom()).and_then(|(unit, own)| unit.ratio_to(&own)).unwrap_or(1.0);
    let mut head = vec![0; header::BYTES];
    for k in 0..3 {
        let axis = n.checked_sub(1 + k);
        let size = axis.map_or(1, |axis| layout.sizes[axis]);
        let spacing = axis.map_or(1.0, |axis| layout.spacings[axis]);
        let size = i32::try_from(size).map_err(|_| WriteError::CannotHold {
            format: c.format,
            what: format!("an axis of {size} places"),
        })?;
        put(&mut head, header::SIZES + 4 * k, size, order);
        put(&mut head, header::INTERVALS + 4 * k, size, order);
        put(&mut head, header::CELL + 4 * k, (spacing * scale * f64::from(size)) as f32, order);
        put(&mut head, header::CELL + 12 + 4 * k, 90_f32, order);
        put(&mut head, header::AXES + 4 * k, k as i32 + 1, order);
        put(&mut head, header::ORIGIN + 4 * k, (layout.origin[k] * scale) as f32, order);
    }
    let is_straight = (0..n).all(|axis| {
        let step = layout.steps[axis];
        (0..3).all(|row| step[row] == if row == n - 1 - axis { layout.spacings[axis] } else { 0.0 })
    });
    if !is_straight {
        c.report.report_dropped("directions of the axes");
    }
    put(&mut head, header::MODE, mode, order);
    put(&mut head, header::SPACE_GROUP, i32::from(n == 3), order);
    put(&mut head, header::VERSION, VERSION, order);
    head[header::MAGIC..header::MAGIC + 4].copy_from_slice(b"MAP ");
    head[header::STAMP..header::STAMP + 2].copy_from_slice(&[0x44, 0x44]);
    put_statistics(&mut head, field, order);
    c.out.write_all(&head)?;
    GridNumbers::new(kind, order, shape.n_vertices, 1).write(None, field, c.format, c.out, c.progress)
}
