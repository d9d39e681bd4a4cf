//! Header of a PLY: elements, their numbers of rows, and the properties of a row.

use crate::model::field::ByteOrder;
use crate::model::grouping::FieldColumns;
use crate::text::{line_end, parse_u64, show, words};
use crate::{ReadError, ValueType};

/// Encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// Kind of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PropertyKind {
    Scalar(ValueType),
    List { count: ValueType, item: ValueType },
}

#[derive(Clone, Debug)]
pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) kind: PropertyKind,
    /// Index of the header line that declares it.
    pub(crate) line: usize,
}

#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) n_rows: u64,
    pub(crate) properties: Vec<Property>,
    /// Index of the header line that declares it.
    pub(crate) line: usize,
}

#[derive(Clone, Debug)]
pub(crate) struct PlyHeader {
    pub(crate) encoding: Encoding,
    /// Range of every line with its line end.
    pub(crate) lines: Vec<(usize, usize)>,
    pub(crate) elements: Vec<Element>,
    /// Start of the body.
    pub(crate) body: usize,
}

/// Content kept from a PLY for its update.
#[derive(Debug)]
pub(crate) struct PlySource {
    pub(crate) bytes: Vec<u8>,
    pub(crate) header: PlyHeader,
    /// Index of the vertex element, and the range of its rows.
    pub(crate) vertex: usize,
    pub(crate) rows: (usize, usize),
    /// Properties that form each vertex field.
    pub(crate) field_properties: Vec<FieldColumns>,
}

fn value_type(name: &[u8]) -> Option<ValueType> {
    Some(match name {
        b"char" | b"int8" => ValueType::I8,
        b"uchar" | b"uint8" => ValueType::U8,
        b"short" | b"int16" => ValueType::I16,
        b"ushort" | b"uint16" => ValueType::U16,
        b"int" | b"int32" => ValueType::I32,
        b"uint" | b"uint32" => ValueType::U32,
        // These names are not in the format's description, but some programs write them.
        b"int64" | b"longlong" => ValueType::I64,
        b"uint64" | b"ulonglong" => ValueType::U64,
        b"float" | b"float32" => ValueType::F32,
        b"double" | b"float64" => ValueType::F64,
        _ => return None,
    })
}

/// Name of a type in a header; 64-bit integers have none.
pub(crate) fn type_name(value_type: ValueType) -> &'static str {
    match value_type {
        ValueType::U8 => "uchar",
        ValueType::I8 => "char",
        ValueType::U16 => "ushort",
        ValueType::I16 => "short",
        ValueType::U32 => "uint",
        ValueType::I32 => "int",
        ValueType::F32 => "float",
        ValueType::U64 | ValueType::I64 | ValueType::F64 => "double",
    }
}

impl Element {
    /// Smallest size of a row in bytes.
    pub(crate) fn min_row_bytes(&self, encoding: Encoding) -> u64 {
        let property = |p: &Property| match (encoding, p.kind) {
            // One digit and one separator.
            (Encoding::Ascii, _) => 2,
            (Encoding::Binary(_), PropertyKind::Scalar(t)) => t.n_bytes() as u64,
            (Encoding::Binary(_), PropertyKind::List { count, .. }) => count.n_bytes() as u64,
        };
        self.properties.iter().map(property).sum()
    }

    /// Position of the property of that name.
    pub(crate) fn property(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }
}

/// Parses the header at the start of `bytes`.
pub(crate) fn parse_header(bytes: &[u8]) -> Result<PlyHeader, ReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut lines = Vec::new();
    let mut start = 0;
    loop {
        if start >= bytes.len() {
            let message = "the header has no `end_header`; get the whole file";
            return Err(ReadError::line_error(bytes, bytes.len(), message));
        }
        let end = line_end(bytes, start);
        let line = &bytes[start..end];
        let number = lines.len();
        let wrong = |message: String| Err(ReadError::Line { line: number as u64 + 1, message });
        lines.push((start, (end + 1).min(bytes.len())));
        start = end + 1;
        let mut parts = words(line);
        match parts.next() {
            Some(b"format") => {
                encoding = Some(match parts.next().unwrap_or(b"") {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Binary(ByteOrder::Little),
                    b"binary_big_endian" => Encoding::Binary(ByteOrder::Big),
                    other => {
                        return wrong(format!("the format must be one of PLY's three, got {}", show(other)));
                    }
                });
            }
            Some(b"element") => {
                let (name, count) = (parts.next(), parts.next());
                let (Some(name), Some(n_rows)) = (name, count.and_then(parse_u64)) else {
                    return wrong("an element needs a name and a number of rows".into());
                };
                let name = String::from_utf8_lossy(name).into_owned();
                elements.push(Element { name, n_rows, properties: Vec::new(), line: number });
            }
            Some(b"property") => {
                let Some(element) = elements.last_mut() else {
                    return wrong("a property must follow an element".into());
                };
                match property(&mut parts, number) {
                    Ok(property) => element.properties.push(property),
                    Err(message) => return wrong(message),
                }
            }
            Some(b"end_header") => break,
            Some(b"ply" | b"comment" | b"obj_info") | None => {}
            Some(other) if number > 0 => {
                return wrong(format!("{} is not a keyword of a PLY header", show(other)));
            }
            Some(_) => {}
        }
    }
    let Some(encoding) = encoding else {
        return Err(ReadError::Line { line: 1, message: "the header has no `format` line; add it".into() });
    };
    Ok(PlyHeader { encoding, lines, elements, body: start.min(bytes.len()) })
}

fn property<'a>(parts: &mut impl Iterator<Item = &'a [u8]>, line: usize) -> Result<Property, String> {
    let next_type = |word: Option<&[u8]>| {
        let word = word.unwrap_or(b"");
        value_type(word).ok_or_else(|| format!("{} is not a number type of PLY", show(word)))
    };
    let first = parts.next();
    let kind = if first == Some(b"list") {
        let count = next_type(parts.next())?;
        if !count.is_integer() {
            return Err("the count of a list must have an integer type".into());
        }
        PropertyKind::List { count, item: next_type(parts.next())? }
    } else {
        PropertyKind::Scalar(next_type(first)?)
    };
    let name = parts.next().ok_or("a property has no name; add one")?;
    Ok(Property { name: String::from_utf8_lossy(name).into_owned(), kind, line })
}
