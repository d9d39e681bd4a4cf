//! NIfTI writer: new files, and files that were read with other values.

use super::header::{HeaderEditor, NiftiHeader, Version};
use crate::model::context::WriteContext;
use crate::model::field::ByteOrder;
use crate::model::grid_layout::GridLayout;
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::{Format, LengthUnit, ShapeFile, ValueType, WriteError};

/// A NIfTI that was read.
#[derive(Debug)]
pub(super) struct NiftiDocument {
    /// Bytes before the numbers, those of the numbers, and those after them. The numbers are empty if the values are the same.
    head: Vec<u8>,
    old: Vec<u8>,
    tail: Vec<u8>,
    header: NiftiHeader,
    numbers: GridNumbers,
}

impl NiftiDocument {
    /// A file, of which the bytes of the numbers need not stay where `are_values` says that they are the values.
    pub(super) fn new(
        mut bytes: Vec<u8>,
        header: NiftiHeader,
        numbers: GridNumbers,
        are_values: bool,
    ) -> Self {
        let tail = bytes.split_off(header.start + numbers.n_bytes().unwrap_or(0));
        let (head, old) = if are_values {
            (bytes[..header.start].to_vec(), Vec::new())
        } else {
            let old = bytes.split_off(header.start);
            (bytes, old)
        };
        Self { head, old, tail, header, numbers }
    }
}

impl SourceDocument for NiftiDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let field = written_field(shape, c.format, &mut c.report)?;
        let Self { head, old, tail, header, numbers } = self;
        let is_edited = shape.edited.contains(&field.name);
        let kind = shape.value_type.unwrap_or(numbers.kind);
        let has_own_kind = kind == numbers.kind;
        if has_own_kind && field.n_channels == numbers.n_channels() {
            c.out.write_all(head)?;
            if is_edited || old.is_empty() {
                let old = (!old.is_empty()).then_some(&old[..]);
                numbers.write(old, field, c.format, c.out, c.progress)?;
            } else {
                c.out.write_all(old)?;
            }
            c.out.write_all(tail)?;
            return Ok(Update::Written);
        }
        // Another type, or another number of channels: the rest of the header stays.
        let mut sizes = header.sizes.clone();
        if field.n_channels != numbers.n_planes {
            sizes.truncate(3);
            if field.n_channels > 1 {
                sizes.resize(3, 1);
                sizes.push(field.n_channels);
            }
            if field.n_channels as u64 > header.version.most() {
                return Ok(Update::DoesNotFit);
            }
        }
        let mut head = head.clone();
        let mut editor = HeaderEditor { bytes: &mut head, version: header.version, order: header.order };
        editor.set_value_type(kind);
        if sizes != header.sizes {
            editor.set_sizes(&sizes);
            editor.set_frame_step(field.frame_step, header.units as u8);
        }
        c.out.write_all(&head)?;
        let planes = planes(kind, header.order, shape.n_vertices, field.n_channels);
        planes.write(None, field, c.format, c.out, c.progress)?;
        c.out.write_all(tail)?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::NIFTI
    }
}

/// Numbers that are the values, a plane for each channel.
fn planes(kind: ValueType, order: ByteOrder, n_places: usize, n_channels: usize) -> GridNumbers {
    GridNumbers { n_planes: n_channels, ..GridNumbers::new(kind, order, n_places, 1) }
}

/// Writes a new file: NIfTI-1, or NIfTI-2 if an axis is too long for it.
pub(super) fn write_nifti(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: c.format, what: "a shape".into() });
    };
    let GridLayout { sizes, spacings, steps, origin, unit, .. } = layout;
    let mut sizes: Vec<usize> = sizes.iter().rev().copied().collect();
    let n_axes = sizes.len();
    if field.n_channels > 1 {
        sizes.resize(3, 1);
        sizes.push(field.n_channels);
    }
    let is_short = sizes.iter().all(|&size| size as u64 <= Version::One.most());
    let version = if is_short { Version::One } else { Version::Two };
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    let mut head = NiftiHeader::new_bytes(version);
    let mut editor = HeaderEditor { bytes: &mut head, version, order: ByteOrder::Little };
    editor.set_value_type(kind);
    editor.set_sizes(&sizes);
    let mut rows = [[0.0; 4]; 3];
    for k in 0..3 {
        let axis = n_axes.checked_sub(1 + k);
        editor.set_spacing(k, axis.map_or(1.0, |axis| spacings[axis]));
        for (row, out) in rows.iter_mut().enumerate() {
            out[k] = axis.map_or(if row == k { 1.0 } else { 0.0 }, |axis| steps[axis][row]);
        }
    }
    for (row, out) in rows.iter_mut().enumerate() {
        out[3] = origin[row];
    }
    editor.set_spacing(3, 1.0);
    editor.set_affine(&rows);
    let codes = [(LengthUnit::METER, 1), (LengthUnit::MILLIMETER, 2), (LengthUnit::MICRON, 3)];
    let code = codes.iter().find(|(known, _)| Some(known) == unit.as_ref()).map(|(_, code)| *code);
    if let (None, Some(unit)) = (code, unit) {
        c.report.report_dropped(format!("the unit of length, {}", unit.plural()));
    }
    editor.set_frame_step(field.frame_step, code.unwrap_or(0));
    c.out.write_all(&head)?;
    let planes = planes(kind, ByteOrder::Little, shape.n_vertices, field.n_channels);
    planes.write(None, field, c.format, c.out, c.progress)
}
