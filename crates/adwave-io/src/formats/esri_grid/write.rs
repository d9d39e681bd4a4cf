//! Writer of ESRI ASCII grids.

use super::read::{EsriHeader, next_word};
use crate::model::context::WriteContext;
use crate::model::grid_values::written_field;
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::report_row;
use crate::text::{parse_f64, push_f32, push_f64};
use crate::{Field, FieldValues, Format, ShapeFile, ValueType, WriteError};

/// Relative difference of a width and a height that are one cell size.
const ROUNDING: f64 = 1e-9;
/// Number that means no data in new files.
const MISSING: f64 = -9999.0;

/// A grid that was read.
#[derive(Debug)]
pub(super) struct GridDocument {
    pub(super) bytes: Vec<u8>,
    pub(super) header: EsriHeader,
}

/// Writes a value as text, in the type asked for or its own.
fn push_value(field: &Field, i: usize, kind: Option<ValueType>, out: &mut Vec<u8>) {
    let x = field.values.get(i);
    match (kind, &field.values) {
        (Some(ValueType::F32), _) | (None, FieldValues::F32(_)) => push_f32(out, x as f32),
        (Some(kind), _) if kind.is_integer() => push_f64(out, x.round_ties_even() + 0.0),
        _ => push_f64(out, x),
    }
}

impl SourceDocument for GridDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let Self { bytes, header } = self;
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        if field.n_channels != 1 {
            return Ok(Update::DoesNotFit);
        }
        let mut out = bytes[..header.start].to_vec();
        let mut at = header.start;
        for i in 0..field.len() {
            report_row(c.progress, i as u64, field.len() as u64)?;
            let Some((word, end)) = next_word(bytes, at) else { return Ok(Update::DoesNotFit) };
            let (old, new) = (header.value(parse_f64(word).unwrap_or(f64::NAN)), field.values.get(i));
            out.extend_from_slice(&bytes[at..end - word.len()]);
            if old == new || (old.is_nan() && new.is_nan()) {
                out.extend_from_slice(word);
            } else if new.is_nan() {
                let Some((_, missing)) = &header.missing else {
                    let what =
                        "a place without data: the file has no line NODATA_value, which would mark it".into();
                    return Err(WriteError::CannotHold { format: c.format, what });
                };
                out.extend_from_slice(missing.as_bytes());
            } else {
                push_value(field, i, shape.value_type, &mut out);
            }
            at = end;
        }
        out.extend_from_slice(&bytes[at..]);
        c.progress.check()?;
        c.out.write_all(&out)?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::ESRI_GRID
    }
}

/// Writes a new grid.
pub(super) fn write_grid(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let cannot = |what: String| WriteError::CannotHold { format: c.format, what };
    let Some(layout) = shape.grid() else { return Err(cannot("a shape".into())) };
    let [n_rows, n_columns] = layout.sizes[..] else {
        return Err(cannot(format!("a grid of {} axes: it stores images", layout.sizes.len())));
    };
    if field.n_channels != 1 {
        return Err(cannot(format!("{} channels: it stores one number at a place", field.n_channels)));
    }
    let [height, width] = [layout.spacings[0], layout.spacings[1]];
    let is_upright = layout.steps == [[0.0, -height, 0.0], [width, 0.0, 0.0]];
    if !is_upright {
        c.report.report_dropped("position and direction of the axes");
    }
    let (x, y) = if is_upright {
        (layout.origin[0] - 0.5 * width, layout.origin[1] - (n_rows as f64 - 0.5) * height)
    } else {
        (0.0, 0.0)
    };
    if let Some(system) = shape.coordinate_system() {
        c.report.report_dropped(format!("the coordinate system {}", system.name));
    }
    let mut out = format!("ncols {n_columns}\nnrows {n_rows}\n").into_bytes();
    let mut line = |key: &str, x: f64| {
        out.extend_from_slice(key.as_bytes());
        out.push(b' ');
        push_f64(&mut out, x);
        out.push(b'\n');
    };
    line("xllcorner", x);
    line("yllcorner", y);
    if (width / height - 1.0).abs() < ROUNDING {
        line("cellsize", width);
    } else {
        line("dx", width);
        line("dy", height);
    }
    let has_missing = (0..field.len()).any(|i| !field.values.get(i).is_finite());
    let mut missing = MISSING;
    while has_missing && (0..field.len()).any(|i| field.values.get(i) == missing) {
        missing = 10.0 * missing - 9.0;
    }
    if has_missing {
        line("NODATA_value", missing);
    }
    for i in 0..field.len() {
        report_row(c.progress, i as u64, field.len() as u64)?;
        if field.values.get(i).is_finite() {
            push_value(field, i, shape.value_type, &mut out);
        } else {
            push_f64(&mut out, missing);
        }
        out.push(if (i + 1) % n_columns == 0 { b'\n' } else { b' ' });
    }
    c.progress.check()?;
    c.out.write_all(&out)?;
    Ok(())
}
