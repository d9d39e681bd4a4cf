//! One array of a GIFTI: its metadata and its numbers.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use adwave::{Cancelled, Progress};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::Node;

use super::numbers::{Encoding, Numbers};
use crate::model::field::ByteOrder;
use crate::model::numbers::from_bytes;
use crate::progress::{BYTES_PER_STEP, at_row};
use crate::text::{parse_f64, show};
use crate::{FieldValues, ReadLimits, ValueType};

/// Array of a file.
pub(super) struct Array {
    /// Intent of the array, without `NIFTI_INTENT_`, in lower case.
    pub(super) intent: String,
    /// Last component of the array's name.
    pub(super) name: Option<String>,
    /// Anatomical structure named in the metadata.
    pub(super) structure: Option<String>,
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) values: FieldValues,
    /// Range of the element with the numbers in the text, and their encoding.
    pub(super) place: Option<(Range<usize>, Numbers)>,
}

/// Reasons for which an array is not read.
pub(super) enum Stop {
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

/// Reads an array.
pub(super) fn array(
    node: Node<'_, '_>,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Array, Stop> {
    let attribute = |name: &str| {
        node.attribute(name).ok_or_else(|| format!("the array has no {name}; save the file again"))
    };
    let intent = attribute("Intent")?.trim_start_matches("NIFTI_INTENT_").to_ascii_lowercase();
    let dimension = |k: usize| {
        let text = attribute(&format!("Dim{k}"))?;
        text.trim()
            .parse::<usize>()
            .map_err(|_| format!("Dim{k} must be a number, got {}", show(text.as_bytes())))
    };
    let n_dimensions: usize = attribute("Dimensionality")?.trim().parse().unwrap_or(0);
    if !(1..=6).contains(&n_dimensions) {
        return Err("the array must have 1 to 6 dimensions; save the file again".into());
    }
    let rows = dimension(0)?;
    limits.check_points(rows as u64).map_err(|e| e.to_string())?;
    let mut columns = 1_usize;
    for k in 1..n_dimensions {
        columns = columns.checked_mul(dimension(k)?).ok_or("the array exceeds the address space")?;
    }
    let kind = value_type(attribute("DataType")?)?;
    let n = rows.checked_mul(columns).ok_or("the array exceeds the address space")?;
    let n_bytes = n.checked_mul(kind.n_bytes()).ok_or("the array exceeds the address space")?;
    let data = node.children().find(|c| c.has_tag_name("Data"));
    let text: String = data.map(|d| d.children().filter_map(|c| c.text()).collect()).unwrap_or_default();
    let by_column = node.attribute("ArrayIndexingOrder") == Some("ColumnMajorOrder") && columns > 1;
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
    let (encoding, mut values) = match attribute("Encoding")? {
        "ASCII" => (Encoding::Text, from_text(&text, kind, progress)?),
        "Base64Binary" => (Encoding::Base64, whole(base64(&text, progress)?)?),
        "GZipBase64Binary" => {
            (Encoding::ZlibBase64, whole(inflate(&base64(&text, progress)?, n_bytes, progress)?)?)
        }
        "ExternalFileBinary" => (Encoding::Base64, whole(external(node, folder, n_bytes)?)?),
        other => return Err(format!("the encoding {} is unknown", show(other.as_bytes())).into()),
    };
    if values.len() != n {
        let found = values.len();
        return Err(format!(
            "the dimensions of the array require {n} values, got {found}; get the whole file"
        )
        .into());
    }
    if by_column {
        values = transposed(&values, rows, columns, progress)?;
    }
    let structure = about(node, STRUCTURE);
    let numbers = Numbers { kind, order, encoding, by_column, rows, columns };
    let is_external = node.attribute("Encoding") == Some("ExternalFileBinary");
    let place = data.filter(|_| !is_external).map(|data| (data.range(), numbers));
    Ok(Array { intent, name: name(node), structure, rows, columns, values, place })
}

/// Reads the bytes of an array from a separate file, which must be in the folder of the GIFTI.
fn external(node: Node<'_, '_>, folder: Option<&Path>, n_bytes: usize) -> Result<Vec<u8>, Stop> {
    let name = node.attribute("ExternalFileName").unwrap_or("").trim();
    let shown = show(name.as_bytes());
    let Some(folder) = folder else {
        return Err(format!("the array is in the file {shown}; open the GIFTI by its path").into());
    };
    // No file in another folder is opened because of the content of a shape.
    if name.is_empty() || name.contains(['/', '\\', ':']) || matches!(name, "." | "..") {
        return Err(format!(
            "the array is in the file {shown}; move it next to the GIFTI and use its name alone"
        )
        .into());
    }
    let offset = node.attribute("ExternalFileOffset").unwrap_or("").trim();
    let offset: u64 = match offset {
        "" => 0,
        _ => offset
            .parse()
            .map_err(|_| format!("the offset must be a number, got {}", show(offset.as_bytes())))?,
    };
    let fails = |error: std::io::Error| {
        format!("the array's file {shown} cannot be read ({error}); move it next to the GIFTI")
    };
    let mut file = File::open(folder.join(name)).map_err(fails)?;
    file.seek(SeekFrom::Start(offset)).map_err(fails)?;
    let mut bytes = Vec::new();
    file.take(n_bytes as u64).read_to_end(&mut bytes).map_err(fails)?;
    Ok(bytes)
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
        other => return Err(format!("arrays of {} are not supported", show(other.as_bytes()))),
    })
}

fn from_text(text: &str, kind: ValueType, progress: Progress<'_>) -> Result<FieldValues, Stop> {
    let mut values = kind.empty();
    for (i, word) in text.split_ascii_whitespace().enumerate() {
        at_row(progress, i as u64, 0)?;
        let number = parse_f64(word.as_bytes()).filter(|&x| values.push_f64(x));
        number.ok_or_else(|| format!("expected a number, got {}", show(word.as_bytes())))?;
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
    // Groups of four letters encode three bytes each; only the last group may be shorter.
    for (k, chunk) in packed.chunks(BYTES_PER_STEP).enumerate() {
        progress.check()?;
        let is_last = (k + 1) * BYTES_PER_STEP >= packed.len();
        if !is_last && chunk.ends_with(b"=") {
            return Err("the Base64 of the array ends before its text; get the whole file".into());
        }
        STANDARD.decode_vec(chunk, &mut plain).map_err(|e| {
            Stop::Broken(format!("the Base64 of the array is damaged ({e}); get the whole file"))
        })?;
    }
    Ok(plain)
}

/// Decompresses a zlib stream, up to one byte more than expected.
fn inflate(packed: &[u8], n_bytes: usize, progress: Progress<'_>) -> Result<Vec<u8>, Stop> {
    let mut plain = Vec::new();
    let mut stream = flate2::read::ZlibDecoder::new(packed).take(n_bytes as u64 + 1);
    loop {
        progress.check()?;
        let before = plain.len();
        stream.by_ref().take(BYTES_PER_STEP as u64).read_to_end(&mut plain).map_err(|e| {
            format!("the compressed array is damaged after {} bytes ({e}); get the whole file", plain.len())
        })?;
        if plain.len() == before {
            return Ok(plain);
        }
    }
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

/// Name of the metadata entry with the anatomical structure.
pub(super) const STRUCTURE: &str = "AnatomicalStructurePrimary";

/// Last component of the name in the array's metadata, which often is a path.
fn name(node: Node<'_, '_>) -> Option<String> {
    let value = about(node, "Name")?;
    let last = value.rsplit(['/', '\\']).next().unwrap_or("").to_owned();
    (!last.is_empty()).then_some(last)
}

/// Entry of the metadata of an array or a file.
pub(super) fn about(node: Node<'_, '_>, name: &str) -> Option<String> {
    let metadata = node.children().find(|c| c.has_tag_name("MetaData"))?;
    let text = |entry: Node<'_, '_>, tag: &str| {
        let child = entry.children().find(|c| c.has_tag_name(tag))?;
        Some(child.text().unwrap_or("").trim().to_owned())
    };
    let entry = metadata.children().find(|entry| text(*entry, "Name").as_deref() == Some(name))?;
    text(entry, "Value")
}
