//! PLY writer: binary little-endian or text.

use std::io::{self, Write};

use adwave::Progress;

use crate::formats::ply::header::type_name;
use crate::model::field::ByteOrder;
use crate::model::grouping::column_names;
use crate::progress::report_row;
use crate::text::{push_f32, push_f64};
use crate::{CoordinatePrecision, Field, FieldValues, Format, ShapeFile, ValueType, WriteError, WriteReport};

/// Encoding of values.
#[derive(Clone, Copy)]
pub(crate) enum ValueStyle {
    Text,
    Bytes(ByteOrder),
}

/// Writes number `i` of a field; 64-bit integers, which PLY does not have, become doubles.
pub(crate) fn push_value(values: &FieldValues, i: usize, style: ValueStyle, out: &mut Vec<u8>) {
    match (values, style) {
        (FieldValues::U64(_) | FieldValues::I64(_), ValueStyle::Bytes(order)) => {
            FieldValues::F64(vec![values.get(i)]).write_bytes(0, order, out);
        }
        (_, ValueStyle::Bytes(order)) => values.write_bytes(i, order, out),
        (_, ValueStyle::Text) => values.write_text(i, out),
    }
}

/// Writes row `i` of the fields; in text each value follows a blank.
pub(crate) fn push_fields(fields: &[&Field], i: usize, style: ValueStyle, out: &mut Vec<u8>) {
    for field in fields {
        for c in 0..field.n_channels {
            if let ValueStyle::Text = style {
                out.push(b' ');
            }
            push_value(&field.values, i * field.n_channels + c, style, out);
        }
    }
}

/// Header lines of the fields.
pub(crate) fn property_lines(fields: &[&Field], line_end: &str) -> String {
    let lines = |field: &&Field| {
        let kind = type_name(field.values.value_type());
        column_names(field)
            .into_iter()
            .map(|name| format!("property {kind} {name}{line_end}"))
            .collect::<String>()
    };
    fields.iter().map(lines).collect()
}

/// Reports the fields whose numbers do not all fit a double.
pub(crate) fn note_rounding(fields: &[&Field], report: &mut WriteReport) {
    const EXACT: u64 = 1 << 53;
    for field in fields {
        let too_large = match &field.values {
            FieldValues::U64(v) => v.iter().any(|&x| x > EXACT),
            FieldValues::I64(v) => v.iter().any(|&x| x.unsigned_abs() > EXACT),
            _ => false,
        };
        if too_large {
            report.report_dropped(format!("digits of `{}` beyond 2^53", field.name));
        }
    }
}

/// Writes points, faces and edges with all fields.
pub(crate) fn write_ply(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let style = if format == Format::PLY { ValueStyle::Bytes(ByteOrder::Little) } else { ValueStyle::Text };
    let encoding = if format == Format::PLY { "binary_little_endian" } else { "ascii" };
    let fields: Vec<&Field> = shape.vertex_fields.iter().collect();
    let face_fields: Vec<&Field> = shape.face_fields.iter().collect();
    note_rounding(&fields, report);
    note_rounding(&face_fields, report);
    let coordinate =
        if shape.precision == CoordinatePrecision::F32 { ValueType::F32 } else { ValueType::F64 };
    writeln!(out, "ply\nformat {encoding} 1.0\nelement vertex {}", shape.points.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {} {axis}", type_name(coordinate))?;
    }
    out.write_all(property_lines(&fields, "\n").as_bytes())?;
    let most = shape.faces.iter().map(<[u32]>::len).max().unwrap_or(0);
    let count = if most <= 255 { ValueType::U8 } else { ValueType::U32 };
    let corner = if i32::try_from(shape.n_vertices).is_ok() { ValueType::I32 } else { ValueType::U32 };
    let texcoords = shape.corner_texcoords();
    let texcoord_count = if most <= 127 { ValueType::U8 } else { ValueType::U32 };
    if !shape.faces.is_empty() {
        writeln!(out, "element face {}", shape.faces.len())?;
        writeln!(out, "property list {} {} vertex_indices", type_name(count), type_name(corner))?;
        if texcoords.is_some() {
            writeln!(out, "property list {} float texcoord", type_name(texcoord_count))?;
        }
        out.write_all(property_lines(&face_fields, "\n").as_bytes())?;
    }
    if !shape.edges.pairs.is_empty() {
        writeln!(
            out,
            "element edge {}\nproperty int vertex1\nproperty int vertex2",
            shape.edges.pairs.len()
        )?;
        if !shape.edges.weights.is_empty() {
            report.report_dropped("weights of edges");
        }
    }
    writeln!(out, "end_header")?;
    let texcoords = texcoords.as_deref().map(|values| CornerList { values, count: texcoord_count });
    write_body(shape, count, texcoords, style, out, progress)
}

/// Two texture coordinates for each corner of the faces, and the type of the length of their lists.
#[derive(Clone, Copy)]
struct CornerList<'a> {
    values: &'a [f64],
    count: ValueType,
}

fn write_body(
    shape: &ShapeFile,
    count: ValueType,
    texcoords: Option<CornerList<'_>>,
    style: ValueStyle,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let fields: Vec<&Field> = shape.vertex_fields.iter().collect();
    let face_fields: Vec<&Field> = shape.face_fields.iter().collect();
    let mut row = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        report_row(progress, i as u64, shape.points.len() as u64)?;
        row.clear();
        push_point(*point, shape.precision, style, &mut row);
        push_fields(&fields, i, style, &mut row);
        end_row(style, &mut row);
        out.write_all(&row)?;
    }
    for (f, face) in shape.faces.iter().enumerate() {
        report_row(progress, f as u64, shape.faces.len() as u64)?;
        row.clear();
        match (style, count) {
            (ValueStyle::Text, _) => write!(row, "{}", face.len())?,
            (ValueStyle::Bytes(_), ValueType::U8) => row.push(face.len() as u8),
            (ValueStyle::Bytes(_), _) => row.extend_from_slice(&(face.len() as u32).to_le_bytes()),
        }
        push_indices(face, style, true, &mut row)?;
        if let Some(list) = texcoords {
            let end = shape.faces.end(f);
            push_texcoords(&list.values[2 * (end - face.len())..2 * end], list.count, style, &mut row)?;
        }
        push_fields(&face_fields, f, style, &mut row);
        end_row(style, &mut row);
        out.write_all(&row)?;
    }
    for pair in &shape.edges.pairs {
        row.clear();
        push_indices(pair, style, false, &mut row)?;
        end_row(style, &mut row);
        out.write_all(&row)?;
    }
    Ok(())
}

/// Writes a list of texture coordinates, which is empty if one is missing.
fn push_texcoords(values: &[f64], count: ValueType, style: ValueStyle, row: &mut Vec<u8>) -> io::Result<()> {
    let values = if values.iter().all(|x| x.is_finite()) { values } else { &[] };
    match (style, count) {
        (ValueStyle::Text, _) => write!(row, " {}", values.len())?,
        (ValueStyle::Bytes(_), ValueType::U8) => row.push(values.len() as u8),
        (ValueStyle::Bytes(_), _) => row.extend_from_slice(&(values.len() as u32).to_le_bytes()),
    }
    for &x in values {
        if let ValueStyle::Text = style {
            row.push(b' ');
            push_f32(row, x as f32);
        } else {
            row.extend_from_slice(&(x as f32).to_le_bytes());
        }
    }
    Ok(())
}

fn push_indices(indices: &[u32], style: ValueStyle, continues: bool, row: &mut Vec<u8>) -> io::Result<()> {
    for (k, &v) in indices.iter().enumerate() {
        match style {
            ValueStyle::Text if k > 0 || continues => write!(row, " {v}")?,
            ValueStyle::Text => write!(row, "{v}")?,
            ValueStyle::Bytes(_) => row.extend_from_slice(&v.to_le_bytes()),
        }
    }
    Ok(())
}

fn end_row(style: ValueStyle, row: &mut Vec<u8>) {
    if let ValueStyle::Text = style {
        row.push(b'\n');
    }
}

fn push_point(point: [f64; 3], precision: CoordinatePrecision, style: ValueStyle, row: &mut Vec<u8>) {
    for (axis, x) in point.into_iter().enumerate() {
        match (style, precision) {
            (ValueStyle::Bytes(_), CoordinatePrecision::F32) => {
                row.extend_from_slice(&(x as f32).to_le_bytes());
            }
            (ValueStyle::Bytes(_), CoordinatePrecision::F64) => row.extend_from_slice(&x.to_le_bytes()),
            (ValueStyle::Text, precision) => {
                if axis > 0 {
                    row.push(b' ');
                }
                match precision {
                    CoordinatePrecision::F32 => push_f32(row, x as f32),
                    CoordinatePrecision::F64 => push_f64(row, x),
                }
            }
        }
    }
}
