//! Writers for rows of numbers: XYZ, PTS, CSV.

use std::io::Write;

use adwave::Progress;

use crate::model::context::WriteContext;
use crate::model::grouping::column_names;
use crate::model::source_document::Update;
use crate::model::text_rows::{RowEdit, Separator, TextRows};
use crate::progress::report_row;
use crate::text::csv::push_csv_row;
use crate::text::push_f64;
use crate::{CoordinatePrecision, Field, Format, ShapeFile, WriteError, WriteReport};

/// Writes the original with other coordinates and with added columns. [`Update::DoesNotFit`] if a column of it was
/// replaced, or if there is no line that could take the names of added ones.
pub(crate) fn update_columns(
    rows: &TextRows,
    shape: &ShapeFile,
    context: &mut WriteContext<'_>,
) -> Result<Update, WriteError> {
    let (out, progress) = (&mut *context.out, context.progress);
    if shape.edited.is_empty() {
        rows.write_all(shape, &RowEdit::default(), out, progress)?;
        return Ok(Update::Written);
    }
    let Some((_, names_end)) = rows.names.filter(|_| context.format != Format::PTS) else {
        return Ok(Update::DoesNotFit);
    };
    if shape.edited.len() + shape.n_original_fields != shape.vertex_fields.len() {
        return Ok(Update::DoesNotFit);
    }
    let separator = if let Separator::Byte(b) = rows.separator { b } else { b' ' };
    let added: Vec<&Field> = shape.vertex_fields.iter().filter(|f| shape.edited.contains(&f.name)).collect();
    let append = |i: usize, buffer: &mut Vec<u8>| {
        for field in &added {
            for c in 0..field.n_channels {
                buffer.push(separator);
                rows.push_number(buffer, field.get(i, c), CoordinatePrecision::F64);
            }
        }
    };
    out.write_all(&rows.bytes[..names_end])?;
    for name in added.iter().flat_map(|f| column_names(f)) {
        out.write_all(&[separator])?;
        out.write_all(name.as_bytes())?;
    }
    let edit = RowEdit { dropped: &[], append: Some(&append) };
    rows.write_range(names_end..rows.bytes.len(), shape, &edit, out, progress)?;
    Ok(Update::Written)
}

/// Writes points and all vertex fields. The first line has the names of the columns: plain in a CSV, after `#` in an
/// XYZ, and there only if there are fields (or no points at all), so that simple readers can read a simple file.
pub(crate) fn write_columns(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if !shape.faces.is_empty() {
        report.report_dropped("faces");
    }
    report.report_face_fields(shape, &[]);
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let separator = if format == Format::CSV { "," } else { " " };
    let names: Vec<String> = shape.vertex_fields.iter().flat_map(column_names).collect();
    if format == Format::CSV {
        let mut head = String::new();
        push_csv_row(&mut head, ["x", "y", "z"].into_iter().chain(names.iter().map(String::as_str)));
        out.write_all(head.as_bytes())?;
    } else if !names.is_empty() || shape.points.is_empty() {
        writeln!(out, "# x y z{}", names.iter().map(|n| format!(" {n}")).collect::<String>())?;
    }
    if format == Format::PTS {
        writeln!(out, "{}", shape.points.len())?;
    }
    let mut line = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        report_row(progress, i as u64, shape.points.len() as u64)?;
        line.clear();
        let fields = shape.vertex_fields.iter().flat_map(|f| (0..f.n_channels).map(move |c| f.get(i, c)));
        for (k, x) in point.iter().copied().chain(fields).enumerate() {
            if k > 0 {
                line.extend_from_slice(separator.as_bytes());
            }
            push_f64(&mut line, x);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}
