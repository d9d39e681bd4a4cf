//! Files of values at the vertices of a surface, identified by their content: FreeSurfer's and CIFTI.

use std::path::Path;

use adwave::Progress;

use crate::formats::freesurfer::overlay::{
    is_annotation, is_curv, is_mgh, read_annotation, read_curv, read_mgh,
};
use crate::limits::decompress;
use crate::registry::read::read_file;
use crate::{Field, ReadError, ReadLimits};

/// Reads the values that a file has for a surface: FreeSurfer's curv files (`lh.thickness`), annotations as whole numbers
/// (−1 where there is no label), MGH and MGZ with a channel for each frame, and CIFTI-2, of which `structure` (`CortexLeft`) and
/// the number of vertices choose the part. Vertices without a value are NaN.
///
/// # Errors
/// One line with the file's name: it cannot be read, is of another kind, is malformed, or has no values for the surface.
pub fn read_surface_values(
    path: &Path,
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    let progress = Progress::none();
    read_file(path, limits, progress)
        .and_then(|bytes| decompress(bytes, limits, progress))
        .and_then(|bytes| parse(&bytes, structure, n_vertices, limits, progress))
        .map_err(|e| e.in_file(path))
}

/// As [`read_surface_values`], from bytes that are not compressed as a whole.
///
/// # Errors
/// As [`read_surface_values`], without the file's name.
pub fn parse_surface_values(
    bytes: &[u8],
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    parse(bytes, structure, n_vertices, limits, Progress::none())
}

fn parse(
    bytes: &[u8],
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    if crate::formats::cifti::read::is_nifti(bytes) {
        return crate::formats::cifti::read::read_cifti(bytes, structure, n_vertices, limits, progress);
    }
    let field = if is_curv(bytes) {
        read_curv(bytes, progress)
    } else if is_mgh(bytes) {
        read_mgh(bytes, progress)
    } else if is_annotation(bytes) {
        read_annotation(bytes, progress)
    } else {
        Err(ReadError::Whole(
            "is no file of values that can be read; give NPY, CSV, GIFTI, CIFTI, MGH, or FreeSurfer's curv or annot"
                .into(),
        ))
    }?;
    Ok(vec![field])
}

/// What a file of values is called where a shape was asked for.
pub(crate) fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    if is_curv(bytes) {
        return Some("FreeSurfer's values at vertices: give it as a field of a surface");
    }
    if is_mgh(bytes) {
        return Some("an MGH volume or overlay: give it as a field of a surface");
    }
    crate::formats::cifti::read::is_nifti(bytes)
        .then_some("NIfTI or CIFTI: give a CIFTI as a field of a surface")
}
