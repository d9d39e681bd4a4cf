//! Files of values at the vertices of a surface, identified by their content: FreeSurfer's and CIFTI.

use std::path::Path;

use adwave::Progress;

use crate::files::read::parse_file;
use crate::formats::TABLE;
use crate::model::context::ReadContext;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{MaskRequest, SurfaceSize, VertexMask};
use crate::{Field, ReadError, ReadLimits};

/// Reads values for a surface: FreeSurfer's curv files (`lh.thickness`), annotations as integers (−1 without a
/// label), labels as 1 at the vertices that they list and 0 elsewhere, MGH and MGZ with a channel per frame, and CIFTI-2, where `structure` (`CortexLeft`) and the number of
/// vertices select the part. Vertices without a value are NaN.
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
