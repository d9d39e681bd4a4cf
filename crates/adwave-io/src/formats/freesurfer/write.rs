//! Writer for surfaces of triangles in 32-bit floats. A surface read from such a file keeps its creator and its tail.

use std::io::Write;

use adwave::Progress;

use super::read::{FreeSurferSource, TRIANGLES};
use crate::model::f32_limits::{is_single, triangles};
use crate::progress::report_row;
use crate::{CoordinatePrecision, Format, ShapeFile, WriteError, WriteReport};

/// Writes a surface.
pub(crate) fn write_surface(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let original = shape.source::<FreeSurferSource>();
    let coordinates = shape.points.as_flattened();
    if shape.precision == CoordinatePrecision::F64
        && !is_single(coordinates.len(), progress, |i| coordinates[i])?
    {
        report.report_dropped("digits of coordinates beyond 32-bit floats");
    }
    report.report_vertex_fields(shape, &[]);
    report.report_face_fields(shape, &[]);
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let triangles = triangles(shape, report);
    let count = |n: usize| {
        i32::try_from(n).map_err(|_| WriteError::CannotHold {
            format: Format::FREESURFER,
            what: format!("{n} vertices or triangles, which exceeds 31 bits"),
        })
    };
    let (n_vertices, n_triangles) = (count(shape.points.len())?, count(triangles.len())?);
    out.write_all(TRIANGLES)?;
    out.write_all(original.map_or(b"created by adwave\n\n", |original| &original.creator))?;
    out.write_all(&n_vertices.to_be_bytes())?;
    out.write_all(&n_triangles.to_be_bytes())?;
    let mut bytes = Vec::new();
    let rows = shape.points.iter().map(|point| point.map(|x| (x as f32).to_be_bytes()));
    let corners = triangles.iter().map(|triangle| triangle.map(u32::to_be_bytes));
    let n = (shape.points.len() + triangles.len()) as u64;
    for (i, row) in rows.chain(corners).enumerate() {
        report_row(progress, i as u64, n)?;
        bytes.extend_from_slice(row.as_flattened());
        if bytes.len() > 1 << 16 {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)?;
    Ok(out.write_all(original.map_or(&[], |original| &original.tail))?)
}
