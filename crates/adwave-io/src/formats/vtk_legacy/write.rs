//! Legacy VTK writer: binary PolyData with all fields.

use std::io::Write;

use adwave::Progress;

use super::scanner::encoded;
use crate::model::field::ByteOrder;
use crate::model::numbers::cell_fields;
use crate::progress::report_row;
use crate::{CoordinatePrecision, Field, FieldValues, Format, ShapeFile, WriteError, WriteReport};

/// Writes a legacy VTK.
pub(crate) fn write_vtk(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let n = shape.points.len();
    let is_double = shape.precision == CoordinatePrecision::F64;
    writeln!(
        out,
        "# vtk DataFile Version 4.2\nadwave\nBINARY\nDATASET POLYDATA\nPOINTS {n} {}",
        if is_double { "double" } else { "float" }
    )?;
    let mut bytes = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        report_row(progress, i as u64, n as u64)?;
        for &x in point {
            if is_double {
                bytes.extend_from_slice(&x.to_be_bytes());
            } else {
                bytes.extend_from_slice(&(x as f32).to_be_bytes());
            }
        }
        flush(&mut bytes, out)?;
    }
    end(&mut bytes, out)?;
    let edges = &shape.edges.pairs;
    let is_cloud = shape.faces.is_empty() && edges.is_empty();
    if is_cloud && n > 0 {
        let vertices = (0..n as u32).map(|v| [v]);
        write_cells("VERTICES", n, n, vertices, out, progress)?;
    }
    if !edges.is_empty() {
        write_cells("LINES", edges.len(), 2 * edges.len(), edges.iter(), out, progress)?;
    }
    if !shape.faces.is_empty() {
        let n_corners = shape.faces.corners().len();
        write_cells("POLYGONS", shape.faces.len(), n_corners, shape.faces.iter(), out, progress)?;
    }
    let n_cells = edges.len() + shape.faces.len();
    let of_cells = cell_fields(shape);
    if n_cells > 0 && !of_cells.is_empty() {
        write_fields("CELL_DATA", n_cells, &of_cells, out, progress)?;
    }
    if !shape.vertex_fields.is_empty() {
        write_fields("POINT_DATA", n, &shape.vertex_fields, out, progress)?;
    }
    if !shape.edges.weights.is_empty() {
        report.report_dropped("weights of edges");
    }
    Ok(())
}

fn flush(bytes: &mut Vec<u8>, out: &mut dyn Write) -> Result<(), WriteError> {
    if bytes.len() > 1 << 16 {
        out.write_all(bytes)?;
        bytes.clear();
    }
    Ok(())
}

fn end(bytes: &mut Vec<u8>, out: &mut dyn Write) -> Result<(), WriteError> {
    bytes.push(b'\n');
    out.write_all(bytes)?;
    bytes.clear();
    Ok(())
}

fn write_cells(
    keyword: &str,
    n: usize,
    n_corners: usize,
    cells: impl Iterator<Item = impl AsRef<[u32]>>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if i32::try_from(n + n_corners).is_err() {
        let what = format!("{n_corners} corners of cells, which exceeds 31 bits");
        return Err(WriteError::CannotHold { format: Format::VTK, what });
    }
    writeln!(out, "{keyword} {n} {}", n + n_corners)?;
    let mut bytes = Vec::new();
    for (i, cell) in cells.enumerate() {
        report_row(progress, i as u64, n as u64)?;
        let cell = cell.as_ref();
        bytes.extend_from_slice(&(cell.len() as u32).to_be_bytes());
        bytes.extend(cell.iter().flat_map(|v| v.to_be_bytes()));
        flush(&mut bytes, out)?;
    }
    end(&mut bytes, out)
}

fn write_fields(
    keyword: &str,
    n: usize,
    fields: &[Field],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    writeln!(out, "{keyword} {n}\nFIELD FieldData {}", fields.len())?;
    let mut bytes = Vec::new();
    for field in fields {
        let kind = match field.values {
            FieldValues::U8(_) => "unsigned_char",
            FieldValues::I8(_) => "signed_char",
            FieldValues::U16(_) => "unsigned_short",
            FieldValues::I16(_) => "short",
            FieldValues::U32(_) => "unsigned_int",
            FieldValues::I32(_) => "int",
            FieldValues::U64(_) => "vtktypeuint64",
            FieldValues::I64(_) => "vtktypeint64",
            FieldValues::F32(_) => "float",
            FieldValues::F64(_) => "double",
        };
        writeln!(out, "{} {} {n} {kind}", encoded(&field.name), field.n_channels)?;
        for i in 0..field.values.len() {
            report_row(progress, i as u64, field.values.len() as u64)?;
            field.values.write_bytes(i, ByteOrder::Big, &mut bytes);
            flush(&mut bytes, out)?;
        }
        end(&mut bytes, out)?;
    }
    Ok(())
}
