//! Rewriting of a CIFTI: the numbers of one surface are replaced, and everything else stays.

use adwave::Progress;

use super::CIFTI;
use super::read::{CiftiNumbers, locate_numbers};
use super::write::CiftiColumns;
use crate::model::f32_limits::check_range;
use crate::model::field::Number;
use crate::model::format_descriptor::ValuesEdit;
use crate::{ReadLimits, ValueType, WriteError};

/// Bytes of the file with new values of the surface's vertices; `None` if these do not fit its columns or its type of
/// numbers, or if the name asks for another kind of file.
pub(super) fn rewrite(bytes: &[u8], edit: &ValuesEdit<'_>) -> Result<Option<Vec<u8>>, WriteError> {
    let found = locate_numbers(
        bytes,
        edit.size.structure,
        edit.size.n_vertices,
        &ReadLimits::default(),
        Progress::none(),
    );
    let Ok(CiftiNumbers { model, start, n_columns, kind, order, is_scaled, .. }) = found else {
        return Ok(None);
    };
    let asked = CiftiColumns::from_path(edit.path).map(|columns| columns.intent().0);
    let intent = i32::from_bytes(&bytes[504..508], order);
    let is_float = matches!(kind, ValueType::F32 | ValueType::F64) && !is_scaled;
    let field = edit.field;
    let fits = field.n_channels == n_columns && field.len() == edit.size.n_vertices;
    if asked != Some(intent) || !is_float || !fits {
        return Ok(None);
    }
    let value = |i: usize| field.values.get(i);
    if kind == ValueType::F32 {
        check_range(
            CIFTI.format,
            &format!("values of `{}`", field.name),
            field.values.len(),
            Progress::none(),
            value,
        )?;
    }
    let mut out = bytes.to_vec();
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
