//! A GIFTI that is written again: the numbers that changed are replaced in its text, new fields join its arrays.

use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use std::io::Write;
use std::ops::Range;

use adwave::Progress;

use super::numbers::Numbers;
use super::write::{left_out, write_field};
use crate::model::f32_limits::check_range;
use crate::{Field, Format, ShapeFile, ValueType, WriteError, WriteReport};

/// Range of the element with an array's numbers, and their encoding.
type Place = (Range<usize>, Numbers);

/// The text of a GIFTI and where its numbers stand.
#[derive(Debug)]
pub(crate) struct GiftiSource {
    pub(super) bytes: Vec<u8>,
    pub(super) points: Place,
    /// The fields by name.
    pub(super) fields: Vec<(String, Place)>,
    /// Range of the number of arrays.
    pub(super) count: Range<usize>,
    pub(super) n_arrays: usize,
    /// End of the last array.
    pub(super) end: usize,
}

/// Replacement of a range of the text.
enum Change<'a> {
    Points(&'a Numbers),
    Values(&'a Numbers, &'a Field),
    Text(String),
    Arrays(Vec<&'a Field>),
}

/// Parts of the text, and what takes their place.
type Changes<'a> = Vec<(Range<usize>, Change<'a>)>;

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
            Change::Points(numbers) => numbers.write(out, progress, |i| coordinates[i])?,
            Change::Values(numbers, field) => numbers.write(out, progress, |i| field.values.get(i))?,
            Change::Text(text) => out.write_all(text.as_bytes())?,
            Change::Arrays(fields) => {
                out.write_all(b"\n")?;
                fields.iter().try_for_each(|field| write_field(field, out, progress))?;
            }
        }
    }
    Ok(out.write_all(&original.bytes[written..])?)
}

/// The changes in the order of the text.
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
        changes.push((range.clone(), Change::Points(numbers)));
    }
    let mut added = Vec::new();
    for field in shape.vertex_fields.iter().filter(|field| shape.edited.contains(&field.name)) {
        match original.fields.iter().find(|(name, _)| *name == field.name) {
            None => {
                left_out(field, report, progress)?;
                added.push(field);
            }
            Some((_, (range, numbers))) => {
                let is_alike = numbers.kind == field.values.value_type();
                if !is_alike || numbers.columns != field.n_channels {
                    return Ok(None);
                }
                changes.push((range.clone(), Change::Values(numbers, field)));
            }
        }
    }
    if !added.is_empty() {
        let count = original.n_arrays + added.len();
        changes.push((original.count.clone(), Change::Text(count.to_string())));
        changes.push((original.end..original.end, Change::Arrays(added)));
    }
    changes.sort_by_key(|(range, _)| range.start);
    Ok(Some(changes))
}
