//! Rewriting of a CIFTI: the numbers of one surface are replaced, and everything else stays.

use adwave::Progress;

use super::CIFTI;
use super::read::{CiftiHead, CiftiNumbers, locate_numbers};
use super::write::CiftiColumns;
use crate::model::f32_limits::check_range;
use crate::model::format_descriptor::ValuesEdit;
use crate::model::numbers::Numbers;
use crate::{FieldValues, ReadLimits, ValueType, WriteError};

/// Bytes of the file with new values of the surface's vertices; `None` if these do not fit its columns, or if the name
/// asks for another kind of file. Integers and scaled numbers become floats everywhere, as edited values are fractions.
pub(super) fn rewrite(bytes: &[u8], edit: &ValuesEdit<'_>) -> Result<Option<Vec<u8>>, WriteError> {
    let found = locate_numbers(
        bytes,
        edit.size.structure,
        edit.size.n_vertices,
        &ReadLimits::default(),
        Progress::none(),
    );
    let Ok(found) = found else { return Ok(None) };
    let CiftiNumbers { model, columns, head, .. } = found;
    let CiftiHead { n_columns, order, start, .. } = head;
    let asked = CiftiColumns::from_path(edit.path);
    let field = edit.field;
    let fits = field.n_channels == n_columns && field.len() == edit.size.n_vertices;
    if asked.is_none() || asked != columns || !fits {
        return Ok(None);
    }
    let value = |i: usize| field.values.get(i);
    let (kind, mut out) = with_floats(bytes, &head);
    if kind == ValueType::F32 {
        check_range(
            CIFTI.format,
            &format!("values of `{}`", field.name),
            field.values.len(),
            Progress::none(),
            value,
        )?;
    }
    let row_bytes = n_columns * kind.n_bytes();
    for (k, &vertex) in model.vertices.iter().enumerate() {
        let mut numbers = kind.empty();
        for c in 0..n_columns {
            numbers.push_f64(value(vertex as usize * n_columns + c));
        }
        let mut row = Vec::with_capacity(row_bytes);
        (0..n_columns).for_each(|c| numbers.write_bytes(c, order, &mut row));
        let at = start + (model.first as usize + k) * row_bytes;
        out[at..at + row_bytes].copy_from_slice(&row);
    }
    Ok(Some(out))
}

/// Type of the floats that hold edited values of a file of that type.
pub(super) fn float_type(kind: ValueType, is_scaled: bool) -> ValueType {
    match kind {
        ValueType::F32 | ValueType::F64 if !is_scaled => kind,
        ValueType::F32 => ValueType::F32,
        _ if kind.n_bytes() < 4 => ValueType::F32,
        _ => ValueType::F64,
    }
}

impl CiftiHead {
    /// Changes the header so that it states floats of this type without a scale.
    pub(super) fn state_floats(&self, floats: ValueType, header: &mut [u8]) {
        if floats == self.kind && !self.is_scaled {
            return;
        }
        let code = if floats == ValueType::F32 { 16_i16 } else { 64 };
        let mut put = |at: usize, text: FieldValues| {
            let mut number = Vec::new();
            text.write_bytes(0, self.order, &mut number);
            header[at..at + number.len()].copy_from_slice(&number);
        };
        put(12, FieldValues::I16(vec![code]));
        put(14, FieldValues::I16(vec![8 * floats.n_bytes() as i16]));
        put(176, FieldValues::F64(vec![1.0]));
        put(184, FieldValues::F64(vec![0.0]));
    }
}

/// Bytes of the file with all numbers as floats without a scale, and the type of these floats.
fn with_floats(bytes: &[u8], head: &CiftiHead) -> (ValueType, Vec<u8>) {
    let CiftiHead { kind, order, start, n_bytes, is_scaled, scale: [slope, intercept], .. } = *head;
    let floats = float_type(kind, is_scaled);
    if floats == kind && !is_scaled {
        return (kind, bytes.to_vec());
    }
    let data = Numbers::Bytes { bytes: (&bytes[start..start + n_bytes]).into(), kind, order };
    let mut values = floats.empty();
    for k in 0..n_bytes / kind.n_bytes() {
        let x = data.get(k);
        values.push_f64(if is_scaled { slope * x + intercept } else { x });
    }
    let mut out = bytes[..start].to_vec();
    head.state_floats(floats, &mut out);
    (0..values.len()).for_each(|k| values.write_bytes(k, order, &mut out));
    out.extend_from_slice(&bytes[start + n_bytes..]);
    (floats, out)
}
