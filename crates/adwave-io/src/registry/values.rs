//! Files of values at the vertices of a surface, identified by their content: FreeSurfer's and CIFTI.

use std::io::Write;
use std::path::Path;

use adwave::Progress;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::files::read::parse_file;
use crate::formats::TABLE;
use crate::model::context::ReadContext;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{MaskRequest, SurfaceSize, ValuesEdit, VertexMask};
use crate::{Field, ReadError, ReadLimits, WriteError};

/// Reads values for a surface: FreeSurfer's curv files (`lh.thickness`), annotations as integers (−1 without a label),
/// labels as 1 at the vertices that they list and 0 elsewhere, MGH and MGZ with a channel per frame, and CIFTI-2, where
/// `structure` (`CortexLeft`) and the number of vertices select the part. Vertices without a value are NaN.
///
/// # Errors
/// The file cannot be read, is of another kind, is malformed, or has no values for the surface. The message is one
/// line with the file's name.
pub fn read_surface_values(
    path: &Path,
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    let progress = Progress::none();
    let size = SurfaceSize { structure, n_vertices };
    parse_file(path, limits, progress, |bytes| parse(&bytes, &size, limits, progress))
}

/// Reads the fields of a file, by the ending of its name if a format of fields has it, else as
/// [`read_surface_values`].
pub(crate) fn read_value_file(
    path: &Path,
    size: &SurfaceSize<'_>,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    let named = TABLE.iter().filter(|format| format.matches_name(path)).find_map(|format| format.read_fields);
    match named {
        Some(read) => read(path, limits),
        None => read_surface_values(path, size.structure, size.n_vertices, limits),
    }
}

/// Bytes of a copy of a file of values with other numbers, for a file at `path`: a GIFTI keeps intents, names and
/// metadata of its arrays, a CIFTI its columns and the values of other structures. `field` has a row per vertex of the
/// surface, and all columns of the file in their order. `.gz` after the extension of `path` compresses. `None` if the
/// file is of another kind than `path` says, or cannot hold the field.
///
/// # Errors
/// [`WriteError::CannotHold`] for finite numbers beyond the range of the file's type.
pub fn rewrite_values(
    source: &Path,
    structure: Option<&str>,
    field: &Field,
    path: &Path,
) -> Result<Option<Vec<u8>>, WriteError> {
    let size = SurfaceSize { structure, n_vertices: field.len() };
    let edit = ValuesEdit { size, field, path };
    let rewritten = parse_file(source, &ReadLimits::default(), Progress::none(), |bytes| {
        let file = FileHead::new(&bytes, None);
        let rewriters =
            TABLE.iter().filter_map(|format| Some(((format.recognize)(&file)?, format.rewrite_values?)));
        let best = rewriters.reduce(|best, other| if other.0 > best.0 { other } else { best });
        Ok(best.map(|(_, rewrite)| rewrite(&bytes, &edit)))
    });
    let Ok(Some(rewritten)) = rewritten else { return Ok(None) };
    let Some(bytes) = rewritten? else { return Ok(None) };
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
        return Ok(Some(bytes));
    }
    let mut gz = GzEncoder::new(Vec::new(), Compression::default());
    gz.write_all(&bytes)?;
    Ok(Some(gz.finish()?))
}

/// Reads a file that names vertices, such as a FreeSurfer label, as a mask; `None` for a file with a number per vertex
/// or of another kind.
///
/// # Errors
/// The file cannot be read or is malformed. The message is one line with the file's name.
pub(crate) fn read_vertex_mask(
    path: &Path,
    request: &MaskRequest<'_>,
    limits: &ReadLimits,
) -> Result<Option<VertexMask>, ReadError> {
    let progress = Progress::none();
    parse_file(path, limits, progress, |bytes| {
        let file = FileHead::new(&bytes, None);
        let recognized = TABLE.iter().filter_map(|format| Some(((format.recognize)(&file)?, *format)));
        let best = recognized.reduce(|best, other| if other.0 > best.0 { other } else { best });
        let Some(read) = best.and_then(|(_, format)| format.read_mask) else { return Ok(None) };
        read(&bytes, request, &ReadContext { limits, progress, name: None, folder: None }).map(Some)
    })
}

/// [`read_surface_values`] from bytes that are not compressed as a whole.
///
/// # Errors
/// The errors of [`read_surface_values`], without the file's name.
pub fn parse_surface_values(
    bytes: &[u8],
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    parse(bytes, &SurfaceSize { structure, n_vertices }, limits, Progress::none())
}

fn parse(
    bytes: &[u8],
    size: &SurfaceSize<'_>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let file = FileHead::new(bytes, None);
    let readers = TABLE.iter().filter_map(|format| Some(((format.recognize)(&file)?, format.read_values?)));
    // The first of the most certain ones.
    let best = readers.reduce(|best, other| if other.0 > best.0 { other } else { best });
    let Some((_, read)) = best else {
        return Err(ReadError::Whole(
            "the file has no supported values; use NPY, CSV, GIFTI, CIFTI, MGH, or FreeSurfer's curv, annot or label"
                .into(),
        ));
    };
    read(bytes, size, &ReadContext { limits, progress, name: None, folder: None })
}
