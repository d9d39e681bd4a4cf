//! Checks for formats with 32-bit floats and triangles, and reports of their losses.

use adwave::Progress;
use adwave::shape::{triangulate, triangulate_with_faces};

use crate::progress::all;
use crate::{Format, ShapeFile, WriteError, WriteReport};

/// Checks that 32-bit floats can represent the numbers; otherwise they would become infinite.
pub(crate) fn check_range(
    format: Format,
    what: &str,
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize) -> f64 + Sync,
) -> Result<(), WriteError> {
    let fits = |i: usize| !value(i).is_finite() || (value(i) as f32).is_finite();
    if all(n, progress, fits)? {
        return Ok(());
    }
    let what = format!("{what} beyond 3.4e38, the range of 32-bit floats");
    Err(WriteError::CannotHold { format, what })
}

/// True if rounding to 32-bit floats changes nothing.
pub(crate) fn is_single(
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize) -> f64 + Sync,
) -> Result<bool, WriteError> {
    let keeps = |i: usize| f64::from(value(i) as f32).to_bits() == value(i).to_bits() || value(i).is_nan();
    Ok(all(n, progress, keeps)?)
}

/// Splits the faces into triangles.
pub(crate) fn triangles(shape: &ShapeFile, report: &mut WriteReport) -> Vec<[u32; 3]> {
    say_what_is_cut(shape, report);
    triangulate(&shape.points, &shape.faces)
}

/// Splits the faces into triangles, each with the index of its face.
pub(crate) fn triangles_with_faces(shape: &ShapeFile, report: &mut WriteReport) -> Vec<(usize, [u32; 3])> {
    say_what_is_cut(shape, report);
    triangulate_with_faces(&shape.points, &shape.faces)
}

fn say_what_is_cut(shape: &ShapeFile, report: &mut WriteReport) {
    if shape.faces.iter().any(|face| face.len() < 3) {
        report.leave_out("faces of fewer than three corners");
    }
    if shape.faces.iter().any(|face| face.len() > 3) {
        report.leave_out("polygons (as triangles)");
    }
}
