//! GIFTI: surfaces and values on them, as neuroimaging has them. XML with arrays as text, Base64, or zlib in Base64.
//!
//! Coordinates are taken as they stand; the transforms to other spaces that a file may name are not applied.

use std::io::Read;
use std::path::Path;

use adwave::{Cancelled, Progress};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node, ParsingOptions};

use crate::field::{ByteOrder, Number, with_values};
use crate::limits::decompress;
use crate::progress::{BYTES_PER_STEP, at_row, collect, extend};
use crate::read::read_file;
use crate::text::{one_line, parse_f64, show};
use crate::{Field, FieldValues, Format, Precision, ReadError, ReadLimits, ShapeFile, ValueType};
use adwave::shape::Polygons;

/// One array of a file.
struct Array {
    /// What the array is for, without `NIFTI_INTENT_`, in lower case.
    intent: String,
    /// The last part of the name that the file gives it.
    name: Option<String>,
    rows: usize,
    columns: usize,
    values: FieldValues,
}

/// Whether the bytes are a GIFTI.
pub(crate) fn is_gifti(head: &[u8]) -> bool {
    memchr::memmem::find(head, b"<GIFTI").is_some()
}

/// Reads the surface in a GIFTI: its points, its triangles, and every other array of values per vertex as a field.
pub(crate) fn read_gifti(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut arrays = arrays(bytes, limits, progress)?;
    let Some(at) = arrays.iter().position(|a| a.intent == "pointset") else {
        return Err(ReadError::Whole(
            "this GIFTI has no points, only values; give it as a field of a surface (--field FILE.gii)"
                .into(),
        ));
    };
    let points = arrays.remove(at);
    if points.columns != 3 {
        return Err(ReadError::Whole(format!("the points have {} coordinates, not 3", points.columns)));
    }
    let coordinates = &points.values;
    let point = |i: usize| [0, 1, 2].map(|c| coordinates.get(3 * i + c));
    let mut shape = ShapeFile::from_cloud(collect(coordinates.len() / 3, progress, point)?);
    shape.format = Some(Format::Gifti);
    shape.precision =
        if points.values.value_type() == ValueType::F64 { Precision::F64 } else { Precision::F32 };
    if let Some(at) = arrays.iter().position(|a| a.intent == "triangle") {
        shape.faces = faces(&arrays.remove(at), shape.n_vertices, progress)?.into();
    }
    for array in arrays {
        if array.rows == shape.n_vertices && !array.values.is_empty() {
            let name = array.name.unwrap_or(array.intent);
            let name = unused(&name, |name| shape.field(name).is_some());
            shape.vertex_fields.push(Field::new(name, array.columns, array.values));
        } else {
            shape.extras.push(format!("{} array of {} rows", array.intent, array.rows));
        }
    }
    Ok(shape)
}

/// Reads the values in a GIFTI, compressed or not, without its points and triangles: a field for each array.
///
/// # Errors
/// One line with the file's name: it cannot be read, is no GIFTI, is malformed, or holds no values.
pub fn read_gifti_fields(path: &Path, limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    read_gifti_fields_with(path, limits, Progress::none())
}

/// [`read_gifti_fields`] that says how far it is and can be stopped.
///
/// # Errors
/// As [`read_gifti_fields`], and [`ReadError::Cancelled`].
pub fn read_gifti_fields_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    read_file(path, limits, progress)
        .and_then(|bytes| decompress(bytes, limits, progress))
        .and_then(|bytes| parse_fields(&bytes, limits, progress))
        .map_err(|e| e.in_file(path))
}

/// As [`read_gifti_fields`], from bytes that are not compressed as a whole.
///
/// # Errors
/// As [`read_gifti_fields`], without the file's name.
pub fn parse_gifti_fields(bytes: &[u8], limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    parse_fields(bytes, limits, Progress::none())
}

fn parse_fields(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<Vec<Field>, ReadError> {
    let mut fields: Vec<Field> = Vec::new();
    for array in arrays(bytes, limits, progress)? {
        if !matches!(array.intent.as_str(), "pointset" | "triangle") && !array.values.is_empty() {
            let name = array.name.unwrap_or(array.intent);
            let name = unused(&name, |name| fields.iter().any(|f| f.name == name));
            fields.push(Field::new(name, array.columns, array.values));
        }
    }
    if fields.is_empty() {
        return Err(ReadError::Whole("this GIFTI has no values at vertices, only a surface".into()));
    }
    Ok(fields)
}

/// A name that is not taken: with a number after it where it is.
fn unused(name: &str, taken: impl Fn(&str) -> bool) -> String {
    let mut free = name.to_string();
    let mut k = 2;
    while taken(&free) {
        free = format!("{name}{k}");
        k += 1;
    }
    free
}

fn faces(array: &Array, n_vertices: usize, progress: Progress<'_>) -> Result<Polygons, ReadError> {
    if array.columns != 3 || !array.values.value_type().is_integer() {
        let found = array.columns;
        return Err(ReadError::Whole(format!("the triangles are rows of {found} numbers, not 3 whole ones")));
    }
    let mut triangles = vec![[0_u32; 3]; array.rows];
    for (f, triangle) in triangles.iter_mut().enumerate() {
        at_row(progress, f as u64, array.rows as u64)?;
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

fn arrays(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<Vec<Array>, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes)
        .map_err(|e| ReadError::at_byte(e.valid_up_to(), "the XML is not UTF-8; save it as UTF-8"))?;
    // The standard document type names a file of its own; nothing is fetched.
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
        return Err(ReadError::Whole("this XML is no GIFTI; give a .gii file".into()));
    }
    let nodes = root.children().filter(|n| n.has_tag_name("DataArray"));
    nodes
        .map(|node| {
            array(node, limits, progress).map_err(|stop| match stop {
                Stop::Cancelled(cancelled) => cancelled.into(),
                Stop::Broken(message) => {
                    let line = u64::from(document.text_pos_at(node.range().start).row);
                    ReadError::Line { line, message }
                }
            })
        })
        .collect()
}

/// Why an array is not read.
enum Stop {
    Cancelled(Cancelled),
    Broken(String),
}

impl From<Cancelled> for Stop {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<String> for Stop {
    fn from(message: String) -> Self {
        Self::Broken(message)
    }
}

impl From<&str> for Stop {
    fn from(message: &str) -> Self {
        Self::Broken(message.into())
    }
}

fn array(node: Node<'_, '_>, limits: &ReadLimits, progress: Progress<'_>) -> Result<Array, Stop> {
    let attribute = |name: &str| {
        node.attribute(name).ok_or_else(|| format!("the array has no {name}; save the file again"))
    };
    let intent = attribute("Intent")?.trim_start_matches("NIFTI_INTENT_").to_ascii_lowercase();
    let dimension = |k: usize| {
        let text = attribute(&format!("Dim{k}"))?;
        text.trim().parse::<usize>().map_err(|_| format!("Dim{k} is {}, not a number", show(text.as_bytes())))
    };
    let n_dimensions: usize = attribute("Dimensionality")?.trim().parse().unwrap_or(0);
    if !(1..=6).contains(&n_dimensions) {
        return Err("the array has no dimensions between 1 and 6; save the file again".into());
    }
    let rows = dimension(0)?;
    limits.check_points(rows as u64).map_err(|e| e.to_string())?;
    let mut columns = 1_usize;
    for k in 1..n_dimensions {
        columns = columns.checked_mul(dimension(k)?).ok_or("the array is larger than memory")?;
    }
    let kind = value_type(attribute("DataType")?)?;
    let n = rows.checked_mul(columns).ok_or("the array is larger than memory")?;
    let n_bytes = n.checked_mul(kind.n_bytes()).ok_or("the array is larger than memory")?;
    let data = node.children().find(|c| c.has_tag_name("Data"));
    let text: String = data.map(|d| d.children().filter_map(|c| c.text()).collect()).unwrap_or_default();
    let order = match attribute("Endian") {
        Ok("BigEndian") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let whole = |bytes: Vec<u8>| {
        let found = bytes.len();
        if found == n_bytes {
            return Ok(from_bytes(&bytes, kind, order, progress)?);
        }
        let more = if found > n_bytes { "more than" } else { "fewer than" };
        let message =
            format!("the array has {more} the {n_bytes} bytes of its dimensions; get the whole file");
        Err(Stop::Broken(message))
    };
    let mut values = match attribute("Encoding")? {
        "ASCII" => from_text(&text, kind, progress)?,
        "Base64Binary" => whole(base64(&text, progress)?)?,
        "GZipBase64Binary" => whole(inflate(&base64(&text, progress)?, n_bytes, progress)?)?,
        "ExternalFileBinary" => return Err("the array is in another file; save it within this one".into()),
        other => return Err(format!("the encoding {} is not known", show(other.as_bytes())).into()),
    };
    if values.len() != n {
        let found = values.len();
        return Err(
            format!("the array has {found} values and its dimensions say {n}; get the whole file").into()
        );
    }
    if node.attribute("ArrayIndexingOrder") == Some("ColumnMajorOrder") && columns > 1 {
        values = transposed(&values, rows, columns, progress)?;
    }
    Ok(Array { intent, name: name(node), rows, columns, values })
}

fn value_type(text: &str) -> Result<ValueType, String> {
    Ok(match text.trim_start_matches("NIFTI_TYPE_") {
        "UINT8" => ValueType::U8,
        "INT8" => ValueType::I8,
        "UINT16" => ValueType::U16,
        "INT16" => ValueType::I16,
        "UINT32" => ValueType::U32,
        "INT32" => ValueType::I32,
        "UINT64" => ValueType::U64,
        "INT64" => ValueType::I64,
        "FLOAT32" => ValueType::F32,
        "FLOAT64" => ValueType::F64,
        other => return Err(format!("arrays of {} are not known", show(other.as_bytes()))),
    })
}

fn from_text(text: &str, kind: ValueType, progress: Progress<'_>) -> Result<FieldValues, Stop> {
    let mut values = kind.empty();
    for (i, word) in text.split_ascii_whitespace().enumerate() {
        at_row(progress, i as u64, 0)?;
        let number = parse_f64(word.as_bytes()).filter(|&x| values.push_f64(x));
        number.ok_or_else(|| format!("{} stands where a number belongs", show(word.as_bytes())))?;
    }
    Ok(values)
}

fn base64(text: &str, progress: Progress<'_>) -> Result<Vec<u8>, Stop> {
    let mut packed: Vec<u8> = Vec::with_capacity(text.len());
    for chunk in text.as_bytes().chunks(BYTES_PER_STEP) {
        progress.check()?;
        packed.extend(chunk.iter().filter(|b| !b.is_ascii_whitespace()));
    }
    let mut plain = Vec::with_capacity(packed.len() / 4 * 3);
    // Groups of four letters stand for three bytes each; only the last may be shorter.
    for (k, chunk) in packed.chunks(BYTES_PER_STEP).enumerate() {
        progress.check()?;
        let is_last = (k + 1) * BYTES_PER_STEP >= packed.len();
        if !is_last && chunk.ends_with(b"=") {
            return Err("the Base64 of the array ends before its text; get the whole file".into());
        }
        STANDARD.decode_vec(chunk, &mut plain).map_err(|e| {
            Stop::Broken(format!("the Base64 of the array is broken ({e}); get the whole file"))
        })?;
    }
    Ok(plain)
}

/// What the zlib stream holds, no more than one byte beyond what is expected.
fn inflate(packed: &[u8], n_bytes: usize, progress: Progress<'_>) -> Result<Vec<u8>, Stop> {
    let mut plain = Vec::new();
    let mut stream = flate2::read::ZlibDecoder::new(packed).take(n_bytes as u64 + 1);
    loop {
        progress.check()?;
        let before = plain.len();
        stream.by_ref().take(BYTES_PER_STEP as u64).read_to_end(&mut plain).map_err(|e| {
            format!("the compressed array breaks after {} bytes ({e}); get the whole file", plain.len())
        })?;
        if plain.len() == before {
            return Ok(plain);
        }
    }
}

fn from_bytes(
    bytes: &[u8],
    kind: ValueType,
    order: ByteOrder,
    progress: Progress<'_>,
) -> Result<FieldValues, Cancelled> {
    let (mut values, width) = (kind.empty(), kind.n_bytes());
    with_values!(&mut values, v => extend(v, bytes.len() / width, progress, |i| {
        Number::from_bytes(&bytes[i * width..], order)
    }))?;
    Ok(values)
}

fn transposed(
    values: &FieldValues,
    rows: usize,
    columns: usize,
    progress: Progress<'_>,
) -> Result<FieldValues, Cancelled> {
    let mut by_row = values.value_type().empty();
    let mut number = Vec::with_capacity(8);
    for r in 0..rows {
        at_row(progress, r as u64, rows as u64)?;
        for c in 0..columns {
            number.clear();
            values.write_bytes(c * rows + r, ByteOrder::Little, &mut number);
            by_row.push_bytes(&number, ByteOrder::Little);
        }
    }
    Ok(by_row)
}

/// The last part of the name in the array's metadata, which often is a path.
fn name(node: Node<'_, '_>) -> Option<String> {
    let metadata = node.children().find(|c| c.has_tag_name("MetaData"))?;
    let text = |entry: Node<'_, '_>, tag: &str| {
        let child = entry.children().find(|c| c.has_tag_name(tag))?;
        Some(child.text().unwrap_or("").trim().to_owned())
    };
    let entry = metadata.children().find(|entry| text(*entry, "Name").as_deref() == Some("Name"))?;
    let value = text(entry, "Value")?;
    let last = value.rsplit(['/', '\\']).next().unwrap_or("").to_owned();
    (!last.is_empty()).then_some(last)
}
