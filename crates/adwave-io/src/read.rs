//! Reading a shape from a file or from bytes.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::limits::decompress;
use crate::sniff::sniff;
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Reads the shape in a file, compressed by gzip or not. The content decides the format, the name only where the
/// content leaves it open.
///
/// # Errors
/// One line that begins with the file's name: the file cannot be read, its format is unknown, it is malformed (with
/// line or byte), or it is larger than the limits.
pub fn read_path(path: &Path, limits: &ReadLimits) -> Result<ShapeFile, ReadError> {
    read_file(path, limits)
        .and_then(|bytes| read_bytes(bytes, path.to_str(), limits))
        .map_err(|e| e.in_file(path))
}

/// The bytes of a file, no more than the limit. A pipe is read to its end.
pub(crate) fn read_file(path: &Path, limits: &ReadLimits) -> Result<Vec<u8>, ReadError> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        return Err(ReadError::Whole("is a folder; give a file".into()));
    }
    limits.check_bytes(metadata.len())?;
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    file.take(limits.max_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    limits.check_bytes(bytes.len() as u64)?;
    Ok(bytes)
}

/// Reads the shape in bytes, compressed by gzip or not. `name_hint` is a file name that the content overrules.
///
/// # Errors
/// As [`read_path`], without the file's name.
pub fn read_bytes(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    limits: &ReadLimits,
) -> Result<ShapeFile, ReadError> {
    let mut bytes = decompress(bytes, limits)?;
    let format = sniff(&bytes, name_hint)?;
    if is_text(format, &bytes) {
        old_line_ends(&mut bytes);
    }
    let mut shape = match format.family() {
        Format::Obj => crate::obj::read::read_obj(bytes, limits),
        Format::Ply => crate::ply::read::read_ply(bytes, limits),
        Format::Off => crate::off::read::read_off(bytes, limits),
        Format::Stl if format == Format::StlAscii => crate::stl::read::read_stl_ascii(&bytes, limits),
        Format::Stl => crate::stl::read::read_stl(&bytes, limits),
        Format::Xyz | Format::Pts | Format::Csv => {
            crate::columns::read::read_columns(bytes, limits, name_hint)
        }
        Format::Pcd => crate::pcd::read::read_pcd(bytes, limits),
        Format::Las | Format::Laz => crate::las::read::read_las(&bytes, limits),
        Format::Gifti => crate::gifti::read::read_gifti(&bytes, limits),
        Format::Mtx => crate::mtx::read::read_mtx(&bytes, limits),
        _ => Err(ReadError::UnknownFormat { found: format!("{format} is written only") }),
    }?;
    shape.n_original_fields = shape.vertex_fields.len();
    Ok(shape)
}

fn is_text(format: Format, bytes: &[u8]) -> bool {
    let text = matches!(
        format,
        Format::Obj | Format::Off | Format::StlAscii | Format::Xyz | Format::Pts | Format::Csv | Format::Mtx
    );
    text || (format == Format::Ply && bytes.starts_with(b"ply\rformat ascii"))
}

/// Lines that end with a carriage return alone (before 2001 on the Macintosh) get line feeds instead.
fn old_line_ends(bytes: &mut [u8]) {
    if memchr::memchr(b'\n', bytes).is_none() {
        for b in bytes {
            if *b == b'\r' {
                *b = b'\n';
            }
        }
    }
}
