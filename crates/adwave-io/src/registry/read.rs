//! Reading of shapes from files or bytes.

use std::path::Path;

use adwave::{Cancelled, Progress};

use crate::files::read::read_file;
use crate::formats::TABLE;
use crate::limits::decompress;
use crate::model::context::ReadContext;
use crate::model::units::UnitRoom;
use crate::progress::BYTES_PER_STEP;
use crate::registry::names::unknown_content;
use crate::registry::sniff::sniff;
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Reads the shape in a file, compressed by gzip or not. The content determines the format; the name counts only if
/// the content is ambiguous. A folder with an `ept.json`, or that file, is read as an EPT; for a part of one see
/// [`read_cloud_part`](crate::read_cloud_part).
///
/// # Errors
/// The file cannot be read, its format is unknown, it is malformed (with line or byte), or it exceeds the limits. The
/// message is one line that begins with the file's name.
pub fn read_path(path: &Path, limits: &ReadLimits) -> Result<ShapeFile, ReadError> {
    read_path_with(path, limits, Progress::none())
}

/// [`read_path`] with cancellation and progress: in bytes while the file is read, then in rows while it is parsed.
///
/// # Errors
/// The errors of [`read_path`], and [`ReadError::Cancelled`] soon after the cancellation.
pub fn read_path_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let context = ReadContext { limits, progress, name: None, folder: None };
    let mut folder_readers = TABLE.iter().filter_map(|format| format.read_folder);
    if let Some(shape) = folder_readers.find_map(|read| read(path, &context)) {
        let shape = shape?;
        let format = shape.format;
        return finish(shape, format, progress);
    }
    read_file(path, limits, progress)
        .and_then(|bytes| read_named(bytes, Some(&path.to_string_lossy()), path.parent(), limits, progress))
        .map_err(|e| e.in_file(path))
}

/// Reads the shape in bytes, compressed by gzip or not. `name_hint` is a file name; the content takes precedence.
///
/// # Errors
/// The errors of [`read_path`], without the file's name.
pub fn read_bytes(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    limits: &ReadLimits,
) -> Result<ShapeFile, ReadError> {
    read_bytes_with(bytes, name_hint, limits, Progress::none())
}

/// [`read_bytes`] with progress and cancellation.
///
/// # Errors
/// The errors of [`read_bytes`], and [`ReadError::Cancelled`] soon after the cancellation.
pub fn read_bytes_with(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    read_named(bytes, name_hint, None, limits, progress)
}

/// Reads the shape in bytes. External files are read from the folder, if there is one.
fn read_named(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut bytes = decompress(bytes, limits, progress)?;
    if let Some(text) = crate::text::encoding::from_utf16(&bytes)
        && !text.contains(&0)
    {
        bytes = text;
    }
    let mut format = sniff(&bytes, name_hint)?;
    if (format.descriptor().has_lines)(&bytes) && old_line_ends(&mut bytes, progress)? {
        // Content that was one long comment may be rows now.
        format = sniff(&bytes, name_hint)?;
    }
    let Some(read) = format.descriptor().read else {
        return Err(unknown_content(format!("{format} is write-only")));
    };
    let context = ReadContext { limits, progress, name: name_hint, folder };
    let mut shape = read(bytes, &context)?;
    if shape.structure.is_none() {
        shape.structure = name_hint.and_then(hemisphere).map(str::to_owned);
    }
    finish(shape, Some(format), progress)
}

/// Hemisphere that a name of FreeSurfer's kind states: that of `lh.white` and of `surf/rh.pial.obj`.
fn hemisphere(name: &str) -> Option<&'static str> {
    match name.rsplit(['/', '\\']).next()?.get(..3)? {
        "lh." => Some("CortexLeft"),
        "rh." => Some("CortexRight"),
        _ => None,
    }
}

/// Adds the facts that hold for all files of the format, and leaves out the vertices without a position.
fn finish(
    mut shape: ShapeFile,
    format: Option<Format>,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    if let Some(UnitRoom::Fixed(unit)) = format.map(|format| format.descriptor().unit)
        && shape.unit.is_none()
    {
        shape.unit = Some(unit.clone());
    }
    shape.with_original_fields().without_missing(progress)
}

/// Replaces line ends that are a carriage return alone (Macintosh before 2001) by line feeds; returns true if there
/// were any.
fn old_line_ends(bytes: &mut [u8], progress: Progress<'_>) -> Result<bool, Cancelled> {
    for chunk in bytes.chunks(BYTES_PER_STEP) {
        progress.check()?;
        if memchr::memchr(b'\n', chunk).is_some() {
            return Ok(false);
        }
    }
    let mut is_changed = false;
    for chunk in bytes.chunks_mut(BYTES_PER_STEP) {
        progress.check()?;
        for b in chunk {
            if *b == b'\r' {
                *b = b'\n';
                is_changed = true;
            }
        }
    }
    Ok(is_changed)
}
