//! NIfTI writer: new files, and files that were read with other values.

use super::header::{HeaderEditor, NiftiHeader, Version};
use crate::model::context::WriteContext;
use crate::model::field::ByteOrder;
use crate::model::grid_layout::GridLayout;
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::{Field, Format, LengthUnit, ShapeFile, ValueType, WriteError, WriteReport};

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

impl NiftiDocument {
    /// The file with numbers of another type, or of another number of channels: the rest of the header stays. `None` if its
    /// version cannot hold so many.
    fn frame(
        &self,
        kind: ValueType,
        n_places: usize,
        n_channels: usize,
        frame_step: Option<f64>,
    ) -> Option<NiftiFrame> {
        let Self { head, tail, header, numbers, .. } = self;
        let mut sizes = header.sizes.clone();
        if n_channels != numbers.n_planes {
            sizes.truncate(3);
            if n_channels > 1 {
                sizes.resize(3, 1);
                sizes.push(n_channels);
            }
            if n_channels as u64 > header.version.most() {
                return None;
            }
        }
        let (mut head, tail) = (head.clone(), tail.clone());
        let mut editor = HeaderEditor { bytes: &mut head, version: header.version, order: header.order };
        editor.set_value_type(kind);
        if sizes != header.sizes {
            editor.set_sizes(&sizes);
            editor.set_frame_step(frame_step, header.units as u8);
        }
        Some(NiftiFrame { head, tail, numbers: planes(kind, header.order, n_places, n_channels) })
    }
}

/// A NIfTI without its numbers, which are the values.
#[derive(Debug)]
pub(super) struct NiftiFrame {
    /// Bytes before the numbers, and those after them.
    pub(super) head: Vec<u8>,
    pub(super) tail: Vec<u8>,
    /// Layout of the numbers, a plane for each channel.
    pub(super) numbers: GridNumbers,
}

impl NiftiFrame {
    /// The file that a volume is written to with `n_channels` values of a type at each place: the one that it was read
    /// from, else a new one.
    ///
    /// # Errors
    /// The shape is no volume.
    pub(super) fn new(
        shape: &ShapeFile,
        kind: ValueType,
        n_channels: usize,
        report: &mut WriteReport,
    ) -> Result<Self, WriteError> {
        let read = shape.source::<NiftiDocument>();
        match read.and_then(|read| read.frame(kind, shape.n_vertices, n_channels, None)) {
            Some(frame) => Ok(frame),
            None => new_frame(shape, kind, n_channels, None, report),
        }
    }

    fn write(self, field: &Field, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
        c.out.write_all(&self.head)?;
        self.numbers.write(None, field, c.format, c.out, c.progress)?;
        Ok(c.out.write_all(&self.tail)?)
    }
}

impl SourceDocument for NiftiDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let field = written_field(shape, c.format, &mut c.report)?;
        let Self { head, old, tail, numbers, .. } = self;
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
        let Some(frame) = self.frame(kind, shape.n_vertices, field.n_channels, field.frame_step) else {
            return Ok(Update::DoesNotFit);
        };
        frame.write(field, c)?;
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

/// Writes a new file.
pub(super) fn write_nifti(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    new_frame(shape, kind, field.n_channels, field.frame_step, &mut c.report)?.write(field, c)
}

/// A new file: NIfTI-1, or NIfTI-2 if an axis is too long for it.
fn new_frame(
    shape: &ShapeFile,
    kind: ValueType,
    n_channels: usize,
    frame_step: Option<f64>,
    report: &mut WriteReport,
) -> Result<NiftiFrame, WriteError> {
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: Format::NIFTI, what: "a shape".into() });
    };
    let GridLayout { sizes, spacings, steps, origin, unit, .. } = layout;
    let mut sizes: Vec<usize> = sizes.iter().rev().copied().collect();
    let n_axes = sizes.len();
    if n_channels > 1 {
        sizes.resize(3, 1);
        sizes.push(n_channels);
    }
    let is_short = sizes.iter().all(|&size| size as u64 <= Version::One.most());
    let version = if is_short { Version::One } else { Version::Two };
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
        report.report_dropped(format!("the unit of length, {}", unit.plural()));
    }
    editor.set_frame_step(frame_step, code.unwrap_or(0));
    let numbers = planes(kind, ByteOrder::Little, shape.n_vertices, n_channels);
    Ok(NiftiFrame { head, tail: Vec::new(), numbers })
}
