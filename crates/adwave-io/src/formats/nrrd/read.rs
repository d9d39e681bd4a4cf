//! NRRD reader.

use std::path::Path;
use std::sync::Arc;

use super::header::{NrrdEncoding, NrrdHeader};
use super::write::NrrdDocument;
use crate::files::read::read_file;
use crate::limits::decompress;
use crate::model::context::ReadContext;
use crate::model::grid_layout::{GridLayout, note_on_missing, step_lengths};
use crate::model::grid_values::GridNumbers;
use crate::model::numbers::{NumberError, from_text};
use crate::text::{line_end, show};
use crate::{Format, ReadError, ShapeFile};

pub(super) fn read_nrrd(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let header = NrrdHeader::parse(&bytes)?;
    let numbers = numbers(&header)?;
    let raw = raw_bytes(&bytes, &header, &numbers, c)?;
    let values = numbers.read(numbers.slice(&raw, 0, c.limits)?, c.progress)?;
    let mut notes = Vec::new();
    let layout = GridLayout { kept: values.kept, ..layout(&header, &mut notes) };
    note_on_missing(&layout, None, &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(values.field);
    shape.format = Some(Format::NRRD);
    shape.notes = notes;
    shape.original = Some(Arc::new(NrrdDocument { bytes, raw, header, numbers }));
    Ok(shape)
}

/// Layout of the numbers: axes before those in space are components, and axes after them are planes.
fn numbers(header: &NrrdHeader) -> Result<GridNumbers, ReadError> {
    let NrrdHeader { sizes, directions, .. } = header;
    let first = directions.iter().position(Option::is_some);
    let last = directions.iter().rposition(Option::is_some);
    let (Some(first), Some(last)) = (first, last) else {
        return Err(ReadError::Whole("no axis of the file is in space; state `space directions`".into()));
    };
    if last - first > 2 || directions[first..=last].iter().any(Option::is_none) {
        let message = "1 to 3 axes in space must follow each other; permute the axes of the file";
        return Err(ReadError::Whole(message.into()));
    }
    let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size));
    let all = [product(&sizes[..first]), product(&sizes[first..=last]), product(&sizes[last + 1..])];
    let [Some(n_components), Some(n_places), Some(n_planes)] = all else {
        return Err(ReadError::Whole("the sizes of the axes are beyond any file; get an intact file".into()));
    };
    Ok(GridNumbers { n_planes, ..GridNumbers::new(header.kind, header.order, n_places, n_components) })
}

/// Bytes of all numbers, without compression.
fn raw_bytes(
    bytes: &[u8],
    header: &NrrdHeader,
    numbers: &GridNumbers,
    c: &ReadContext<'_>,
) -> Result<Vec<u8>, ReadError> {
    let beside;
    let mut content = match &header.data_file {
        None => &bytes[header.start..],
        Some(name) => {
            beside = bytes_beside(name, c)?;
            &beside[..]
        }
    };
    for _ in 0..header.line_skip.min(content.len()) {
        content = &content[(line_end(content, 0) + 1).min(content.len())..];
    }
    let n = numbers.n_bytes().unwrap_or(usize::MAX);
    let skip = |content: &[u8]| match usize::try_from(header.byte_skip) {
        Ok(skip) => skip.min(content.len()),
        Err(_) => content.len().saturating_sub(n),
    };
    match header.encoding {
        NrrdEncoding::Raw => Ok(content[skip(content)..].to_vec()),
        NrrdEncoding::Gzip => {
            if !content.starts_with(&[0x1f, 0x8b]) {
                let message = "the values are no gzip stream; get the whole file";
                return Err(ReadError::byte_error(header.start, message));
            }
            let plain = decompress(content.to_vec(), c.limits, c.progress)?;
            Ok(plain[skip(&plain)..].to_vec())
        }
        NrrdEncoding::Text => {
            let values = from_text(content, header.kind, c.progress).map_err(|e| match e {
                NumberError::Cancelled(cancelled) => ReadError::Cancelled(cancelled),
                NumberError::At(at, message) => {
                    ReadError::line_error(bytes, header.start + at, format!("{message}; correct it"))
                }
            })?;
            let mut raw = Vec::new();
            (0..values.len()).for_each(|i| values.write_bytes(i, header.order, &mut raw));
            Ok(raw)
        }
    }
}

/// Reads the file that the header names, in the folder of the header.
fn bytes_beside(name: &str, c: &ReadContext<'_>) -> Result<Vec<u8>, ReadError> {
    let is_single = !name.contains('%') && !name.starts_with("LIST") && !name.starts_with("SKIPLIST");
    let path = Path::new(name);
    // A header from elsewhere names no file outside of its folder.
    let is_inside = path
        .components()
        .all(|part| matches!(part, std::path::Component::Normal(_) | std::path::Component::CurDir));
    let Some(folder) = c.folder.filter(|_| is_single && is_inside) else {
        let message = format!(
            "the values are in another file ({}), which is read from the folder of the header only; join them into one \
             .nrrd (unu save -f nrrd)",
            show(name.as_bytes())
        );
        return Err(ReadError::Whole(message));
    };
    let path = folder.join(path);
    read_file(&path, c.limits, c.progress).map_err(|e| e.in_file(&path))
}

fn layout(header: &NrrdHeader, notes: &mut Vec<String>) -> GridLayout {
    let in_space =
        header.directions.iter().zip(&header.sizes).filter_map(|(step, size)| Some(((*step)?, *size)));
    let (mut steps, mut sizes): (Vec<[f64; 3]>, Vec<usize>) = in_space.unzip();
    steps.reverse();
    sizes.reverse();
    let spacings = step_lengths(&steps, notes);
    if !header.has_spacings {
        notes.push("the header states no spacings; they are 1".into());
    }
    let axis_names = ["z", "y", "x"][3 - sizes.len()..].to_vec();
    let unit = header.unit.clone();
    GridLayout { sizes, spacings, axis_names, origin: header.origin, steps, unit, kept: None }
}
