//! Frame of a file: its XML without the binary part at its end, and the encoding of its numbers.

use std::borrow::Cow;
use std::cell::Cell;

use roxmltree::{Document, Node, ParsingOptions};

use crate::model::field::ByteOrder;
use crate::text::{one_line, show};
use crate::{ReadError, ReadLimits};

/// Compression of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compressor {
    None,
    Zlib,
}

/// Bytes after the underscore of the appended part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appended<'a> {
    pub(super) bytes: &'a [u8],
    /// Start in the file.
    pub(super) start: usize,
    pub(super) is_base64: bool,
}

/// Encoding of arrays that are no text.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArrayEncoding {
    pub(super) order: ByteOrder,
    /// Size of each number before the data of an array in bytes: 4 or 8.
    pub(super) header_bytes: usize,
    pub(super) compressor: Compressor,
}

/// File in the course of reading.
pub(super) struct XmlFrame<'a> {
    pub(super) encoding: ArrayEncoding,
    pub(super) appended: Option<Appended<'a>>,
    /// Starts of arrays in the appended part, in order.
    pub(super) offsets: Vec<usize>,
    /// Number of bytes that may still be decoded.
    pub(super) budget: Cell<u64>,
    pub(super) limits: &'a ReadLimits,
}

/// Splits a file into its XML, closed where the appended part was cut out, and that part.
pub(super) fn split(bytes: &[u8]) -> Result<(Cow<'_, [u8]>, Option<Appended<'_>>), ReadError> {
    let truncated = || {
        let message = "the file ends before </VTKFile>; get the whole file";
        Err(ReadError::byte_error(bytes.len(), message))
    };
    let Some(tag) = memchr::memmem::find(bytes, b"<AppendedData") else { return Ok((bytes.into(), None)) };
    let Some(end_of_tag) = memchr::memchr(b'>', &bytes[tag..]).map(|n| tag + n + 1) else {
        return truncated();
    };
    let Some(closing) = memchr::memmem::rfind(bytes, b"</AppendedData") else { return truncated() };
    if closing < end_of_tag || !bytes[closing..].trim_ascii_end().ends_with(b"</VTKFile>") {
        return truncated();
    }
    let mark = memchr::memchr(b'_', &bytes[end_of_tag..closing]).map(|n| end_of_tag + n + 1);
    let tag_text = &bytes[tag..end_of_tag];
    let is_base64 = memchr::memmem::find(tag_text, b"base64").is_some();
    let appended = mark.map(|start| Appended { bytes: &bytes[start..closing], start, is_base64 });
    let mut xml = bytes[..end_of_tag].to_vec();
    if !tag_text.ends_with(b"/>") {
        xml.extend_from_slice(b"</AppendedData>");
    }
    xml.extend_from_slice(b"</VTKFile>");
    Ok((xml.into(), appended))
}

/// Parses the XML.
pub(super) fn parse(xml: &[u8]) -> Result<Document<'_>, ReadError> {
    let xml = xml.strip_prefix(b"\xef\xbb\xbf").unwrap_or(xml);
    let text = std::str::from_utf8(xml)
        .map_err(|e| ReadError::byte_error(e.valid_up_to(), "the XML is not UTF-8; save it as UTF-8"))?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| ReadError::Line {
        line: e.pos().row.into(),
        message: format!("the XML is malformed ({}); get the whole file", one_line(&e)),
    })
}

/// Creates an error at the line of an element.
pub(super) fn error_at(node: Node<'_, '_>, message: impl Into<String>) -> ReadError {
    let line = node.document().text_pos_at(node.range().start).row.into();
    ReadError::Line { line, message: message.into() }
}

/// Parses the integers of an attribute.
pub(super) fn numbers<T: std::str::FromStr, const N: usize>(
    node: Node<'_, '_>,
    name: &str,
) -> Result<Option<[T; N]>, ReadError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let words: Option<Vec<T>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let numbers = words.and_then(|words| <[T; N]>::try_from(words).ok());
    let shown = show(text.as_bytes());
    numbers.map(Some).ok_or_else(|| {
        error_at(node, format!("{name} must be {N} numbers, got {shown}; save the file again"))
    })
}

/// Count in an attribute of an element, if present.
pub(super) fn count(node: Node<'_, '_>, name: &str) -> Result<Option<u64>, ReadError> {
    Ok(numbers::<u64, 1>(node, name)?.map(|[n]| n))
}

impl<'a> XmlFrame<'a> {
    /// Parses the encoding in the root element.
    pub(super) fn new(
        root: Node<'_, '_>,
        appended: Option<Appended<'a>>,
        limits: &'a ReadLimits,
    ) -> Result<Self, ReadError> {
        let order = match root.attribute("byte_order") {
            Some("BigEndian") => ByteOrder::Big,
            _ => ByteOrder::Little,
        };
        let header_bytes = match root.attribute("header_type") {
            Some("UInt64") => 8,
            _ => 4,
        };
        let compressor = match root.attribute("compressor").map(str::trim) {
            None | Some("") => Compressor::None,
            Some("vtkZLibDataCompressor") => Compressor::Zlib,
            Some(other) => {
                let message = format!(
                    "its arrays are compressed by {}, which is not supported; save the file with zlib or \
                    without compression",
                    show(other.as_bytes())
                );
                return Err(error_at(root, message));
            }
        };
        let mut offsets: Vec<usize> =
            root.descendants().filter_map(|node| node.attribute("offset")?.trim().parse().ok()).collect();
        offsets.sort_unstable();
        let budget = Cell::new(limits.max_bytes);
        let encoding = ArrayEncoding { order, header_bytes, compressor };
        Ok(Self { encoding, appended, offsets, budget, limits })
    }

    /// Deducts bytes from the budget of decoded bytes.
    pub(super) fn spend(&self, n_bytes: u64) -> Result<(), ReadError> {
        let Some(left) = self.budget.get().checked_sub(n_bytes) else {
            let found = (self.limits.max_bytes - self.budget.get()).saturating_add(n_bytes);
            return Err(ReadError::Limit { what: "bytes", found, limit: self.limits.max_bytes });
        };
        self.budget.set(left);
        Ok(())
    }
}
