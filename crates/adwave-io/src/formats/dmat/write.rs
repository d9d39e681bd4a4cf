//! DMAT writer: the points as a matrix of three columns.

use std::io::Write;

use adwave::Progress;

use crate::progress::at_row;
use crate::text::push_f64;
use crate::{Format, ShapeFile, WriteError, WriteReport};

/// Writes the points.
pub(crate) fn write_dmat(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    report.leave_vertex_fields(shape, &[]);
    report.leave_face_fields(shape, &[]);
    for (is_there, what) in [(!shape.faces.is_empty(), "faces"), (!shape.edges.pairs.is_empty(), "edges")] {
        if is_there {
            report.leave_out(what);
        }
    }
    let is_binary = format == Format::DMAT_BINARY;
    let n = shape.points.len();
    writeln!(out, "{}3 {n}", if is_binary { "0 0\n" } else { "" })?;
    let mut row = Vec::new();
    for k in 0..3 * n {
        at_row(progress, k as u64, 3 * n as u64)?;
        let x = shape.points[k % n][k / n];
        row.clear();
        if is_binary {
            row.extend_from_slice(&x.to_le_bytes());
        } else {
            push_f64(&mut row, x);
            row.push(b'\n');
        }
        out.write_all(&row)?;
    }
    Ok(())
}
