//! Header of a NRRD: lines of text.

use crate::model::field::ByteOrder;
use crate::text::{line_end, show};
use crate::{LengthUnit, ReadError, ValueType};

/// Largest number of axes.
const MOST_AXES: usize = 16;

/// Encoding of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NrrdEncoding {
    Raw,
    Gzip,
    Text,
}

/// Lines of the header.
#[derive(Clone, Debug)]
pub(super) struct NrrdHeader {
    pub(super) kind: ValueType,
    pub(super) order: ByteOrder,
    pub(super) encoding: NrrdEncoding,
    /// Size of each axis; the first is contiguous.
    pub(super) sizes: Vec<usize>,
    /// Direction of each axis, `None` for axes that are not in space.
    pub(super) directions: Vec<Option<[f64; 3]>>,
    pub(super) origin: [f64; 3],
    pub(super) unit: Option<LengthUnit>,
    /// File with the values.
    pub(super) data_file: Option<String>,
    /// Bytes before the values in it; the values are at its end if it is negative.
    pub(super) byte_skip: i64,
    pub(super) line_skip: usize,
    /// First byte after the header.
    pub(super) start: usize,
    /// True if directions or spacings are stated.
    pub(super) has_spacings: bool,
}

fn value_type(name: &str) -> Option<ValueType> {
    Some(match name {
        "signed char" | "int8" | "int8_t" => ValueType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => ValueType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => ValueType::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => ValueType::U16,
        "int" | "signed int" | "int32" | "int32_t" => ValueType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => ValueType::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => ValueType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            ValueType::U64
        }
        "float" => ValueType::F32,
        "double" => ValueType::F64,
        _ => return None,
    })
}

/// Name of a type in a header.
pub(super) fn type_name(kind: ValueType) -> &'static str {
    match kind {
        ValueType::I8 => "int8",
        ValueType::U8 => "uint8",
        ValueType::I16 => "int16",
        ValueType::U16 => "uint16",
        ValueType::I32 => "int32",
        ValueType::U32 => "uint32",
        ValueType::I64 => "int64",
        ValueType::U64 => "uint64",
        ValueType::F32 => "float",
        ValueType::F64 => "double",
    }
}

/// Key and value of a line, if it is a field of the header.
pub(super) fn field_of(line: &str) -> Option<(String, &str)> {
    let (key, value) = line.split_once(':')?;
    let is_field = !line.starts_with('#') && !value.starts_with('=');
    is_field.then(|| (key.trim().to_ascii_lowercase(), value.trim()))
}

/// Lines of the header with the byte after each; without the blank line that ends it.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = (&[u8], usize)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        if at >= bytes.len() {
            return None;
        }
        let (start, end) = (at, line_end(bytes, at));
        at = (end + 1).min(bytes.len());
        let line = bytes[start..end].strip_suffix(b"\r").unwrap_or(&bytes[start..end]);
        Some((line, at))
    })
}

/// Vector `(1,0,0)` of up to three numbers.
fn vector(word: &str) -> Option<[f64; 3]> {
    let inside = word.strip_prefix('(')?.strip_suffix(')')?;
    let mut vector = [0.0; 3];
    let numbers: Vec<f64> = inside.split(',').map(|x| x.trim().parse().ok()).collect::<Option<_>>()?;
    if numbers.is_empty() || numbers.len() > 3 || numbers.iter().any(|x| !x.is_finite()) {
        return None;
    }
    vector[..numbers.len()].copy_from_slice(&numbers);
    Some(vector)
}

/// Vectors and words of a line: blanks may stand inside of brackets.
fn vectors(value: &str) -> Vec<String> {
    let (mut words, mut word, mut depth) = (Vec::new(), String::new(), 0_i32);
    for c in value.chars() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if c.is_whitespace() && depth <= 0 {
            if !word.is_empty() {
                words.push(std::mem::take(&mut word));
            }
        } else {
            word.push(c);
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

/// Fields of the header that are parsed together at its end.
#[derive(Default)]
struct NrrdFields<'a> {
    kind: Option<&'a str>,
    sizes: Option<&'a str>,
    encoding: Option<&'a str>,
    endian: Option<&'a str>,
    directions: Option<&'a str>,
    origin: Option<&'a str>,
    spacings: Option<&'a str>,
    kinds: Option<&'a str>,
    units: Option<&'a str>,
    data_file: Option<&'a str>,
    byte_skip: Option<&'a str>,
    line_skip: Option<&'a str>,
}

fn wrong(message: impl Into<String>) -> ReadError {
    ReadError::Whole(message.into())
}

impl NrrdHeader {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut fields = NrrdFields::default();
        let (mut start, mut is_ended) = (bytes.len(), false);
        for (line, after) in lines(bytes).skip(1) {
            if line.is_empty() {
                (start, is_ended) = (after, true);
                break;
            }
            let Ok(line) = std::str::from_utf8(line) else {
                let message = "the header is no text before the blank line that ends it; get the whole file";
                return Err(ReadError::line_error(bytes, after - 1, message));
            };
            let Some((key, value)) = field_of(line) else { continue };
            let field = match key.as_str() {
                "type" => &mut fields.kind,
                "sizes" => &mut fields.sizes,
                "encoding" => &mut fields.encoding,
                "endian" => &mut fields.endian,
                "space directions" => &mut fields.directions,
                "space origin" => &mut fields.origin,
                "spacings" => &mut fields.spacings,
                "kinds" => &mut fields.kinds,
                "space units" => &mut fields.units,
                "data file" | "datafile" => &mut fields.data_file,
                "byte skip" | "byteskip" => &mut fields.byte_skip,
                "line skip" | "lineskip" => &mut fields.line_skip,
                _ => continue,
            };
            *field = Some(value);
        }
        if !is_ended && fields.data_file.is_none() {
            return Err(wrong("the header has no end; get the whole file"));
        }
        Self::from_fields(&fields, start)
    }

    fn from_fields(fields: &NrrdFields<'_>, start: usize) -> Result<Self, ReadError> {
        let missing =
            |key: &str| wrong(format!("the line `{key}` is missing in the header; get the whole file"));
        let name = fields.kind.ok_or_else(|| missing("type"))?;
        let kind = value_type(name).ok_or_else(|| {
            wrong(format!("the type {} is not supported; convert it to float", show(name.as_bytes())))
        })?;
        let encoding = match fields.encoding.ok_or_else(|| missing("encoding"))? {
            "raw" => NrrdEncoding::Raw,
            "gzip" | "gz" => NrrdEncoding::Gzip,
            "ascii" | "text" | "txt" => NrrdEncoding::Text,
            other => {
                let other = show(other.as_bytes());
                return Err(wrong(format!("the encoding {other} is not supported; convert it to gzip")));
            }
        };
        let sizes = fields.sizes.ok_or_else(|| missing("sizes"))?;
        let sizes = sizes.split_whitespace().map(|size| size.parse().ok().filter(|&size: &usize| size > 0));
        let sizes: Option<Vec<usize>> = sizes.take(MOST_AXES + 1).collect();
        let sizes = sizes.filter(|sizes| !sizes.is_empty() && sizes.len() <= MOST_AXES);
        let sizes =
            sizes.ok_or_else(|| wrong("each of the `sizes` must be a whole number above 0; correct them"))?;
        let order = match fields.endian {
            Some("big") => ByteOrder::Big,
            None if kind.n_bytes() > 1 && encoding != NrrdEncoding::Text => return Err(missing("endian")),
            _ => ByteOrder::Little,
        };
        let byte_skip = fields.byte_skip.map_or(Some(0), |skip| skip.parse().ok());
        let line_skip = fields.line_skip.map_or(Some(0), |skip| skip.parse().ok());
        let (Some(byte_skip), Some(line_skip)) = (byte_skip, line_skip) else {
            return Err(wrong("`byte skip` and `line skip` must be whole numbers; correct them"));
        };
        let unit = fields.units.and_then(|units| LengthUnit::from_name(units.split('"').nth(1)?));
        let directions = directions(fields, &sizes)?;
        Ok(Self {
            kind,
            order,
            encoding,
            directions,
            sizes,
            origin: fields.origin.and_then(vector).unwrap_or([0.0; 3]),
            unit,
            data_file: fields.data_file.map(str::to_owned),
            byte_skip,
            line_skip,
            start,
            has_spacings: fields.directions.is_some() || fields.spacings.is_some(),
        })
    }
}

/// Directions of the axes: those of the space, else the spacings, along x, y and z in turn.
fn directions(fields: &NrrdFields<'_>, sizes: &[usize]) -> Result<Vec<Option<[f64; 3]>>, ReadError> {
    let n = sizes.len();
    if let Some(directions) = fields.directions {
        let words = vectors(directions);
        if words.len() != n {
            return Err(wrong(format!(
                "`space directions` has {} entries for {n} axes; correct them",
                words.len()
            )));
        }
        return Ok(words.iter().map(|word| vector(word)).collect());
    }
    let is_space: Vec<bool> = match fields.kinds.map(|kinds| kinds.split_whitespace().collect::<Vec<_>>()) {
        Some(kinds) if kinds.len() == n => {
            kinds.iter().map(|kind| matches!(*kind, "domain" | "space" | "???" | "none")).collect()
        }
        _ => (0..n).map(|axis| axis < 3).collect(),
    };
    let spacings: Vec<f64> = fields.spacings.map_or(Vec::new(), |spacings| {
        spacings.split_whitespace().map(|word| word.parse().unwrap_or(f64::NAN)).collect()
    });
    let mut row = 0;
    Ok((0..n)
        .map(|axis| {
            let spacing = spacings.get(axis).copied().filter(|h| h.is_normal()).unwrap_or(1.0);
            let direction = (is_space[axis] && row < 3).then(|| {
                let mut direction = [0.0; 3];
                direction[row] = spacing;
                direction
            });
            row += usize::from(direction.is_some());
            direction
        })
        .collect())
}
