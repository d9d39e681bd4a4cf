//! MatrixMarket writer: coordinate matrices.

use std::io::{self, Write};

use adwave::Progress;
use adwave::rows::CompressedRows;

use crate::formats::npy::write::MatrixValue;
use crate::progress::{CancellableWriter, report_row};
use crate::text::push_f64;
use crate::{Direction, Format, ShapeFile, WriteError, WriteReport, atomic_write_with};

/// Writes the edges as a matrix, with their weights if they have any.
pub(crate) fn write_mtx(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let edges = &shape.edges;
    if edges.pairs.is_empty() && !shape.points.is_empty() {
        return Err(WriteError::CannotHold {
            format: Format::MTX,
            what: "a shape without edges of its own".into(),
        });
    }
    for (is_there, what) in [(!shape.points.is_empty(), "coordinates"), (!shape.faces.is_empty(), "faces")] {
        if is_there {
            report.report_dropped(what);
        }
    }
    report.report_vertex_fields(shape, &[]);
    report.report_face_fields(shape, &[]);
    let kind = if edges.weights.is_empty() { "pattern" } else { "real" };
    let symmetry = if edges.direction == Direction::Both { "symmetric" } else { "general" };
    let n = shape.n_vertices;
    writeln!(out, "%%MatrixMarket matrix coordinate {kind} {symmetry}\n{n} {n} {}", edges.pairs.len())?;
    for (e, &[a, b]) in edges.pairs.iter().enumerate() {
        report_row(progress, e as u64, edges.pairs.len() as u64)?;
        // A symmetric matrix is written as its lower triangle.
        let (row, column) = if edges.direction == Direction::Both { (a.max(b), a.min(b)) } else { (a, b) };
        write_entry(out, row, column, |line| {
            if let Some(&weight) = edges.weights.get(e) {
                line.push(b' ');
                push_f64(line, weight);
            }
        })?;
    }
    Ok(())
}

fn write_entry(
    out: &mut dyn Write,
    row: u32,
    column: u32,
    write_value: impl FnOnce(&mut Vec<u8>),
) -> io::Result<()> {
    let mut line = format!("{} {}", u64::from(row) + 1, u64::from(column) + 1).into_bytes();
    write_value(&mut line);
    line.push(b'\n');
    out.write_all(&line)
}

/// Writes a matrix as a MatrixMarket file, `coordinate real general`.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write).
pub fn write_matrix_market<V: MatrixValue>(
    path: &std::path::Path,
    matrix: &CompressedRows<V>,
) -> Result<(), WriteError> {
    write_matrix_market_with(path, matrix, Progress::none())
}

/// [`write_matrix_market`] with progress and cancellation.
///
/// # Errors
/// The errors of [`write_matrix_market`], and [`WriteError::Cancelled`].
pub fn write_matrix_market_with<V: MatrixValue>(
    path: &std::path::Path,
    matrix: &CompressedRows<V>,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    atomic_write_with(path, progress, |out| {
        let out = &mut CancellableWriter::new(out, progress);
        let (n_rows, n_columns, n) = (matrix.n_rows(), matrix.n_columns(), matrix.nnz());
        writeln!(out, "%%MatrixMarket matrix coordinate real general\n{n_rows} {n_columns} {n}")?;
        for row in 0..n_rows {
            report_row(progress, row as u64, n_rows as u64)?;
            let (columns, values) = matrix.row(row);
            for (&column, value) in columns.iter().zip(values) {
                write_entry(out, row as u32, column, |line| {
                    line.push(b' ');
                    value.push_text(line);
                })?;
            }
        }
        Ok(())
    })
}
