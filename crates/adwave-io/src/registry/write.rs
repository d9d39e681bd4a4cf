//! Writing of shapes to files or bytes.

use std::io::Write;
use std::path::Path;

use adwave::Progress;

use crate::files::atomic::atomic_write_with;
use crate::model::colors::with_byte_colors;
use crate::model::context::WriteContext;
use crate::model::float_steps::note_on_writing;
use crate::model::format_descriptor::{CoordinateType, ProvenanceRoom};
use crate::model::source_document::{CORNER_TEXCOORDS, Update};
use crate::model::units::convert_unit;
use crate::progress::{CancellableWriter, all};
use crate::provenance::{CommentInserter, NAME, Provenance};
use crate::registry::names::unknown_ending;
use crate::{CoordinatePrecision, Format, ShapeFile, WriteError, WriteReport};

/// Writes the shape to a file atomically (see [`atomic_write`](crate::atomic_write)). Without a format the extension
/// decides; a shape read from the text (or binary) form of that extension is written in the same form. `.gz` after
/// the extension compresses.
///
/// A shape written in the format it was read from keeps all other content of the file.
///
/// # Errors
/// Writing fails, or the format cannot store the shape; an older file of that name is unchanged then. The message is
/// one line that begins with the file's name.
pub fn write_path(shape: &ShapeFile, path: &Path, format: Option<Format>) -> Result<WriteReport, WriteError> {
    write_path_with(shape, path, format, Progress::none())
}

/// [`write_path`] with cancellation and progress, in rows of vertices and then of faces.
///
/// # Errors
/// The errors of [`write_path`], and [`WriteError::Cancelled`] soon after the cancellation.
pub fn write_path_with(
    shape: &ShapeFile,
    path: &Path,
    format: Option<Format>,
    progress: Progress<'_>,
) -> Result<WriteReport, WriteError> {
    let by_name = || {
        let grid = shape.grid().and_then(|_| Format::grid_from_path(path));
        let named = grid.or_else(|| Format::from_path(path))?;
        Some(shape.format.filter(|own| own.family() == named).unwrap_or(named))
    };
    let Some(format) = format.or_else(by_name) else {
        return Err(unknown_ending().in_file(path));
    };
    if !format.can_write() {
        return Err(WriteError::ReadOnly { format }.in_file(path));
    }
    let compress = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    atomic_write_with(path, progress, |out| {
        if !compress {
            return write_bytes_with(shape, format, out, progress);
        }
        let mut gz = flate2::write::GzEncoder::new(out, flate2::Compression::default());
        let report = write_bytes_with(shape, format, &mut gz, progress)?;
        gz.finish()?;
        Ok(report)
    })
}

/// Writes the shape in a format.
///
/// # Errors
/// Writing fails, or the format cannot store any part of the shape.
pub fn write_bytes(
    shape: &ShapeFile,
    format: Format,
    out: &mut dyn Write,
) -> Result<WriteReport, WriteError> {
    write_bytes_with(shape, format, out, Progress::none())
}

/// [`write_bytes`] with progress and cancellation.
///
/// # Errors
/// The errors of [`write_bytes`], and [`WriteError::Cancelled`] soon after the cancellation.
pub fn write_bytes_with(
    shape: &ShapeFile,
    format: Format,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<WriteReport, WriteError> {
    if !format.can_write() {
        return Err(WriteError::ReadOnly { format });
    }
    let out = &mut CancellableWriter::new(out, progress);
    let provenance = shape.new_provenance().map(Provenance::to_json);
    match (provenance, format.descriptor().provenance) {
        (Some(json), ProvenanceRoom::Comment { begin, lines_before }) => {
            let line = format!("{begin} {NAME} {json}\n");
            write_shape(shape, format, &mut CommentInserter::new(out, line, lines_before), progress)
        }
        _ => write_shape(shape, format, out, progress),
    }
}

fn write_shape(
    shape: &ShapeFile,
    format: Format,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<WriteReport, WriteError> {
    check_indices(shape, format, progress)?;
    check_range(shape, format, progress)?;
    let holds_grids = format.holds_grids();
    if holds_grids != shape.grid.is_some() {
        let what = if holds_grids { "a shape: it holds images and volumes" } else { "the values of a grid" };
        return Err(WriteError::CannotHold { format, what: what.into() });
    }
    let holds_brains = format.holds_brains();
    if holds_brains != shape.brain.is_some() {
        let what = if holds_brains {
            "a shape: it holds values of a brain"
        } else {
            "values of the parts of a brain"
        };
        return Err(WriteError::CannotHold { format, what: what.into() });
    }
    let has_values = holds_grids || holds_brains;
    if shape.points.len() != shape.n_vertices && !has_values && !format.holds_graphs() {
        let what = "a graph without coordinates".into();
        return Err(WriteError::CannotHold { format, what });
    }
    let mut context = WriteContext { format, out, report: WriteReport::default(), progress };
    if let Some(whole) = shape.with_left_out(format.descriptor().holds_missing, progress)? {
        return write_shape(&whole, format, context.out, progress);
    }
    let converted = convert_unit(shape, format, &mut context.report)?;
    let shape = converted.as_ref().unwrap_or(shape);
    // Documents of formats with 32-bit floats alone round relative to their own nodes and offsets.
    let is_updated =
        shape.original.as_deref().zip(shape.format).is_some_and(|(s, own)| s.can_update(own, format));
    let descriptor = format.descriptor();
    let is_single = match descriptor.coordinates {
        CoordinateType::Double => false,
        CoordinateType::Single => !is_updated,
        CoordinateType::OfShape => {
            shape.precision == CoordinatePrecision::F32 && (shape.moved || !is_updated)
        }
    };
    if is_single {
        context.report.notes.extend(note_on_writing(shape, progress)?);
    }
    if let Some(source) = shape.original.as_deref()
        && shape.format.is_some_and(|read| source.can_update(read, format))
    {
        if source.update(shape, &mut context)? == Update::Written {
            return Ok(context.report);
        }
        context.report.not_written.clear();
    }
    if !shape.original.as_deref().is_some_and(|source| source.keeps_extras(format)) {
        let keeps_texcoords = descriptor.holds_corner_texcoords && shape.corner_texcoords().is_some();
        for extra in shape.extras.iter().filter(|extra| !keeps_texcoords || *extra != CORNER_TEXCOORDS) {
            context.report.report_dropped(extra.clone());
        }
    }
    if !descriptor.holds_field_data {
        for field in &shape.field_data {
            context.report.report_dropped(format!("field data `{}`", field.name));
        }
    }
    if shape.vertex_names.is_some() && !descriptor.holds_names {
        context.report.report_dropped("names of vertices");
    }
    let write = descriptor.write.ok_or(WriteError::ReadOnly { format })?;
    let colored =
        if descriptor.has_byte_colors { with_byte_colors(shape, &mut context.report) } else { None };
    write(colored.as_ref().unwrap_or(shape), &mut context)?;
    Ok(context.report)
}

/// Checks indices, because a shape without an original file may name vertices that it does not have.
fn check_indices(shape: &ShapeFile, format: Format, progress: Progress<'_>) -> Result<(), WriteError> {
    let (corners, n) = (shape.faces.corners(), shape.n_vertices);
    if !all(corners.len(), progress, |k| (corners[k] as usize) < n)? {
        let face = shape.faces.iter().position(|f| f.iter().any(|&v| v as usize >= n)).unwrap_or(0);
        let what = format!("face {face}, which names a vertex beyond the {n} existing ones");
        return Err(WriteError::CannotHold { format, what });
    }
    Ok(())
}

/// Checks that coordinates written in single precision do not become infinite.
fn check_range(shape: &ShapeFile, format: Format, progress: Progress<'_>) -> Result<(), WriteError> {
    let is_single = format.descriptor().coordinates == CoordinateType::Single;
    if shape.precision == CoordinatePrecision::F64 && !is_single {
        return Ok(());
    }
    let coordinates = shape.points.as_flattened();
    let fits = |k: usize| !coordinates[k].is_finite() || (coordinates[k] as f32).is_finite();
    if !all(coordinates.len(), progress, fits)? {
        let what = "coordinates beyond 3.4e38, the range of 32-bit floats".to_owned();
        return Err(WriteError::CannotHold { format, what });
    }
    Ok(())
}
