//! GIFTI reader: surfaces and values on them in neuroimaging. The format is XML with arrays as text, Base64, or zlib
//! in Base64.
//!
//! Coordinates are not transformed: the transforms to other spaces that a file may contain are not applied.

use crate::files::read::parse_file;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use adwave::Progress;
use adwave::shape::Polygons;
use roxmltree::{Document, ParsingOptions};

use super::array::{Array, ArrayError, STRUCTURE, about, array};
use super::update::{ArrayLocation, GiftiSource};
use crate::model::field::unused;
use crate::model::label_table::LabelTable;
use crate::progress::{collect, report_row};
use crate::text::one_line;
use crate::{CoordinatePrecision, Field, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// Content of a file.
struct GiftiContent {
    arrays: Vec<Array>,
    /// Anatomical structure that the file states for all its arrays.
    structure: Option<String>,
    /// Range of the number of arrays in the text.
    count: Option<Range<usize>>,
    /// End of the last array in the text.
    end: usize,
    /// Names and colors of the labels in all arrays of labels.
    labels: Option<Arc<LabelTable>>,
}

/// True if the bytes are a GIFTI.
pub(crate) fn is_gifti(head: &[u8]) -> bool {
    memchr::memmem::find(head, b"<GIFTI").is_some()
}

/// Reads the surface in a GIFTI: its points, its triangles, and every other array of values per vertex as a field.
/// Arrays in separate files are read if these are in the same folder.
pub(crate) fn read_gifti(
    bytes: Vec<u8>,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let GiftiContent { mut arrays, structure, count, end, labels } =
        content(&bytes, folder, limits, progress)?;
    let n_arrays = arrays.len();
    // A copy in another folder would have no file next to it.
    let is_whole = arrays.iter().all(|array| array.place.is_some());
    let Some(at) = arrays.iter().position(|a| a.intent == "pointset") else {
        return Err(ReadError::Whole(
            "this GIFTI has values but no points; use it as a signal of a surface".into(),
        ));
    };
    let points = arrays.remove(at);
    if points.columns != 3 {
        return Err(ReadError::Whole(format!("points must have 3 coordinates, got {}", points.columns)));
    }
    let coordinates = &points.values;
    let point = |i: usize| [0, 1, 2].map(|c| coordinates.get(3 * i + c));
    let mut shape = ShapeFile::from_cloud(collect(coordinates.len() / 3, progress, point)?);
    shape.format = Some(Format::GIFTI);
    shape.structure = points.structure.or(structure);
    shape.precision = if points.values.value_type() == ValueType::F64 {
        CoordinatePrecision::F64
    } else {
        CoordinatePrecision::F32
    };
    if let Some(at) = arrays.iter().position(|a| a.intent == "triangle") {
        shape.faces = faces(&arrays.remove(at), shape.n_vertices, progress)?.into();
    }
    let mut places = Vec::new();
    for array in arrays {
        if array.rows == shape.n_vertices && !array.values.is_empty() {
            let name = array.name.unwrap_or_else(|| array.intent.clone());
            let name = unused(&name, "", |name| shape.field(name).is_some());
            places.extend(array.place.map(|place| (name.clone(), place)));
            let labels = labels.clone().filter(|_| array.intent == "label");
            shape.vertex_fields.push(Field::new(name, array.columns, array.values).with_labels(labels));
        } else {
            shape.extras.push(format!("{} array of {} rows", array.intent, array.rows));
        }
    }
    // Offsets do not count the UTF-8 byte order mark, which is rare.
    if let (Some(points), Some(count)) = (points.place, count)
        && !bytes.starts_with(MARK)
        && is_whole
    {
        let original = GiftiSource { bytes, points, fields: places, count, n_arrays, end };
        shape.set_source(original);
    }
    Ok(shape)
}

/// UTF-8 byte order mark, which some editors write.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads the values in a GIFTI, compressed or not, without its points and triangles; each array becomes a field.
///
/// # Errors
/// The file cannot be read, is not a GIFTI, is malformed, or has no values. The message is one line with the file's
/// name.
pub fn read_gifti_fields(path: &Path, limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    read_gifti_fields_with(path, limits, Progress::none())
}

/// [`read_gifti_fields`] with progress and cancellation.
///
/// # Errors
/// The errors of [`read_gifti_fields`], and [`ReadError::Cancelled`].
pub fn read_gifti_fields_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    parse_file(path, limits, progress, |bytes| parse_fields(&bytes, path.parent(), limits, progress))
}

/// [`read_gifti_fields`] from bytes that are not compressed as a whole.
///
/// # Errors
/// The errors of [`read_gifti_fields`], without the file's name.
pub fn parse_gifti_fields(bytes: &[u8], limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    parse_fields(bytes, None, limits, Progress::none())
}

fn parse_fields(
    bytes: &[u8],
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    let mut fields: Vec<Field> = Vec::new();
    let GiftiContent { arrays, labels, .. } = content(bytes, folder, limits, progress)?;
    for array in arrays {
        if !matches!(array.intent.as_str(), "pointset" | "triangle") && !array.values.is_empty() {
            let labels = labels.clone().filter(|_| array.intent == "label");
            let name = array.name.unwrap_or(array.intent);
            let name = unused(&name, "", |name| fields.iter().any(|f| f.name == name));
            fields.push(Field::new(name, array.columns, array.values).with_labels(labels));
        }
    }
    if fields.is_empty() {
        return Err(ReadError::Whole("this GIFTI has a surface but no values at vertices".into()));
    }
    Ok(fields)
}

/// Places of the arrays of values in the text, in the order of the file.
///
/// # Errors
/// The file is malformed, or has arrays whose numbers are elsewhere.
pub(super) fn value_arrays(bytes: &[u8]) -> Result<Vec<ArrayLocation>, ReadError> {
    // Offsets do not count the UTF-8 byte order mark, which is rare.
    if bytes.starts_with(MARK) {
        return Err(ReadError::Whole("the text begins with a byte order mark; save it without".into()));
    }
    let arrays = content(bytes, None, &ReadLimits::default(), Progress::none())?.arrays;
    let has_values =
        |array: &Array| !matches!(array.intent.as_str(), "pointset" | "triangle") && !array.values.is_empty();
    let places = arrays.into_iter().filter(has_values).map(|array| array.place);
    let elsewhere = || ReadError::Whole("the numbers are in another file; keep both together".into());
    places.map(|place| place.ok_or_else(elsewhere)).collect()
}

fn faces(array: &Array, n_vertices: usize, progress: Progress<'_>) -> Result<Polygons, ReadError> {
    if array.columns != 3 || !array.values.value_type().is_integer() {
        let found = array.columns;
        return Err(ReadError::Whole(format!(
            "triangles must be rows of 3 integers, got rows of {found} numbers"
        )));
    }
    let mut triangles = vec![[0_u32; 3]; array.rows];
    for (f, triangle) in triangles.iter_mut().enumerate() {
        report_row(progress, f as u64, array.rows as u64)?;
        for (k, corner) in triangle.iter_mut().enumerate() {
            let index = array.values.get(3 * f + k);
            if !(index >= 0.0 && index < n_vertices as f64) {
                return Err(ReadError::FaceIndex {
                    place: "the triangle array".into(),
                    face: f as u64,
                    index: index as i64,
                    n_vertices: n_vertices as u64,
                });
            }
            *corner = index as u32;
        }
    }
    Ok(Polygons::from_triangles(&triangles))
}

fn content(
    bytes: &[u8],
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<GiftiContent, ReadError> {
    let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
    let text = std::str::from_utf8(bytes)
        .map_err(|e| ReadError::byte_error(e.valid_up_to(), "the XML is not UTF-8; save it as UTF-8"))?;
    // The standard document type refers to an external file, which is not fetched.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let line = u64::from(e.pos().row);
        ReadError::Line {
            line,
            message: format!("the XML is malformed ({}); get the whole file", one_line(&e)),
        }
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "GIFTI" {
        return Err(ReadError::Whole("this XML is not a GIFTI; use a .gii file".into()));
    }
    let count = root.attribute_node("NumberOfDataArrays").map(|count| count.range_value());
    let end = root.children().filter(|n| n.has_tag_name("DataArray")).map(|n| n.range().end).max();
    let nodes = root.children().filter(|n| n.has_tag_name("DataArray"));
    let arrays = nodes
        .map(|node| {
            array(node, folder, limits, progress).map_err(|stop| match stop {
                ArrayError::Cancelled(cancelled) => cancelled.into(),
                ArrayError::Broken(message) => {
                    let line = u64::from(document.text_pos_at(node.range().start).row);
                    ReadError::Line { line, message }
                }
            })
        })
        .collect::<Result<_, _>>()?;
    let labels = root.children().find(|n| n.has_tag_name("LabelTable")).and_then(LabelTable::from_xml);
    Ok(GiftiContent { arrays, structure: about(root, STRUCTURE), count, end: end.unwrap_or(0), labels })
}
