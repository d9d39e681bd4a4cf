//! Point Cloud Library files, binary or text.

use crate::formats::pcd::read::PcdSource;
use std::io::Write;

use adwave::Progress;

use crate::model::field::ByteOrder;
use crate::model::grouping::one_word;
use crate::progress::at_row;
use crate::text::{push_f32, push_f64};
use crate::{Field, FieldValues, Format, Precision, ShapeFile, ValueType, WriteError, WriteReport};

/// True for a color of bytes, which is packed into one number for the library.
fn is_packed(field: &Field) -> bool {
    field.name == "color" && matches!(field.n_channels, 3 | 4) && matches!(field.values, FieldValues::U8(_))
}

fn packed(field: &Field, i: usize) -> u32 {
    let byte = |c: usize| if c < field.n_channels { field.get(i, c) as u8 } else { 0 };
    u32::from_le_bytes([byte(2), byte(1), byte(0), byte(3)])
}

/// Columns of a field: name, type and count of each.
fn columns(field: &Field) -> Vec<(String, ValueType, usize)> {
    let value_type = field.values.value_type();
    let three = |names: [&str; 3]| names.map(|n| (n.to_string(), value_type, 1)).to_vec();
    match (field.name.as_str(), field.n_channels) {
        _ if is_packed(field) => {
            let name = if field.n_channels == 3 { "rgb" } else { "rgba" };
            // An integer in both forms: as a float some bit patterns would be NaN, which text cannot represent.
            vec![(name.into(), ValueType::U32, 1)]
        }
        ("normal", 3) => three(["normal_x", "normal_y", "normal_z"]),
        ("color", 3) => three(["red", "green", "blue"]),
        (name, n) => vec![(one_word(name), value_type, n)],
    }
}

/// Writes points and all vertex fields, with the sensor pose and the image size of the original PCD.
pub(crate) fn write_pcd(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if !shape.faces.is_empty() {
        report.leave_out("faces");
    }
    report.leave_face_fields(shape, &[]);
    if !shape.edges.pairs.is_empty() {
        report.leave_out("edges");
    }
    let coordinate = if shape.precision == Precision::F32 { ValueType::F32 } else { ValueType::F64 };
    let mut all: Vec<_> = ["x", "y", "z"].map(|n| (n.to_string(), coordinate, 1)).to_vec();
    all.extend(shape.vertex_fields.iter().flat_map(columns));
    let list = |part: &dyn Fn(&(String, ValueType, usize)) -> String| {
        all.iter().map(|c| format!(" {}", part(c))).collect::<String>()
    };
    let kind = |t: ValueType| match t {
        ValueType::F32 | ValueType::F64 => "F",
        ValueType::I8 | ValueType::I16 | ValueType::I32 | ValueType::I64 => "I",
        _ => "U",
    };
    let n = shape.points.len() as u64;
    let (viewpoint, width, height) = match shape.source::<PcdSource>() {
        Some(pcd) => (pcd.viewpoint.as_str(), pcd.width, pcd.height),
        _ => ("0 0 0 1 0 0 0", n, 1),
    };
    let encoding = match format {
        Format::PCD => "binary",
        Format::PCD_COMPRESSED => "binary_compressed",
        _ => "ascii",
    };
    writeln!(out, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7")?;
    writeln!(out, "FIELDS{}\nSIZE{}", list(&|c| c.0.clone()), list(&|c| c.1.n_bytes().to_string()))?;
    writeln!(out, "TYPE{}\nCOUNT{}", list(&|c| kind(c.1).into()), list(&|c| c.2.to_string()))?;
    writeln!(out, "WIDTH {width}\nHEIGHT {height}\nVIEWPOINT {viewpoint}\nPOINTS {n}\nDATA {encoding}")?;
    if format == Format::PCD_COMPRESSED {
        return write_compressed(shape, &all, out, progress);
    }
    let mut row = Vec::new();
    for i in 0..shape.points.len() {
        at_row(progress, i as u64, n)?;
        row.clear();
        if format == Format::PCD {
            binary_row(shape, i, &mut row);
        } else {
            text_row(shape, i, &mut row);
        }
        out.write_all(&row)?;
    }
    Ok(())
}

/// Writes compressed points field by field: all of the first field, all of the second, …
fn write_compressed(
    shape: &ShapeFile,
    columns: &[(String, ValueType, usize)],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (n, mut rows) = (shape.points.len(), Vec::new());
    for i in 0..n {
        at_row(progress, i as u64, n as u64)?;
        binary_row(shape, i, &mut rows);
    }
    let stride: usize = columns.iter().map(|(_, kind, count)| kind.n_bytes() * count).sum();
    let mut plain = Vec::with_capacity(rows.len());
    let mut start = 0;
    for (_, kind, count) in columns {
        let size = kind.n_bytes() * count;
        for i in 0..n {
            at_row(progress, i as u64, n as u64)?;
            plain.extend_from_slice(&rows[i * stride + start..][..size]);
        }
        start += size;
    }
    drop(rows);
    let packed = super::lzf::compress(&plain, progress)?;
    let sizes = [packed.len(), plain.len()].map(u32::try_from);
    let [Ok(n_packed), Ok(n_plain)] = sizes else {
        let what = "4 GiB of points".into();
        return Err(WriteError::CannotHold { format: Format::PCD_COMPRESSED, what });
    };
    out.write_all(&[n_packed.to_le_bytes(), n_plain.to_le_bytes()].concat())?;
    Ok(out.write_all(&packed)?)
}

fn binary_row(shape: &ShapeFile, i: usize, row: &mut Vec<u8>) {
    for x in shape.points[i] {
        match shape.precision {
            Precision::F32 => row.extend_from_slice(&(x as f32).to_le_bytes()),
            Precision::F64 => row.extend_from_slice(&x.to_le_bytes()),
        }
    }
    for field in &shape.vertex_fields {
        if is_packed(field) {
            row.extend_from_slice(&packed(field, i).to_le_bytes());
            continue;
        }
        for c in 0..field.n_channels {
            field.values.write_bytes(i * field.n_channels + c, ByteOrder::Little, row);
        }
    }
}

fn text_row(shape: &ShapeFile, i: usize, row: &mut Vec<u8>) {
    for (axis, x) in shape.points[i].into_iter().enumerate() {
        if axis > 0 {
            row.push(b' ');
        }
        match shape.precision {
            Precision::F32 => push_f32(row, x as f32),
            Precision::F64 => push_f64(row, x),
        }
    }
    for field in &shape.vertex_fields {
        if is_packed(field) {
            row.extend_from_slice(format!(" {}", packed(field, i)).as_bytes());
            continue;
        }
        for c in 0..field.n_channels {
            row.push(b' ');
            field.values.write_text(i * field.n_channels + c, row);
        }
    }
    row.push(b'\n');
}
