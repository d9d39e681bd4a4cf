//! CIFTI reader: values of one surface, NaN at vertices without a value.

use std::sync::Arc;

use adwave::Progress;

use super::models::{BrainModel, CiftiMaps, maps};
use super::write::CiftiColumns;
use crate::model::field::{ByteOrder, Number};
use crate::model::label_table::LabelTable;
use crate::model::numbers::Numbers;
use crate::progress::extend;
use crate::{Field, FieldValues, ReadError, ReadLimits, ValueType};

/// Size of the NIfTI-2 header in bytes.
pub(super) const HEADER: usize = 540;
/// Advice for a surface without a structure.
const NAME_STRUCTURE: &str = "use a GIFTI that states it (AnatomicalStructurePrimary), or name the file with lh. or rh. \
    at the beginning";
/// Code of the extension that contains the XML.
const CIFTI: i32 = 32;

/// True if the bytes are a NIfTI of any version.
pub(crate) fn is_nifti(bytes: &[u8]) -> bool {
    let magic = |at: usize, magic: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    magic(4, b"n+2\0") || magic(344, b"n+1\0")
}

/// The numbers of a CIFTI: their type and place.
pub(super) struct CiftiHead {
    /// Byte of the first number of the file.
    pub(super) start: usize,
    /// Bytes of all numbers of the file.
    pub(super) n_bytes: usize,
    pub(super) n_columns: usize,
    pub(super) n_rows: usize,
    pub(super) kind: ValueType,
    pub(super) order: ByteOrder,
    /// Slope and intercept.
    pub(super) scale: [f64; 2],
    /// True if the numbers are not the values themselves.
    pub(super) is_scaled: bool,
}

/// Numbers of one surface in a CIFTI.
pub(super) struct CiftiNumbers {
    pub(super) model: BrainModel,
    /// Meaning of the columns, which the XML states; the code of the intent in the header may be missing.
    pub(super) columns: Option<CiftiColumns>,
    /// Seconds from column to column of a series.
    step: Option<f64>,
    /// Names of the columns, if they have any.
    names: Option<Vec<String>>,
    /// Names and colors of the labels of each column; empty without labels.
    labels: Vec<Option<Arc<LabelTable>>>,
    pub(super) head: CiftiHead,
}

/// Reads the values of the surface with `n_vertices` vertices and, if known, this structure.
pub(crate) fn read_cifti(
    bytes: &[u8],
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    let found = locate_numbers(bytes, structure, n_vertices, limits, progress)?;
    let CiftiHead { start, n_bytes, kind, order, .. } = found.head;
    let values = Numbers::Bytes { bytes: (&bytes[start..start + n_bytes]).into(), kind, order };
    fields(&found, &values, n_vertices, progress)
}

/// Locates the numbers of the surface with `n_vertices` vertices and, if known, this structure.
pub(super) fn locate_numbers(
    bytes: &[u8],
    structure: Option<&str>,
    n_vertices: usize,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<CiftiNumbers, ReadError> {
    let (head, maps) = read_head(bytes, progress)?;
    let CiftiMaps { models, columns, step, names, labels, .. } = maps;
    let (model, n_rows) = (select_model(models, structure, n_vertices)?, head.n_rows);
    let end = model.first.checked_add(model.vertices.len() as u64);
    if end.is_none_or(|end| end > n_rows as u64) {
        let structure = &model.structure;
        let message =
            format!("the rows of {structure} lie outside the {n_rows} rows of the file; get the whole file");
        return Err(ReadError::Whole(message));
    }
    // The file may have values for few of the vertices.
    limits.check_bytes((n_vertices as u64).saturating_mul(head.n_columns as u64).saturating_mul(8))?;
    Ok(CiftiNumbers { model, columns, step, names, labels, head })
}

/// Reads the header and the XML.
pub(super) fn read_head(bytes: &[u8], progress: Progress<'_>) -> Result<(CiftiHead, CiftiMaps), ReadError> {
    let cut = || ReadError::byte_error(bytes.len(), "the file ends too early; get the whole file");
    if !bytes[4..].starts_with(b"n+2") {
        let message = "this NIfTI-1 file is not a CIFTI and has no vertices; use values on a surface";
        return Err(ReadError::Whole(message.into()));
    }
    if bytes.len() < HEADER + 4 {
        return Err(cut());
    }
    let order = if bytes[..4] == 540_i32.to_le_bytes() { ByteOrder::Little } else { ByteOrder::Big };
    let length = |at: usize| u64::try_from(i64::from_bytes(&bytes[at..], order)).map_err(|_| cut());
    let kind = match i16::from_bytes(&bytes[12..], order) {
        2 => ValueType::U8,
        4 => ValueType::I16,
        8 => ValueType::I32,
        16 => ValueType::F32,
        64 => ValueType::F64,
        256 => ValueType::I8,
        512 => ValueType::U16,
        768 => ValueType::U32,
        1024 => ValueType::I64,
        1280 => ValueType::U64,
        other => {
            return Err(ReadError::byte_error(
                12,
                format!("values of type {other} are not supported; save them as floats"),
            ));
        }
    };
    let (n_columns, n_rows) = (length(16 + 5 * 8)?, length(16 + 6 * 8)?);
    let maps = maps(
        extension(bytes, order).ok_or_else(|| {
            ReadError::Whole("this NIfTI is not a CIFTI and has no vertices; use values on a surface".into())
        })?,
        progress,
    )?;
    let start = usize::try_from(length(168)?).map_err(|_| cut())?;
    let n_bytes = n_columns.checked_mul(n_rows).and_then(|n| n.checked_mul(kind.n_bytes() as u64));
    let data = n_bytes.and_then(|n| bytes.get(start..)?.get(..usize::try_from(n).ok()?)).ok_or_else(cut)?;
    if n_columns == 0 || n_rows == 0 {
        return Err(ReadError::Whole("the CIFTI has no values; get the whole file".into()));
    }
    let scale = [176, 184].map(|at| f64::from_bytes(&bytes[at..], order));
    let [slope, intercept] = scale;
    let is_scaled = slope.is_finite() && slope != 0.0 && (slope, intercept) != (1.0, 0.0);
    let (n_bytes, n_columns, n_rows) = (data.len(), n_columns as usize, n_rows as usize);
    Ok((CiftiHead { start, n_bytes, n_columns, n_rows, kind, order, scale, is_scaled }, maps))
}

/// XML in the extensions of the header.
fn extension(bytes: &[u8], order: ByteOrder) -> Option<&[u8]> {
    let mut at = HEADER + 4;
    if bytes[HEADER] == 0 {
        return None;
    }
    loop {
        let head = bytes.get(at..)?.get(..8)?;
        let size = usize::try_from(i32::from_bytes(head, order)).ok().filter(|&size| size >= 8)?;
        let content = bytes.get(at + 8..)?.get(..size - 8)?;
        if i32::from_bytes(&head[4..], order) == CIFTI {
            return Some(content);
        }
        at += size;
    }
}

/// Selects the brain model of the surface.
fn select_model(
    models: Vec<BrainModel>,
    structure: Option<&str>,
    n_vertices: usize,
) -> Result<BrainModel, ReadError> {
    let plain = |name: &str| name.replace('_', "").to_ascii_lowercase();
    let fits = |model: &&BrainModel| match structure {
        Some(structure) => plain(&model.structure) == plain(structure),
        None => model.n_vertices == n_vertices as u64,
    };
    let known: Vec<&str> = models.iter().map(|model| model.structure.as_str()).collect();
    let known = if known.is_empty() { "no surface".to_owned() } else { known.join(", ") };
    let mut found: Vec<BrainModel> = models.into_iter().filter(|model| fits(&model)).collect();
    if found.len() == 1 && found[0].n_vertices == n_vertices as u64 {
        return Ok(found.remove(0));
    }
    match (&found[..], structure) {
        ([model], _) => Err(ReadError::Whole(format!(
            "has values for {} vertices of {}, but the surface has {n_vertices}; use the matching surface",
            model.n_vertices, model.structure
        ))),
        ([], Some(structure)) => Err(ReadError::Whole(format!(
            "has values for {known}, but not for the surface's structure {structure}"
        ))),
        ([], None) => Err(ReadError::Whole(format!(
            "has values for {known}, but not for a surface of {n_vertices} vertices"
        ))),
        _ => Err(ReadError::Whole(format!(
            "has values for {known}, and the surface does not state its structure; {NAME_STRUCTURE}"
        ))),
    }
}

/// One field per named column; columns without names become the channels of one field.
fn fields(
    found: &CiftiNumbers,
    values: &Numbers<'_>,
    n_vertices: usize,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    let CiftiNumbers { model, names, head, .. } = found;
    let CiftiHead { n_columns, is_scaled, scale: [slope, intercept], .. } = *head;
    let mut rows = vec![None; n_vertices];
    for (i, &vertex) in model.vertices.iter().enumerate() {
        rows[vertex as usize] = Some(model.first as usize + i);
    }
    let value = |vertex: usize, column: usize| {
        let x = rows[vertex].map_or(f64::NAN, |row| values.get(row * n_columns + column));
        if is_scaled { slope * x + intercept } else { x }
    };
    let is_single = values.kind() == ValueType::F32 && !is_scaled;
    let field = |name: String, first: usize, k: usize| -> Result<Field, ReadError> {
        let at = |i: usize| value(i / k, first + i % k);
        let values = if is_single {
            let mut single = Vec::new();
            extend(&mut single, n_vertices * k, progress, |i| at(i) as f32)?;
            FieldValues::F32(single)
        } else {
            let mut double = Vec::new();
            extend(&mut double, n_vertices * k, progress, at)?;
            FieldValues::F64(double)
        };
        Ok(Field::new(name, k, values))
    };
    match names {
        Some(names) if names.len() == n_columns => {
            let named = names.iter().enumerate().map(|(column, name)| {
                let name = if name.is_empty() { format!("map{}", column + 1) } else { name.clone() };
                Ok(field(name, column, 1)?.with_labels(found.labels.get(column).cloned().flatten()))
            });
            named.collect()
        }
        _ => Ok(vec![field("series".into(), 0, n_columns)?.with_frame_step(found.step)]),
    }
}
