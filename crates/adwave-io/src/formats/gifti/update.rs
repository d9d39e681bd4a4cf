//! Rewriting of a GIFTI: changed numbers are replaced in its text, and new fields are added to its arrays.

use crate::model::context::WriteContext;
use crate::model::format_descriptor::ValuesEdit;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use std::io::Write;
use std::ops::Range;

use adwave::Progress;

use super::GIFTI;
use super::numbers::ArrayStorage;
use super::read::value_arrays;
use super::write::{check_field, write_field};
use crate::model::f32_limits::check_range;
use crate::{Field, Format, ShapeFile, ValueType, WriteError, WriteReport};

/// Range of the element with an array's numbers, and their encoding.
pub(super) type ArrayLocation = (Range<usize>, ArrayStorage);

/// Text of a GIFTI with the ranges of its numbers.
#[derive(Debug)]
pub(crate) struct GiftiSource {
    pub(super) bytes: Vec<u8>,
    pub(super) points: ArrayLocation,
    /// Fields by name.
    pub(super) fields: Vec<(String, ArrayLocation)>,
    /// Range of the number of arrays.
    pub(super) count: Range<usize>,
    pub(super) n_arrays: usize,
    /// End of the last array.
    pub(super) end: usize,
}

/// Replacement of a range of the text.
enum TextChange<'a> {
    Points(&'a ArrayStorage),
    Values(&'a ArrayStorage, &'a Field),
    Text(String),
    Arrays(Vec<&'a Field>),
}

/// Ranges of the text with their replacements.
type Changes<'a> = Vec<(Range<usize>, TextChange<'a>)>;

impl SourceDocument for GiftiSource {
    /// Writes the original with other coordinates and fields, unless points or a field are no numbers of the array's
    /// kind any more.
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let changes = changes(shape, self, &mut context.report, context.progress)?;
        let Some(changes) = changes else { return Ok(Update::DoesNotFit) };
        write_changes(shape, self, changes, context.out, context.progress)?;
        Ok(Update::Written)
    }
}

fn write_changes(
    shape: &ShapeFile,
    original: &GiftiSource,
    changes: Changes<'_>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let coordinates = shape.points.as_flattened();
    let mut written = 0;
    for (range, change) in changes {
        out.write_all(&original.bytes[written..range.start])?;
        written = range.end;
        match change {
            TextChange::Points(numbers) => numbers.write(out, progress, |i| coordinates[i])?,
            TextChange::Values(numbers, field) => numbers.write(out, progress, |i| field.values.get(i))?,
            TextChange::Text(text) => out.write_all(text.as_bytes())?,
            TextChange::Arrays(fields) => {
                out.write_all(b"\n")?;
                fields.iter().try_for_each(|field| write_field(field, out, progress))?;
            }
        }
    }
    Ok(out.write_all(&original.bytes[written..])?)
}

/// Collects the changes in the order of the text.
fn changes<'a>(
    shape: &'a ShapeFile,
    original: &'a GiftiSource,
    report: &mut WriteReport,
    progress: Progress<'_>,
) -> Result<Option<Changes<'a>>, WriteError> {
    let mut changes = Vec::new();
    if shape.moved {
        let (range, numbers) = &original.points;
        let coordinates = shape.points.as_flattened();
        if numbers.kind.is_integer() {
            return Ok(None);
        }
        if numbers.kind != ValueType::F64 {
            check_range(Format::GIFTI, "coordinates", coordinates.len(), progress, |i| coordinates[i])?;
        }
        changes.push((range.clone(), TextChange::Points(numbers)));
    }
    let mut added = Vec::new();
    for field in shape.vertex_fields.iter().filter(|field| shape.edited.contains(&field.name)) {
        match original.fields.iter().find(|(name, _)| *name == field.name) {
            None => {
                check_field(field, report, progress)?;
                added.push(field);
            }
            Some((_, (range, numbers))) => {
                let is_alike = numbers.kind == field.values.value_type();
                if !is_alike || numbers.columns != field.n_channels {
                    return Ok(None);
                }
                changes.push((range.clone(), TextChange::Values(numbers, field)));
            }
        }
    }
    if !added.is_empty() {
        let count = original.n_arrays + added.len();
        changes.push((original.count.clone(), TextChange::Text(count.to_string())));
        changes.push((original.end..original.end, TextChange::Arrays(added)));
    }
    changes.sort_by_key(|(range, _)| range.start);
    Ok(Some(changes))
}

/// Bytes of a GIFTI with new numbers of all its arrays of values; `None` if these do not fit its arrays, or if the name
/// asks for another kind of file.
pub(super) fn rewrite(bytes: &[u8], edit: &ValuesEdit<'_>) -> Result<Option<Vec<u8>>, WriteError> {
    let (field, progress) = (edit.field, Progress::none());
    let Ok(places) = value_arrays(bytes) else { return Ok(None) };
    let fits = |(_, numbers): &ArrayLocation| {
        matches!(numbers.kind, ValueType::F32 | ValueType::F64) && numbers.rows == field.len()
    };
    let n_columns: usize = places.iter().map(|(_, numbers)| numbers.columns).sum();
    if !GIFTI.matches_name(edit.path) || n_columns != field.n_channels || !places.iter().all(fits) {
        return Ok(None);
    }
    let value = |i: usize| field.values.get(i);
    if places.iter().any(|(_, numbers)| numbers.kind == ValueType::F32) {
        let name = format!("values of `{}`", field.name);
        check_range(Format::GIFTI, &name, field.values.len(), progress, value)?;
    }
    let (mut out, mut written, mut first) = (Vec::with_capacity(bytes.len()), 0, 0);
    for (range, numbers) in places {
        out.extend_from_slice(&bytes[written..range.start]);
        written = range.end;
        let columns = numbers.columns;
        numbers.write(&mut out, progress, |i| value(i / columns * field.n_channels + first + i % columns))?;
        first += columns;
    }
    out.extend_from_slice(&bytes[written..]);
    Ok(Some(out))
}
