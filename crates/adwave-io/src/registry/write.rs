//! Writing of shapes to files or bytes.

use std::io::Write;
use std::path::Path;

use adwave::Progress;

use crate::model::original::{Original, RowEdit};
use crate::progress::{Watched, all};
use crate::provenance::{NAME, Provenance, WithComment};
use crate::{Format, Precision, ShapeFile, WriteError, atomic_write_with};

/// What is not in the written file because the format cannot hold it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteReport {
    /// What the shape has and the format cannot hold, so that the file is without it: one phrase each, such as
    /// ``vertex field `gaze` ``; empty where all was written.
    pub not_written: Vec<String>,
}

impl WriteReport {
    pub(crate) fn leave_out(&mut self, what: impl Into<String>) {
        let what = what.into();
        if !self.not_written.contains(&what) {
            self.not_written.push(what);
        }
    }

    /// Names all vertex fields but those that are held.
    pub(crate) fn leave_vertex_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.vertex_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            self.leave_out(format!("vertex field `{}`", field.name));
        }
    }

    /// Names all face fields but those that are held.
    pub(crate) fn leave_face_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.face_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            self.leave_out(format!("face field `{}`", field.name));
        }
    }
}

/// Writes the shape as a whole file (see [`atomic_write`](crate::atomic_write)). Without a format the name's ending decides; a shape read
/// from the text (or binary) form of that ending is written in the same form. `.gz` after the ending compresses.
///
/// A shape that is written in the format that it was read from keeps everything else that the file had.
///
/// # Errors
/// One line that begins with the file's name; an older file of that name is unchanged then.
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
        let named = Format::from_path(path)?;
        Some(shape.format.filter(|own| own.family() == named).unwrap_or(named))
    };
    let Some(format) = format.or_else(by_name) else {
        return Err(WriteError::UnknownFormat.in_file(path));
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
    let out = &mut Watched::new(out, progress);
    let comment = shape.new_provenance().map(Provenance::to_json).and_then(|json| match format.family() {
        Format::Ply => Some((format!("comment {NAME} {json}\n"), 2)),
        Format::Obj => Some((format!("# {NAME} {json}\n"), 0)),
        _ => None,
    });
    match comment {
        Some((line, lines_before)) => {
            write_shape(shape, format, &mut WithComment::new(out, line, lines_before), progress)
        }
        None => write_shape(shape, format, out, progress),
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
    if shape.points.len() != shape.n_vertices && !format.holds_graphs() {
        let what = "a graph without coordinates".into();
        return Err(WriteError::CannotHold { format, what });
    }
    if let Some(Original::Pcd(pcd)) = shape.original.as_deref()
        && let Some(whole) = &pcd.whole
        && format.family() == Format::Pcd
    {
        return write_bytes_with(&whole.with(shape, progress)?, format, out, progress);
    }
    let is_gltf = |format: Format| matches!(format, Format::Glb | Format::Gltf);
    // Text and binary glTF hold the same.
    let is_same = shape.format == Some(format) || (is_gltf(format) && shape.format.is_some_and(is_gltf));
    if is_same && let Some(report) = update(shape, format, out, progress)? {
        return Ok(report);
    }
    let mut report = WriteReport::default();
    // The records of a LAS stay in a LAZ, and the other way round.
    let keeps_extras = matches!(format, Format::Las | Format::Laz)
        && matches!(shape.original.as_deref(), Some(Original::Las(_)));
    for extra in shape.extras.iter().filter(|_| !keeps_extras) {
        report.leave_out(extra.clone());
    }
    match format {
        Format::Obj => crate::formats::obj::write::write_obj(shape, &mut report, out, progress)?,
        Format::Ply | Format::PlyAscii => {
            crate::formats::ply::write::write_ply(shape, format, &mut report, out, progress)?;
        }
        Format::Off => crate::formats::off::write::write_off(shape, &mut report, out, progress)?,
        Format::OffBinary => {
            crate::formats::off::binary::write_off_binary(shape, &mut report, out, progress)?
        }
        Format::Stl | Format::StlAscii => {
            crate::formats::stl::write::write_stl(shape, format, &mut report, out, progress)?;
        }
        Format::Xyz | Format::Pts | Format::Csv => {
            crate::formats::columns::write::write_columns(shape, format, &mut report, out, progress)?;
        }
        Format::Pcd | Format::PcdAscii | Format::PcdCompressed => {
            crate::formats::pcd::write::write_pcd(shape, format, &mut report, out, progress)?;
        }
        Format::Mtx => crate::formats::mtx::write::write_mtx(shape, &mut report, out, progress)?,
        Format::Vtp => crate::formats::vtk_xml::write::write_vtp(shape, &mut report, out, progress)?,
        Format::Vtu => crate::formats::vtk_xml::write::write_vtu(shape, &mut report, out, progress)?,
        Format::FreeSurfer => {
            crate::formats::freesurfer::write::write_surface(shape, None, &mut report, out, progress)?;
        }
        Format::Vtk => crate::formats::vtk_legacy::write::write_vtk(shape, &mut report, out, progress)?,
        Format::Glb | Format::Gltf => {
            crate::formats::gltf::write::write_gltf(shape, format, &mut report, out, progress)?;
        }
        Format::Gifti => crate::formats::gifti::write::write_gifti(shape, &mut report, out, progress)?,
        Format::Amf => crate::formats::amf::write::write_amf(shape, &mut report, out, progress)?,
        Format::ThreeMf => crate::formats::threemf::write::write_3mf(shape, &mut report, out, progress)?,
        Format::Dmat | Format::DmatBinary => {
            crate::formats::dmat::write::write_dmat(shape, format, &mut report, out, progress)?;
        }
        Format::Tgf => crate::formats::graph::write::write_tgf(shape, &mut report, out, progress)?,
        Format::EdgeList => crate::formats::graph::write::write_edge_list(shape, &mut report, out, progress)?,
        Format::GraphMl => crate::formats::graph::write::write_graphml(shape, &mut report, out, progress)?,
        Format::Medit | Format::MeditBinary => {
            crate::formats::medit::write::write_medit(shape, format, &mut report, out, progress)?;
        }
        Format::Msh | Format::MshAscii => {
            crate::formats::msh::write::write_msh(shape, format, &mut report, out, progress)?;
        }
        Format::Las | Format::Laz => {
            crate::formats::las::write::write_las(shape, format, &mut report, out, progress)?;
        }
        Format::E57 | Format::Ept | Format::Geomview | Format::Vti | Format::Vtr | Format::Vts => {
            return Err(WriteError::ReadOnly { format });
        }
    }
    Ok(report)
}

/// A shape that comes from no file may name vertices that it does not have.
fn check_indices(shape: &ShapeFile, format: Format, progress: Progress<'_>) -> Result<(), WriteError> {
    let (corners, n) = (shape.faces.corners(), shape.n_vertices);
    if !all(corners.len(), progress, |k| (corners[k] as usize) < n)? {
        let face = shape.faces.iter().position(|f| f.iter().any(|&v| v as usize >= n)).unwrap_or(0);
        let what = format!("face {face}, which names a vertex beyond the {n} existing ones");
        return Err(WriteError::CannotHold { format, what });
    }
    Ok(())
}

/// Coordinates that are written in single precision must not become infinite.
fn check_range(shape: &ShapeFile, format: Format, progress: Progress<'_>) -> Result<(), WriteError> {
    let is_single = matches!(
        format,
        Format::Stl | Format::Gifti | Format::FreeSurfer | Format::Glb | Format::Gltf | Format::OffBinary
    );
    if shape.precision == Precision::F64 && !is_single {
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

/// Writes the original with the changes, where the changes allow that.
fn update(
    shape: &ShapeFile,
    format: Format,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<Option<WriteReport>, WriteError> {
    let Some(original) = &shape.original else { return Ok(None) };
    match &**original {
        // Points of the plane that left it need a z each.
        Original::Rows(rows)
            if format == Format::Obj
                && rows.columns[2] == usize::MAX
                && shape.points.iter().any(|p| p[2] != 0.0) =>
        {
            Ok(None)
        }
        Original::Rows(rows) if format == Format::Obj => {
            crate::formats::obj::write::update_obj(shape, rows, out, progress).map(Some)
        }
        Original::Rows(rows) if format == Format::Off && shape.edited.is_empty() => {
            rows.write_all(shape, &RowEdit::default(), out, progress)?;
            Ok(Some(WriteReport::default()))
        }
        Original::Rows(rows) if matches!(format, Format::Xyz | Format::Csv) => {
            crate::formats::columns::write::update_columns(shape, rows, out, progress)
        }
        Original::Rows(rows) if format == Format::Pts && shape.edited.is_empty() => {
            rows.write_all(shape, &RowEdit::default(), out, progress)?;
            Ok(Some(WriteReport::default()))
        }
        Original::OffBinary(rows) if shape.edited.is_empty() => {
            rows.write_range((0, rows.bytes.len()), shape, out, progress)?;
            Ok(Some(WriteReport::default()))
        }
        Original::Pcd(pcd) if shape.edited.is_empty() => {
            let Some(rows) = &pcd.rows else { return Ok(None) };
            rows.write_all(shape, &RowEdit::default(), out, progress)?;
            Ok(Some(WriteReport::default()))
        }
        Original::FreeSurfer(original) => {
            let mut report = WriteReport::default();
            crate::formats::freesurfer::write::write_surface(
                shape,
                Some(original),
                &mut report,
                out,
                progress,
            )?;
            Ok(Some(report))
        }
        Original::Msh(msh) => crate::formats::msh::write::update_msh(shape, msh, out, progress),
        Original::Medit(medit) => crate::formats::medit::write::update_medit(shape, medit, out, progress),
        Original::Gifti(gifti) => crate::formats::gifti::update::update_gifti(shape, gifti, out, progress),
        Original::Gltf(gltf) => crate::formats::gltf::update::update_gltf(shape, gltf, format, out, progress),
        Original::Ply(ply) => crate::formats::ply::update::update_ply(shape, ply, out, progress).map(Some),
        _ => Ok(None),
    }
}
