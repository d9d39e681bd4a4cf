//! Array of a VTK XML file.

use std::borrow::Cow;

use adwave::Progress;
use roxmltree::Node;

use super::blocks::{BlockError, from_base64, plain};
use super::document::{XmlFrame, count, error_at};
use crate::model::numbers::{IndexError, NumberError, Numbers, from_text};
use crate::text::show;
use crate::{Field, FieldValues, ReadError, ValueType};

/// Arrays of an element.
pub(super) fn arrays<'a, 'i>(section: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    section.children().filter(|node| node.has_tag_name("DataArray") || node.has_tag_name("Array"))
}

/// Name of an array for messages.
fn display_name(node: Node<'_, '_>) -> String {
    show(node.attribute("Name").unwrap_or("without a name").as_bytes())
}

/// Type of an array's numbers; `None` for texts and other content.
pub(super) fn value_type(node: Node<'_, '_>) -> Option<ValueType> {
    Some(match node.attribute("type")? {
        "Int8" | "Char" => ValueType::I8,
        "UInt8" | "Bit" => ValueType::U8,
        "Int16" => ValueType::I16,
        "UInt16" => ValueType::U16,
        "Int32" => ValueType::I32,
        "UInt32" => ValueType::U32,
        "Int64" | "IdType" => ValueType::I64,
        "UInt64" => ValueType::U64,
        "Float32" => ValueType::F32,
        "Float64" => ValueType::F64,
        _ => return None,
    })
}

impl<'a> XmlFrame<'a> {
    /// Reads the numbers of an array.
    pub(super) fn array<'n: 'a>(
        &self,
        node: Node<'n, '_>,
        progress: Progress<'_>,
    ) -> Result<Numbers<'a>, ReadError> {
        let Some(kind) = value_type(node) else {
            let found = show(node.attribute("type").unwrap_or("").as_bytes());
            let message =
                format!("array {} has the type {found}, which is not a type of numbers", display_name(node));
            return Err(error_at(node, message));
        };
        let is_bits = node.attribute("type") == Some("Bit");
        self.read(node, kind, is_bits, progress).map_err(|broken| match broken {
            BlockError::Cancelled(cancelled) => cancelled.into(),
            BlockError::Error(error) => error,
            BlockError::Message(message) => {
                error_at(node, format!("array {}: {message}", display_name(node)))
            }
        })
    }

    fn read<'n: 'a>(
        &self,
        node: Node<'n, '_>,
        kind: ValueType,
        is_bits: bool,
        progress: Progress<'_>,
    ) -> Result<Numbers<'a>, BlockError> {
        let format = node.attribute("format").unwrap_or(if node.has_attribute("offset") {
            "appended"
        } else {
            "ascii"
        });
        let bytes = match format {
            "ascii" => {
                return match from_text(text(node).as_bytes(), kind, progress) {
                    Ok(values) => Ok(Numbers::Values(values)),
                    Err(NumberError::Cancelled(cancelled)) => Err(cancelled.into()),
                    Err(NumberError::At(_, message)) => Err(BlockError::Message(message)),
                };
            }
            "binary" => {
                let text = text(node);
                if text.trim_ascii().is_empty() {
                    Cow::Borrowed(&[][..])
                } else {
                    plain(self, Cow::Owned(from_base64(text.as_bytes(), progress)?), progress)?
                }
            }
            "appended" => self.appended(node, progress)?,
            other => {
                return Err(BlockError::Message(format!(
                    "its format {} is unknown; save the file again",
                    show(other.as_bytes())
                )));
            }
        };
        if is_bits {
            let n = count(node, "NumberOfTuples")?.unwrap_or(u64::MAX);
            let n = n.saturating_mul(n_channels(node)? as u64).min(8 * bytes.len() as u64) as usize;
            let bits = (0..n).map(|i| bytes[i / 8] >> (7 - i % 8) & 1).collect();
            return Ok(Numbers::Values(FieldValues::U8(bits)));
        }
        if !bytes.len().is_multiple_of(kind.n_bytes()) {
            let message =
                format!("its {} bytes do not form complete numbers; get the whole file", bytes.len());
            return Err(BlockError::Message(message));
        }
        Ok(Numbers::Bytes { bytes, kind, order: self.encoding.order })
    }

    fn appended(&self, node: Node<'_, '_>, progress: Progress<'_>) -> Result<Cow<'a, [u8]>, BlockError> {
        let message = |text: &str| Err(BlockError::Message(text.to_owned()));
        let Some(appended) = self.appended else {
            return message("its data are appended, but the file has no appended data; get the whole file");
        };
        let Some(offset) = node.attribute("offset").and_then(|text| text.trim().parse::<usize>().ok()) else {
            return message("its offset is missing; save the file again");
        };
        let Some(bytes) = appended.bytes.get(offset..) else {
            let end = appended.start + appended.bytes.len();
            return Err(BlockError::Message(format!(
                "its data begin after byte {end}, where they end; get the whole file"
            )));
        };
        if !appended.is_base64 {
            return plain(self, Cow::Borrowed(bytes), progress);
        }
        let next = self.offsets.partition_point(|&other| other <= offset);
        let length = self.offsets.get(next).map_or(bytes.len(), |next| (next - offset).min(bytes.len()));
        // Arrays may share a start.
        self.spend(length as u64)?;
        plain(self, Cow::Owned(from_base64(&bytes[..length], progress)?), progress)
    }

    /// Reads an array as a field; `None` if it has no numbers, or more than belong to the rows.
    pub(super) fn field<'n: 'a>(
        &self,
        node: Node<'n, '_>,
        n_rows: usize,
        of: &str,
        progress: Progress<'_>,
    ) -> Result<Option<Field>, ReadError> {
        if value_type(node).is_none() {
            return Ok(None);
        }
        let n_channels = n_channels(node)?;
        let numbers = self.array(node, progress)?;
        let found = numbers.len();
        let expected = n_rows.saturating_mul(n_channels);
        if found > expected {
            return Ok(None);
        }
        if found < expected {
            let message = format!(
                "array {} needs {n_channels} values for each of {n_rows} {of}, got {found}; get the \
                complete file",
                display_name(node)
            );
            return Err(error_at(node, message));
        }
        let name = node.attribute("Name").unwrap_or("array");
        Ok(Some(Field::new(name, n_channels, numbers.into_values(progress)?)))
    }

    /// Reads an array that belongs to no rows; `None` if it has no numbers in complete rows.
    pub(super) fn field_data<'n: 'a>(
        &self,
        node: Node<'n, '_>,
        progress: Progress<'_>,
    ) -> Result<Option<Field>, ReadError> {
        if value_type(node).is_none() {
            return Ok(None);
        }
        let (n_channels, numbers) = (n_channels(node)?, self.array(node, progress)?);
        let name = node.attribute("Name").unwrap_or("array");
        let is_whole = numbers.len().is_multiple_of(n_channels);
        Ok(if is_whole { Some(Field::new(name, n_channels, numbers.into_values(progress)?)) } else { None })
    }

    /// Array of that name in an element.
    pub(super) fn find_array<'n: 'a>(
        &self,
        section: Node<'n, '_>,
        name: &str,
        progress: Progress<'_>,
    ) -> Result<Option<Numbers<'a>>, ReadError> {
        let node = arrays(section).find(|node| node.attribute("Name") == Some(name));
        node.map(|node| self.array(node, progress)).transpose()
    }
}

/// Number of values per row of an array.
pub(super) fn n_channels(node: Node<'_, '_>) -> Result<usize, ReadError> {
    let n = count(node, "NumberOfComponents")?.unwrap_or(1).max(1);
    usize::try_from(n)
        .ok()
        .filter(|&n| n <= 1 << 20)
        .ok_or_else(|| error_at(node, format!("array {} has too many components: {n}", display_name(node))))
}

/// Text of an element, without its child elements.
fn text<'a>(node: Node<'a, '_>) -> Cow<'a, str> {
    let mut parts = node.children().filter(Node::is_text).filter_map(|child| child.text());
    let first = parts.next().unwrap_or("");
    match parts.next() {
        None => Cow::Borrowed(first),
        Some(second) => {
            let rest: Vec<&str> = parts.collect();
            Cow::Owned([first, second].into_iter().chain(rest).collect::<Vec<_>>().join(" "))
        }
    }
}

/// Creates the error for numbers that are not indices below `limit`.
pub(super) fn no_index(section: Node<'_, '_>, what: &str, error: IndexError, limit: u64) -> ReadError {
    match error {
        IndexError::Cancelled => adwave::Cancelled.into(),
        IndexError::Fractions => {
            error_at(section, format!("the {what} must be integers; save the file again"))
        }
        IndexError::At(i, x) => {
            let message = format!("number {i} of the {what} must be below {limit}, got {x}; correct it");
            error_at(section, message)
        }
    }
}
